#include "tests/apps/mesh_text.h"
#include "tests/apps/window_at_play.h"

#include <fstream>

namespace lorica::test {
namespace {

/// Drops files on the window, as a file manager does.
std::string drop(const std::vector<std::filesystem::path>& files) {
  std::string line = LORICA_DROP_FILES " $w";
  for (const std::filesystem::path& file : files) line += " " + file.string();
  return line;
}

class WindowDrop : public WindowPlay {
 protected:
  void SetUp() override {
    if (std::string(LORICA_DROP_FILES).empty()) GTEST_SKIP() << "libX11 is not installed (Debian package libx11-dev)";
    WindowPlay::SetUp();
  }
};

TEST_F(WindowDrop, BadFilesAreMessagesAndTheSessionGoesOn) {
  std::filesystem::create_directory(folder_.path() / "folder");
  const std::filesystem::path broken = folder_.write("broken.glb", "not a character"),
                              huge = folder_.write("huge.csv", ""), scene = folder_.write("scene.json", R"({
    "format": "lorica scene 1", "props": [{ "shape": "wheel" }] })");
  std::filesystem::resize_file(huge, std::uintmax_t{3} << 30);
  std::vector<std::filesystem::path> meshes;  // more than a session takes
  for (int m = 0; m < 13; ++m) {
    meshes.push_back(writeObj(folder_, std::to_string(m) + ".obj", makeBox({0, 0, 0}, {0.4, 0.4, 0.4})));
  }
  Hands hands(folder_);
  hands.mouse("windowsize --sync $w 480 360");
  hands.press("1 2 4 5 6 7 Tab space");  // an empty picture
  hands.picture("shift+p");
  for (const std::vector<std::filesystem::path>& files :
       {std::vector{broken}, {folder_.path() / "folder"}, {huge}, {folder_.path() / "gone.bvh"}, {scene}, meshes}) {
    hands.line(drop(files));
    hands.sleep("0.4");
  }
  hands.picture("shift+p");
  const CommandResult result =
      hands.runWith({"play", "walk", "--window", "--decomposition", body_, "--json", "-"}, *display_);
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.json()["recording"], "walk");
  EXPECT_GT(differing(hands.pictureNumber(1), hands.pictureNumber(2)), 1000) << "a message";
}

TEST_F(WindowDrop, AMotionThatEndsEarlyIsPlayedAndSaid) {
  const std::filesystem::path whole = folder_.path() / "whole.bvh", early = folder_.path() / "early.bvh";
  ASSERT_EQ(runLorica({"convert", shipped("wave.csv"), whole.string()}).exitCode, 0);
  const std::string text = readFile(whole).value();
  std::ofstream(early) << text.substr(0, text.size() / 2);
  Hands hands(folder_);
  hands.mouse("windowsize --sync $w 480 360");
  hands.press("1 2 4 5 6 7 Tab space");  // an empty picture
  for (const std::filesystem::path& file : {whole, early}) {
    hands.line(drop({file}));
    hands.sleep("3");
    hands.picture("shift+p");
  }
  const CommandResult result =
      hands.runWith({"play", "walk", "--window", "--decomposition", body_, "--json", "-"}, *display_);
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.json()["recording"], "early");
  EXPECT_GT(differing(hands.pictureNumber(1), hands.pictureNumber(2)), 1000) << "a message";
}

TEST_F(WindowDrop, TheDemoGoesOnWithWhatIsDroppedOnIt) {
  Hands hands(folder_);
  hands.sleep("1");
  hands.line(drop({shipped("wave.csv")}));
  hands.line("xdotool search --sync --name '^Lorica: wave'");
  const CommandResult result = hands.runWith({"demo", "--window", "--seconds", "120", "--json", "-"}, *display_);
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.json()["recording"], "wave");
}

TEST_F(WindowDrop, WhatIsDroppedWhileTheFirstBodyIsDecomposedIsOpenedAfterIt) {
  Hands hands(folder_);
  hands.line(drop({shipped("wave.csv")}));
  hands.line("xdotool search --sync --name '^Lorica: wave'");
  const CommandResult result = hands.runWith({"play", "walk", "--window", "--json", "-"}, *display_);
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.json()["recording"], "wave");
}

TEST_F(WindowDrop, OfSeveralMotionsTheFirstIsPlayedAndTheOthersAreInTheList) {
  Hands hands(folder_);
  hands.sleep("1");
  hands.line(drop({shipped("wave.csv"), shipped("turn_around.csv"), shipped("jumping_jacks.csv")}));
  hands.line("xdotool search --sync --name '^Lorica: wave'");
  hands.sleep("0.5");
  hands.mouse("mousemove --window $w 113 393 click 1");  // the list of files
  hands.sleep("0.5");
  hands.mouse("mousemove --window $w 113 465 click 1");  // the third
  hands.line("xdotool search --sync --name '^Lorica: jumping_jacks'");
  const CommandResult result =
      hands.runWith({"play", "walk", "--window", "--decomposition", body_, "--json", "-"}, *display_);
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.json()["recording"], "jumping_jacks");
}

TEST_F(WindowDrop, AMotionASceneAndAMeshReplaceWhatIsPlayed) {
  const std::filesystem::path scene = folder_.write("empty.json", R"({"format": "lorica scene 1", "props": []})");
  const std::filesystem::path mesh = writeObj(folder_, "box.obj", makeBox({0, 0, 0}, {0.4, 0.4, 0.4}));
  Hands hands(folder_);
  hands.mouse("windowsize --sync $w 480 360");
  hands.line(drop({shipped("wave.csv"), scene}));
  hands.sleep("1");
  hands.press("Tab space 1 2 5 6 Home");
  hands.sleep("0.5");
  hands.picture();
  hands.line(drop({mesh}));
  hands.sleep("1");
  hands.press("Home 1 2");
  hands.sleep("0.5");
  hands.picture();
  const CommandResult result =
      hands.runWith({"play", "walk", "--window", "--decomposition", body_, "--json", "-"}, *display_);
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.json()["recording"], "wave");
  EXPECT_GT(differing(hands.pictureNumber(1), hands.pictureNumber(2)), 500) << "the mesh is a prop";
}

TEST_F(WindowDrop, TheSessionGoesOnWhileTheSandOfADroppedSceneSettles) {
  const std::filesystem::path scene = folder_.write("sand.json", R"({
    "format": "lorica scene 1", "grains": {"radius": 0.02, "settle": 20,
    "fill": [{"at": [0, 0.5, 0], "size": [3, 1, 3], "count": 150000}]}})");
  Hands hands(folder_);
  hands.mouse("windowsize --sync $w 480 360");
  hands.press("Tab");
  hands.line(drop({scene}));
  hands.sleep("1");
  hands.picture();
  hands.sleep("0.3");
  hands.picture();
  const CommandResult result =
      hands.runWith({"play", "walk", "--window", "--decomposition", body_, "--json", "-"}, *display_);
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_GT(differing(hands.pictureNumber(1), hands.pictureNumber(2)), 200) << "the avatar walks on";
}

TEST_F(WindowDrop, AFileThatVanishesWhileItLoadsDoesNotEndTheSession) {
  Hands hands(folder_);
  for (const std::string after : {"0", "0.01", "0.1"}) {
    const std::filesystem::path copy = folder_.path() / ("copy" + after + ".csv");
    std::filesystem::copy_file(shipped("wave.csv"), copy);
    hands.line(drop({copy}));
    hands.sleep(after);
    hands.line("rm " + copy.string());
    hands.sleep("0.5");
  }
  const CommandResult result =
      hands.runWith({"play", "walk", "--window", "--decomposition", body_, "--json", "-"}, *display_);
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_GT(result.json()["frames"], 0);
}

}  // namespace
}  // namespace lorica::test

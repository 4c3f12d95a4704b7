#include "tests/apps/mesh_text.h"
#include "tests/apps/window_at_play.h"

#include <fstream>

namespace lorica::test {
namespace {

/// Drops files on the window, as a file manager does.
std::string drop(const std::vector<std::filesystem::path>& files) {
  std::string line = built("lorica_drop_files").string() + " $w";
  for (const std::filesystem::path& file : files) line += " " + file.string();
  return line;
}

class WindowDrop : public WindowPlay {
 protected:
  void SetUp() override {
    if (!exists(built("lorica_drop_files"))) GTEST_SKIP() << "libX11 is not installed (Debian package libx11-dev)";
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
    hands.handled();
  }
  hands.pictureUnlike(1, 1000, "shift+p");
  const CommandResult result = hands.runWith({"play", "walk", "--window", "--decomposition", body_, "--json", "-"});
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
  hands.line(drop({whole}));
  hands.session("whole");
  hands.picture("shift+p");
  hands.line(drop({early}));
  hands.session("early");
  hands.pictureUnlike(1, 1000, "shift+p");
  const CommandResult result = hands.runWith({"play", "walk", "--window", "--decomposition", body_, "--json", "-"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.json()["recording"], "early");
  EXPECT_GT(differing(hands.pictureNumber(1), hands.pictureNumber(2)), 1000) << "a message";
}

TEST_F(WindowDrop, TheDemoGoesOnWithWhatIsDroppedOnIt) {
  Hands hands(folder_);
  hands.handled();
  hands.line(drop({shipped("wave.csv")}));
  hands.session("wave");
  const CommandResult result = hands.runWith({"demo", "--window", "--seconds", "120", "--json", "-"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.json()["recording"], "wave");
}

TEST_F(WindowDrop, WhatIsDroppedWhileTheFirstBodyIsDecomposedIsOpenedAfterIt) {
  Hands hands(folder_, "^Lorica");
  hands.surroundings.cache = "/dev/null";
  hands.line(drop({shipped("wave.csv")}));
  hands.session("wave");
  const CommandResult result = hands.runWith({"play", "walk", "--window", "--json", "-"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.json()["recording"], "wave");
}

TEST_F(WindowDrop, OfSeveralMotionsTheFirstIsPlayedAndTheOthersAreInTheList) {
  Hands hands(folder_);
  hands.line(drop({shipped("wave.csv"), shipped("turn_around.csv"), shipped("jumping_jacks.csv")}));
  hands.session("wave");
  hands.handled();
  hands.mouse("mousemove --window $w 113 129 click 1");  // the list of files
  hands.handled();
  hands.mouse("mousemove --window $w 113 201 click 1");  // the third
  hands.session("jumping_jacks");
  const CommandResult result = hands.runWith({"play", "walk", "--window", "--decomposition", body_, "--json", "-"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.json()["recording"], "jumping_jacks");
}

TEST_F(WindowDrop, AMotionASceneAndAMeshReplaceWhatIsPlayed) {
  const std::filesystem::path scene = folder_.write("empty.json", R"({"format": "lorica scene 1", "props": []})");
  const std::filesystem::path mesh = writeObj(folder_, "box.obj", makeBox({0, 0, 0}, {0.4, 0.4, 0.4}));
  Hands hands(folder_);
  hands.mouse("windowsize --sync $w 480 360");
  hands.line(drop({shipped("wave.csv"), scene}));
  hands.session("wave");
  hands.press("Tab space 1 2 5 6 Home");
  hands.pictureAtRest();
  hands.line(drop({mesh}));
  hands.pictureUnlike(1, 500);
  hands.press("Home 1 2");
  hands.pictureAtRest();
  const CommandResult result = hands.runWith({"play", "walk", "--window", "--decomposition", body_, "--json", "-"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.json()["recording"], "wave");
  EXPECT_GT(differing(hands.pictureNumber(1), hands.pictureNumber(3)), 500) << "the mesh is a prop";
}

TEST_F(WindowDrop, TheSessionGoesOnWhileTheSandOfADroppedSceneSettles) {
  const std::filesystem::path scene = folder_.write("sand.json", R"({
    "format": "lorica scene 1", "grains": {"radius": 0.02, "settle": 20,
    "fill": [{"at": [0, 0.5, 0], "size": [3, 1, 3], "count": 150000}]}})");
  Hands hands(folder_);
  hands.mouse("windowsize --sync $w 480 360");
  hands.press("Tab");
  hands.line(drop({scene}));
  hands.handled();
  hands.picture();
  hands.pictureUnlike(1, 200);
  const CommandResult result = hands.runWith({"play", "walk", "--window", "--decomposition", body_, "--json", "-"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_GT(differing(hands.pictureNumber(1), hands.pictureNumber(2)), 200) << "the avatar walks on";
}

TEST_F(WindowDrop, AFileThatVanishesWhileItLoadsDoesNotEndTheSession) {
  Hands hands(folder_);
  for (const std::string after : {"0", "0.01", "0.1"}) {
    const std::filesystem::path copy = folder_.path() / ("copy" + after + ".csv");
    std::filesystem::copy_file(shipped("wave.csv"), copy);
    hands.line(drop({copy}));
    hands.line("sleep " + after + "; rm " + copy.string());
    hands.handled();
  }
  const CommandResult result = hands.runWith({"play", "walk", "--window", "--decomposition", body_, "--json", "-"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_GT(result.json()["frames"], 0);
}

}  // namespace
}  // namespace lorica::test

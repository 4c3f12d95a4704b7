#include "tests/apps/window_at_play.h"

#include "tests/apps/mesh_text.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <thread>

namespace lorica::test {
namespace {

/// A scene whose sand settles around the feet.
std::string sandScene(int grains, double settle) {
  return R"({"format": "lorica scene 1", "grains": {"radius": 0.02, "settle": )" + std::to_string(settle) +
         R"(, "fill": [{"at": [0, 0.5, 0], "size": [3, 1, 3], "count": )" + std::to_string(grains) + "}]}}";
}

/// Windows that load at first.
class WindowLoading : public ::testing::Test {
 protected:
  void SetUp() override { LORICA_REQUIRE_KEYS(); }

  std::string smallBody() { return mannequinBody(folder_, 4); }

  /// Runs the command while something is done with its window, which still decomposes the body: that is not finished.
  void expectLeftAtOnce(const std::vector<std::string>& arguments, const std::string& command = "true") {
    Hands hands(folder_, "^Lorica");
    hands.line(command);
    const std::filesystem::path cache = folder_.path() / "cache";
    hands.surroundings.cache = cache;
    const CommandResult result = hands.runWith(arguments);
    EXPECT_EQ(result.exitCode, 0) << arguments[0] << ": " << result.err;
    EXPECT_EQ(result.out, "") << arguments[0];
    if (!exists(cache)) return;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(cache)) {
      EXPECT_NE(entry.path().extension(), ".lorica") << arguments[0] << " decomposed to the end";
    }
  }

  TemporaryFolder folder_;
};

TEST_F(WindowLoading, ClosingWhileTheBodyIsDecomposedEndsAtOnce) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"play", "walk", "--window"},
                                                    {"demo", "--window"},
                                                    {"live", "--virtual", "--window"}}) {
    expectLeftAtOnce(arguments);
  }
}

TEST_F(WindowLoading, AReplayOpensItsWindowFirst) {
  const std::string recorded = folder_.path() / "walk.lsession", body = smallBody();
  const nlohmann::json made =
      jsonOf({"play", "--force", "walk", "--decomposition", body, "--record", recorded, "--frames", "30"});
  std::filesystem::remove(body);
  const VirtualDisplay display;
  const CommandResult missing =
      runLorica({"replay", recorded, "--window"}, {.folder = folder_.path(), .display = display.name()});
  EXPECT_EQ(missing.exitCode, 2);
  EXPECT_NE(missing.err.find("body.lorica"), std::string::npos) << missing.err;
  const CommandResult whole = runLorica({"play", "--force", "walk", "--record", recorded, "--frames", "30"});
  ASSERT_EQ(whole.exitCode, 0) << whole.err;
  expectLeftAtOnce({"replay", recorded, "--window"});
}

TEST_F(WindowLoading, ClosingWhileTheCameraIsOpenedEndsAtOnce) {
  const std::filesystem::path driver = built("tests/capture/sensor/libopenni_test_driver.so");
  if (!exists(driver)) GTEST_SKIP() << "built without OpenNI2";
  // The driver reads a pipe that is never written to: it would never come back.
  const std::filesystem::path cameras = folder_.path() / "cameras";
  std::filesystem::create_directory(cameras);
  ASSERT_EQ(mkfifo((cameras / "slow").c_str(), 0600), 0);
  const std::string body = smallBody();
  Hands hands(folder_, "^Lorica");
  hands.line("exec 3>cameras/slow; xdotool key Escape; sleep 1000");  // opened once the driver reads it
  setenv("LORICA_TEST_CAMERAS", cameras.c_str(), 1);
  const CommandResult result = hands.runWith({"live", "--driver", driver, "--decomposition", body, "--window"});
  unsetenv("LORICA_TEST_CAMERAS");
  EXPECT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.out, "");
}

TEST_F(WindowLoading, WhatCannotBeLoadedAtFirstIsTheCommandsError) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"play", "nowhere.bvh", "--window"},
                                                    {"live", "--virtual", "--character", "nowhere.glb", "--window"},
                                                    {"live", "--virtual", "--scene", "nowhere.json", "--window"}}) {
    const VirtualDisplay display;
    const CommandResult result = runLorica(arguments, {.folder = folder_.path(), .display = display.name()});
    EXPECT_EQ(result.exitCode, 2) << result.err;
    EXPECT_NE(result.err.find("nowhere."), std::string::npos) << result.err;
    EXPECT_EQ(result.out, "");
  }
}

TEST_F(WindowLoading, ADisplayThatGoesAwayEndsTheProgramWithASentence) {
  const std::string body = smallBody(), recorded = folder_.path() / "recorded.lsession";
  const std::filesystem::path part = folder_.path() / "recorded.part.lsession";
  const auto expectUnplugged = [&](const std::vector<std::string>& arguments, const std::string& title, bool records) {
    std::optional<VirtualDisplay> display(std::in_place);
    const CommandSurroundings surroundings = {
        .folder = folder_.path(), .cache = "/dev/null", .display = display->name()};
    std::thread unplug([&] {
      EXPECT_EQ(std::system(("xdotool search --sync --onlyvisible --name '" + title + "'").c_str()), 0);
      while (records && !(exists(part) && file_size(part) > 5000)) usleep(5000);
      display.reset();
    });
    const CommandResult result = runLorica(arguments, surroundings);
    unplug.join();
    EXPECT_EQ(result.exitCode, 2) << result.err;
    EXPECT_TRUE(result.err.ends_with("lorica: the connection to the display was lost\n")) << result.err;
    EXPECT_EQ(result.out, "");
  };
  expectUnplugged({"play", "walk", "--window"}, "^Lorica$", false);  // while it decomposes
  expectUnplugged({"play", "--force", "walk", "--window", "--decomposition", body, "--record", recorded},
                  "^Lorica: ", true);
  const nlohmann::json again = jsonOf({"replay", recorded, "--decomposition", body});
  EXPECT_EQ(again["same"], true) << "what was recorded until then is kept";
}

TEST_F(WindowLoading, CancelIsAsClosing) {
  // Until there is no window any more.
  expectLeftAtOnce({"demo", "--window"}, "while xdotool mousemove --window $w 774 51 click 1; do sleep 0.2; done");
}

TEST_F(WindowLoading, ClosingWhileSandSettlesEndsAtOnce) {
  // It settles for minutes before the session comes to the window, and in its first step.
  const std::string body = smallBody(), scene = folder_.write("sand.json", sandScene(150'000, 20.0));
  for (const std::vector<std::string>& source : {std::vector<std::string>{"play", "walk"}, {"live", "--virtual"}}) {
    std::vector<std::string> arguments = source;
    arguments.insert(arguments.end(), {"--window", "--scene", scene, "--decomposition", body});
    Hands hands(folder_, "^Lorica");
    hands.line("sleep 2");  // where the machine is slow it is left before it settles
    const CommandResult result = hands.runWith(arguments);
    EXPECT_EQ(result.exitCode, 0) << source[0] << ": " << result.err;
  }
}

/// Runs from the first frame, at which the session is paused, to its last one, where it is paused again.
void runToTheEnd(int first, Hands& hands) {
  hands.press("space");
  hands.pictureUnlike(first, 0);
  hands.pictureAtRest();
  hands.press("space");
}

TEST_F(WindowLoading, WithOtherPartsSandSettlesBesideThePictureAndAsItAlwaysDoes) {
  const std::string body = smallBody(), scene = folder_.write("sand.json", sandScene(5'000, 0.5));
  std::vector<nlohmann::json> hashes;
  for (const bool again : {false, true}) {  // the second time the first frame is known
    Hands hands(folder_);
    hands.pictureAtRest();  // the last frame
    hands.press("space bracketleft");
    hands.pictureUnlike(1, 0);
    hands.press("Home");
    hands.pictureUnlike(2, 0);  // the sand lies otherwise around other parts
    hands.handled();            // while nothing is to be seen, pictures wait
    runToTheEnd(3, hands);
    if (again) {
      hands.press("Home");
      hands.pictureUnlike(5, 0);
      runToTheEnd(6, hands);
    }
    const CommandResult result =
        hands.runWith({"play", "walk", "--scene", scene, "--decomposition", body, "--frames", "4", "--json", "-",
                       "--events", folder_.path() / "events.jsonl", "--force", "--window"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    ASSERT_EQ(result.json()["avatars"][0]["parts"], 3) << hands.said();
    hashes.push_back(result.json()["hash"]);
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST_F(WindowLoading, WhileSandSettlesAroundOtherPartsTheSessionGoesOn) {
  const std::string body = smallBody(), scene = folder_.write("sand.json", sandScene(5'000, 20.0));
  Hands hands(folder_);
  hands.mouse("windowsize --sync $w 480 360");
  hands.press("Tab space");
  hands.pictureAtRest();
  hands.press("bracketleft");
  hands.pictureUnlike(1, 0);
  hands.press("Home space");
  hands.picture();
  hands.pictureUnlike(3, 200);  // the avatar walks on
  const CommandResult result =
      hands.runWith({"play", "walk", "--scene", scene, "--decomposition", body, "--window", "--json", "-"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_GT(differing(hands.pictureNumber(3), hands.pictureNumber(4)), 200) << hands.said();
}

TEST_F(WindowLoading, WhatSettlesBesideThePictureIsAsInAnUninterruptedRun) {
  const std::string body = smallBody(), scene = folder_.write("sand.json", sandScene(5'000, 0.5));
  const std::vector<std::string> command{"play",     "walk", "--scene", scene, "--decomposition", body,
                                         "--frames", "4",    "--json",  "-",   "--events",        ""};
  std::vector<std::string> alone = command, again = command;
  alone.back() = folder_.path() / "alone.jsonl";
  again.back() = folder_.path() / "again.jsonl";
  again.emplace_back("--window");
  const CommandResult truth = runLorica(alone);
  ASSERT_EQ(truth.exitCode, 0) << truth.err;
  Hands hands(folder_);
  hands.pictureAtRest();  // the last frame
  hands.press("space Home");
  hands.pictureUnlike(1, 0);  // it has settled once more
  runToTheEnd(2, hands);
  const CommandResult result = hands.runWith(again);
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.json()["frames"], 4);
  EXPECT_EQ(result.json()["hash"], truth.json()["hash"]);
}

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
  hands.mouse("mousemove --window $w 113 164 click 1");  // the list of files
  hands.handled();
  hands.mouse("mousemove --window $w 113 243 click 1");  // the third
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

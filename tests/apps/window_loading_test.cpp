#include "tests/apps/window_at_play.h"

#include <sys/stat.h>
#include <unistd.h>
#include <cstdlib>
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
  const CommandResult made = runLorica(
      {"play", "--force", "walk", "--decomposition", body, "--record", recorded, "--frames", "30", "--json", "-"});
  ASSERT_EQ(made.exitCode, 0) << made.err;
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
  const CommandResult again = runLorica({"replay", recorded, "--decomposition", body, "--json", "-"});
  ASSERT_EQ(again.exitCode, 0) << again.err;
  EXPECT_EQ(again.json()["same"], true) << "what was recorded until then is kept";
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

}  // namespace
}  // namespace lorica::test

#include "tests/apps/window_at_play.h"

#include <sys/stat.h>
#include <chrono>
#include <sstream>
#include <thread>

namespace lorica::test {
namespace {

using Clock = std::chrono::steady_clock;

/// A scene whose sand settles around the feet.
std::string sandScene(int grains, double settle) {
  return R"({"format": "lorica scene 1", "grains": {"radius": 0.02, "settle": )" + std::to_string(settle) +
         R"(, "fill": [{"at": [0, 0.5, 0], "size": [3, 1, 3], "count": )" + std::to_string(grains) + "}]}}";
}

/// Windows that load at first: without a cache of decompositions.
class WindowLoading : public ::testing::Test {
 protected:
  void SetUp() override {
    LORICA_REQUIRE_KEYS();
    display_.emplace();
    ASSERT_TRUE(display_->ready());
    surroundings_.display = display_->name();
    surroundings_.folder = folder_.path();
  }
  /// Does something with a window, $w, in parallel with the command. Ends what was done before.
  void inWindow(const std::string& commands) {
    const std::filesystem::path script = folder_.write(
        "hands.sh", "w=$(xdotool search --sync --name '^Lorica')\nxdotool windowfocus --sync $w\n" + commands);
    hands_.emplace(script, 30);
  }

  std::string smallBody() {
    std::string body = folder_.path() / "body.lorica";
    EXPECT_EQ(runLorica({"decompose", "mannequin", "--parts", "4", "--keyframes", "2", "-o", body}).exitCode, 0);
    return body;
  }

  TemporaryFolder folder_;
  std::optional<VirtualDisplay> display_;
  std::optional<BackgroundScript> hands_;
  CommandSurroundings surroundings_;
};

TEST_F(WindowLoading, ClosingWhileTheBodyIsDecomposedEndsAtOnce) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"play", "walk", "--window"},
                                                    {"demo", "--window"},
                                                    {"live", "--virtual", "--window"}}) {
    inWindow("sleep 0.7\nxdotool key Escape\n");
    const Clock::time_point begin = Clock::now();
    const CommandResult result = runLorica(arguments, surroundings_);
    EXPECT_EQ(result.exitCode, 0) << arguments[0] << ": " << result.err;
    EXPECT_EQ(result.out, "") << arguments[0];
    EXPECT_LT(Clock::now() - begin, std::chrono::seconds(10)) << arguments[0] << ": the whole takes longer";
  }
}

TEST_F(WindowLoading, AReplayOpensItsWindowFirst) {
  const std::string recorded = folder_.path() / "walk.lsession", body = smallBody();
  const CommandResult made =
      runLorica({"play", "walk", "--decomposition", body, "--record", recorded, "--frames", "30", "--json", "-"});
  ASSERT_EQ(made.exitCode, 0) << made.err;
  std::filesystem::remove(body);
  const CommandResult missing = runLorica({"replay", recorded, "--window"}, surroundings_);
  EXPECT_EQ(missing.exitCode, 2);
  EXPECT_NE(missing.err.find("body.lorica"), std::string::npos) << missing.err;
  const CommandResult whole = runLorica({"play", "walk", "--record", recorded, "--frames", "30"}, surroundings_);
  ASSERT_EQ(whole.exitCode, 0) << whole.err;
  inWindow("sleep 0.7\nxdotool key Escape\n");  // while it decomposes
  const CommandResult closed = runLorica({"replay", recorded, "--window"}, surroundings_);
  EXPECT_EQ(closed.exitCode, 0) << closed.err;
  EXPECT_EQ(closed.out, "");
}

#ifdef LORICA_TEST_DRIVER
TEST_F(WindowLoading, ClosingWhileTheCameraIsOpenedEndsAtOnce) {
  // The driver reads a pipe that nobody writes.
  const std::filesystem::path cameras = folder_.path() / "cameras";
  std::filesystem::create_directory(cameras);
  ASSERT_EQ(mkfifo((cameras / "slow").c_str(), 0600), 0);
  setenv("LORICA_TEST_CAMERAS", cameras.c_str(), 1);
  const std::string body = smallBody();
  inWindow("sleep 1.5\nxdotool key Escape\n");
  const Clock::time_point begin = Clock::now();
  const CommandResult result =
      runLorica({"live", "--driver", LORICA_TEST_DRIVER, "--decomposition", body, "--window"}, surroundings_);
  unsetenv("LORICA_TEST_CAMERAS");
  EXPECT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_LT(Clock::now() - begin, std::chrono::seconds(10)) << "it would never come back";
}
#endif

TEST_F(WindowLoading, WhatCannotBeLoadedAtFirstIsTheCommandsError) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"play", "nowhere.bvh", "--window"},
                                                    {"live", "--virtual", "--character", "nowhere.glb", "--window"},
                                                    {"live", "--virtual", "--scene", "nowhere.json", "--window"}}) {
    const CommandResult result = runLorica(arguments, surroundings_);
    EXPECT_EQ(result.exitCode, 2) << result.err;
    EXPECT_NE(result.err.find("nowhere."), std::string::npos) << result.err;
    EXPECT_EQ(result.out, "");
  }
}

TEST_F(WindowLoading, ADisplayThatGoesAwayEndsTheProgramWithASentence) {
  const std::string body = smallBody(), recorded = folder_.path() / "recorded.lsession";
  for (const std::vector<std::string>& arguments :  // while it decomposes, and while it plays
       {std::vector<std::string>{"play", "walk", "--window"},
        {"play", "walk", "--window", "--decomposition", body, "--record", recorded}}) {
    std::thread unplug([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(2000));
      display_.reset();
    });
    const CommandResult result = runLorica(arguments, surroundings_);
    unplug.join();
    EXPECT_EQ(result.exitCode, 2) << result.err;
    EXPECT_TRUE(result.err.ends_with("lorica: the connection to the display was lost\n")) << result.err;
    EXPECT_EQ(result.out, "");
    display_.emplace();
    surroundings_.display = display_->name();
  }
  const CommandResult again = runLorica({"replay", recorded, "--decomposition", body, "--json", "-"});
  ASSERT_EQ(again.exitCode, 0) << again.err;
  EXPECT_EQ(again.json()["same"], true) << "what was recorded until then is kept";
}

TEST_F(WindowLoading, CancelIsAsClosing) {
  inWindow(
      "for i in 1 2 3 4 5 6 7 8 9 10; do sleep 1; xdotool mousemove --window $w 774 51 click 1 || exit; done\n"
      "xdotool key Escape\n");
  const Clock::time_point begin = Clock::now();
  const CommandResult result = runLorica({"demo", "--window"}, surroundings_);
  EXPECT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_LT(Clock::now() - begin, std::chrono::seconds(10)) << "the whole takes longer";
}

TEST_F(WindowLoading, ClosingWhileSandSettlesEndsAtOnce) {
  const std::string body = smallBody(), scene = folder_.write("sand.json", sandScene(150'000, 20.0));
  // Before the session comes to the window, and in its first step.
  for (const std::vector<std::string>& source : {std::vector<std::string>{"play", "walk"}, {"live", "--virtual"}}) {
    std::vector<std::string> arguments = source;
    arguments.insert(arguments.end(), {"--window", "--scene", scene, "--decomposition", body});
    inWindow("sleep 2\nxdotool key Escape\n");
    const Clock::time_point begin = Clock::now();
    const CommandResult result = runLorica(arguments, surroundings_);
    EXPECT_EQ(result.exitCode, 0) << source[0] << ": " << result.err;
    EXPECT_LT(Clock::now() - begin, std::chrono::seconds(10)) << source[0] << ": the whole takes longer";
  }
}

TEST_F(WindowLoading, WithOtherPartsSandSettlesBesideThePictureAndAsItAlwaysDoes) {
  const std::string body = smallBody(), scene = folder_.write("sand.json", sandScene(5'000, 0.5));
  std::vector<nlohmann::json> hashes;
  for (const char* times : {"Home", "Home Home"}) {  // the second time the first frame is known
    Hands hands(folder_);
    hands.press("space");
    hands.picture();  // after the first frame, which may take long
    hands.press("bracketleft");
    hands.sleep("1");
    for (std::istringstream keys(times); !keys.eof();) {
      std::string key;
      keys >> key;
      hands.press(key);
      hands.sleep("1.5");
    }
    hands.press("space");
    hands.sleep("1");
    const CommandResult result =
        hands.runWith({"play", "walk", "--scene", scene, "--decomposition", body, "--frames", "4", "--json", "-",
                       "--events", folder_.path() / "events.jsonl", "--window"},
                      *display_);
    ASSERT_EQ(result.exitCode, 0) << result.err;
    ASSERT_EQ(result.json()["avatars"][0]["parts"], 3) << hands.said();
    hashes.push_back(result.json()["hash"]);
    EXPECT_TRUE(std::filesystem::remove(folder_.path() / "lorica-001.png")) << "the next one has its name";
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST_F(WindowLoading, WhileSandSettlesAroundOtherPartsTheSessionGoesOn) {
  const std::string body = smallBody(), scene = folder_.write("sand.json", sandScene(20'000, 20.0));
  Hands hands(folder_);
  hands.mouse("windowsize --sync $w 480 360");
  hands.line("xdotool search --sync --name '^Lorica: walk'");
  hands.press("Tab bracketleft");
  hands.sleep("1");
  hands.press("Home");
  hands.sleep("0.7");
  hands.picture();
  hands.sleep("0.3");
  hands.picture();
  const CommandResult result =
      hands.runWith({"play", "walk", "--scene", scene, "--decomposition", body, "--window", "--json", "-"}, *display_);
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_GT(differing(hands.pictureNumber(1), hands.pictureNumber(2)), 200) << "the avatar walks on";
}

TEST_F(WindowLoading, WhatSettlesBesideThePictureIsAsInAnUninterruptedRun) {
  const std::string body = smallBody(), scene = folder_.write("sand.json", sandScene(5'000, 0.5));
  const std::vector<std::string> command{"play",     "walk", "--scene", scene, "--decomposition", body,
                                         "--frames", "4",    "--json",  "-",   "--events",        ""};
  std::vector<std::string> alone = command, again = command;
  alone.back() = folder_.path() / "alone.jsonl";
  again.back() = folder_.path() / "again.jsonl";
  again.emplace_back("--window");
  const CommandResult truth = runLorica(alone, surroundings_);
  ASSERT_EQ(truth.exitCode, 0) << truth.err;
  Hands hands(folder_);
  hands.sleep("1");
  hands.press("Home");  // it settles once more
  hands.sleep("2");
  const CommandResult result = hands.runWith(again, *display_);
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.json()["frames"], 4);
  EXPECT_EQ(result.json()["hash"], truth.json()["hash"]);
}

}  // namespace
}  // namespace lorica::test

#include "geometry/files.h"
#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

namespace lorica::test {
namespace {

CommandSurroundings before(const std::string& virtualCamera) {
  CommandSurroundings surroundings;
  surroundings.virtualCamera = virtualCamera;
  return surroundings;
}

TEST(Live, AVirtualPersonIsFollowed) {
  const TemporaryFolder folder;
  const CommandResult result = runLorica({"live", "--virtual", "--motion", "wave", "--decomposition",
                                          mannequinBody(folder), "--frames", "30", "--headless", "--json", "-"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const nlohmann::json json = result.json();
  EXPECT_GT(json["depthFrames"].get<int>(), 20);
  EXPECT_GT(json["framesWithPerson"].get<int>(), 20);
  EXPECT_EQ(json["maxPeople"], 1);
  EXPECT_EQ(json["unplugged"], 0);
  // bench/tracking measures how soon; a busy machine drops images here.
  EXPECT_GE(json["firstPose"].get<double>(), 0.0);
  EXPECT_GE(json["latency"]["median"].get<double>(), json["tracking"]["median"].get<double>());
}

TEST(Live, AwayFromTheRecordingsItTrainsOnTheSameMotionsMadeAnew) {
  const TemporaryFolder folder;
  CommandSurroundings moved;
  moved.recordings = "/nowhere";
  const CommandResult live =
      runLorica({"live", "--virtual", "--motion", "wave", "--frames", "3", "--headless", "--json", "-"}, moved);
  ASSERT_EQ(live.exitCode, 0) << live.err;
  EXPECT_EQ(live.json()["parts"], 16);
  const auto hashOf = [](const CommandSurroundings& surroundings) {
    const CommandResult made =
        runLorica({"decompose", "mannequin", "--parts", "3", "--keyframes", "4", "--json", "-"}, surroundings);
    EXPECT_EQ(made.exitCode, 0) << made.err;
    return made.json()["hash"];
  };
  EXPECT_EQ(hashOf(moved), hashOf({}));
}

TEST(Live, AnUnpluggedSensorIsSurvivedAndComesBack) {
  const TemporaryFolder folder;
  CommandSurroundings unplugged = before("unplug=1.5:3.5");
  unplugged.interruptWhen = [](const RunningCommand& command) {
    return command.err.find("the sensor is back") != std::string::npos &&
           command.err.find("a person is tracked") != std::string::npos;
  };
  const CommandResult result = runLorica(
      {"live", "--virtual", "--decomposition", mannequinBody(folder), "--headless", "--json", "-"}, unplugged);
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const nlohmann::json json = result.json();
  EXPECT_EQ(json["unplugged"], 1) << result.err;
  EXPECT_NE(result.err.find("the sensor is back"), std::string::npos) << result.err;
  EXPECT_GT(json["framesWithPerson"].get<int>(), 0);
}

TEST(Live, CtrlCEndsItWithASummary) {
  const TemporaryFolder folder;
  CommandSurroundings surroundings;
  surroundings.interruptWhen = [](const RunningCommand& command) {
    return command.err.find("a person is tracked") != std::string::npos;
  };
  const CommandResult result =
      runLorica({"live", "--virtual", "--decomposition", mannequinBody(folder), "--headless"}, surroundings);
  EXPECT_EQ(result.exitCode, 0) << result.err;
  EXPECT_NE(result.out.find("latency"), std::string::npos) << result.out;
}

TEST(Live, WrongSourcesAreRefusedInASentence) {
  const CommandResult noCamera = runLorica({"live", "--headless", "--frames", "5"});
  EXPECT_EQ(noCamera.exitCode, 2);
  EXPECT_NE(noCamera.err.find("--virtual"), std::string::npos) << noCamera.err;
  const CommandResult noMotion = runLorica({"live", "--virtual", "--motion", "flying", "--headless", "--frames", "5"});
  EXPECT_EQ(noMotion.exitCode, 2);
  EXPECT_NE(noMotion.err.find("flying"), std::string::npos) << noMotion.err;
  const CommandResult noDriver = runLorica({"live", "--driver", "nowhere/libX.so.0", "--headless", "--frames", "5"});
  EXPECT_EQ(noDriver.exitCode, 2);
  EXPECT_NE(noDriver.err.find("libX.so.0"), std::string::npos) << noDriver.err;
  EXPECT_EQ(runLorica({"live", "--motion", "walk"}).exitCode, 2) << "--motion is for the virtual camera";
}

TEST(Record, WhatAVirtualCameraSawCanBePlayed) {
  const TemporaryFolder folder;
  const std::filesystem::path out = folder.path() / "seen.oni";
  // Each image once, however slow the machine: people are found after half a second of theirs.
  const CommandResult recorded =
      runLorica({"record", out, "--virtual", "--frames", "40", "--json", "-"}, before("pace=fast"));
  ASSERT_EQ(recorded.exitCode, 0) << recorded.err;
  const int frames = recorded.json()["frames"];
  EXPECT_GE(frames, 40);
  EXPECT_GT(recorded.json()["skeletons"].get<int>(), 10);
  EXPECT_EQ(filesIn(folder.path()), (std::vector<std::string>{"seen.csv", "seen.oni"}));

  EXPECT_EQ(runLorica({"info", out, "--json", "-"}).json()["frames"], frames);
  const std::string body = mannequinBody(folder);
  const CommandResult played = runLorica({"play", out, "--decomposition", body, "--json", "-"});
  ASSERT_EQ(played.exitCode, 0) << played.err;
  EXPECT_EQ(played.json()["frames"], frames) << "every frame once";
  const CommandResult again = runLorica({"play", out, "--decomposition", body, "--json", "-"});
  EXPECT_EQ(again.json()["hash"], played.json()["hash"]);
  EXPECT_EQ(runLorica({"info", folder.path() / "seen.csv", "--json", "-"}).json()["kind"], "recording");
}

TEST(Record, TheShippedRecordingIsPlayedByItsName) {
  const TemporaryFolder folder;
  const CommandResult result =
      runLorica({"play", "wave_depth", "--decomposition", mannequinBody(folder), "--json", "-"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.json()["frames"], runLorica({"info", "wave_depth", "--json", "-"}).json()["frames"]);
}

TEST(Record, JointsOfAnotherOriginAreNotOverwritten) {
  const TemporaryFolder folder;
  const std::filesystem::path mine = folder.write("body.csv", "mine");
  const CommandResult result = runLorica({"record", folder.path() / "body.oni", "--virtual", "--frames", "3"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_NE(result.err.find("body.csv"), std::string::npos) << result.err;
  EXPECT_EQ(readFile(mine).value(), "mine");
}

TEST(Record, ADamagedRecordingIsASentence) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "broken.oni";
  ASSERT_TRUE(writeFileAtomically(file, "NI10 and then nothing of use").ok());
  for (const char* command : {"play", "info"}) {
    const CommandResult result = runLorica({command, file});
    EXPECT_EQ(result.exitCode, 2) << command;
    EXPECT_NE(result.err.find("broken.oni"), std::string::npos) << result.err;
  }
}

}  // namespace
}  // namespace lorica::test

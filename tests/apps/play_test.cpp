#include "geometry/files.h"
#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"
#include "viewer/pictures/image_files.h"

#include <gtest/gtest.h>

namespace lorica::test {
namespace {

TEST(Play, JsonHasStagesFramesContactsAndHash) {
  const TemporaryFolder folder;
  const CommandResult result =
      runLorica({"play", "walk", "--decomposition", mannequinBody(folder), "--frames", "40", "--json", "-"});
  EXPECT_EQ(result.exitCode, 0) << result.err;
  const nlohmann::json json = result.json();
  EXPECT_EQ(json["recording"], "walk");
  EXPECT_EQ(json["character"], "mannequin");
  EXPECT_EQ(json["parts"], 5);
  EXPECT_EQ(json["frames"], 40);
  EXPECT_TRUE(json["contacts"].is_number_integer());
  EXPECT_EQ(json["hash"].get<std::string>().size(), 16u);
  for (const char* stage : {"retarget", "motion", "points", "hulls", "physics", "total"}) {
    const double median = json["stages"][stage]["median"];
    const double p95 = json["stages"][stage]["p95"];
    EXPECT_GE(median, 0.0) << stage;
    EXPECT_GE(p95, median) << stage;
  }
}

TEST(Play, TellsTheHitsOfTargetsInTheReportAndAsJson) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "hits.json";
  const CommandResult result = runLorica({"play", "--scene", "targets", "--decomposition", mannequinBody(folder),
                                          "--frames", "90", "--json", file, "--record", folder.path() / "s.lsession"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const nlohmann::json targets = nlohmann::json::parse(readFile(file).value())["targets"];
  ASSERT_EQ(targets.size(), 3u);
  EXPECT_EQ(targets[0]["name"], "bag");
  EXPECT_GE(targets[0]["hits"].get<int>(), 1);
  EXPECT_NE(result.out.find("targets        bag, " + std::to_string(targets[0]["hits"].get<int>()) + " hit"),
            std::string::npos)
      << result.out;
  for (const nlohmann::json& target : targets) {
    int sum = 0;
    for (const char* limb : {"leftHand", "rightHand", "leftFoot", "rightFoot", "rest"}) sum += target[limb].get<int>();
    EXPECT_EQ(target["hits"], sum);
  }
  const CommandResult replayed = runLorica({"replay", folder.path() / "s.lsession", "--json", "-"});
  ASSERT_EQ(replayed.exitCode, 0) << replayed.err;
  EXPECT_EQ(replayed.json()["targets"], targets);
}

TEST(Play, RunsAndThreadsAgree) {
  const TemporaryFolder folder;
  const std::filesystem::path body = mannequinBody(folder);
  const auto outcome = [&body](const char* threads) {
    nlohmann::json json = runLorica({"play", "punch_and_kick", "--decomposition", body, "--frames", "60", "--threads",
                                     threads, "--json", "-"})
                              .json();
    json.erase("stages");
    return json;
  };
  const nlohmann::json one = outcome("1");
  EXPECT_TRUE(one["hash"].is_string());
  EXPECT_EQ(outcome("1"), one);
  EXPECT_EQ(outcome("2"), one);
}

TEST(Play, AwayFromTheRecordingsItTrainsOnTheSameMotionsMadeAnew) {
  const TemporaryFolder folder;
  const std::filesystem::path session = folder.path() / "s.lsession";
  CommandSurroundings moved;
  moved.folder = folder.path();
  moved.cache = folder.path() / "cache";
  moved.recordings = "/nowhere";
  const std::string motion = recordingsFolder() / "wave.csv";
  const CommandResult played =
      runLorica({"play", motion, "--frames", "10", "--cover", "0.01", "--record", session, "--json", "-"}, moved);
  ASSERT_EQ(played.exitCode, 0) << played.err;
  const std::string sentence = "/nowhere: no such folder; the hulls are trained on the same motions, generated again";
  const std::size_t said = played.err.find(sentence);
  EXPECT_NE(said, std::string::npos) << played.err;
  EXPECT_EQ(played.err.find(sentence, said + 1), std::string::npos) << "said twice: " << played.err;
  CommandSurroundings home = moved;
  home.recordings.clear();
  EXPECT_EQ(runLorica({"play", motion, "--frames", "10", "--cover", "0.01", "--json", "-"}, home).json()["hash"],
            played.json()["hash"]);
  EXPECT_EQ(runLorica({"replay", session, "--json", "-"}, moved).json()["same"], true);
  const CommandResult unknown = runLorica({"play", "wave"}, moved);
  EXPECT_EQ(unknown.exitCode, 2);
}

TEST(Play, PathAndNameMeanTheSame) {
  const TemporaryFolder folder;
  const std::filesystem::path body = mannequinBody(folder);
  const auto hashOf = [&body](const std::string& recording) {
    return runLorica({"play", recording, "--decomposition", body, "--frames", "5", "--json", "-"}).json()["hash"];
  };
  EXPECT_EQ(hashOf("wave"), hashOf(recordingsFolder() / "wave.csv"));
}

TEST(Play, SnapshotsAndAFilmAreWritten) {
  const TemporaryFolder folder;
  const std::filesystem::path pictures = folder.path() / "pictures";
  const std::filesystem::path film = folder.path() / "film.mp4";
  const CommandResult result = runLorica({"play", "wave", "--decomposition", mannequinBody(folder), "--frames", "7",
                                          "--snapshots", pictures, "--every", "3", "--video", film, "--json", "-"});
  if (result.exitCode == 2 && result.err.find("OSMesa") != std::string::npos) GTEST_SKIP() << result.err;
  EXPECT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.json()["snapshots"], 3);
  EXPECT_EQ(filesIn(pictures), (std::vector<std::string>{"frame_0000.png", "frame_0003.png", "frame_0006.png"}));
  const Result<Image> image = readPng(pictures / "frame_0003.png");
  ASSERT_TRUE(image);
  EXPECT_EQ(image->width, 1280);
  EXPECT_EQ(image->height, 720);
  EXPECT_EQ(result.json()["videoFrames"], 7);
  EXPECT_GT(std::filesystem::file_size(film), 10'000u);
}

TEST(Play, ACameraWithoutPicturesIsRefused) {
  const CommandResult result = runLorica({"play", "wave", "--camera", "front"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_NE(result.err.find("--snapshots or --video"), std::string::npos) << result.err;
}

TEST(Play, AFileAloneWithoutDisplaySaysWhatMakesPictures) {
  const CommandResult result = runLorica({"walk", "--frames", "2"});
  EXPECT_EQ(result.exitCode, 0);
  EXPECT_NE(result.err.find("No display: `lorica snapshot walk`"), std::string::npos) << result.err;
  EXPECT_EQ(runLorica({"play", "walk", "--frames", "2"}).err.find("No display"), std::string::npos);
}

TEST(Play, WindowWithoutDisplaySaysWhatToDo) {
  const CommandResult result = runLorica({"play", "walk", "--window"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_NE(result.err.find("DISPLAY"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("--snapshots"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace lorica::test

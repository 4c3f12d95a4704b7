#include "geometry/files.h"

#include "tests/apps/refusals.h"
#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "viewer/pictures/image_files.h"

#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace lorica::test {
namespace {

TEST(Play, JsonHasStagesFramesContactsAndHash) {
  const TemporaryFolder folder;
  const nlohmann::json json = jsonOf({"play", "walk", "--decomposition", mannequinBody(folder), "--frames", "40"});
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
  EXPECT_TRUE(has(result.out, "targets        bag, " + std::to_string(targets[0]["hits"].get<int>()) + " hit"));
  for (const nlohmann::json& target : targets) {
    int sum = 0;
    for (const char* limb : {"leftHand", "rightHand", "leftFoot", "rightFoot", "rest"}) sum += target[limb].get<int>();
    EXPECT_EQ(target["hits"], sum);
  }
  const nlohmann::json replayed = jsonOf({"replay", folder.path() / "s.lsession"});
  EXPECT_EQ(replayed["targets"], targets);
}

TEST(Play, RunsAndThreadsAgree) {
  const TemporaryFolder folder;
  const std::filesystem::path body = mannequinBody(folder);
  const auto outcome = [&body](const char* threads) {
    nlohmann::json json =
        jsonOf({"play", "punch_and_kick", "--decomposition", body, "--frames", "60", "--threads", threads});
    json.erase("stages");
    return json;
  };
  const nlohmann::json one = outcome("1");
  EXPECT_TRUE(one["hash"].is_string());
  EXPECT_EQ(outcome("1"), one);
  EXPECT_EQ(outcome("2"), one);
}

TEST(Play, AwayFromTheRecordingsItTrainsOnTheSameMotions) {
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
  CommandSurroundings home = moved;
  home.recordings.clear();
  EXPECT_EQ(jsonOf({"play", motion, "--frames", "10", "--cover", "0.01"}, home)["hash"], played.json()["hash"]);
  EXPECT_EQ(jsonOf({"replay", session}, moved)["same"], true);
  const CommandResult unknown = runLorica({"play", "wave"}, moved);
  EXPECT_EQ(unknown.exitCode, 2);
}

TEST(Play, PathAndNameMeanTheSame) {
  const TemporaryFolder folder;
  const std::filesystem::path body = mannequinBody(folder);
  const auto hashOf = [&body](const std::string& recording) {
    return jsonOf({"play", recording, "--decomposition", body, "--frames", "5"})["hash"];
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

TEST(Play, AFileAloneWithoutDisplaySaysWhatMakesPictures) {
  const CommandResult result = runLorica({"walk", "--frames", "2"});
  EXPECT_EQ(result.exitCode, 0);
  EXPECT_TRUE(has(result.err, "No display: `lorica snapshot walk`"));
  EXPECT_FALSE(has(runLorica({"play", "walk", "--frames", "2"}).err, "No display"));
}

TEST(Demo, DrawsToFilesAndStartsFromTheCacheTheSecondTime) {
  const TemporaryFolder folder;
  const std::filesystem::path cache = folder.path() / "cache";
  const std::filesystem::path pictures = folder.path() / "pictures";
  const std::vector<std::string> arguments = {"demo",  "--force", "--headless", "--seconds", "1",
                                              "--out", pictures,  "--json",     "-"};
  const CommandSurroundings surroundings = {.folder = folder.path(), .cache = cache};

  const CommandResult first = runLorica(arguments, surroundings);
  ASSERT_EQ(first.exitCode, 0) << first.err;
  const nlohmann::json json = first.json();
  EXPECT_EQ(json["fromCache"], false);
  EXPECT_EQ(json["parts"], 16);
  EXPECT_EQ(json["keyframes"], 12);
  EXPECT_EQ(json["frames"], 30);
  EXPECT_GT(json["stages"]["total"]["median"].get<double>(), 0.0);

  if (!json["renderer"].is_null()) {
    EXPECT_EQ(filesIn(pictures),
              (std::vector<std::string>{"contact_sheet.png", "demo.mp4", "hulls_1.png", "hulls_2.png", "hulls_3.png",
                                        "snapshot_1.png", "snapshot_2.png", "snapshot_3.png"}));
    const Result<Image> snapshot = readPng(pictures / "snapshot_1.png");
    ASSERT_TRUE(snapshot);
    EXPECT_EQ(snapshot->width, 1280);
    EXPECT_EQ(snapshot->height, 720);
    EXPECT_TRUE(readPng(pictures / "contact_sheet.png"));
    EXPECT_GT(std::filesystem::file_size(pictures / "demo.mp4"), 10000u);
  }

  // The cache holds one file, which the second run uses; the third run replaces it because it is damaged.
  const std::vector<std::string> cached = filesIn(cache / "lorica");
  ASSERT_EQ(cached.size(), 1u);
  const nlohmann::json second = runLorica(arguments, surroundings).json();
  EXPECT_EQ(second["fromCache"], true);
  EXPECT_EQ(second["hash"], json["hash"]);

  std::ofstream(cache / "lorica" / cached.front(), std::ios::binary) << "not a decomposition";
  const CommandResult third = runLorica(arguments, surroundings);
  EXPECT_EQ(third.exitCode, 0);
  EXPECT_TRUE(has(third.err, "computed again"));
  EXPECT_EQ(third.json()["fromCache"], false);
  EXPECT_EQ(third.json()["hash"], json["hash"]);
}

TEST(Demo, AScenePlaysInItsPlaceWithItsOwnAvatarsOrWithOneThatKicks) {
  const TemporaryFolder folder;
  for (const auto& [scene, motion] : {std::pair{"dominoes", "walk"}, {"boxes", "punch_and_kick"}}) {
    const CommandResult demo = runLorica(
        {"demo", "--headless", "--seconds", "0.1", "--scene", scene, "--out", folder.path() / scene, "--json", "-"});
    ASSERT_EQ(demo.exitCode, 0) << demo.err;
    EXPECT_EQ(demo.json()["recording"], motion);
    EXPECT_TRUE(demo.json()["fromCache"].is_null());
  }
  expectRefused(runLorica({"demo", "--headless", "--scene", "pond", "--out", folder.path() / "no"}), {"pond"});
}

TEST(Demo, WithoutTheVideoModuleThereArePictures) {
  const TemporaryFolder folder;
  folder.write("liblorica_video.so", "");  // found first, but not a library
  const CommandSurroundings surroundings = {.folder = folder.path(), .libraries = folder.path()};
  const CommandResult demo =
      runLorica({"demo", "--headless", "--seconds", "0.2", "--out", "pictures", "--json", "-"}, surroundings);
  ASSERT_EQ(demo.exitCode, 0) << demo.err;
  if (demo.json()["renderer"].is_null()) return;
  EXPECT_TRUE(demo.json()["video"].is_null());
  EXPECT_TRUE(has(demo.err, "writing MP4 needs liblorica_video.so"));
  EXPECT_EQ(filesIn(folder.path() / "pictures"),
            (std::vector<std::string>{"contact_sheet.png", "hulls_1.png", "hulls_2.png", "hulls_3.png",
                                      "snapshot_1.png", "snapshot_2.png", "snapshot_3.png"}));

  expectRefused(runLorica({"snapshot", "walk", "--video", "walk.mp4"}, surroundings),
                {"walk.mp4: writing MP4 needs liblorica_video.so"});
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "walk.mp4"));
}

TEST(Demo, CacheThatCannotBeWrittenIsAWarning) {
  const TemporaryFolder folder;
  // XDG_CACHE_HOME is a file here.
  const CommandResult result = runLorica({"demo", "--headless", "--seconds", "0.1", "--out", "pictures"},
                                         {.folder = folder.path(), .cache = "/dev/null"});
  EXPECT_EQ(result.exitCode, 0) << result.err;
  expectAll(result.err, {"warning: ", "is not cached"});
  EXPECT_TRUE(has(result.out, "16 convex parts"));
}

TEST(Demo, OutputFolderThatCannotBeMadeIsRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("occupied", "a file");
  const CommandResult result = runLorica({"demo", "--headless", "--seconds", "0.1", "--out", file},
                                         {.folder = folder.path(), .cache = folder.path() / "cache"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_TRUE(has(result.err, "occupied"));
}

std::vector<nlohmann::json> linesOf(const std::string& text) {
  std::vector<nlohmann::json> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(nlohmann::json::parse(line));
  return lines;
}

TEST(Events, PlayWritesEachContactAsLinesAndReplayWritesTheSame) {
  const TemporaryFolder folder;
  const std::string body = mannequinBody(folder, 8);
  const std::string events = folder.path() / "kick.jsonl";
  const std::string session = folder.path() / "kick.lsession";
  const nlohmann::json played = jsonOf(
      {"play", "punch_and_kick", "--frames", "200", "--decomposition", body, "--events", events, "--record", session});
  const std::string written = readFile(events).value();
  const std::vector<nlohmann::json> lines = linesOf(written);
  ASSERT_FALSE(lines.empty());
  int begins = 0, ends = 0;
  for (const nlohmann::json& line : lines) {
    begins += line["event"] == "begin" ? 1 : 0;
    ends += line["event"] == "end" ? 1 : 0;
    EXPECT_EQ(line.contains("prop"), line["kind"] == "prop");
    EXPECT_EQ(line.contains("otherPart"), line["kind"] == "self");
    EXPECT_EQ(line["point"].size(), 3U);
    EXPECT_GE(line["strength"].get<double>(), 0.0);
    EXPECT_LE(line["began"].get<double>(), line["touched"].get<double>());
    EXPECT_LE(line["touched"].get<double>(), line["time"].get<double>());
    EXPECT_TRUE(line["bone"].is_string());
  }
  EXPECT_GT(begins, 0);
  EXPECT_EQ(begins, ends);
  // Times have at most six decimals.
  EXPECT_FALSE(
      std::regex_search(written, std::regex("(time|began|touched)..[0-9]+[.][0-9][0-9][0-9][0-9][0-9][0-9][0-9]")));
  EXPECT_EQ(filesIn(folder.path()), (std::vector<std::string>{"body.lorica", "kick.jsonl", "kick.lsession"}));

  const CommandResult replayed = runLorica({"replay", session, "--events", "-"});
  ASSERT_EQ(replayed.exitCode, 0) << replayed.err;
  EXPECT_EQ(replayed.out, written);
  EXPECT_TRUE(has(replayed.err, "all steps are bit-identical"));
}

// Springs on the command line, on a character that nobody here made.

constexpr const char* kGodette = "characters/godette/Godette_vrm_v4.vrm";

TEST(Springs, InfoCountsThem) {
  LORICA_REQUIRE_DATASET(godette, kGodette);
  const nlohmann::json told = jsonOf({"info", godette});
  const nlohmann::json expected = {{"chains", 8}, {"joints", 16}, {"colliders", 4}, {"constraints", 0}};
  EXPECT_EQ(told["springs"], expected);
  const CommandResult shown = runLorica({"info", godette});
  EXPECT_TRUE(has(shown.out, "8 strands with 16 joints, 4 colliders"));
}

TEST(Springs, EachModeMovesTheHullsInItsOwnWayAndIsReplayed) {
  LORICA_REQUIRE_DATASET(godette, kGodette);
  const TemporaryFolder folder;
  const std::string body = (folder.path() / "body.lorica").string();
  const CommandResult made = runLorica({"decompose", godette, "--parts", "8", "--keyframes", "2", "-o", body});
  ASSERT_EQ(made.exitCode, 0) << made.err;
  const auto hashWith = [&](std::vector<std::string> springs) {
    const std::string session = (folder.path() / "s.lsession").string();
    std::vector<std::string> arguments = {"play",     "walk", "--character", godette, "--decomposition", body,
                                          "--frames", "40",   "--record",    session, "--force",         "--json",
                                          "-"};
    arguments.insert(arguments.end(), springs.begin(), springs.end());
    const CommandResult played = runLorica(arguments);
    EXPECT_EQ(played.exitCode, 0) << played.err;
    const nlohmann::json again = jsonOf({"replay", session, "--character", godette});
    EXPECT_EQ(again["hash"], played.json()["hash"]);
    return played.json()["hash"].get<std::string>();
  };
  const std::string usual = hashWith({});
  EXPECT_EQ(hashWith({"--springs", "file"}), usual) << "the file has colliders";
  EXPECT_NE(hashWith({"--springs", "body"}), usual);
  EXPECT_NE(hashWith({"--springs", "none"}), usual);
}

}  // namespace
}  // namespace lorica::test

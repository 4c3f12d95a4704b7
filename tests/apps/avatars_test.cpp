#include "tests/apps/refusals.h"
#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "viewer/pictures/image_files.h"

#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace lorica::test {
namespace {

TEST(SeveralAvatars, PlaySideBySideTheSameWithAnyNumberOfThreadsAndReplay) {
  const TemporaryFolder folder;
  const std::string body = mannequinBody(folder, 8);
  const std::string session = folder.path() / "two.lsession";
  std::set<std::string> hashes;
  nlohmann::json json;
  for (const char* threads : {"1", "2", "7"}) {
    const nlohmann::json played = jsonOf({"play", "walk,jumping_jacks", "--frames", "60", "--decomposition", body,
                                          "--threads", threads, "--force", "--record", session});
    json = played;
    hashes.insert(json["hash"]);
  }
  EXPECT_EQ(hashes.size(), 1u);
  ASSERT_EQ(json["avatars"].size(), 2u);
  EXPECT_EQ(json["avatars"][0]["recording"], "walk");
  EXPECT_EQ(json["avatars"][1]["recording"], "jumping_jacks");
  EXPECT_NE(json["avatars"][0]["hash"], json["avatars"][1]["hash"]);
  EXPECT_EQ(json["contacts"], json["avatars"][0]["contacts"].get<int>() + json["avatars"][1]["contacts"].get<int>());
  const CommandResult told = runLorica({"replay", session});
  EXPECT_TRUE(has(told.out, "2 avatars replayed walk and jumping_jacks:"));
  const nlohmann::json replayed = jsonOf({"replay", session});
  EXPECT_EQ(replayed["same"], true);
  EXPECT_EQ(replayed["hash"], json["hash"]);
  for (int a = 0; a < 2; ++a) {
    EXPECT_EQ(replayed["avatars"][a]["hash"], json["avatars"][a]["hash"]);
    EXPECT_EQ(replayed["avatars"][a]["frames"], 60);
  }
}

TEST(SeveralAvatars, AreRecordedWithoutAWindow) {
  const TemporaryFolder folder;
  const std::string body = mannequinBody(folder, 8);
  const std::string session = folder.path() / "two.lsession";
  const nlohmann::json recorded = jsonOf({"record", session, "walk,wave", "--frames", "20", "--decomposition", body});
  ASSERT_EQ(recorded["avatars"].size(), 2u);
  const CommandResult played =
      runLorica({"play", "walk,wave", "--frames", "20", "--decomposition", body, "--json", "-"});
  EXPECT_EQ(played.json()["hash"], recorded["hash"]);
  EXPECT_EQ(jsonOf({"replay", session})["same"], true);
}

TEST(SeveralAvatars, BeforeACameraAreRecorded) {
  const TemporaryFolder folder;
  const std::string session = folder.path() / "two.lsession";
  const CommandResult recorded =
      runLorica({"record", session, "--virtual", "--motion", "wave,walk", "--people", "2", "--seconds", "2", "--scene",
                 "duel", "--decomposition", mannequinBody(folder, 8), "--json", "-"});
  ASSERT_EQ(recorded.exitCode, 0) << recorded.err;
  EXPECT_EQ(recorded.json()["avatars"].size(), 2u);
  EXPECT_TRUE(has(recorded.err, "duel: its 2 avatars stay away"));
  EXPECT_EQ(jsonOf({"replay", session})["same"], true);
}

TEST(SeveralAvatars, HaveTheirOwnSelfContacts) {
  const TemporaryFolder folder;
  const nlohmann::json json = jsonOf(
      {"play", "walk,jumping_jacks", "--self-contacts", "--frames", "60", "--decomposition", mannequinBody(folder, 8)});
  for (int a = 0; a < 2; ++a) {
    const std::string alone = a == 0 ? "walk" : "jumping_jacks";
    const nlohmann::json one =
        jsonOf({"play", alone, "--self-contacts", "--frames", "60", "--decomposition", folder.path() / "body.lorica"});
    EXPECT_EQ(json["avatars"][a]["selfContacts"]["frames"], one["selfContacts"]["frames"]) << alone;
    EXPECT_EQ(json["avatars"][a]["selfContacts"]["pairs"], one["selfContacts"]["pairs"]) << alone;
  }
}

TEST(SeveralAvatars, TellWhatTheyTouchOfEachOther) {
  const TemporaryFolder folder;
  const CommandResult played = runLorica(
      {"play", "--scene", "duel", "--decomposition", mannequinBody(folder, 8), "--frames", "90", "--events", "-"});
  ASSERT_EQ(played.exitCode, 0) << played.err;
  std::istringstream lines(played.out);
  int meetings = 0;
  for (std::string line; std::getline(lines, line);) {
    const nlohmann::json event = nlohmann::json::parse(line);
    EXPECT_EQ(event.contains("otherAvatar"), event["kind"] == "avatars");
    if (event["kind"] != "avatars") continue;
    ++meetings;
    EXPECT_LT(event["avatar"].get<int>(), event["otherAvatar"].get<int>());
    EXPECT_TRUE(event["bone"].is_string());
    EXPECT_TRUE(event["otherBone"].is_string());
  }
  EXPECT_GT(meetings, 0);
}

/// A scene with two avatars. @param second  the keys of the second one
std::string stageIn(const TemporaryFolder& folder, const std::string& second) {
  const std::string file = folder.path() / "stage.json";
  std::ofstream(file) << R"({"format": "lorica scene 1", "avatars": [{"motion": "walk", "place": [-1, 0, 0]}, {)"
                      << second << "}]}";
  return file;
}

TEST(SeveralAvatars, OfAScenePerformWhereItPutsThemAndReplay) {
  const TemporaryFolder folder;
  const std::string body = mannequinBody(folder, 8);
  const std::string session = folder.path() / "stage.lsession";
  const std::string stage = stageIn(folder, R"("motion": "walk", "start": 1, "place": [1, 0, 0.5], "heading": 180)");
  const nlohmann::json played =
      jsonOf({"play", "--scene", stage, "--decomposition", body, "--record", session, "--frames", "30"});
  EXPECT_EQ(played["avatars"].size(), 2u);
  EXPECT_NE(played["avatars"][0]["hash"], played["avatars"][1]["hash"]);
  const nlohmann::json replayed = jsonOf({"replay", session});
  EXPECT_EQ(replayed["hash"], played["hash"]);
  // A motion that is given replaces them.
  const nlohmann::json given = jsonOf({"play", "wave", "--scene", stage, "--decomposition", body});
  EXPECT_EQ(given["avatars"].size(), 1u);
}

TEST(SeveralAvatars, OfARecordedSessionAreMotionsByNumber) {
  const TemporaryFolder folder;
  const std::string session = folder.path() / "two.lsession";
  ASSERT_EQ(runLorica({"play", "walk,wave", "--frames", "30", "--decomposition", mannequinBody(folder, 8), "--record",
                       session})
                .exitCode,
            0);
  // What is written is read back as the motion of either.
  const auto converted = [&](const std::string& from, const std::vector<std::string>& more) {
    const std::string file = folder.path() / "out.csv";
    std::vector<std::string> words = {"convert", "--force", from, file};
    words.insert(words.end(), more.begin(), more.end());
    const CommandResult run = runLorica(words);
    EXPECT_EQ(run.exitCode, 0) << run.err;
    std::ifstream in(file);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
  };
  const std::string first = converted(session, {}), second = converted(session, {"--person", "2"});
  EXPECT_EQ(first, converted(session, {"--person", "1"}));
  EXPECT_EQ(first, converted("walk", {}).substr(0, first.size()));
  EXPECT_EQ(second, converted("wave", {}).substr(0, second.size()));
  expectRefused(runLorica({"info", session, "--person", "3"}), {"has 2 avatars, expected at most that number"});
  const CommandResult info = runLorica({"info", session});
  EXPECT_TRUE(has(info.out, "of 2 avatars this is the first"));
}

/// Pixels of a picture in which red, or else blue, is at least twice as bright as the other.
std::array<int, 2> redAndBlueIn(const Image& image) {
  std::array<int, 2> counts = {0, 0};
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    const int red = image.rgba[i], blue = image.rgba[i + 2];
    counts[0] += red > 40 && red >= 2 * blue ? 1 : 0;
    counts[1] += blue > 40 && blue >= 2 * red ? 1 : 0;
  }
  return counts;
}

TEST(SeveralAvatars, OfASceneHaveItsColoursThenAndInTheReplay) {
  const TemporaryFolder folder;
  const std::string session = folder.path() / "stage.lsession";
  const std::string stage = folder.path() / "stage.json";
  std::ofstream(stage) << R"({"format": "lorica scene 1", "avatars": [{"motion": "wave", "color": "#ff2020"},)"
                       << R"({"motion": "wave", "place": [1, 0, 0], "color": "#2020ff"}]})";
  const CommandResult played =
      runLorica({"play", "--scene", stage, "--decomposition", mannequinBody(folder, 8), "--record", session, "--frames",
                 "1", "--snapshots", folder.path() / "played"});
  ASSERT_EQ(played.exitCode, 0) << played.err;
  const CommandResult replayed = runLorica({"replay", session, "--snapshots", folder.path() / "replayed"});
  ASSERT_EQ(replayed.exitCode, 0) << replayed.err;
  for (const char* run : {"played", "replayed"}) {
    const Result<Image> picture = readPng(folder.path() / run / "frame_0000.png");
    ASSERT_TRUE(picture) << run;
    const auto [red, blue] = redAndBlueIn(*picture);
    EXPECT_GT(red, 5'000) << run;
    EXPECT_GT(blue, 5'000) << run;
  }
}

TEST(SeveralAvatars, WhoStartsInAWallIsNamed) {
  const TemporaryFolder folder;
  const std::string scene = folder.path() / "wall.json";
  std::ofstream(scene) << R"({"format": "lorica scene 1", "props": [{"shape": "box", "size": [0.8, 3, 0.8],)"
                       << R"("at": [1, 1.5, 0], "fixed": true}], "avatars": [{"motion": "wave"},)"
                       << R"({"motion": "wave", "place": [1, 0, 0]}]})";
  const CommandResult played =
      runLorica({"play", "--scene", scene, "--decomposition", mannequinBody(folder, 8), "--frames", "3"});
  ASSERT_EQ(played.exitCode, 0) << played.err;
  const std::string said = "avatar 2 (mannequin) starts inside the fixed object at (1.00, 1.50, 0.00)";
  ASSERT_TRUE(has(played.err, said));
  EXPECT_EQ(played.err.find(said, played.err.find(said) + 1), std::string::npos);
  EXPECT_FALSE(has(played.err, "avatar 1"));
}

TEST(SeveralAvatars, BadStagesAreASentence) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& second, const std::string& found) {
    expectRefused(runLorica({"play", "--scene", stageIn(folder, second)}), {found});
  };
  refused(R"("motion": "walk", "place": [-1, 0, 0.05])",
          "avatars[1].place: found the place of avatars[0], expected places that are 0.1 m apart or more");
  refused(R"("motion": "walk", "start": 1000)", "avatars[1]: start: found 1000 s, expected at most");
  refused(R"("motion": "sing")", "avatars[1]: ");
  refused(R"("motion": "../walk.csv")", "avatars[1]: ");
  refused(R"("character": "/etc/passwd.glb", "motion": "walk")", "avatars[1]: ");
  refused(R"("dance": "walk")", "dance");
  refused(R"("motion": "walk", "color": "red")", "avatars[1].color: ");
  std::string crowd = R"("motion": "walk", "place": [0, 0, 0.5])";
  for (int i = 2; i < 10'000; ++i)
    crowd += R"(}, {"motion": "walk", "place": [0, 0, )" + std::to_string(i % 90 / 2.0) + "]";
  refused(crowd, "avatars: found 10000 avatars, expected at most 64");
}

/// The walk, 2 s long, and from 0.5 to 1.5 s a second person who waves.
std::string twoPeopleIn(const TemporaryFolder& folder) {
  const std::string file = folder.path() / "two.csv";
  std::ifstream walk(recordingsFolder() / "walk.csv"), wave(recordingsFolder() / "wave.csv");
  std::ofstream out(file);
  std::string first, second;
  std::getline(walk, first);
  std::getline(wave, second);
  out << first << "\n";
  for (int frame = 0; frame < 60; ++frame) {
    std::getline(walk, first);
    std::getline(wave, second);
    out << first << "\n";
    const std::size_t comma = second.find(',');
    if (frame >= 15 && frame < 45) out << second.replace(comma, 3, ",2,") << "\n";
  }
  return file;
}

TEST(SeveralAvatars, OfAllPeopleOfARecordingPerformWhereTheyStood) {
  const TemporaryFolder folder;
  const std::string body = mannequinBody(folder, 8), file = twoPeopleIn(folder);
  const std::string session = folder.path() / "two.lsession";
  const nlohmann::json json = jsonOf({"play", file, "--person", "all", "--decomposition", body, "--record", session});
  ASSERT_EQ(json["avatars"].size(), 2u);
  EXPECT_EQ(json["frames"], 60);
  EXPECT_EQ(json["avatars"][0]["recording"], "two: person 1");
  EXPECT_EQ(json["avatars"][0]["frames"], 60);
  EXPECT_NEAR(json["avatars"][1]["frames"].get<int>(), 30, 1);
  // The first one does the same with and without the second.
  const CommandResult alone = runLorica({"play", "walk", "--frames", "60", "--decomposition", body, "--json", "-"});
  EXPECT_EQ(alone.json()["avatars"][0]["hash"], json["avatars"][0]["hash"]);
  EXPECT_EQ(jsonOf({"replay", session})["same"], true);
  const auto refused = [](const std::vector<std::string>& arguments, const std::string& found) {
    expectRefused(runLorica(arguments), {found});
  };
  refused({"play", file, "--person", "all", "--character", "mannequin,mannequin,mannequin"},
          "found 3 characters and 2 people, expected one character for all of them or one for each");
  refused({"play", file + ",walk", "--person", "all"}, "expected one recording of several people");
  refused({"record", "x.bvh", file, "--person", "all"}, "x.bvh: found --person all, expected the number of one person");
  refused({"info", file, "--person", "all"}, "found --person all, expected the number of one person");
}

TEST(SeveralAvatars, WhoLeavesFadesInThePictures) {
  const TemporaryFolder folder;
  const std::string body = mannequinBody(folder, 8), file = twoPeopleIn(folder);
  const auto pictures = [&](const std::string& person) {
    const CommandResult taken = runLorica({"snapshot", file, "--person", person, "--at", "1.4,1.75,1.95", "--eye",
                                           "0,1.5,5", "--target", "0,1,0", "--show", "skin", "--size", "320x180",
                                           "--decomposition", body, "--force", "-o", folder.path() / "at.png"});
    EXPECT_EQ(taken.exitCode, 0) << taken.err;
    std::vector<Image> images;
    for (const char* name : {"at_1.png", "at_2.png", "at_3.png"}) {
      images.push_back(readPng(folder.path() / name).value());
    }
    return images;
  };
  const std::vector<Image> both = pictures("all"), first = pictures("1");
  // How much of the second one is seen in the picture of the first.
  const auto added = [&](std::size_t i) {
    int difference = 0;
    for (std::size_t p = 0; p < both[i].rgba.size(); ++p) difference += std::abs(both[i].rgba[p] - first[i].rgba[p]);
    return difference;
  };
  EXPECT_GT(added(0), 10'000);
  EXPECT_GT(added(1), added(0) / 5);
  EXPECT_LT(added(1), added(0) * 4 / 5);
  EXPECT_EQ(added(2), 0);
}

TEST(Live, TwoVirtualPeopleAreTwoAvatars) {
  const TemporaryFolder folder;
  const std::string session = folder.path() / "two.lsession";
  const nlohmann::json json = jsonOf({"live", "--virtual", "--motion", "wave,walk", "--people", "2", "--decomposition",
                                      mannequinBody(folder, 8), "--seconds", "5", "--headless", "--record", session});
  EXPECT_EQ(json["maxPeople"], 2);
  ASSERT_EQ(json["avatars"].size(), 2u);
  for (const nlohmann::json& avatar : json["avatars"]) EXPECT_GT(avatar["frames"].get<int>(), 0);
  const nlohmann::json replayed = jsonOf({"replay", session});
  EXPECT_EQ(replayed["same"], true);
}

}  // namespace
}  // namespace lorica::test

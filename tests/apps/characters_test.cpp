#include "capture/files/bvh_file.h"
#include "capture/files/joint_csv.h"
#include "geometry/files.h"
#include "tests/apps/mannequin_glb.h"
#include "tests/apps/refusals.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

/// A folder with typical user characters, made once; the cache is shared, so that each is decomposed once.
struct Studio {
  TemporaryFolder folder;
  fs::path whole = folder.write("whole.glb", mannequinGlb(false));
  fs::path torn = folder.write("torn.glb", mannequinGlb(true));
  fs::path nameless = folder.write("nameless.glb", mannequinGlb(false, false));
  CommandSurroundings surroundings{folder.path()};

  [[nodiscard]] CommandResult run(const std::vector<std::string>& arguments) const {
    return runLorica(arguments, surroundings);
  }
};
const Studio& studio() {
  static const Studio made;
  return made;
}

nlohmann::json studioJson(std::vector<std::string> arguments) {
  arguments.insert(arguments.end(), {"--json", "-"});
  const CommandResult result = studio().run(arguments);
  EXPECT_EQ(result.exitCode, 0) << result.err;
  return result.exitCode == 0 ? result.json() : nlohmann::json();
}

void expectRefused(const std::vector<std::string>& arguments, const std::vector<std::string_view>& parts) {
  expectRefused(studio().run(arguments), parts);
}

TEST(Characters, InfoSaysWhatAFileHoldsAndWhatIsDoneAboutIt) {
  const nlohmann::json whole = studioJson({"info", studio().whole});
  EXPECT_EQ(whole["kind"], "character");
  EXPECT_EQ(whole["format"], "glTF 2.0");
  EXPECT_EQ(whole["bones"]["leftUpperArm"], "mixamorig:LeftArm");
  EXPECT_EQ(whole["bones"]["hips"], "mixamorig:Hips");
  EXPECT_TRUE(whole["retargetable"]);
  EXPECT_EQ(whole["clips"].size(), 2u);
  EXPECT_EQ(whole["clips"][0]["name"], "Bow");
  EXPECT_NEAR(whole["clips"][0]["seconds"].get<double>(), 1.0, 1e-6);
  EXPECT_EQ(whole["body"]["made"], false);
  EXPECT_EQ(whole["body"]["openEdges"], 0);

  const nlohmann::json torn = studioJson({"info", studio().torn});
  EXPECT_EQ(torn["body"]["made"], true);
  EXPECT_GT(torn["body"]["openEdges"].get<int>(), 50);
  EXPECT_LT(torn["body"]["bindPose"]["meanToOriginal"].get<double>(), 0.01);
  EXPECT_LT(torn["body"]["bindPose"]["meanOutside"].get<double>(), 0.01);
}

TEST(Characters, ACharacterOfAFilePerformsAsTheBuiltInOneDoes) {
  // The same mesh, joints and motion; only the precision of the file's floats differs.
  const nlohmann::json built = studioJson({"play", "wave", "--frames", "30"});
  const nlohmann::json read = studioJson({"play", "wave", "--character", studio().whole, "--frames", "30"});
  EXPECT_EQ(read["parts"], 16);
  EXPECT_EQ(read["frames"], built["frames"]);
  EXPECT_NE(read["hash"], built["hash"]);
  // Decomposed anew.
  const CommandResult again =
      runLorica({"play", "wave", "--character", studio().whole, "--frames", "30", "--threads", "1", "--json", "-"},
                {.folder = ".", .cache = "/dev/null"});
  EXPECT_EQ(read["hash"], again.json()["hash"]);
}

TEST(Characters, OwnClipsPlayByNameAndTheFirstByDefault) {
  EXPECT_EQ(studioJson({"play", studio().whole})["frames"], 61) << "1 s at 60 frames a second, both ends";
  EXPECT_EQ(studioJson({"play", studio().whole, "--clip", "nod"})["frames"], 31);
  EXPECT_EQ(studioJson({"play", "--character", studio().whole, "--clip", "Nod"})["frames"], 31);
  // Another character with joints of the same names.
  EXPECT_EQ(studioJson({"play", studio().whole, "--clip", "Nod", "--character", "mannequin"})["frames"], 31);
}

TEST(Characters, ATornOnePlaysWithABodyMadeForIt) {
  const nlohmann::json json = studioJson({"play", "wave", "--character", studio().torn, "--frames", "10"});
  EXPECT_EQ(json["parts"], 16);
  EXPECT_EQ(json["cover"]["exact"], true);
}

TEST(Characters, BonesWithoutNamesAreFoundByShapeAndAMapPutsThemRight) {
  const nlohmann::json found = studioJson({"info", studio().nameless});
  EXPECT_TRUE(found["retargetable"]);
  const nlohmann::json named = studioJson({"info", studio().whole});
  EXPECT_NEAR(found["height"].get<double>(), named["height"].get<double>(), 1e-3);

  const fs::path map = studio().folder.path() / "map.json";
  ASSERT_EQ(studio().run({"info", studio().nameless, "--write-map", map}).exitCode, 0);
  nlohmann::json written = nlohmann::json::parse(std::ifstream(map));
  EXPECT_EQ(written["bones"]["leftHand"], found["bones"]["leftHand"]);
  EXPECT_EQ(written["unsure"]["leftIndexProximal"], "fingers are told apart by their places alone");
  EXPECT_FALSE(written["unsure"].contains("leftHand"));
  // Swap the arms and their descendants.
  const nlohmann::json before = written["bones"];
  for (const auto& [bone, joint] : before.items()) {
    const bool leg = bone.find("Leg") != std::string::npos || bone.find("Foot") != std::string::npos ||
                     bone.find("Toes") != std::string::npos;
    if (bone.starts_with("left") && !leg) written["bones"][bone] = before["right" + bone.substr(4)];
    if (bone.starts_with("right") && !leg) written["bones"][bone] = before["left" + bone.substr(5)];
  }
  std::ofstream(map) << written;
  const nlohmann::json swapped = studioJson({"info", studio().nameless, "--map", map});
  EXPECT_EQ(swapped["bones"]["leftHand"], found["bones"]["rightHand"]);

  written["bones"]["leftHand"] = "bone 999";
  std::ofstream(map) << written;
  expectRefused({"info", studio().nameless, "--map", map}, {"map.json", "leftHand", "bone 999"});
}

TEST(Motions, ConvertedToBvhAndBackTheJointsAreWhereTheyWere) {
  const fs::path bvh = studio().folder.path() / "walk.bvh";
  const fs::path csv = studio().folder.path() / "walk.csv";
  ASSERT_EQ(studio().run({"convert", "walk", bvh}).exitCode, 0);
  ASSERT_EQ(studio().run({"convert", bvh, csv}).exitCode, 0);
  const std::vector<SkeletonFrame> before = readJointCsv(recordingsFolder() / "walk.csv").value();
  const std::vector<SkeletonFrame> after = readJointCsv(csv).value();
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t f = 0; f < before.size(); f += 7) {
    for (int j = 0; j < kBodyJointCount; ++j) {
      const auto joint = static_cast<BodyJoint>(j);
      // Bones keep their length, but the bending trunk of the recording does not.
      EXPECT_LT((before[f][joint].position - after[f][joint].position).norm(), joint == BodyJoint::kTorso ? 0.03 : 0.02)
          << f << " " << nameOf(joint);
    }
  }
}

TEST(Motions, EveryoneInADepthRecordingIsWrittenInTheCamerasFrame) {
  const fs::path base = studio().folder.path() / "everyone";
  const nlohmann::json json = studioJson({"convert", "wave_depth", base.string() + ".csv", "--camera-frame"});
  const int frames = json["frames"];
  EXPECT_EQ(frames, studioJson({"info", "wave_depth"})["frames"]);
  std::ifstream joints(base.string() + ".cam.csv");
  std::string line;
  std::getline(joints, line);
  EXPECT_TRUE(line.starts_with("frame,user,head_x,head_y,head_z,head_confidence,neck_x"));
  int rows = 0, people = 0;
  while (std::getline(joints, line)) {
    const int frame = std::stoi(line), user = std::stoi(line.substr(line.find(',') + 1));
    EXPECT_EQ(frame, rows++);
    EXPECT_EQ(std::ranges::count(line, ','), user == 0 ? 1 : 1 + 4 * kBodyJointCount);
    people += user == 1 ? 1 : 0;
  }
  EXPECT_EQ(rows, frames);
  EXPECT_GT(people, frames / 2);
  EXPECT_EQ(fs::file_size(base.string() + ".lab") % static_cast<std::uintmax_t>(frames), 0U);
  EXPECT_EQ(studioJson({"info", base.string() + ".csv"})["frames"], frames);
  expectRefused({"convert", "wave_depth", base.string() + ".bvh", "--camera-frame"}, {"everyone.cam.csv", "--force"});
}

TEST(Motions, EveryoneIsWrittenWithANumber) {
  const fs::path two = studio().folder.path() / "two.csv", both = studio().folder.path() / "both.csv";
  std::vector<SkeletonFrame> frames = readJointCsv(recordingsFolder() / "walk.csv").value();
  frames.resize(40);
  std::vector<SkeletonFrame> rows;
  for (const SkeletonFrame& frame : frames) {
    for (int user : {4, 9}) (rows.emplace_back(frame)).user = user;
  }
  ASSERT_TRUE(writeJointCsv(two, rows));
  EXPECT_EQ(studioJson({"convert", two, both, "--person", "all"})["frames"], 80);
  const auto people = parseJointCsvOfAll(readFile(both).value(), "both.csv").value();
  ASSERT_EQ(people.size(), 2u);
  EXPECT_EQ(people[1].size(), 40u);
  EXPECT_EQ(people[1].front().user, 2);
}

TEST(Outputs, WhatExistsIsKeptUnlessForced) {
  // What a command writes, and the command.
  const std::vector<std::pair<std::string, std::vector<std::string>>> commands = {
      {"kept.csv", {"convert", "walk", "kept.csv"}},
      {"kept.obj", {"decompose", "box.off", "--parts", "1", "--export-obj", "kept.obj"}},
      {"kept.stl", {"export", "box.off", "kept.stl", "--parts", "1"}},
      {"robot_meshes/box_hull_0.stl", {"export", "box.off", "robot.urdf", "--parts", "1"}},
      {"kept.json", {"info", "walk", "--json", "kept.json"}},
      {"kept.json", {"info", "mannequin", "--json", "kept.json"}},
      {"kept.lsession", {"record", "kept.lsession", "walk", "--frames", "2"}},
      {"kept.events", {"play", "walk", "--frames", "2", "--events", "kept.events"}},
      {"kept.png", {"snapshot", "walk", "--frame", "0", "-o", "kept.png", "--size", "64x64"}},
      {"pictures/frame_0002.png",
       {"play", "walk", "--frames", "4", "--every", "2", "--snapshots", "pictures", "--size", "64x64"}},
      {"shown/contact_sheet.png", {"demo", "--headless", "--seconds", "0.1", "--out", "shown"}},
  };
  (void)studio().folder.write("box.off",
                              "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  for (auto [name, command] : commands) {
    fs::create_directories((studio().folder.path() / name).parent_path());
    const fs::path file = studio().folder.write(name, "mine");
    expectRefused(command, {name + " exists", "--force"});
    EXPECT_EQ(readFile(file).value(), "mine") << name;
    command.emplace_back("--force");
    const CommandResult forced = studio().run(command);
    if (forced.exitCode == 2 && forced.err.find("OSMesa") != std::string::npos) continue;
    EXPECT_EQ(forced.exitCode, 0) << forced.err;
    EXPECT_NE(readFile(file).value(), "mine") << name;
  }
}

TEST(Outputs, AFolderMayHoldOtherFiles) {
  const fs::path folder = studio().folder.path() / "others";
  fs::create_directories(folder);
  for (const char* name : {"notes.txt", "frame_0001.png", "frame_2.png"})
    ASSERT_TRUE(writeFileAtomically(folder / name, "mine"));
  for (const std::string& out : {folder.string(), std::string(".")}) {
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"play", "walk", "--frames", "4", "--every", "2", "--size", "64x64", "--snapshots"},
          {"demo", "--headless", "--seconds", "0.1", "--out"}}) {
      std::vector<std::string> words = command;
      words.push_back(out);
      const CommandResult run = studio().run(words);
      EXPECT_EQ(run.exitCode, 0) << run.err;
    }
  }
  for (const char* name : {"notes.txt", "frame_0001.png", "frame_2.png"})
    EXPECT_EQ(readFile(folder / name).value(), "mine");
}

TEST(Motions, SmoothingSaysItsDelayAndIsForJointsOnly) {
  const nlohmann::json plain = studioJson({"play", "walk_noisy", "--frames", "60"});
  EXPECT_TRUE(plain["smoothingDelay"].is_null());
  const nlohmann::json smoothed = studioJson({"play", "walk_noisy", "--frames", "60", "--smooth", "one-euro"});
  EXPECT_GT(smoothed["smoothingDelay"].get<double>(), 0.001);
  EXPECT_LT(smoothed["smoothingDelay"].get<double>(), 0.1);
  const nlohmann::json calmer = studioJson(
      {"play", "walk_noisy", "--frames", "60", "--smooth", "one-euro", "--min-cutoff", "0.3", "--beta", "0.1"});
  EXPECT_GT(calmer["smoothingDelay"].get<double>(), smoothed["smoothingDelay"].get<double>());
}

TEST(Motions, AMirroredWaveIsAnotherOne) {
  EXPECT_NE(studioJson({"play", "wave", "--frames", "20"})["hash"],
            studioJson({"play", "wave", "--frames", "20", "--mirror"})["hash"]);
}

/// The character without clips; `humanoid` = with bones that have names.
fs::path withoutClips(bool humanoid) {
  GlbWriter writer = humanoid ? mannequinWriter(false) : smallCharacter();
  writer.document.erase("animations");
  return studio().folder.write(humanoid ? "hero.glb" : "box.glb", writer.glb());
}

TEST(Characters, AFileAloneIsOpenedAndWithoutClipsItWalksOrStands) {
  const nlohmann::json walking = studioJson({withoutClips(true), "--frames", "5"});
  EXPECT_EQ(walking["recording"], "walk");
  EXPECT_EQ(walking["character"], "hero");
  EXPECT_NE(walking["notes"].dump().find("hero.glb: has no clips, so it performs `walk`"), std::string::npos);
  const nlohmann::json standing = studioJson({withoutClips(false)});
  EXPECT_EQ(standing["frames"], 120);
  EXPECT_NE(standing["notes"].dump().find("has no clips and is no humanoid, so it stands"), std::string::npos);
  const nlohmann::json demo =
      studioJson({"demo", withoutClips(true), "--headless", "--seconds", "0.2", "--out", "pictures"});
  EXPECT_EQ(demo["character"], "hero");
  EXPECT_EQ(
      studioJson({"demo", withoutClips(false), "--headless", "--seconds", "0.2", "--out", "standing"})["recording"],
      "box");
}

TEST(OpenFile, EveryKindIsPlayedOrDescribedAndOnlyASessionReplayed) {
  const fs::path folder = studio().folder.path();
  EXPECT_EQ(studioJson({studio().whole, "--frames", "3"})["recording"], "whole: Bow");
  (void)studioJson({"record", folder / "s.lsession", "walk", "--frames", "5"});
  EXPECT_EQ(studioJson({folder / "s.lsession"})["same"], true);
  const fs::path scene =
      studio().folder.write("stage.json", R"({"format": "lorica scene 1", "avatars": [{"motion": "wave"}]})");
  EXPECT_EQ(studioJson({scene, "--frames", "3"})["recording"], "wave");
  const fs::path mesh =
      studio().folder.write("box.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  EXPECT_EQ(studioJson({mesh})["kind"], "mesh");
  const nlohmann::json beside = studioJson({"play", mesh, "--frames", "3"});
  EXPECT_EQ(beside["recording"], "walk");
  EXPECT_NE(beside["notes"].dump().find("box.off: is a mesh, so it is a prop"), std::string::npos);
  expectRefused({"record", folder / "m.lsession", mesh}, {"m.lsession", "box.off in a scene"});
  EXPECT_EQ(studioJson({"info", scene})["avatars"][0]["motion"], "wave");
  // Whoever checks a session must not be told that something else went well.
  for (const fs::path& other : {scene, mesh, fs::path(studio().whole)}) {
    expectRefused({"replay", other},
                  {other.filename().string() + ": not a session file, expected a file written by `lorica record`"});
  }
  for (const char* name : {"mannequin", "walk"}) EXPECT_EQ(studioJson({name, "--frames", "3"})["recording"], "walk");
  expectRefused({folder / "nothing.glb"}, {"nothing.glb: cannot be read: No such file"});
}

TEST(OpenFile, WhatLoricaDoesNotOpenIsNamed) {
  struct Other {
    const char* name;
    std::string content;
    const char* found;
  };
  const Other others[] = {{"photo.csv", "\x89PNG\r\n\x1a\n", "a PNG picture"},
                          {"photo.glb", "\x89PNG\r\n\x1a\n", "a PNG picture"},
                          {"film.mp4",
                           std::string("\0\0\0\x18"
                                       "ftypmp42",
                                       12),
                           "a film (MP4)"},
                          {"notes.md", "# Notes\n", "a text of remarks"},
                          {"notes.csv", "shop,price\n", "a text that begins with 'shop'"},
                          {"other.json", "{\"a\": 1}", "a text that begins with '{\"a\":'"},
                          {"hero.dat", "glTF\2", "a character whose name does not end in .glb"},
                          {"walk.txt", "HIERARCHY\n", "a motion whose name does not end in .bvh"}};
  for (const Other& other : others) {
    const fs::path file = studio().folder.write(other.name, other.content);
    const std::vector<std::vector<std::string>> commands = {
        {file}, {"info", file}, {"play", file}, {"demo", file, "--headless"}};
    for (std::size_t i = 0; i < commands.size(); ++i) {
      const bool asCharacter = i == 3 && std::string(other.name).find("photo") != 0;
      if (!asCharacter) expectRefused(commands[i], {std::string("found ") + other.found, "Lorica opens characters"});
    }
  }
}

/// A shared character performs a shared BVH and recorded joints.
void expectPerforms(const char* character, int parts) {
  LORICA_REQUIRE_DATASET(file, character);
  LORICA_REQUIRE_DATASET(bvh, "bvh/animated_drawings/zombie.bvh");
  LORICA_REQUIRE_DATASET(joints, "joints/ui_prmd/m04_s01_e01_positions.txt");
  for (const fs::path& motion : {bvh, joints}) {
    const nlohmann::json json = studioJson({"play", motion, "--character", file, "--frames", "5"});
    EXPECT_EQ(json["frames"], 5) << motion;
    EXPECT_EQ(json["parts"], parts) << motion;
  }
}

TEST(SharedCharacters, AClosedOnePerformsBvhAndJoints) {
  expectPerforms("characters/cesiumman/CesiumMan.glb", 16);
}
TEST(SharedCharacters, ATornOnePerformsBvhAndJoints) {
  expectPerforms("characters/godette/Godette_vrm_v4.vrm", 16);
}
TEST(SharedCharacters, AnFbxPerformsBvhAndJoints) {
  expectPerforms("characters/arnaud/arnaud.fbx", 16);
}
TEST(SharedCharacters, AnAnimalPlaysItsOwnClipsAndDeclinesAPersonsMotion) {
  LORICA_REQUIRE_DATASET(fox, "characters/fox/Fox.glb");
  EXPECT_EQ(studioJson({"play", fox, "--clip", "Run", "--frames", "5"})["parts"], 16);
  expectRefused({"play", "walk", "--character", fox}, {"Fox", "Survey, Walk, Run", "--clip Survey", "--write-map"});
}

}  // namespace
}  // namespace lorica::test

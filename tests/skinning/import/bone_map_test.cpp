#include "skinning/import/bone_map.h"

#include "geometry/files.h"
#include "skinning/humanoid/humanoid.h"
#include "skinning/mannequin/mannequin_skeleton.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

namespace lorica {
namespace {

using test::TemporaryFolder;
using enum HumanBone;

[[nodiscard]] std::size_t at(HumanBone bone) {
  return static_cast<std::size_t>(bone);
}

[[nodiscard]] Joint joint(std::string name, JointIndex parent, std::optional<HumanBone> bone = std::nullopt) {
  Joint made;
  made.name = std::move(name);
  made.parent = parent;
  made.rest.translation = {0.0, 0.1, 0.0};
  made.bone = bone;
  return made;
}

/// A root, hips, a leg of two joints, a tail; "Head" occurs twice.
[[nodiscard]] Skeleton small() {
  return std::move(
      *Skeleton::create({joint("Root", kNoJoint), joint("Pelvis", 0, kHips), joint("Thigh.L", 1, kLeftUpperLeg),
                         joint("Shin.L", 2, kLeftLowerLeg), joint("Neck", 1), joint("Head", 4, kHead), joint("Head", 0),
                         joint("Tail \"1\"", 1)}));
}

[[nodiscard]] std::string readMessage(std::string_view content) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("map.json", content);
  const Result<BoneMap> map = readBoneMap(file);
  if (map.ok()) return "read";
  EXPECT_TRUE(map.error().message.starts_with(file.string())) << map.error().message;
  return map.error().message.substr(file.string().size());
}

[[nodiscard]] std::string bonesMessage(std::string_view bones) {
  return readMessage("{\"lorica\": \"bone map 1\", \"bones\": {" + std::string(bones) + "}}");
}

[[nodiscard]] std::string applyMessage(const BoneMap& map) {
  const Result<Skeleton> applied = applyBoneMap(small(), map, "map.json");
  return applied.ok() ? "applied" : applied.error().message;
}

TEST(BoneMap, SaysWhatIsUnsure) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "map.json";
  const std::vector<BoneDoubt> doubts = {{{kHips, kLeftUpperLeg}, "a guess"}, {{kHips}, "very low"}};
  ASSERT_TRUE(writeBoneMap(file, small(), "hero.glb", doubts));
  const nlohmann::json written = nlohmann::json::parse(*readFile(file));
  EXPECT_EQ(written["unsure"].size(), 2u);
  EXPECT_EQ(written["unsure"]["hips"], "a guess; very low");
  EXPECT_EQ(written["unsure"]["leftUpperLeg"], "a guess");
  EXPECT_TRUE(readBoneMap(file)) << "what is unsure does not matter to the reader";
  ASSERT_TRUE(writeBoneMap(file, small(), "hero.glb"));
  EXPECT_FALSE(nlohmann::json::parse(*readFile(file)).contains("unsure"));
}

TEST(BoneMap, WhatIsWrittenIsReadAndAppliedAgain) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "map.json";
  for (const Skeleton& skeleton : {small(), makeMannequinSkeleton()}) {
    ASSERT_TRUE(writeBoneMap(file, skeleton, "hero.glb").ok());
    const Result<BoneMap> map = readBoneMap(file);
    ASSERT_TRUE(map.ok()) << map.error().message;
    EXPECT_EQ(map->character, "hero.glb");
    HumanoidGuess none;
    none.jointOf.fill(kNoJoint);
    const Result<Skeleton> applied = applyBoneMap(withBones(skeleton, none), *map, "map.json");
    ASSERT_TRUE(applied.ok()) << applied.error().message;
    for (int i = 0; i < kHumanBoneCount; ++i) {
      const auto bone = static_cast<HumanBone>(i);
      EXPECT_EQ(applied->jointOf(bone), skeleton.jointOf(bone)) << nameOf(bone);
    }
  }
}

TEST(BoneMap, TheFileIsForPeople) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "map.json";
  ASSERT_TRUE(writeBoneMap(file, small(), "hero.glb").ok());
  const std::string text = *readFile(file);
  EXPECT_NE(text.find("  \"lorica\": \"bone map 1\",\n  \"character\": \"hero.glb\",\n  \"bones\": {\n    \"hips\": "
                      "\"Pelvis\",\n    \"spine\": null,\n"),
            std::string::npos)
      << text;
  const nlohmann::ordered_json json = nlohmann::ordered_json::parse(text);
  int next = 0;
  for (const auto& [key, value] : json["bones"].items()) {
    EXPECT_EQ(key, nameOf(static_cast<HumanBone>(next++))) << "all bones, in order";
  }
  EXPECT_EQ(next, kHumanBoneCount);
  EXPECT_EQ(json["bones"]["head"], "Neck/Head");
  EXPECT_EQ(json["unusedJoints"], nlohmann::ordered_json({"Root", "Neck", "Root/Head", "Tail \"1\""}));
}

TEST(BoneMap, AnEditedMapChangesBones) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("map.json", R"({
    // the tail is the spine
    "lorica": "bone map 1",
    "bones": { "hips": "Pelvis", "spine": "Tail \"1\"", "leftUpperLeg": null }
  })");
  const Result<BoneMap> map = readBoneMap(file);
  ASSERT_TRUE(map.ok()) << map.error().message;
  const Result<Skeleton> applied = applyBoneMap(small(), *map, "map.json");
  ASSERT_TRUE(applied.ok()) << applied.error().message;
  EXPECT_EQ(applied->jointOf(kSpine), 7);
  EXPECT_EQ(applied->jointOf(kLeftUpperLeg), kNoJoint) << "null removes it";
  EXPECT_EQ(applied->jointOf(kHead), kNoJoint) << "omitted is null";
  EXPECT_EQ(map->character, "");
}

TEST(BoneMap, WrongFilesAreRefusedInSentences) {
  EXPECT_TRUE(readMessage("").starts_with(": not JSON: parse error at line 1, column 1: ")) << readMessage("");
  EXPECT_NE(readMessage("{\n \"lorica\": \"bone map 1\"\n \"bones\": {}}").find("line 3"), std::string::npos);
  EXPECT_EQ(readMessage("[]"), ": not a bone map, expected an object with \"lorica\": \"bone map 1\"");
  EXPECT_EQ(readMessage("{\"bones\": {}}"), ": not a bone map, expected an object with \"lorica\": \"bone map 1\"");
  EXPECT_EQ(readMessage("{\"lorica\": \"bone map 2\", \"bones\": {}}"),
            ": lorica is \"bone map 2\", expected \"bone map 1\"");
  EXPECT_EQ(readMessage("{\"lorica\": \"bone map 1\", \"bone\": {}}"),
            ": unknown key \"bone\"; did you mean \"bones\"?");
  EXPECT_EQ(readMessage("{\"lorica\": \"bone map 1\"}"),
            ": bones is missing, expected an object with a joint name for each bone");
  EXPECT_EQ(readMessage("{\"lorica\": \"bone map 1\", \"bones\": []}"),
            ": bones is missing, expected an object with a joint name for each bone");
  EXPECT_EQ(readMessage("{\"lorica\": \"bone map 1\", \"character\": 1, \"bones\": {}}"),
            ": character is not a string, expected a file name");
  EXPECT_EQ(bonesMessage("\"leftUperArm\": null"),
            ": bones: \"leftUperArm\" is not a bone; did you mean \"leftUpperArm\"?");
  EXPECT_EQ(bonesMessage("\"LeftUpperArm\": null"),
            ": bones: \"LeftUpperArm\" is not a bone; did you mean \"leftUpperArm\"?");
  EXPECT_EQ(bonesMessage("\"xyzzyxyzzyxyzzy\": null"), ": bones: \"xyzzyxyzzyxyzzy\" is not a bone");
  EXPECT_EQ(bonesMessage("\"hips\": 3"), ": bones: hips is a number, expected a joint name or null");
  EXPECT_EQ(bonesMessage("\"hips\": \"\""), ": bones: hips is an empty string, expected a joint name or null");
  EXPECT_EQ(bonesMessage("\"hips\": \"a\", \"head\": null, \"hips\": \"b\""), ": duplicate key \"hips\"");
  EXPECT_EQ(bonesMessage("\"hips\": \"\xff\"").substr(0, 10), ": not JSON");

  const Result<BoneMap> missing = readBoneMap("/nowhere/map.json");
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
}

TEST(BoneMap, EveryBeginningOfAFileEndsInASentence) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "map.json";
  ASSERT_TRUE(writeBoneMap(file, small(), "hero.glb").ok());
  const std::string whole = *readFile(file);
  const std::string body = whole.substr(0, whole.size() - 1);  // the last newline may be missing
  for (std::size_t size = 0; size < body.size(); ++size) {
    EXPECT_FALSE(parseBoneMap(body.substr(0, size), "map.json").ok()) << size;
  }
  EXPECT_EQ(readMessage(body), "read");
  const std::string deep(100000, '[');
  EXPECT_EQ(readMessage(deep).substr(0, 10), ": not JSON");
}

TEST(BoneMap, JointsThatDoNotFitAreRefusedInSentences) {
  BoneMap map;
  map.jointOf[at(kHips)] = "Pelvis";
  EXPECT_EQ(applyMessage(map), "applied");

  map.jointOf[at(kLeftUpperLeg)] = "Thigh_L";
  EXPECT_EQ(applyMessage(map),
            "map.json: leftUpperLeg: the character has no joint \"Thigh_L\"; did you mean \"Thigh.L\"?");
  map.jointOf[at(kLeftUpperLeg)] = "mixamorig:LeftUpLeg";
  EXPECT_EQ(applyMessage(map), "map.json: leftUpperLeg: the character has no joint \"mixamorig:LeftUpLeg\"");
  map.jointOf[at(kLeftUpperLeg)] = "Pelvis";
  EXPECT_EQ(applyMessage(map), "map.json: the joint \"Pelvis\" is both hips and leftUpperLeg, expected one bone");
  map.jointOf[at(kLeftUpperLeg)] = "Shin.L";
  map.jointOf[at(kLeftLowerLeg)] = "Thigh.L";
  EXPECT_EQ(applyMessage(map),
            "map.json: leftLowerLeg is \"Thigh.L\", which is not below \"Shin.L\", the leftUpperLeg");

  BoneMap head;
  head.jointOf[at(kHips)] = "Pelvis";
  head.jointOf[at(kHead)] = "Head";
  EXPECT_EQ(applyMessage(head),
            "map.json: head: 2 joints are named \"Head\", expected one: write \"Neck/Head\" or \"Root/Head\"");
  head.jointOf[at(kHead)] = "Root/Head";
  EXPECT_EQ(applyMessage(head), "map.json: head is \"Root/Head\", which is not below \"Pelvis\", the hips");
  head.jointOf[at(kHead)] = "Pelvis/Neck/Head";
  EXPECT_EQ(applyMessage(head), "applied");
}

TEST(BoneMap, NamesThatAreNoTextSurviveAFile) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "map.json";
  const Skeleton skeleton =
      std::move(*Skeleton::create({joint("B\xfc"
                                         "cken",
                                         kNoJoint, kHips),
                                   joint("Kopf/\n\t\"", 0, kHead), joint("Wirbels\xc3\xa4ule", 0, kSpine)}));
  ASSERT_TRUE(writeBoneMap(file, skeleton, "h\xe4ld.glb").ok());
  const Result<BoneMap> map = readBoneMap(file);
  ASSERT_TRUE(map.ok()) << map.error().message;
  HumanoidGuess none;
  none.jointOf.fill(kNoJoint);
  BoneMap withoutHead = *map;
  withoutHead.jointOf[at(kHead)].clear();  // it is beside the spine
  const Result<Skeleton> applied = applyBoneMap(withBones(skeleton, none), withoutHead, "map.json");
  ASSERT_TRUE(applied.ok()) << applied.error().message;
  EXPECT_EQ(applied->jointOf(kHips), 0);
  EXPECT_EQ(applied->jointOf(kSpine), 2);
  EXPECT_EQ(map->jointOf[at(kHead)], "Kopf/\n\t\"");
}

// Thousands of joints with one name, as in a malicious file: writing is fast, even if the result is not useful.
TEST(BoneMap, ManyJointsOfOneNameAreWritten) {
  std::vector<Joint> chain;
  std::vector<Joint> star;
  for (JointIndex i = 0; i < 5000; ++i) {
    chain.push_back(joint("a", i - 1));
    star.push_back(joint("a", i == 0 ? kNoJoint : 0));
  }
  const TemporaryFolder folder;
  for (const std::vector<Joint>& joints : {chain, star}) {
    const std::filesystem::path file = folder.path() / "map.json";
    ASSERT_TRUE(writeBoneMap(file, *Skeleton::create(joints), "hero.glb").ok());
    const Result<BoneMap> map = readBoneMap(file);
    EXPECT_TRUE(map.ok()) << map.error().message;
  }
}

TEST(BoneMap, AFolderThatIsNotThereCannotBeWritten) {
  const Result<void> written = writeBoneMap("/nowhere/at/all/map.json", small(), "hero.glb");
  ASSERT_FALSE(written.ok());
  EXPECT_EQ(written.error().code, ErrorCode::kUnwritable);
}

}  // namespace
}  // namespace lorica

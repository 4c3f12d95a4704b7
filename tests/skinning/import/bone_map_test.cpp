#include "skinning/import/bone_map.h"

#include "geometry/files.h"
#include "skinning/humanoid/humanoid.h"
#include "skinning/import/character_file.h"
#include "skinning/mannequin/mannequin_skeleton.h"
#include "tests/skinning/humanoid/humanoid_samples.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <map>
#include <string>

namespace lorica {
namespace {

using test::TemporaryFolder;
using enum HumanBone;
using test::contradictions;
using test::differences;
using test::namesOf;
using test::RigNames;

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

/// The map of a skeleton, as its file.
[[nodiscard]] std::string written(const Skeleton& skeleton, const std::string& character = "hero.glb",
                                  const std::vector<BoneDoubt>& doubts = {}) {
  const TemporaryFolder folder;
  EXPECT_TRUE(writeBoneMap(folder.path() / "map.json", skeleton, character, doubts).ok());
  return *readFile(folder.path() / "map.json");
}

TEST(BoneMap, SaysWhatIsUnsure) {
  const std::string text = written(small(), "hero.glb", {{{kHips, kLeftUpperLeg}, "a guess"}, {{kHips}, "very low"}});
  const nlohmann::json unsure = nlohmann::json::parse(text)["unsure"];
  EXPECT_EQ(unsure.size(), 2u);
  EXPECT_EQ(unsure["hips"], "a guess; very low");
  EXPECT_EQ(unsure["leftUpperLeg"], "a guess");
  EXPECT_EQ(readMessage(text), "read") << "what is unsure does not matter to the reader";
  EXPECT_FALSE(nlohmann::json::parse(written(small())).contains("unsure"));
}

TEST(BoneMap, WhatIsWrittenIsReadAndAppliedAgain) {
  for (const Skeleton& skeleton : {small(), makeMannequinSkeleton()}) {
    const BoneMap map = test::valueOf(parseBoneMap(written(skeleton), "map.json"));
    EXPECT_EQ(map.character, "hero.glb");
    const Skeleton applied = test::valueOf(applyBoneMap(test::withoutBones(skeleton), map, "map.json"));
    for (int i = 0; i < kHumanBoneCount; ++i) {
      const auto bone = static_cast<HumanBone>(i);
      EXPECT_EQ(applied.jointOf(bone), skeleton.jointOf(bone)) << nameOf(bone);
    }
  }
}

TEST(BoneMap, TheFileIsForPeople) {
  const std::string text = written(small());
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
  const BoneMap map = test::valueOf(readBoneMap(folder.write("map.json", R"({
    // the tail is the spine
    "lorica": "bone map 1",
    "bones": { "hips": "Pelvis", "spine": "Tail \"1\"", "leftUpperLeg": null }
  })")));
  const Skeleton applied = test::valueOf(applyBoneMap(small(), map, "map.json"));
  EXPECT_EQ(applied.jointOf(kSpine), 7);
  EXPECT_EQ(applied.jointOf(kLeftUpperLeg), kNoJoint) << "null removes it";
  EXPECT_EQ(applied.jointOf(kHead), kNoJoint) << "omitted is null";
  EXPECT_EQ(map.character, "");
}

TEST(BoneMap, WrongFilesAreRefusedInSentences) {
  const std::string none = "not a bone map, expected an object with \"lorica\": \"bone map 1\"";
  const std::string missing = "bones is missing, expected an object with a joint name for each bone";
  for (const auto& [text, message] : std::initializer_list<std::pair<std::string, std::string>>{
           {"[]", none},
           {R"({"bones": {}})", none},
           {R"({"lorica": "bone map 2", "bones": {}})", R"(lorica is "bone map 2", expected "bone map 1")"},
           {R"({"lorica": "bone map 1", "bone": {}})", R"(unknown key "bone"; did you mean "bones"?)"},
           {R"({"lorica": "bone map 1"})", missing},
           {R"({"lorica": "bone map 1", "bones": []})", missing},
           {R"({"lorica": "bone map 1", "character": 1, "bones": {}})",
            "character is not a string, expected a file name"}}) {
    EXPECT_EQ(readMessage(text), ": " + message);
  }
  for (const auto& [bones, message] : std::initializer_list<std::pair<std::string, std::string>>{
           {R"("leftUperArm": null)", R"(bones: "leftUperArm" is not a bone; did you mean "leftUpperArm"?)"},
           {R"("LeftUpperArm": null)", R"(bones: "LeftUpperArm" is not a bone; did you mean "leftUpperArm"?)"},
           {R"("xyzzyxyzzyxyzzy": null)", R"(bones: "xyzzyxyzzyxyzzy" is not a bone)"},
           {R"("hips": 3)", "bones: hips is a number, expected a joint name or null"},
           {R"("hips": "")", "bones: hips is an empty string, expected a joint name or null"},
           {R"("hips": "a", "head": null, "hips": "b")", "bones.hips: found twice in one object, expected once"}}) {
    EXPECT_EQ(readMessage("{\"lorica\": \"bone map 1\", \"bones\": {" + bones + "}}"), ": " + message);
  }
  EXPECT_TRUE(readMessage("").starts_with(": not JSON: parse error at line 1, column 1: ")) << readMessage("");
  EXPECT_NE(readMessage("{\n \"lorica\": \"bone map 1\"\n \"bones\": {}}").find("line 3"), std::string::npos);
  EXPECT_EQ(readMessage("{\"lorica\": \"bone map 1\", \"bones\": {\"hips\": \"\xff\"}}").substr(0, 10), ": not JSON");
  EXPECT_EQ(readBoneMap("/nowhere/map.json").error().code, ErrorCode::kNotFound);
}

TEST(BoneMap, EveryBeginningOfAFileEndsInASentence) {
  const std::string whole = written(small());
  const std::string body = whole.substr(0, whole.size() - 1);  // the last newline may be missing
  for (std::size_t size = 0; size < body.size(); ++size) {
    EXPECT_FALSE(parseBoneMap(body.substr(0, size), "map.json").ok()) << size;
  }
  EXPECT_EQ(readMessage(body), "read");
  EXPECT_EQ(readMessage(std::string(100000, '[')).substr(0, 10), ": its JSON");
}

TEST(BoneMap, JointsThatDoNotFitAreRefusedInSentences) {
  for (const auto& [joints, message] : std::initializer_list<std::pair<std::map<HumanBone, std::string>, std::string>>{
           {{{kHips, "Pelvis"}}, "applied"},
           {{{kHips, "Pelvis"}, {kLeftUpperLeg, "Thigh_L"}},
            "leftUpperLeg: the character has no joint \"Thigh_L\"; did you mean \"Thigh.L\"?"},
           {{{kHips, "Pelvis"}, {kLeftUpperLeg, "mixamorig:LeftUpLeg"}},
            "leftUpperLeg: the character has no joint \"mixamorig:LeftUpLeg\""},
           {{{kHips, "Pelvis"}, {kLeftUpperLeg, "Pelvis"}},
            "the joint \"Pelvis\" is both hips and leftUpperLeg, expected one bone"},
           {{{kHips, "Pelvis"}, {kLeftUpperLeg, "Shin.L"}, {kLeftLowerLeg, "Thigh.L"}},
            "leftLowerLeg is \"Thigh.L\", which is not below \"Shin.L\", the leftUpperLeg"},
           {{{kHips, "Pelvis"}, {kHead, "Head"}},
            "head: 2 joints are named \"Head\", expected one: write \"Neck/Head\" or \"Root/Head\""},
           {{{kHips, "Pelvis"}, {kHead, "Root/Head"}},
            "head is \"Root/Head\", which is not below \"Pelvis\", the hips"},
           {{{kHips, "Pelvis"}, {kHead, "Pelvis/Neck/Head"}}, "applied"}}) {
    BoneMap map;
    for (const auto& [bone, joint] : joints) map.jointOf[at(bone)] = joint;
    const Result<Skeleton> applied = applyBoneMap(small(), map, "map.json");
    EXPECT_EQ(applied.ok() ? "map.json: applied" : applied.error().message, "map.json: " + message);
  }
}

TEST(BoneMap, NamesThatAreNoTextSurviveAFile) {
  const Skeleton skeleton =
      std::move(*Skeleton::create({joint("B\xfc"
                                         "cken",
                                         kNoJoint, kHips),
                                   joint("Kopf/\n\t\"", 0, kHead), joint("Wirbels\xc3\xa4ule", 0, kSpine)}));
  const BoneMap map = test::valueOf(parseBoneMap(written(skeleton, "h\xe4ld.glb"), "map.json"));
  BoneMap withoutHead = map;
  withoutHead.jointOf[at(kHead)].clear();  // it is beside the spine
  const Skeleton applied = test::valueOf(applyBoneMap(test::withoutBones(skeleton), withoutHead, "map.json"));
  EXPECT_EQ(applied.jointOf(kHips), 0);
  EXPECT_EQ(applied.jointOf(kSpine), 2);
  EXPECT_EQ(map.jointOf[at(kHead)], "Kopf/\n\t\"");
}

// Thousands of joints with one name, as in a malicious file: writing is fast, even if the result is not useful.
TEST(BoneMap, ManyJointsOfOneNameAreWritten) {
  std::vector<Joint> chain, star;
  for (JointIndex i = 0; i < 5000; ++i) {
    chain.push_back(joint("a", i - 1));
    star.push_back(joint("a", i == 0 ? kNoJoint : 0));
  }
  for (const std::vector<Joint>& joints : {chain, star})
    EXPECT_EQ(readMessage(written(*Skeleton::create(joints))), "read");
}

TEST(BoneMap, AFolderThatIsNotThereCannotBeWritten) {
  EXPECT_EQ(writeBoneMap("/nowhere/at/all/map.json", small(), "hero.glb").error().code, ErrorCode::kUnwritable);
}

void expectBones(const std::filesystem::path& file, const std::map<HumanBone, std::string>& truth,
                 std::string_view by) {
  const Skeleton skeleton = test::valueOf(readCharacterFile(file)).character.skeleton;
  const HumanoidGuess guess = guessHumanoid(test::withoutBones(skeleton));
  EXPECT_EQ(differences(truth, namesOf(skeleton, guess)), "") << file;
  EXPECT_EQ(contradictions(skeleton, guess), "") << file;
  EXPECT_EQ(guess.by, by) << file;
  for (int bone = 0; bone < kHumanBoneCount; ++bone) {
    EXPECT_EQ(skeleton.jointOf(static_cast<HumanBone>(bone)), guess[static_cast<HumanBone>(bone)])
        << file << ": reading marks the bones, " << nameOf(static_cast<HumanBone>(bone));
  }
}

TEST(CharacterBones, CesiumMan) {
  LORICA_REQUIRE_DATASET(file, "characters/cesiumman/CesiumMan.glb");
  // Numbered chains with different numbers left and right: no convention, so the shape is used, and the names for
  // sides.
  const RigNames rig = test::rigOf(
      "", "", "L,R",
      "Skeleton_torso_joint_1,Skeleton_torso_joint_2,torso_joint_3,,Skeleton_neck_joint_1,Skeleton_neck_joint_2",
      "leg_joint_%_1,leg_joint_%_2,leg_joint_%_3,leg_joint_%_5", ",,,");
  std::map<HumanBone, std::string> truth = namesOf(rig);
  truth[kLeftUpperArm] = "Skeleton_arm_joint_L__4_";
  truth[kLeftLowerArm] = "Skeleton_arm_joint_L__3_";
  truth[kLeftHand] = "Skeleton_arm_joint_L__2_";
  truth[kRightUpperArm] = "Skeleton_arm_joint_R";
  truth[kRightLowerArm] = "Skeleton_arm_joint_R__2_";
  truth[kRightHand] = "Skeleton_arm_joint_R__3_";
  expectBones(file, truth, "the skeleton's shape");
}

TEST(CharacterBones, ArnaudAndHisClipFiles) {
  // the thighs are below Spine
  const RigNames rig =
      test::rigOf("", "", "Left,Right", "Hips,Spine1,Spine2,Spine3,Neck,Head", "%UpLeg,%Leg,%Foot,%FootThumb1",
                  "%Shoulder,%Arm,%ForeArm,%Hand", "%Hand@#", "Thumb,Index,Middle,Ring,Pinky");
  std::map<HumanBone, std::string> truth = namesOf(rig);
  truth[kLeftHand] = "Lefthand";  // as the artist wrote it
  truth[kLeftLittleProximal] = "LeftHandRingPinky1";
  truth[kLeftLittleIntermediate] = "LeftHandRingPinky2";
  truth[kLeftLittleDistal] = "LeftHandRingPinky3";
  for (const char* name : {"arnaud", "walk", "run", "crossarms", "atlas"}) {
    LORICA_REQUIRE_DATASET(file, std::string("characters/arnaud/") + name + ".fbx");
    expectBones(file, truth, "names (Mixamo)");
  }
}

TEST(CharacterBones, KayKit) {
  const RigNames rig = test::rigOf("", "", "l,r", "hips,spine,chest,,,head", "upperleg.%,lowerleg.%,foot.%,toes.%",
                                   ",upperarm.%,lowerarm.%,wrist.%");
  for (const char* name : {"Barbarian", "Mage"}) {
    LORICA_REQUIRE_DATASET(file, std::string("characters/kaykit/") + name + ".glb");
    expectBones(file, namesOf(rig), "names (KayKit)");
  }
}

TEST(CharacterBones, RaylibRobot) {
  LORICA_REQUIRE_DATASET(file, "characters/raylib_robot/robot.glb");
  // Its feet are below the root and its thumbs below the forearms: joints not below the limb are not its bones. Hips is
  // only a joint of the trunk: Body carries trunk and legs.
  const RigNames rig = test::rigOf("", "", "L,R", "Body,Abdomen,Torso,,Neck,Head", "UpperLeg.%,LowerLeg.%,,",
                                   "Shoulder.%,UpperArm.%,LowerArm.%,Palm2.%");
  std::map<HumanBone, std::string> truth = namesOf(rig);
  truth[kLeftMiddleProximal] = "Middle1.L";
  truth[kLeftMiddleIntermediate] = "Middle2.L";
  truth[kRightMiddleProximal] = "Middle1.R";
  truth[kRightMiddleIntermediate] = "Middle2.R";
  expectBones(file, truth, "names (common words)");
}

TEST(CharacterBones, Greenman) {
  LORICA_REQUIRE_DATASET(file, "characters/greenman/greenman.glb");
  // A puppet: its hip joints lead sideways from the middle to legs of one joint, its hands are its arms.
  const RigNames rig = test::rigOf("", "", "L,R", "root,body_low,,,,body_up", "leg_%,,,", ",hand_%,,");
  expectBones(file, namesOf(rig), "names (common words)");
}

TEST(CharacterBones, TheFoxIsNoHuman) {
  LORICA_REQUIRE_DATASET(file, "characters/fox/Fox.glb");
  expectBones(file, {}, "");
}

// The list in the VRM file was made by its artist: the guess must agree for every bone that it finds.
TEST(CharacterBones, GodetteAsHerOwnListHasHer) {
  LORICA_REQUIRE_DATASET(file, "characters/godette/Godette_vrm_v4.vrm");
  const Skeleton own = test::valueOf(readCharacterFile(file)).character.skeleton;
  const HumanoidGuess guess = guessHumanoid(test::withoutBones(own));
  int found = 0;
  int listed = 0;
  for (int i = 0; i < kHumanBoneCount; ++i) {
    const auto bone = static_cast<HumanBone>(i);
    if (own.jointOf(bone) != kNoJoint) ++listed;
    if (guess[bone] == kNoJoint) continue;
    EXPECT_EQ(guess[bone], own.jointOf(bone)) << nameOf(bone);
    ++found;
  }
  EXPECT_EQ(listed, 45);
  EXPECT_EQ(found, 27) << "all but six fingers, whose names are meaningless";
}

}  // namespace
}  // namespace lorica

#include "geometry/counts.h"
#include "skinning/import/character_file.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <set>
#include <string>
#include <vector>

/// VRM files whose humanoid maps few bones, or none: names tell the others.
namespace lorica {
namespace {

using enum HumanBone;
using nlohmann::json;

struct Bone {
  HumanBone bone;
  int parent;
  Vec3 at;
  std::array<const char*, 2> names;  ///< of Mixamo, of VRoid
};

const std::vector<Bone> kBody = {
    {kHips, -1, {0.0, 1.0, 0.0}, {"mixamorig:Hips", "J_Bip_C_Hips"}},
    {kSpine, 0, {0.0, 1.1, 0.0}, {"mixamorig:Spine", "J_Bip_C_Spine"}},
    {kChest, 1, {0.0, 1.3, 0.0}, {"mixamorig:Spine1", "J_Bip_C_Chest"}},
    {kNeck, 2, {0.0, 1.5, 0.0}, {"mixamorig:Neck", "J_Bip_C_Neck"}},
    {kHead, 3, {0.0, 1.6, 0.0}, {"mixamorig:Head", "J_Bip_C_Head"}},
    {kLeftUpperLeg, 0, {0.1, 0.95, 0.0}, {"mixamorig:LeftUpLeg", "J_Bip_L_UpperLeg"}},
    {kLeftLowerLeg, 5, {0.1, 0.5, 0.0}, {"mixamorig:LeftLeg", "J_Bip_L_LowerLeg"}},
    {kLeftFoot, 6, {0.1, 0.1, 0.0}, {"mixamorig:LeftFoot", "J_Bip_L_Foot"}},
    {kRightUpperLeg, 0, {-0.1, 0.95, 0.0}, {"mixamorig:RightUpLeg", "J_Bip_R_UpperLeg"}},
    {kRightLowerLeg, 8, {-0.1, 0.5, 0.0}, {"mixamorig:RightLeg", "J_Bip_R_LowerLeg"}},
    {kRightFoot, 9, {-0.1, 0.1, 0.0}, {"mixamorig:RightFoot", "J_Bip_R_Foot"}},
    {kLeftUpperArm, 2, {0.2, 1.45, 0.0}, {"mixamorig:LeftArm", "J_Bip_L_UpperArm"}},
    {kLeftLowerArm, 11, {0.45, 1.45, 0.0}, {"mixamorig:LeftForeArm", "J_Bip_L_LowerArm"}},
    {kLeftHand, 12, {0.7, 1.45, 0.0}, {"mixamorig:LeftHand", "J_Bip_L_Hand"}},
    {kRightUpperArm, 2, {-0.2, 1.45, 0.0}, {"mixamorig:RightArm", "J_Bip_R_UpperArm"}},
    {kRightLowerArm, 14, {-0.45, 1.45, 0.0}, {"mixamorig:RightForeArm", "J_Bip_R_LowerArm"}},
    {kRightHand, 15, {-0.7, 1.45, 0.0}, {"mixamorig:RightHand", "J_Bip_R_Hand"}}};

/// A box on each bone: in one skin, or each on its node.
test::GlbWriter bodyNamed(int names, bool rigid = false) {
  test::GlbWriter writer;
  TriMesh all;
  std::vector<std::uint8_t> joints;
  std::vector<float> weights;
  std::vector<Affine3> matrices;
  std::vector<int> bones;
  for (int b = 0; b < countOf(kBody); ++b) {
    const Bone& bone = kBody[b];
    const Vec3 from = bone.parent == -1 ? bone.at : Vec3(bone.at - kBody[bone.parent].at);
    json node = {{"name", bone.names[names]}, {"translation", {from.x(), from.y(), from.z()}}};
    for (int c = 0; c < countOf(kBody); ++c) {
      if (kBody[c].parent == b) node["children"].push_back(c);
    }
    const Vec3 middle = rigid ? Vec3(Vec3::Zero()) : bone.at;
    const TriMesh box = test::makeBox(middle - Vec3::Constant(0.08), middle + Vec3::Constant(0.08));
    if (rigid) {
      const json attributes = {{"POSITION", writer.positions(box.vertices)}};
      const json primitive = {{"attributes", attributes}, {"indices", writer.triangles(box.triangles)}};
      node["mesh"] = writer.add("meshes", {{"primitives", json::array({primitive})}});
    }
    writer.add("nodes", node);
    bones.push_back(b);
    matrices.emplace_back(Eigen::Translation3d(-bone.at));
    const VertexIndex first = countOf(all.vertices);
    for (const Vec3& p : box.vertices) {
      all.vertices.push_back(p);
      joints.insert(joints.end(), {static_cast<std::uint8_t>(b), 0, 0, 0});
      weights.insert(weights.end(), {1.0F, 0.0F, 0.0F, 0.0F});
    }
    for (const Triangle& t : box.triangles) all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  json roots = json::array({0});
  if (!rigid) {
    const int skin = writer.add("skins", {{"joints", bones}, {"inverseBindMatrices", writer.matrices(matrices)}});
    json primitive = {{"indices", writer.triangles(all.triangles)}};
    primitive["attributes"] = {{"POSITION", writer.positions(all.vertices)},
                               {"JOINTS_0", writer.accessor(joints, "VEC4")},
                               {"WEIGHTS_0", writer.accessor(weights, "VEC4")}};
    const int mesh = writer.add("meshes", {{"primitives", json::array({primitive})}});
    roots.push_back(writer.add("nodes", {{"mesh", mesh}, {"skin", skin}}));
  }
  writer.add("scenes", {{"nodes", roots}});
  return writer;
}

using BoneMap = std::vector<std::pair<HumanBone, int>>;  // nodes

void addVrm1(test::GlbWriter& writer, const BoneMap& map, const char* extension = "VRMC_vrm") {
  json bones = json::object();
  for (const auto& [bone, node] : map) bones[std::string(nameOf(bone))] = {{"node", node}};
  writer.document["extensions"][extension] = {{"specVersion", "1.0"}, {"humanoid", {{"humanBones", bones}}}};
}

void addVrm0(test::GlbWriter& writer, const BoneMap& map) {
  json bones = json::array();
  for (const auto& [bone, node] : map) bones.push_back({{"bone", nameOf(bone)}, {"node", node}});
  writer.document["extensions"]["VRM"] = {{"specVersion", "0.0"}, {"humanoid", {{"humanBones", bones}}}};
}

/// The name of a bone's joint; empty if it has none.
std::string jointOf(const CharacterFile& file, HumanBone bone) {
  const JointIndex joint = file.character.skeleton.jointOf(bone);
  return joint == kNoJoint ? "" : file.character.skeleton.joint(joint).name;
}

TEST(VrmBones, ThatAreNotMappedAreFoundByTheirNames) {
  const std::vector<std::pair<BoneMap, std::string>> maps = {
      {{}, "its humanoid maps no bone: 17 were found by names ("},
      {{{kHead, 4}}, "its humanoid maps 1 bone: 16 more were found by names ("},
      {{{kLeftHand, -1}, {kHips, 0}, {kRightFoot, 10}}, "its humanoid maps 2 bones: 15 more were found by names ("},
      {{{kHips, 0}, {kSpine, 1}, {kChest, 2}, {kNeck, 3}, {kHead, 4}, {kLeftUpperArm, 11}, {kRightUpperArm, 14}},
       "its humanoid maps 7 bones: 10 more were found by names ("}};
  for (const int names : {0, 1}) {
    for (const bool first : {true, false}) {
      for (const auto& [map, note] : maps) {
        test::GlbWriter writer = bodyNamed(names);
        first ? addVrm1(writer, map) : addVrm0(writer, map);
        const CharacterFile file = test::valueOf(test::parsed(writer));
        EXPECT_EQ(file.format, first ? "VRM 1.0" : "VRM 0.x");
        for (const Bone& bone : kBody) EXPECT_EQ(jointOf(file, bone.bone), bone.names[names]) << nameOf(bone.bone);
        EXPECT_TRUE(test::hasNote(file, note)) << note << testing::PrintToString(file.notes);
        EXPECT_FALSE(test::hasNote(file, "which does not exist"));
      }
    }
  }
}

TEST(VrmBones, ThatAreMappedHavePrecedence) {
  test::GlbWriter writer = bodyNamed(0);
  addVrm1(writer, {{kHips, 0}, {kUpperChest, 2}, {kLeftUpperLeg, 8}, {kLeftLowerLeg, 9}, {kLeftFoot, 10}});
  const CharacterFile file = test::valueOf(test::parsed(writer));
  EXPECT_EQ(jointOf(file, kUpperChest), "mixamorig:Spine1");
  EXPECT_EQ(jointOf(file, kLeftFoot), "mixamorig:RightFoot");
  // What contradicts the map stays out: a joint is one bone.
  const std::array<BoneMap, 6> odds = {BoneMap{{kSpine, 0}},
                                       BoneMap{{kHips, 5}},
                                       BoneMap{{kHead, 0}, {kNeck, 4}},
                                       BoneMap{{kLeftHand, 2}},
                                       BoneMap{{kLeftUpperArm, 13}, {kLeftHand, 11}},
                                       BoneMap{{kRightToes, 6}, {kLeftUpperLeg, 16}}};
  for (const BoneMap& odd : odds) {
    test::GlbWriter other = bodyNamed(1);
    addVrm1(other, odd);
    const CharacterFile read = test::valueOf(test::parsed(other));
    for (const auto& [bone, node] : odd) EXPECT_EQ(jointOf(read, bone), kBody[node].names[1]);
    std::set<JointIndex> joints;
    for (int b = 0; b < kHumanBoneCount; ++b) {
      const JointIndex joint = read.character.skeleton.jointOf(static_cast<HumanBone>(b));
      EXPECT_TRUE(joint == kNoJoint || joints.insert(joint).second) << b;
    }
  }
}

TEST(VrmBones, AWholeMapIsNotCompleted) {
  test::GlbWriter writer = bodyNamed(0);
  BoneMap map;
  for (int b = 0; b < countOf(kBody); ++b) {
    if (kBody[b].bone != kChest && kBody[b].bone != kNeck) map.emplace_back(kBody[b].bone, b);
  }
  addVrm1(writer, map);
  const CharacterFile file = test::valueOf(test::parsed(writer));
  EXPECT_EQ(jointOf(file, kChest), "");
  EXPECT_EQ(jointOf(file, kNeck), "");
  EXPECT_FALSE(test::hasNote(file, "its humanoid maps"));
  // An animation lists the bones that it moves.
  test::GlbWriter animation = bodyNamed(0);
  addVrm1(animation, {{kHips, 0}, {kHead, 4}}, "VRMC_vrm_animation");
  EXPECT_EQ(jointOf(test::valueOf(test::parsed(animation)), kLeftHand), "");
}

TEST(VrmBones, OfRigidBoxesAreFoundToo) {
  for (const BoneMap& map : {BoneMap{}, {{kHips, 0}, {kHead, 4}}}) {
    test::GlbWriter writer = bodyNamed(1, true);
    addVrm1(writer, map);
    const CharacterFile file = test::valueOf(test::parsed(writer));
    EXPECT_FALSE(file.isMesh());
    EXPECT_TRUE(test::hasNote(file, "has no skin: its 17 meshes follow 17 humanoid bones, rigidly"))
        << testing::PrintToString(file.notes);
    EXPECT_EQ(jointOf(file, kRightHand), "J_Bip_R_Hand");
  }
}

}  // namespace
}  // namespace lorica

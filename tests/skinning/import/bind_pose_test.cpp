#include "geometry/counts.h"
#include "skinning/import/file_scene.h"
#include "tests/skinning/import/agreement.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <array>
#include <numbers>

namespace lorica {
namespace {

struct Bone {
  const char* name;
  int parent;
  Vec3 at;  ///< in the bind pose
};

constexpr int kBones = 6;
const std::array<Bone, kBones> kBody = {{{"Hips", -1, {0.0, 1.0, 0.0}},
                                         {"Spine", 0, {0.0, 1.2, 0.0}},
                                         {"Head", 1, {0.0, 1.6, 0.0}},
                                         {"LeftUpLeg", 0, {0.1, 0.9, 0.0}},
                                         {"LeftLeg", 3, {0.1, 0.5, 0.0}},
                                         {"LeftFoot", 4, {0.1, 0.1, 0.0}}}};

/// A box around each bone of a body, in one skin or in a skin for each mesh.
/// @param turned  the nodes' rotations; their inverse bind matrices are those of the body that stands
/// @param meshes  the bones of each mesh and of its skin
test::GlbWriter posedBody(const std::array<Quat, kBones>& turned, const std::vector<std::vector<int>>& meshes) {
  test::GlbWriter writer;
  for (int b = 0; b < kBones; ++b) {
    const Bone& bone = kBody[b];
    const Vec3 from = bone.parent == -1 ? bone.at : Vec3(bone.at - kBody[bone.parent].at);
    const Eigen::Vector4d q = turned[b].coeffs();
    nlohmann::json node = {{"name", bone.name},
                           {"translation", {from.x(), from.y(), from.z()}},
                           {"rotation", {q.x(), q.y(), q.z(), q.w()}}};
    for (int c = 0; c < kBones; ++c) {
      if (kBody[c].parent == b) node["children"].push_back(c);
    }
    writer.add("nodes", node);
  }
  nlohmann::json roots = {0};
  for (const std::vector<int>& bones : meshes) {
    TriMesh all;
    std::vector<std::uint8_t> joints;
    std::vector<float> weights;
    std::vector<Affine3> matrices;
    for (int b = 0; b < countOf(bones); ++b) {
      const Vec3& at = kBody[bones[b]].at;
      matrices.emplace_back(Eigen::Translation3d(-at));
      const TriMesh box = test::makeBox(at - Vec3::Constant(0.1), at + Vec3::Constant(0.1));
      const VertexIndex first = countOf(all.vertices);
      for (const Vec3& p : box.vertices) {
        all.vertices.push_back(p);
        joints.insert(joints.end(), {static_cast<std::uint8_t>(b), 0, 0, 0});
        weights.insert(weights.end(), {1.0F, 0.0F, 0.0F, 0.0F});
      }
      for (Triangle t : box.triangles) all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    const int skin = writer.add("skins", {{"joints", bones}, {"inverseBindMatrices", writer.matrices(matrices)}});
    nlohmann::json primitive = {{"indices", writer.triangles(all.triangles)}};
    primitive["attributes"] = {{"POSITION", writer.positions(all.vertices)},
                               {"JOINTS_0", writer.accessor(joints, "VEC4")},
                               {"WEIGHTS_0", writer.accessor(weights, "VEC4")}};
    const int mesh = writer.add("meshes", {{"primitives", {primitive}}});
    roots.push_back(writer.add("nodes", {{"mesh", mesh}, {"skin", skin}}));
  }
  writer.add("scenes", {{"nodes", roots}});
  return writer;
}

const std::vector<std::vector<int>> kOneSkin = {{0, 1, 2, 3, 4, 5}};

std::array<Quat, kBones> unturned() {
  std::array<Quat, kBones> turned;
  turned.fill(Quat::Identity());
  return turned;
}

Quat turn(double degrees, const Vec3& axis) {
  return Quat(Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, axis.normalized()));
}

std::vector<Affine3> restOf(const CharacterFile& file) {
  const Skeleton& skeleton = file.character.skeleton;
  std::vector<Affine3> world(skeleton.joints().size());
  computeWorldFromJoint(skeleton, restPose(skeleton), world);
  return world;
}

/// At rest each bone is where the inverse bind matrices say, and so is the mesh.
void expectStanding(const CharacterFile& file) {
  const std::vector<Affine3> world = restOf(file);
  for (JointIndex j = 0; j < file.character.skeleton.jointCount(); ++j) {
    EXPECT_TRUE((world[j] * file.character.jointFromModel[j]).matrix().isIdentity(1e-5)) << j;
    for (const Bone& bone : kBody) {
      if (file.character.skeleton.joint(j).name != bone.name) continue;
      EXPECT_LE((world[j].translation() - bone.at).norm(), 1e-5) << bone.name;
    }
  }
  EXPECT_NEAR(file.character.height, 1.7, 1e-5);
}

TEST(BindPose, ComesFromTheSkinWhereTheNodesArePosed) {
  std::array<Quat, kBones> turned = unturned();
  turned[4] = turn(70.0, Vec3::UnitX());
  turned[5] = turn(-40.0, Vec3(1.0, 0.0, 1.0));
  test::GlbWriter writer = posedBody(turned, kOneSkin);
  const Quat key = turn(30.0, Vec3::UnitZ());
  const int times = writer.accessor(std::vector<float>{0.0F, 1.0F}, "SCALAR");
  const int values = writer.accessor(
      std::vector<float>{0, 0, 0, 1, 0, 0, static_cast<float>(key.z()), static_cast<float>(key.w())}, "VEC4");
  writer.add("animations", {{"samplers", {{{"input", times}, {"output", values}}}},
                            {"channels", {{{"sampler", 0}, {"target", {{"node", 3}, {"path", "rotation"}}}}}}});
  const CharacterFile file = test::valueOf(test::parsed(writer));
  expectStanding(file);
  EXPECT_TRUE(test::hasNote(
      file, "its nodes are posed, 2 in all, by up to 70 degrees and 0 cm from its skin's bind pose, which is used"))
      << testing::PrintToString(file.notes);
  // What the file itself shows is kept: as it was saved, and in its clip, which turns one joint of the posed leg.
  const test::GltfTruth truth(writer.glb());
  EXPECT_LE(test::farthestFromTruth(file, truth, -1, 0.0), 1e-5);
  EXPECT_LE(test::farthestFromTruth(file, truth, 0, 0.6), 1e-5);
}

TEST(BindPose, NodesThatAgreeKeepTheirNumbers) {
  std::array<Quat, kBones> turned = unturned();
  const CharacterFile file = test::valueOf(test::parsed(posedBody(turned, kOneSkin)));
  expectStanding(file);
  EXPECT_FALSE(test::hasNote(file, "posed"));
}

TEST(BindPose, HipsThatAreTurnedDoNotTiltTheBody) {
  // As of a character that was saved in the first frame of its clip: no bone is where it was bound.
  std::array<Quat, kBones> turned = unturned();
  turned[0] = turn(35.0, Vec3(1.0, 2.0, 0.5));
  for (int b = 1; b < kBones; ++b) turned[b] = turn(10.0 + 5.0 * b, Vec3(b, 1.0, -2.0));
  expectStanding(test::valueOf(test::parsed(posedBody(turned, kOneSkin))));
  // The face, which comes first, has the head only; the body decides.
  expectStanding(test::valueOf(test::parsed(posedBody(turned, {{2}, {0, 1, 3, 4, 5}, {2, 1}}))));
}

TEST(BindPose, HairWithBonesOfItsOwnHangsOnTheHead) {
  std::array<Quat, kBones> turned = unturned();
  turned[1] = turn(60.0, Vec3::UnitX());
  turned[3] = turn(30.0, Vec3::UnitZ());
  // The "hair" of this body is its head, below the posed spine.
  expectStanding(test::valueOf(test::parsed(posedBody(turned, {{2}, {0, 1, 3, 4, 5}}))));
}

TEST(BindPose, ABodyThatLiesInItsNodesStandsAsModelled) {
  std::array<Quat, kBones> turned = unturned();
  turned[0] = turn(-90.0, Vec3::UnitX());
  expectStanding(test::valueOf(test::parsed(posedBody(turned, kOneSkin))));
  turned[5] = turn(30.0, Vec3::UnitX());
  expectStanding(test::valueOf(test::parsed(posedBody(turned, kOneSkin))));
}

TEST(BindPose, NodesOutsideTheSkinFollowTheirParents) {
  std::array<Quat, kBones> turned = unturned();
  turned[2] = turn(50.0, Vec3::UnitX());
  test::GlbWriter writer = posedBody(turned, kOneSkin);
  const TriMesh hat = test::makeBox(Vec3(-0.1, 0.2, -0.1), Vec3(0.1, 0.3, 0.1));
  nlohmann::json primitive = {{"indices", writer.triangles(hat.triangles)}};
  primitive["attributes"] = {{"POSITION", writer.positions(hat.vertices)}};
  const int mesh = writer.add("meshes", {{"primitives", {primitive}}});
  const int node = writer.add("nodes", {{"name", "hat"}, {"mesh", mesh}, {"translation", {0.0, 0.5, 0.0}}});
  writer.document["nodes"][2]["children"] = {node};
  const CharacterFile file = test::valueOf(test::parsed(writer));
  const Aabb box = boundsOf(file.character.mesh.vertices);
  EXPECT_NEAR(box.max.y(), 2.4, 1e-5);  // upright above the head at 1.6 m
  EXPECT_NEAR(box.max.z(), 0.1, 1e-5);
  EXPECT_LE(test::farthestFromTruth(file, test::GltfTruth(writer.glb()), -1, 0.0), 1e-5);
}

TEST(BindPose, BonesThatMoveNothingAndHaveNoMatrixFollowTheirParents) {
  std::array<Quat, kBones> turned = unturned();
  turned[4] = turn(70.0, Vec3::UnitX());
  test::GlbWriter writer = posedBody(turned, kOneSkin);
  // The tip of the foot is in the skin with a matrix that was never set.
  const int tip = writer.add("nodes", {{"name", "LeftToeTip"}, {"translation", {0.0, -0.1, 0.2}}});
  writer.document["nodes"][5]["children"] = {tip};
  writer.document["skins"][0]["joints"].push_back(tip);
  std::vector<Affine3> matrices;
  for (const Bone& bone : kBody) matrices.emplace_back(Eigen::Translation3d(-bone.at));
  matrices.push_back(Affine3::Identity());
  writer.document["skins"][0]["inverseBindMatrices"] = writer.matrices(matrices);
  const CharacterFile file = test::valueOf(test::parsed(writer));
  const Skeleton& skeleton = file.character.skeleton;
  for (JointIndex j = 0; j < skeleton.jointCount(); ++j) {
    if (skeleton.joint(j).name != "LeftToeTip") continue;
    EXPECT_LE((restOf(file)[j].translation() - Vec3(0.1, 0.0, 0.2)).norm(), 1e-5);
  }
}

/// The same body without a skin: each box on its node.
test::GlbWriter rigidBody() {
  test::GlbWriter writer = posedBody(unturned(), {{0}, {1}, {2}, {3}, {4}, {5}});
  nlohmann::json& nodes = writer.document["nodes"];
  for (int b = 0; b < kBones; ++b) {
    const Vec3& at = kBody[b].at;
    nodes[kBones + b].erase("skin");
    nodes[kBones + b]["translation"] = {-at.x(), -at.y(), -at.z()};
    nodes[b]["children"].push_back(kBones + b);
  }
  writer.document.erase("skins");
  writer.document["scenes"][0]["nodes"] = {0};
  return writer;
}

TEST(RigidHumanoid, FollowsTheBonesThatAFileLists) {
  test::GlbWriter writer = rigidBody();
  const CharacterFile plain = test::valueOf(test::parsed(writer));
  EXPECT_TRUE(plain.isMesh());  // its names alone are no whole body
  const auto bone = [](const char* name, int node) { return nlohmann::json{{name, {{"node", node}}}}; };
  nlohmann::json bones;
  bones.update(bone("hips", 0));
  bones.update(bone("spine", 1));
  bones.update(bone("head", 2));
  bones.update(bone("leftUpperLeg", 3));
  bones.update(bone("leftLowerLeg", 4));
  bones.update(bone("leftFoot", 5));
  writer.document["extensions"]["VRMC_vrm"] = {{"specVersion", "1.0"}, {"humanoid", {{"humanBones", bones}}}};
  const CharacterFile file = test::valueOf(test::parsed(writer));
  EXPECT_FALSE(file.isMesh());
  EXPECT_TRUE(test::hasNote(file, "has no skin: its 6 meshes follow 6 humanoid bones, rigidly"))
      << testing::PrintToString(file.notes);
  expectStanding(file);
  const Character& character = file.character;
  EXPECT_NE(character.skeleton.jointOf(HumanBone::kLeftFoot), kNoJoint);
  // The foot's box follows the foot: turned up by 90 degrees, it is in front of the knee.
  Pose pose = restPose(character.skeleton);
  pose[character.skeleton.jointOf(HumanBone::kLeftLowerLeg)].rotation = turn(-90.0, Vec3::UnitX());
  EXPECT_NEAR(boundsOf(test::posedVertices(file, pose)).max.z(), 0.5, 1e-5);
}

TEST(RigidHumanoid, OfAVrmIsACharacter) {
  LORICA_REQUIRE_DATASET(path, "strangers/rigid_boxes.vrm");
  const CharacterFile file = test::valueOf(readCharacterFile(path));
  EXPECT_EQ(file.format, "VRM 1.0");
  EXPECT_FALSE(file.isMesh());
  EXPECT_TRUE(test::hasNote(file, "has no skin: its 19 meshes follow 17 humanoid bones, rigidly"));
  EXPECT_NE(file.character.skeleton.jointOf(HumanBone::kRightHand), kNoJoint);
}

TEST(FlatBones, HangOnTheParentsThatTheirNamesMean) {
  // As tools for Second Life write them: all joints side by side, with the collision volumes among them.
  struct Listed {
    const char* name;
    const char* parent;
    Vec3 at;
  };
  const std::vector<Listed> joints = {{"mPelvis", "root", {0.0, 1.0, 0.0}},
                                      {"mKneeLeft", "mHipLeft", {0.1, 0.5, 0.0}},
                                      {"mHipLeft", "mPelvis", {0.1, 0.95, 0.0}},
                                      {"mAnkleLeft", "mKneeLeft", {0.1, 0.1, 0.0}},
                                      {"mHipRight", "mPelvis", {-0.1, 0.95, 0.0}},
                                      {"mKneeRight", "mHipRight", {-0.1, 0.5, 0.0}},
                                      {"mAnkleRight", "mKneeRight", {-0.1, 0.1, 0.0}},
                                      {"mChest", "mTorso", {0.0, 1.3, 0.0}},
                                      {"mTorso", "mPelvis", {0.0, 1.1, 0.0}},
                                      {"mNeck", "mChest", {0.0, 1.5, 0.0}},
                                      {"mHead", "mNeck", {0.0, 1.6, 0.0}},
                                      {"mCollarLeft", "mChest", {0.05, 1.45, 0.0}},
                                      {"mShoulderLeft", "mCollarLeft", {0.2, 1.45, 0.0}},
                                      {"mElbowLeft", "mShoulderLeft", {0.45, 1.45, 0.0}},
                                      {"mWristLeft", "mElbowLeft", {0.7, 1.45, 0.0}},
                                      {"mHandIndex2Left", "mHandIndex1Left", {0.82, 1.45, 0.0}},
                                      {"mHandIndex1Left", "mWristLeft", {0.78, 1.45, 0.0}},
                                      {"mCollarRight", "mChest", {-0.05, 1.45, 0.0}},
                                      {"mShoulderRight", "mCollarRight", {-0.2, 1.45, 0.0}},
                                      {"mElbowRight", "mShoulderRight", {-0.45, 1.45, 0.0}},
                                      {"mWristRight", "mElbowRight", {-0.7, 1.45, 0.0}},
                                      {"L_HAND", "mWristLeft", {0.72, 1.45, 0.0}}};
  FileScene scene;
  scene.format = "COLLADA";
  scene.nodes.push_back({"root", -1, {}, std::nullopt});
  FileMesh mesh;
  mesh.node = 0;
  mesh.skin = 0;
  mesh.weightBegin.push_back(0);
  FileSkin skin;
  TriMesh all;
  for (int j = 0; j < countOf(joints); ++j) {
    const Vec3& at = joints[j].at;
    JointTransform local;
    local.translation = at;
    scene.nodes.push_back({joints[j].name, 0, local, std::nullopt});
    skin.nodes.push_back(j + 1);
    skin.jointFromMesh.emplace_back(Eigen::Translation3d(-at));
    const TriMesh box = test::makeBox(at - Vec3::Constant(0.05), at + Vec3::Constant(0.05));
    all = test::joined(all, box);
    for (std::size_t v = 0; v < box.vertices.size(); ++v) {
      mesh.weights.push_back({j, 1.0});
      mesh.weightBegin.push_back(mesh.weights.size());
    }
  }
  mesh.positions = all.vertices;
  mesh.triangles = all.triangles;
  scene.skins.push_back(skin);
  scene.meshes.push_back(mesh);

  const CharacterFile file = test::valueOf(makeCharacterFile(scene, "t.dae"));
  EXPECT_TRUE(test::hasNote(file, "its bones are a list without a hierarchy: the parents of 21 were found"))
      << testing::PrintToString(file.notes);
  const Skeleton& skeleton = file.character.skeleton;
  const std::vector<Affine3> world = restOf(file);
  int found = 0;
  for (const Listed& one : joints) {
    for (JointIndex j = 0; j < skeleton.jointCount(); ++j) {
      if (skeleton.joint(j).name != one.name) continue;
      ++found;
      EXPECT_EQ(skeleton.joint(skeleton.joint(j).parent).name, one.parent) << one.name;
      EXPECT_LE((world[j].translation() - one.at).norm(), 1e-5) << one.name;
    }
  }
  EXPECT_EQ(found, countOf(joints));
  for (const HumanBone bone : {HumanBone::kHips, HumanBone::kSpine, HumanBone::kHead, HumanBone::kLeftHand,
                               HumanBone::kRightLowerLeg, HumanBone::kRightUpperArm}) {
    EXPECT_NE(skeleton.jointOf(bone), kNoJoint) << nameOf(bone);
  }
}

/// A bone of an avatar of Second Life. Those in capitals are volumes that only collide: their matrices are scaled.
struct Volume {
  const char* name;
  int parent;
  Vec3 at;                         ///< in the bind pose
  Vec3 scale = {1.0, 1.0, 1.0};    ///< of its inverse bind matrix's inverse
  Vec3 degrees = {0.0, 0.0, 0.0};  ///< the same, about X, then Y, then Z
};

const std::vector<Volume> kAvatar = {
    {"mPelvis", -1, {0.0, 1.07, 0.0}},   {"PELVIS", 0, {0.0, 1.05, -0.01}, {0.12, 0.16, 0.17}},
    {"mTorso", 0, {0.0, 1.15, 0.0}},     {"BELLY", 2, {0.0, 1.19, 0.03}, {0.09, 0.13, 0.15}, {8.0, 0.0, 0.0}},
    {"mChest", 2, {0.0, 1.36, 0.0}},     {"CHEST", 4, {0.0, 1.43, 0.02}, {0.11, 0.15, 0.2}, {-10.0, 3.0, 0.0}},
    {"mHead", 4, {0.0, 1.6, 0.0}},       {"HEAD", 6, {0.0, 1.67, 0.02}, {0.11, 0.09, 0.12}},
    {"mHipLeft", 0, {0.13, 1.03, 0.0}},  {"L_UPPER_LEG", 8, {0.13, 0.8, -0.02}, {0.09, 0.09, 0.32}, {95.0, 0.0, 4.0}},
    {"mKneeLeft", 8, {0.08, 0.54, 0.0}}, {"L_LOWER_LEG", 10, {0.08, 0.3, -0.02}, {0.06, 0.06, 0.25}, {90.0, 0.0, 0.0}}};

Affine3 bindOf(const Volume& bone) {
  const Vec3 angles = bone.degrees * std::numbers::pi / 180.0;
  return Eigen::Translation3d(bone.at) * Eigen::AngleAxisd(angles.z(), Vec3::UnitZ()) *
         Eigen::AngleAxisd(angles.y(), Vec3::UnitY()) * Eigen::AngleAxisd(angles.x(), Vec3::UnitX()) *
         Eigen::Scaling(bone.scale);
}

enum class Nodes { kAgree, kUnscaled, kUnscaledAndPosed };

/// Boxes around the bones, each vertex on its bone and on the next of the same skin.
/// @param skins   bones of each, in their order in the file
test::GlbWriter avatarGlb(const std::vector<Volume>& bones, Nodes how, const std::vector<std::vector<int>>& skins) {
  test::GlbWriter writer;
  for (int b = 0; b < countOf(bones); ++b) {
    const Volume& bone = bones[b];
    const Affine3 parent = bone.parent == -1 ? Affine3::Identity() : bindOf(bones[bone.parent]);
    Affine3 local = parent.inverse() * bindOf(bone);
    if (how != Nodes::kAgree) {  // as of a program whose bones have no scale
      local = Eigen::Translation3d(bone.at - (bone.parent == -1 ? Vec3::Zero() : bones[bone.parent].at));
    }
    if (how == Nodes::kUnscaledAndPosed && bone.name[0] == 'm') local.rotate(turn(5.0 * b, Vec3(1.0, b, -1.0)));
    nlohmann::json node = {{"name", bone.name}};
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 4; ++row) node["matrix"].push_back(local.matrix()(row, column));
    }
    if (how != Nodes::kAgree) {
      const Quat rotation(local.rotation());
      const Vec3 at = local.translation();
      node.erase("matrix");
      node["translation"] = {at.x(), at.y(), at.z()};
      node["rotation"] = {rotation.x(), rotation.y(), rotation.z(), rotation.w()};
    }
    for (int c = 0; c < countOf(bones); ++c) {
      if (bones[c].parent == b) node["children"].push_back(c);
    }
    writer.add("nodes", node);
  }
  nlohmann::json roots = {0};
  for (const std::vector<int>& own : skins) {
    TriMesh all;
    std::vector<std::uint8_t> joints;
    std::vector<float> weights;
    std::vector<Affine3> matrices;
    for (int b = 0; b < countOf(own); ++b) {
      const Vec3& at = bones[own[b]].at;
      matrices.push_back(bindOf(bones[own[b]]).inverse());
      const TriMesh box = test::makeBox(at - Vec3::Constant(0.04), at + Vec3::Constant(0.04));
      for (std::size_t v = 0; v < box.vertices.size(); ++v) {
        joints.insert(joints.end(),
                      {static_cast<std::uint8_t>(b), static_cast<std::uint8_t>((b + 1) % own.size()), 0, 0});
        weights.insert(weights.end(), {0.75F, 0.25F, 0.0F, 0.0F});
      }
      all = test::joined(all, box);
    }
    const int skin = writer.add("skins", {{"joints", own}, {"inverseBindMatrices", writer.matrices(matrices)}});
    nlohmann::json primitive = {{"indices", writer.triangles(all.triangles)}};
    primitive["attributes"] = {{"POSITION", writer.positions(all.vertices)},
                               {"JOINTS_0", writer.accessor(joints, "VEC4")},
                               {"WEIGHTS_0", writer.accessor(weights, "VEC4")}};
    const int mesh = writer.add("meshes", {{"primitives", {primitive}}});
    roots.push_back(writer.add("nodes", {{"mesh", mesh}, {"skin", skin}}));
  }
  writer.add("scenes", {{"nodes", roots}});
  return writer;
}

/// Whatever the nodes say, no vertex moves in the bind pose, and it has the size that it was modelled in.
TEST(BindPose, HoldsTheScaleAndShearOfBonesThatOnlyCollide) {
  const std::vector<int> all = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  std::vector<int> reversed(all.rbegin(), all.rend());
  const std::vector<int> volumes = {1, 3, 5, 7, 9, 11};
  std::vector<Volume> sheared = kAvatar;  // a slider that widens bones above turned volumes
  sheared[2].scale = {1.3, 0.9, 1.1};
  sheared[10].scale = {0.8, 1.0, 1.2};
  struct Case {
    const char* name;
    const std::vector<Volume>& bones;
    std::vector<std::vector<int>> skins;
  };
  const std::vector<Case> cases = {{"one skin", kAvatar, {all}},
                                   {"listed from the leaves", kAvatar, {reversed}},
                                   {"volumes only", kAvatar, {volumes}},
                                   {"a body and a shirt", kAvatar, {all, {3, 5, 2, 4}}},
                                   {"shear", sheared, {all}},
                                   {"shear, volumes only", sheared, {volumes, {11, 9}}}};
  for (const Case& c : cases) {
    for (const Nodes how : {Nodes::kAgree, Nodes::kUnscaled, Nodes::kUnscaledAndPosed}) {
      SCOPED_TRACE(testing::Message() << c.name << ", " << static_cast<int>(how));
      const CharacterFile file = test::valueOf(test::parsed(avatarGlb(c.bones, how, c.skins)));
      const std::vector<Vec3> posed = test::posedVertices(file, -1, 0.0);
      double farthest = 0.0;
      for (std::size_t v = 0; v < posed.size(); ++v) {
        farthest = std::max(farthest, (posed[v] - file.character.mesh.vertices[v]).norm());
      }
      EXPECT_LT(farthest, 2e-3);
      Aabb box;
      for (const std::vector<int>& skin : c.skins) {
        for (const int b : skin) box.extend(c.bones[b].at);
      }
      EXPECT_NEAR(file.character.height, box.max.y() - box.min.y() + 0.08, 1e-3);
      EXPECT_EQ(test::hasNote(file, "have a scale or shear that the nodes lack"), how != Nodes::kAgree)
          << testing::PrintToString(file.notes);
      for (const Joint& joint : file.character.skeleton.joints())
        EXPECT_GT(joint.rest.scale.cwiseAbs().minCoeff(), 0.0);
    }
  }
}

/// The clip turns a bone above volumes; nothing grows.
TEST(BindPose, ClipsTurnBonesAboveWhatOnlyCollides) {
  test::GlbWriter writer = avatarGlb(kAvatar, Nodes::kUnscaled, {{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}});
  const Quat key = turn(90.0, Vec3::UnitZ());
  const int times = writer.accessor(std::vector<float>{0.0F, 1.0F}, "SCALAR");
  const int values = writer.accessor(
      std::vector<float>{0, 0, 0, 1, 0, 0, static_cast<float>(key.z()), static_cast<float>(key.w())}, "VEC4");
  writer.add("animations", {{"samplers", {{{"input", times}, {"output", values}}}},
                            {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "rotation"}}}}}}});
  const CharacterFile file = test::valueOf(test::parsed(writer));
  const Affine3 turned = Eigen::Translation3d(kAvatar[0].at) * key * Eigen::Translation3d(-kAvatar[0].at);
  const std::vector<Vec3> posed = test::posedVertices(file, 0, 1.0);
  for (std::size_t v = 0; v < posed.size(); ++v) {
    ASSERT_LT((posed[v] - turned * file.character.mesh.vertices[v]).norm(), 2e-3) << v;
  }
}

/// A bone that is sheared in the bind pose alone is two joints, which clips move as the one node that it is.
TEST(BindPose, ClipsOfBonesThatAreShearedInTheBindPoseAreTheFiles) {
  const std::vector<Volume> bones = {{"mPelvis", -1, {0.0, 0.5, 0.0}},
                                     {"mTorso", 0, {0.0, 0.8, 0.0}, {1.3, 0.9, 1.1}},
                                     {"mChest", 1, {0.0, 1.1, 0.1}, {0.9, 1.2, 1.0}, {30.0, -20.0, 10.0}},
                                     {"mHead", 2, {0.0, 1.4, 0.1}}};
  test::GlbWriter writer = avatarGlb(bones, Nodes::kUnscaledAndPosed, {{3, 1, 0, 2}});
  const Quat key = turn(50.0, Vec3(1.0, -2.0, 0.5));
  std::vector<float> rotations = {0, 0, 0, 1};
  for (const double number : key.coeffs()) rotations.push_back(static_cast<float>(number));
  const int times = writer.accessor(std::vector<float>{0.0F, 1.0F}, "SCALAR");
  const int values = writer.accessor(rotations, "VEC4");
  writer.add("animations", {{"samplers", {{{"input", times}, {"output", values}}}},
                            {"channels", {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}}}}});
  const CharacterFile file = test::valueOf(test::parsed(writer));
  EXPECT_TRUE(test::hasNote(file, "nodes are sheared: each is represented by two joints"));
  const std::vector<Vec3> resting = test::posedVertices(file, -1, 0.0);
  for (std::size_t v = 0; v < resting.size(); ++v) {
    ASSERT_LT((resting[v] - file.character.mesh.vertices[v]).norm(), 1e-5);
  }
  const test::GltfTruth truth(writer.glb());
  EXPECT_LE(test::farthestFromTruth(file, truth, -1, 0.0), 1e-5);
  for (const double time : {0.0, 0.6, 1.0}) EXPECT_LE(test::farthestFromTruth(file, truth, 0, time), 1e-5) << time;
}

TEST(BindPose, OfAPosedFigureIsThatOfTheSameFigureUnposed) {
  LORICA_REQUIRE_DATASET(posedPath, "strangers/figure_posed_nodes.glb");
  LORICA_REQUIRE_DATASET(unposedPath, "strangers/figure_half_body.glb");
  const CharacterFile posed = test::valueOf(readCharacterFile(posedPath));
  const CharacterFile unposed = test::valueOf(readCharacterFile(unposedPath));
  EXPECT_TRUE(test::hasNote(posed, "its nodes are posed, 4 in all, by up to 70 degrees"));
  const std::vector<Affine3> a = restOf(posed);
  const std::vector<Affine3> b = restOf(unposed);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t j = 0; j < a.size(); ++j) {
    EXPECT_LE((a[j].translation() - b[j].translation()).norm(), 1e-4) << j;
    EXPECT_LE(Quat(a[j].rotation()).angularDistance(Quat(b[j].rotation())), 0.002) << j;
  }
}

}  // namespace
}  // namespace lorica

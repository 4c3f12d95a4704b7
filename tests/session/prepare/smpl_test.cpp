#include "session/prepare/smpl.h"

#include "geometry/arrays/array_file.h"
#include "geometry/little_endian.h"
#include "session/prepare/file_kinds.h"
#include "session/prepare/read_motion.h"
#include "session/prepare/subject.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using test::errorOf;
using test::has;
using test::TemporaryFolder;
using test::valueOf;

constexpr double kQuarter = std::numbers::pi / 2.0;

template <typename Number>
NamedArray arrayOf(const char* name, const char* type, std::vector<std::size_t> shape,
                   const std::vector<Number>& numbers) {
  NamedArray array{name, type, std::move(shape), {}};
  for (const Number number : numbers) appendLittleEndian(number, array.bytes);
  return array;
}

fs::path write(const TemporaryFolder& folder, const std::string& name, const std::vector<NamedArray>& arrays) {
  auto file = valueOf(NewFile::create(folder.path() / name));
  EXPECT_TRUE(writeArrays(arrays, *file).ok() && file->finish().ok());
  return folder.path() / name;
}

/// Frames of `joints` joints at rest.
std::vector<double> atRest(std::size_t frames, std::size_t joints) {
  return std::vector<double>(frames * joints * 3, 0.0);
}

std::vector<Affine3> worldOf(const SkeletalMotion& motion, int frame) {
  std::vector<Affine3> world(motion.skeleton.jointCount());
  computeWorldFromJoint(motion.skeleton, motion.pose(frame), world);
  return world;
}

TEST(Smpl, MotionsOfEveryModelTurnTheirJoints) {
  for (const std::size_t joints : {22, 24, 52, 55}) {
    SCOPED_TRACE(joints);
    const TemporaryFolder folder;
    std::vector<double> poses = atRest(3, joints), trans(9, 0.0);
    poses[1 * joints * 3 + 16 * 3 + 2] = kQuarter;  // frame 1: the left upper arm about Z, so that it points up
    poses[2 * joints * 3 + 1] = kQuarter;           // frame 2: the whole body about Y, so that it looks along +X
    for (int f = 0; f < 3; ++f) trans[3 * f + 1] = 1.0;
    const fs::path file =
        write(folder, "walk.npz",
              {arrayOf("poses", "<f8", {3, 3 * joints}, poses), arrayOf("trans", "<f8", {3, 3}, trans),
               arrayOf("mocap_framerate", "<f8", {}, std::vector{60.0})});
    EXPECT_EQ(kindOf(file), FileKind::kBodyModel);
    struct : Host {
    } host;
    const Motion motion = valueOf(readMotion(file, {}, host));
    ASSERT_TRUE(motion.bones);
    EXPECT_EQ(motion.bones->skeleton.jointCount(), static_cast<int>(joints));
    EXPECT_EQ(motion.bones->times, (std::vector<double>{0.0, 1.0 / 60.0, 2.0 / 60.0}));
    const auto at = [&](const std::vector<Affine3>& world, HumanBone bone) -> Vec3 {
      return world[motion.bones->skeleton.jointOf(bone)].translation();
    };
    const std::vector<Affine3> rest = worldOf(*motion.bones, 0), raised = worldOf(*motion.bones, 1),
                               turned = worldOf(*motion.bones, 2);
    EXPECT_TRUE(at(rest, HumanBone::kHips).isApprox(Vec3(0.0, 1.0, 0.0), 1e-9));
    const Vec3 arm = at(rest, HumanBone::kLeftHand) - at(rest, HumanBone::kLeftUpperArm);
    EXPECT_GT(arm.x(), 0.4) << "a T-pose";
    EXPECT_LT(std::abs(arm.y()), 0.05);
    const Vec3 up = at(raised, HumanBone::kLeftHand) - at(raised, HumanBone::kLeftUpperArm);
    EXPECT_TRUE(up.isApprox(Vec3(-arm.y(), arm.x(), arm.z()), 1e-9));
    EXPECT_TRUE(at(raised, HumanBone::kRightHand).isApprox(at(rest, HumanBone::kRightHand), 1e-12));
    const Vec3 turnedArm = at(turned, HumanBone::kLeftHand) - at(turned, HumanBone::kLeftUpperArm);
    EXPECT_TRUE(turnedArm.isApprox(Vec3(arm.z(), arm.y(), -arm.x()), 1e-9));
    if (joints >= 52) {
      const Character mannequin = makeMannequin();
      for (const HumanBone finger : {HumanBone::kLeftIndexProximal, HumanBone::kRightLittleDistal,
                                     HumanBone::kLeftThumbMetacarpal, HumanBone::kRightRingIntermediate}) {
        EXPECT_NE(motion.bones->skeleton.jointOf(finger), kNoJoint);
      }
    }
  }
}

/// AMASS has Z up, the models themselves Y: what the body's own axes do tells.
TEST(Smpl, UpIsWhereTheBodyStands) {
  for (const bool zUp : {false, true}) {
    const TemporaryFolder folder;
    std::vector<float> poses(2 * 66, 0.0f), trans(6, 0.0f);
    for (int f = 0; f < 2; ++f) {
      if (zUp) poses[66 * f] = static_cast<float>(kQuarter);  // Y to Z
      trans[3 * f] = 0.5f;
      trans[3 * f + (zUp ? 2 : 1)] = 0.9f;
    }
    const Motion motion = valueOf(readSmplMotion(
        write(folder, "m.npz", {arrayOf("poses", "<f4", {2, 22, 3}, poses), arrayOf("trans", "<f4", {2, 3}, trans)})));
    const std::vector<Affine3> world = worldOf(*motion.bones, 1);
    const Skeleton& skeleton = motion.bones->skeleton;
    EXPECT_TRUE(world[0].translation().isApprox(Vec3(0.5, 0.9, 0.0), 1e-6));
    EXPECT_GT(world[skeleton.jointOf(HumanBone::kHead)].translation().y(), 1.3);
    EXPECT_GT(world[skeleton.jointOf(HumanBone::kLeftToes)].translation().z(), 0.05) << "it looks along +Z";
    ASSERT_EQ(motion.notes.size(), 1u);
    EXPECT_TRUE(has(motion.notes[0], "30 frames a second"));
    EXPECT_TRUE(has(motion.firstGuess, zUp ? "Z is up" : "Y is up"));
  }
}

TEST(Smpl, AModelIsACharacterWithItsJoints) {
  // A made-up body: a box around each of the mannequin's joints.
  const TemporaryFolder folder;
  const std::size_t joints = 24;
  const std::vector<double> poses = atRest(1, joints);
  const Skeleton rest =
      valueOf(readSmplMotion(write(folder, "rest.npz", {arrayOf("poses", "<f8", {1, 72}, poses)}))).bones->skeleton;
  std::vector<Affine3> world(joints);
  computeWorldFromJoint(rest, restPose(rest), world);
  std::vector<double> points, weights, regressor;
  std::vector<std::uint32_t> faces, tree(2 * joints);
  const std::size_t count = 8 * joints;
  regressor.assign(joints * count, 0.0);
  for (std::size_t j = 0; j < joints; ++j) {
    const Vec3 at = world[j].translation() + Vec3(0.0, -1.2, 0.0);  // not on the floor
    const TriMesh box = test::makeBox(at - Vec3::Constant(0.03), at + Vec3::Constant(0.03));
    for (const Vec3& p : box.vertices) {
      points.insert(points.end(), p.begin(), p.end());
      for (std::size_t k = 0; k < joints; ++k) weights.push_back(k == j ? 1.0 : 0.0);
    }
    for (const Triangle& t : box.triangles) {
      for (const VertexIndex v : t) faces.push_back(static_cast<std::uint32_t>(8 * j + v));
    }
    for (std::size_t v = 0; v < 8; ++v) regressor[j * count + 8 * j + v] = 1.0 / 8.0;
    tree[j] = static_cast<std::uint32_t>(rest.joint(static_cast<JointIndex>(j)).parent);  // 2^32 - 1 of the root
    tree[joints + j] = static_cast<std::uint32_t>(j);
  }
  std::vector<NamedArray> arrays = {
      arrayOf("v_template", "<f8", {count, 3}, points), arrayOf("weights", "<f8", {count, joints}, weights),
      arrayOf("J_regressor", "<f8", {joints, count}, regressor), arrayOf("f", "<u4", {faces.size() / 3, 3}, faces),
      arrayOf("kintree_table", "<u4", {2, joints}, tree)};
  const fs::path file = write(folder, "SMPL_made_up.npz", arrays);
  EXPECT_EQ(kindOf(file), FileKind::kCharacter);
  struct : Host {
  } host;
  const CharacterFile read = valueOf(readPlayed(file, host));
  const Character& character = read.character;
  EXPECT_EQ(character.name, "SMPL_made_up");
  EXPECT_EQ(read.format, "SMPL model");
  EXPECT_EQ(read.maxInfluences, 1);
  double lowest = 1.0;
  for (const Vec3& p : character.mesh.vertices) lowest = std::min(lowest, p.y());
  EXPECT_NEAR(lowest, 0.0, 1e-12);
  // The arm up: its boxes turn about the shoulder.
  Pose pose = restPose(character.skeleton);
  pose[16].rotation = Quat(Eigen::AngleAxisd(kQuarter, Vec3::UnitZ()));
  std::vector<Affine3> bones(joints);
  computeWorldFromJoint(character.skeleton, pose, bones);
  computeWorldFromModel(character, bones, bones);
  std::vector<Vec3> posed(count);
  skinLinearBlend(character, bones, posed);
  const Vec3 shoulder = -character.jointFromModel[16].translation();
  for (std::size_t v = 0; v < count; ++v) {
    const std::size_t j = v / 8;
    const bool arm = j == 16 || j == 18 || j == 20 || j == 22;
    const Vec3 from = character.mesh.vertices[v] - shoulder;
    const Vec3 expected = arm ? Vec3(shoulder + Vec3(-from.y(), from.x(), from.z())) : character.mesh.vertices[v];
    EXPECT_LT((posed[v] - expected).norm(), 1e-9) << v;
  }
  // One shape makes all of it larger by a tenth, the other moves one point up.
  std::vector<double> shapes(2 * points.size(), 0.0);
  for (std::size_t i = 0; i < points.size(); ++i) shapes[2 * i] = 0.1 * points[i];
  shapes[2 * (3 * 5 + 1) + 1] = 0.25;
  arrays.push_back(arrayOf("shapedirs", "<f8", {count, 3, 2}, shapes));
  arrays.push_back(arrayOf("betas", "<f8", {1}, std::vector{2.0}));
  const CharacterFile large = valueOf(readSmplModel(write(folder, "large.npz", arrays)));
  EXPECT_NEAR(large.character.height, 1.2 * character.height, 1e-9);
  for (JointIndex j = 0; j < static_cast<JointIndex>(joints); ++j) {
    const Vec3& own = character.skeleton.joint(j).rest.translation;
    EXPECT_TRUE(large.character.skeleton.joint(j).rest.translation.isApprox(1.2 * own, 1e-9)) << j;
  }
  ASSERT_EQ(large.morphs.targets.size(), 2u);
  EXPECT_EQ(large.morphs.targets[0].offsets.size(), count);
  ASSERT_EQ(large.morphs.targets[1].offsets.size(), 1u);
  EXPECT_EQ(large.morphs.targets[1].offsets[0].vertex, 5);
  EXPECT_TRUE(large.morphs.targets[1].offsets[0].position.isApprox(Vec3f(0.0f, 0.25f, 0.0f)));
  arrays.back() = arrayOf("betas", "<f8", {3}, std::vector(3, 0.5));
  EXPECT_TRUE(has(errorOf(readSmplModel(write(folder, "more.npz", arrays))).message,
                  "betas has 3 numbers, expected at most 2"));
  for (const char* missing : {"weights", "kintree_table", "f", "J_regressor"}) {
    std::vector<NamedArray> fewer = arrays;
    std::erase_if(fewer, [&](const NamedArray& array) { return array.name == missing; });
    EXPECT_TRUE(has(errorOf(readSmplModel(write(folder, "fewer.npz", fewer))).message,
                    fmt::format("has no array `{}`", missing)));
  }
}

TEST(Smpl, WhatIsNoMotionIsSaid) {
  const TemporaryFolder folder;
  const auto said = [&](const std::vector<NamedArray>& arrays) {
    return errorOf(readSmplMotion(write(folder, "x.npz", arrays))).message;
  };
  EXPECT_TRUE(
      has(said({arrayOf("poses", "<f8", {2, 71}, std::vector<double>(142, 0.0))}), "poses has the shape (2, 71)"));
  std::vector<double> nan = atRest(2, 24);
  nan[100] = std::nan("");
  EXPECT_TRUE(has(said({arrayOf("poses", "<f8", {2, 72}, nan)}), "poses: element 100 is nan"));
  const NamedArray poses = arrayOf("poses", "<f8", {2, 72}, atRest(2, 24));
  EXPECT_TRUE(has(said({poses, arrayOf("trans", "<f8", {3, 3}, std::vector<double>(9, 0.0))}),
                  "trans has the shape (3, 3), expected (2, 3)"));
  EXPECT_TRUE(has(said({poses, arrayOf("fps", "<f8", {}, std::vector{-1.0})}), "fps is no number of frames a second"));
  const fs::path pickle = folder.write("SMPL_NEUTRAL.pkl", "\x80\x02}q\x01.");
  EXPECT_TRUE(has(errorOf(refuseOtherKinds(pickle)).message, "a pickle runs code when it is opened"));
}

}  // namespace
}  // namespace lorica

#include "capture/files/bvh_file.h"
#include "capture/files/joint_csv.h"
#include "capture/files/joint_stream.h"
#include "capture/retarget/proxy_skeleton.h"
#include "capture/retarget/retarget.h"
#include "capture/retarget/skeletal_retarget.h"
#include "geometry/random_numbers.h"
#include "skinning/import/character_file.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/datasets.h"
#include "tests/support/edge_stretch.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace lorica {
namespace {

using B = HumanBone;

/// A motion's poses on a character.
std::vector<Pose> performed(const Character& character, std::span<const SkeletonFrame> frames, std::size_t every) {
  ProxySkeleton proxy = *ProxySkeleton::create(character);
  Retargeter retargeter = *Retargeter::create(proxy.skeleton(), {});
  Pose proxyPose(proxy.skeleton().joints().size());
  std::vector<Pose> poses;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    retargeter.apply(frames[f], proxyPose);
    if (f % every != 0) continue;
    poses.emplace_back(character.skeleton.joints().size());
    proxy.mapBack(proxyPose, poses.back());
  }
  return poses;
}

std::vector<Pose> posesOf(const SkeletalMotion& motion, std::size_t every) {
  const std::size_t joints = motion.skeleton.joints().size();
  std::vector<Pose> poses;
  for (std::size_t f = 0; f < motion.times.size(); f += every) {
    const auto first = motion.poses.begin() + static_cast<std::ptrdiff_t>(f * joints);
    poses.emplace_back(first, first + static_cast<std::ptrdiff_t>(joints));
  }
  return poses;
}

/// No edge becomes longer than the limit allows.
void expectWhole(const Character& character, std::span<const Pose> poses, const std::string& what,
                 double limit = test::kMaxStretch) {
  const test::EdgeStretch edges(character);
  std::vector<Affine3> world(character.skeleton.joints().size());
  std::vector<Vec3> posed(character.mesh.vertices.size());
  test::EdgeStretch::Worst worst;
  for (const Pose& pose : poses) {
    computeWorldFromJoint(character.skeleton, pose, world);
    computeWorldFromModel(character, world, world);
    skinLinearBlend(character, world, posed);
    const test::EdgeStretch::Worst in = edges.in(posed);
    if (in.stretch > worst.stretch) worst = in;
  }
  const auto joint = [&](VertexIndex v) { return character.skeleton.joint(test::mainJoint(character, v)).name; };
  EXPECT_LT(worst.stretch, limit) << what << ": from " << joint(worst.a) << " to " << joint(worst.b);
}

const std::vector<SkeletonFrame>& recording(const std::string& name) {
  static std::map<std::string, std::vector<SkeletonFrame>> read;
  std::vector<SkeletonFrame>& frames = read[name];
  if (frames.empty()) frames = *readJointCsv(test::recordingsFolder() / (name + ".csv"));
  return frames;
}

/// A puppet of 180 vertices, as wide as it is tall; its arms are one joint each, and swing down through its body.
constexpr const char* kPuppet = "greenman/greenman.glb";
constexpr double kMaxStretchOfPuppet = 2.5;

class SharedCharacter : public ::testing::TestWithParam<const char*> {};

TEST_P(SharedCharacter, StaysWholeInEveryMotion) {
  LORICA_REQUIRE_DATASET(file, std::string("characters/") + GetParam());
  const Result<CharacterFile> read = readCharacterFile(file);
  ASSERT_TRUE(read) << read.error().message;
  const Character& character = read->character;
  const double limit = GetParam() == std::string(kPuppet) ? kMaxStretchOfPuppet : test::kMaxStretch;
  for (const char* name : {"walk", "wave", "squat_and_reach", "jumping_jacks", "punch_and_kick", "turn_around",
                           "walk_noisy", "punch_and_kick_noisy"}) {
    expectWhole(character, performed(character, recording(name), 10), name, limit);
  }
  for (const char* name : {"animated_drawings/zombie", "animated_drawings/jumping_jacks", "makehuman/walk1",
                           "makehuman/zombieWalk1", "makehuman/tpose"}) {
    LORICA_REQUIRE_DATASET(bvh, std::string("bvh/") + name + ".bvh");
    const Result<SkeletalMotion> motion = retargetMotion(readBvh(bvh)->motion, character, {});
    ASSERT_TRUE(motion) << motion.error().message;
    expectWhole(character, posesOf(*motion, 10), name, limit);
  }
  for (const char* name : {"m01", "m02", "m04", "m07", "m10"}) {
    LORICA_REQUIRE_DATASET(joints, fmt::format("joints/ui_prmd/{}_s01_e01_positions.txt", name));
    expectWhole(character, performed(character, readJointStream(joints, {})->frames, 10), name, limit);
  }
}

INSTANTIATE_TEST_SUITE_P(All, SharedCharacter,
                         ::testing::Values("cesiumman/CesiumMan.glb", "kaykit/Barbarian.glb", "kaykit/Mage.glb",
                                           "raylib_robot/robot.glb", kPuppet, "arnaud/arnaud.fbx",
                                           "godette/Godette_vrm_v4.vrm"),
                         [](const auto& chosen) {
                           const std::string name = std::filesystem::path(chosen.param).stem().string();
                           return name.substr(0, name.find('_'));
                         });

/// The mannequin with hands, feet and toes that hang at random places, or whose mesh is carried by controls there.
Character rearranged(std::uint64_t seed) {
  Character character = makeMannequin();
  const Skeleton whole = character.skeleton;
  RandomNumbers random(seed);
  std::vector<Affine3> world(whole.joints().size());
  computeWorldFromJoint(whole, restPose(whole), world);
  std::vector<Joint> joints(whole.joints().begin(), whole.joints().end());
  const auto hang = [&](Joint& joint, JointIndex parent, const Affine3& where) {
    const Affine3 local = (parent == kNoJoint ? Affine3(Affine3::Identity()) : world[parent]).inverse() * where;
    joint.parent = parent;
    joint.rest.translation = local.translation();
    joint.rest.rotation = Quat(local.rotation()).normalized();
  };
  std::map<JointIndex, JointIndex> carriedBy;
  for (const B end : {B::kLeftHand, B::kRightHand, B::kLeftFoot, B::kRightFoot}) {
    const JointIndex joint = whole.jointOf(end);
    const std::array<JointIndex, 2> places = {kNoJoint, whole.jointOf(B::kHips)};
    const JointIndex place = places[random.bits() % places.size()];
    switch (random.bits() % 4) {
      case 0:  // stays on its limb
        break;
      case 1:  // hangs elsewhere, and is known
        hang(joints[joint], place, world[joint]);
        break;
      case 2:  // hangs elsewhere, under a name that says what it is
        hang(joints[joint], place, world[joint]);
        for (JointIndex j = 0; j < whole.jointCount(); ++j) {
          JointIndex above = j;
          while (above != kNoJoint && above != joint) above = whole.joint(above).parent;
          if (above == joint) joints[j].bone.reset();
        }
        break;
      case 3: {  // stays, but a control carries its mesh
        Joint control{fmt::format("{}", random.bits() % 1000), kNoJoint, {}, std::nullopt};
        hang(control, place, world[joint]);
        carriedBy[joint] = static_cast<JointIndex>(joints.size());
        joints.push_back(control);
        character.jointFromModel.push_back(character.jointFromModel[joint]);
        break;
      }
    }
  }
  for (Influence& influence : character.influences) {
    if (const auto found = carriedBy.find(influence.joint); found != carriedBy.end()) influence.joint = found->second;
  }
  character.skeleton = *Skeleton::create(std::move(joints));
  return character;
}

TEST(Stretch, RigsWhoseHandsAndFeetHangElsewhereStayWhole) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Character character = rearranged(seed);
    const Result<ProxySkeleton> proxy = ProxySkeleton::create(character);
    ASSERT_TRUE(proxy) << "seed " << seed << ": " << proxy.error().message;
    EXPECT_TRUE(leftBehind(character).empty()) << "seed " << seed;
    for (const char* name : {"walk", "jumping_jacks", "squat_and_reach"}) {
      expectWhole(character, performed(character, recording(name), 10), fmt::format("seed {}, {}", seed, name));
    }
  }
}

// The measure itself: a foot that stays where the walk began.
TEST(Stretch, AFootLeftBehindIsNoticed) {
  const Character character = makeMannequin();
  const test::EdgeStretch edges(character);
  EXPECT_LT(edges.in(character.mesh.vertices).stretch, 1e-12);
  std::vector<Vec3> walked = character.mesh.vertices;
  for (VertexIndex v = 0; v < static_cast<VertexIndex>(walked.size()); ++v) {
    if (test::mainJoint(character, v) != character.skeleton.jointOf(B::kLeftFoot)) walked[v].z() += 0.3;
  }
  EXPECT_GT(edges.in(walked).stretch, test::kMaxStretch);
}

}  // namespace
}  // namespace lorica

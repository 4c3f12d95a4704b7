// Hair as three-vrm moves it: the same springs, the same poses, the same steps of 1/60 s.
#include "capture/files/joint_csv.h"
#include "session/pose_source.h"
#include "skinning/import/character_file.h"
#include "skinning/springs/spring_simulation.h"
#include "tests/peers/peer.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

using nlohmann::json;

constexpr int kSecond = 60;  // steps
constexpr int kHeld = 300;   // steps in the last pose, in which everything comes to rest

/// Rotation of a joint relative to the world, in the rest pose.
Quat restRotation(const Skeleton& skeleton, JointIndex joint) {
  Quat world = Quat::Identity();
  for (; joint != kNoJoint; joint = skeleton.joint(joint).parent) world = skeleton.joint(joint).rest.rotation * world;
  return world;
}

/// A pose as the peer's frames give it: VRM's normalised rotations, and how far the hips moved.
json frameOf(const Skeleton& skeleton, const Pose& pose, double seconds) {
  json frame = {{"dt", seconds}};
  for (JointIndex j = 0; j < skeleton.jointCount(); ++j) {
    const Joint& joint = skeleton.joint(j);
    if (!joint.bone) continue;
    const Quat parent = restRotation(skeleton, joint.parent);
    const Quat q = parent * pose[j].rotation * joint.rest.rotation.conjugate() * parent.conjugate();
    frame["rotations"][nameOf(*joint.bone)] = {q.x(), q.y(), q.z(), q.w()};
  }
  std::vector<Affine3> now(pose.size());
  std::vector<Affine3> rest(pose.size());
  computeWorldFromJoint(skeleton, pose, now);
  computeWorldFromJoint(skeleton, restPose(skeleton), rest);
  const JointIndex hips = skeleton.jointOf(HumanBone::kHips);
  const Vec3 moved = now[hips].translation() - rest[hips].translation();
  frame["hips"] = {moved.x(), moved.y(), moved.z()};
  return frame;
}

JointIndex jointNamed(const Skeleton& skeleton, const std::string& name) {
  for (JointIndex j = 0; j < skeleton.jointCount(); ++j) {
    if (skeleton.joint(j).name == name) return j;
  }
  return kNoJoint;
}

TEST(PeerSprings, GodettesHairFollowsTheSamePaths) {
  LORICA_REQUIRE_DATASET(path, "characters/godette/Godette_vrm_v4.vrm");
  LORICA_REQUIRE_PEERS();
  const Result<CharacterFile> file = readCharacterFile(path);
  ASSERT_TRUE(file.ok()) << file.error().message;
  const Character& character = file.value().character;
  const Skeleton& skeleton = character.skeleton;
  const auto recording = readJointCsv(test::recordingsFolder() / "walk.csv").value();
  const SkeletalMotion walk = perform(character, recording).value();

  SpringSimulation springs = SpringSimulation::create(skeleton, file.value().springs).value();
  json shots = {{"picture", false}, {"vertices", false}};
  json& frames = shots["shots"]["walk"]["frames"] = json::array();
  std::vector<std::vector<Affine3>> ours;
  Pose pose(static_cast<std::size_t>(skeleton.jointCount()));
  double swing = 0.0;  // of the hair in the first second [rad]
  const int walked = static_cast<int>((walk.times.back() - walk.times.front()) / kSpringStepSeconds);
  for (int step = 0; step <= walked + kHeld; ++step) {
    poseAt(walk, walk.times.front() + std::min(step, walked) * kSpringStepSeconds, pose);
    frames.push_back(frameOf(skeleton, pose, step == 0 ? 0.0 : kSpringStepSeconds));
    springs.advance(pose, step == 0 ? 0.0 : kSpringStepSeconds);
    computeWorldFromJoint(skeleton, pose, ours.emplace_back(pose.size()));
    for (const SpringJoint& spring : springs.joints()) {
      if (step > kSecond) continue;
      swing = std::max(swing, pose[spring.joint].rotation.angularDistance(skeleton.joint(spring.joint).rest.rotation));
    }
  }

  const auto made = test::shootWithPeer(path, shots);
  ASSERT_EQ(made.size(), 1U);
  const json& theirs = made.at("walk").facts.at("frames");
  const json& names = made.at("walk").facts.at("nodeNames");
  ASSERT_EQ(theirs.size(), ours.size());
  double inFirstSecond = 0.0;
  double inWholeWalk = 0.0;
  double settled = 0.0;
  double body = 0.0;
  int compared = 0;
  for (std::size_t node = 0; node < names.size(); ++node) {
    const JointIndex joint = jointNamed(skeleton, names[node].get<std::string>());
    if (joint == kNoJoint) continue;
    const bool swings = std::any_of(springs.joints().begin(), springs.joints().end(),
                                    [&](const SpringJoint& spring) { return spring.joint == joint; });
    compared += swings ? 1 : 0;
    for (std::size_t f = 0; f < ours.size(); ++f) {
      const double apart = (ours[f][joint].translation() - test::vectorOf(theirs[f].at(node))).norm();
      if (!swings) body = std::max(body, apart);
      if (swings && f <= kSecond) inFirstSecond = std::max(inFirstSecond, apart);
      if (swings) inWholeWalk = std::max(inWholeWalk, apart);
      if (swings && f + 1 == ours.size()) settled = std::max(settled, apart);
    }
  }
  EXPECT_EQ(compared, 16);
  EXPECT_GT(swing, 0.05) << "the hair hardly swings";
  EXPECT_LT(body, 1e-4) << "the bodies differ";
  EXPECT_LT(inFirstSecond, 5e-3);
  EXPECT_LT(inWholeWalk, 5e-3);
  EXPECT_LT(settled, 5e-3);
  std::printf(
      "hair swings by up to %.2f rad; joints within %.2g mm over the first second, %.2g mm over the whole walk, "
      "%.2g mm settled; the body within %.2g mm\n",
      swing, 1e3 * inFirstSecond, 1e3 * inWholeWalk, 1e3 * settled, 1e3 * body);
}

}  // namespace
}  // namespace lorica

// Whatever a sensor says of somebody's legs, the avatar stands on the floor.
#include "capture/synthetic/synthetic_motion.h"
#include "session/pose_source.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/capture/spoiled_legs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

using J = BodyJoint;

const Character& mannequin() {
  static const Character character = makeMannequin();
  return character;
}

/// Largest height of the avatar's lowest point above or below the floor from `seconds` on [m].
double floats(const std::vector<SkeletonFrame>& frames, double seconds, const JointSettings& settings = {}) {
  const Result<SkeletalMotion> motion = perform(mannequin(), frames, settings);
  EXPECT_TRUE(motion) << motion.error().message;
  double worst = 0.0;
  std::vector<Affine3> world(static_cast<std::size_t>(mannequin().skeleton.jointCount()));
  std::vector<Vec3> posed(mannequin().mesh.vertices.size());
  for (int f = 0; f < motion->frameCount(); f += 5) {
    if (motion->times[f] - motion->times.front() < seconds) continue;
    computeWorldFromJoint(mannequin().skeleton, motion->pose(f), world);
    computeWorldFromModel(mannequin(), world, world);
    skinLinearBlend(mannequin(), world, posed);
    double lowest = posed.front().y();
    for (const Vec3& p : posed) lowest = std::min(lowest, p.y());
    worst = std::max(worst, std::abs(lowest));
  }
  return worst;
}

TEST(Standing, LegsThatRunUpwards) {
  std::vector<SkeletonFrame> frames = synthesizeMotion(SyntheticMotion::kWave);
  for (SkeletonFrame& frame : frames) {
    test::turnUpwards(frame);
    for (TrackedJoint& joint : frame.joints) joint.position.y() += 0.5;
  }
  EXPECT_LT(floats(frames, 2.5), 0.03);
}

TEST(Standing, LegsThatChangeTheirLength) {
  std::vector<SkeletonFrame> frames = synthesizeMotion(SyntheticMotion::kWave);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    test::scaleThighs(frames[f], 1.0 + 0.7 * std::sin(1.3 * static_cast<double>(f)));
    for (const auto& leg : test::kLegs) frames[f][leg.foot].confidence = frames[f][leg.knee].confidence = 0.5;
  }
  EXPECT_LT(floats(frames, 3.0), 0.03);
}

TEST(Standing, SomebodyOnAChair) {
  std::vector<SkeletonFrame> frames = synthesizeMotion(SyntheticMotion::kWave);
  for (SkeletonFrame& frame : frames) {
    for (const J joint : {J::kLeftKnee, J::kRightKnee, J::kLeftFoot, J::kRightFoot}) frame[joint] = {};
    for (TrackedJoint& joint : frame.joints) joint.position.y() -= 0.4;
  }
  EXPECT_LT(floats(frames, 2.5), 0.03);
  JointSettings upper;
  upper.upperBody = true;
  EXPECT_LT(floats(frames, 0.0, upper), 0.03);
}

TEST(Standing, AWebcamThatSeesNoHips) {
  std::vector<SkeletonFrame> frames = synthesizeMotion(SyntheticMotion::kWave);
  for (SkeletonFrame& frame : frames) {
    for (const J joint : {J::kLeftHip, J::kRightHip, J::kLeftKnee, J::kRightKnee, J::kLeftFoot, J::kRightFoot}) {
      frame[joint] = {};
    }
  }
  JointSettings upper;
  upper.upperBody = true;
  EXPECT_LT(floats(frames, 0.0, upper), 0.03);
}

}  // namespace
}  // namespace lorica

// Heads whose end is known are transferred by where they look, not by how they were bound.
#include "capture/retarget/skeletal_retarget.h"
#include "tests/capture/figures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <vector>

namespace lorica {
namespace {

/// @param bow  of the head at rest, about +X [rad] @param end  in the frame of the head [m]
Skeleton figureWithHead(double bow, const Vec3& end) {
  const Skeleton plain = test::makeFigure({}).skeleton;
  std::vector<Joint> joints(plain.joints().begin(), plain.joints().end());
  const JointIndex head = plain.jointOf(HumanBone::kHead);
  joints[head].rest.rotation = Quat(Eigen::AngleAxisd(bow, Vec3::UnitX()));
  Joint top;
  top.name = "HeadTop_End";
  top.parent = head;
  top.rest.translation = end;
  joints.push_back(top);
  return Skeleton::create(std::move(joints)).value();
}

/// By how much a plain figure's head looks up or down when another one's head is held at an angle [degrees].
double pitchOnPlain(const Skeleton& skeleton, double angle) {
  Pose pose = restPose(skeleton);
  pose[skeleton.jointOf(HumanBone::kHead)].rotation = Quat(Eigen::AngleAxisd(angle, Vec3::UnitX()));
  const SkeletalMotion motion{"nod", skeleton, {0.0}, pose};
  const Skeleton plain = test::makeFigure({}).skeleton;
  const SkeletalMotion performed = retargetMotion(motion, plain).value();
  const Affine3 head = test::worldOf(plain, Pose(performed.poses))[plain.jointOf(HumanBone::kHead)];
  const Vec3 ahead = head.linear() * Vec3::UnitZ();
  return std::atan2(-ahead.y(), ahead.z()) * 180.0 / std::numbers::pi;
}

TEST(BowedHead, ALevelLookStaysLevel) {
  constexpr double kBow = 0.35;
  const Vec3 above(0.0, 0.2, 0.0);
  for (const double bow : {0.0, kBow, -kBow}) {
    const Skeleton skeleton = figureWithHead(bow, above);
    EXPECT_NEAR(pitchOnPlain(skeleton, 0.0), 0.0, 0.5) << bow;
    EXPECT_NEAR(pitchOnPlain(skeleton, 0.3), 17.2, 0.5) << bow;
  }
}

TEST(BowedHead, AnEndThatIsNotStraightAboveSaysNothing) {
  // As Mixamo's: the head is bound level, and its top is 20 degrees ahead.
  EXPECT_NEAR(pitchOnPlain(figureWithHead(0.0, Vec3(0.0, 0.185, 0.066)), 0.0), 0.0, 0.1);
}

}  // namespace
}  // namespace lorica

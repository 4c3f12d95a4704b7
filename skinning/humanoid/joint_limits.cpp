#include "skinning/humanoid/joint_limits.h"

#include "geometry/counts.h"
#include "skinning/mannequin/mannequin_skeleton.h"

#include <array>
#include <cmath>
#include <numbers>

namespace lorica {
namespace {

using enum HumanBone;
using Table = std::array<JointRange, kHumanBoneCount>;

/// The sources list degrees.
AngleRange degrees(double min, double max) {
  constexpr double kRadians = std::numbers::pi / 180.0;
  return {min * kRadians, max * kRadians};
}

/// Builds the axes from the bone's length and the first axis.
JointRange rangeAbout(const Vec3& length, AngleRange twist, const Vec3& firstAxis, AngleRange first,
                      AngleRange second = {}) {
  JointRange range;
  range.twistAxis = length;
  range.firstAxis = firstAxis;
  range.secondAxis = length.cross(firstAxis);
  range.twist = twist;
  range.first = first;
  range.second = second;
  return range;
}

JointRange mirroredRange(JointRange range) {
  // Mirroring reverses a rotation: its axis keeps the component along the mirror's normal and negates the others.
  for (Vec3* axis : {&range.twistAxis, &range.firstAxis, &range.secondAxis}) {
    *axis = Vec3(axis->x(), -axis->y(), -axis->z());
  }
  return range;
}

Table makeTable() {
  Table table;
  const auto at = [&table](HumanBone bone) -> JointRange& { return table[ordinalOf(bone)]; };
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();

  // Trunk: turn left, right; bend forward (about +X), back; bend to a side. Flexion 80, extension 25, to the side 35,
  // rotation 45 in total; for the neck 45, 45, 45, 60.
  at(kHips) = rangeAbout(y, degrees(-180, 180), x, {});
  for (const HumanBone bone : {kSpine, kChest, kUpperChest}) {
    at(bone) = rangeAbout(y, degrees(-15, 15), x, degrees(-25.0 / 3, 80.0 / 3), degrees(-35.0 / 3, 35.0 / 3));
  }
  for (const HumanBone bone : {kNeck, kHead}) {
    at(bone) = rangeAbout(y, degrees(-30, 30), x, degrees(-22.5, 22.5), degrees(-22.5, 22.5));
  }

  // Left leg, along -Y: flexion moves the thigh forward (about -X) and the shin back (+X); abduction is about +Z,
  // medial rotation about -Y. The foot rotates in and out about its length, +Z.
  at(kLeftUpperLeg) = rangeAbout(y, degrees(-45, 45), x, degrees(-120, 30), degrees(-45, 30));
  at(kLeftLowerLeg) = rangeAbout(y, {}, x, degrees(0, 135));
  at(kLeftFoot) = rangeAbout(z, degrees(-35, 15), x, degrees(-20, 50));
  at(kLeftToes) = rangeAbout(z, {}, x, degrees(-70, 45));

  // Left arm, along +X: up is about +Z, forward about -Y. Abduction 180 from hanging, so 90 up from the T-pose, of
  // which the collarbone contributes 30; horizontal flexion 135 and extension 45, of which it contributes 25 and 15.
  // With the palm down, medial rotation is about +X.
  at(kLeftShoulder) = rangeAbout(x, {}, z, degrees(-10, 30), degrees(-15, 25));
  at(kLeftUpperArm) = rangeAbout(x, degrees(-90, 70), z, degrees(-90, 60), degrees(-30, 110));

  // Pronation 80 and supination 80: with the palm down the forearm is fully pronated. Half of that rotation is applied
  // to the forearm, half to the hand, as along a real forearm. The hand bends down about -Z and towards the thumb about
  // -Y.
  at(kLeftLowerArm) = rangeAbout(x, degrees(-80, 0), -y, degrees(0, 150));
  at(kLeftHand) = rangeAbout(x, degrees(-80, 0), z, degrees(-80, 70), degrees(-30, 20));
  at(kLeftHand).twistAtParent = true;

  // Fingers bend down, about -Z, and spread away from the middle finger, the index finger towards the thumb.
  const AngleRange knuckle = degrees(-45, 90), middle = degrees(0, 100), last = degrees(0, 90);
  at(kLeftIndexProximal) = rangeAbout(x, {}, -z, knuckle, degrees(-20, 0));
  at(kLeftMiddleProximal) = rangeAbout(x, {}, -z, knuckle, degrees(-20, 20));
  at(kLeftRingProximal) = rangeAbout(x, {}, -z, knuckle, degrees(0, 20));
  at(kLeftLittleProximal) = rangeAbout(x, {}, -z, knuckle, degrees(0, 20));
  for (const HumanBone bone :
       {kLeftIndexIntermediate, kLeftMiddleIntermediate, kLeftRingIntermediate, kLeftLittleIntermediate}) {
    at(bone) = rangeAbout(x, {}, -z, middle);
  }
  for (const HumanBone bone : {kLeftIndexDistal, kLeftMiddleDistal, kLeftRingDistal, kLeftLittleDistal}) {
    at(bone) = rangeAbout(x, {}, -z, last);
  }

  // The thumb is in the palm's plane, pointing half forward. It moves out of that plane downward (abduction, to +70)
  // and within it: towards the fingers (flexion, 15) and away (extension, 20). Its nail faces half up, half forward, so
  // its other joints bend about an axis between the two.
  const Vec3 thumb = (x + z).normalized();
  const Vec3 down = (x - z).normalized();
  at(kLeftThumbMetacarpal) = rangeAbout(thumb, {}, down, degrees(0, 70), degrees(-20, 15));
  at(kLeftThumbProximal) = rangeAbout(thumb, {}, (down + y).normalized(), degrees(0, 50));
  at(kLeftThumbDistal) = rangeAbout(thumb, {}, (down + y).normalized(), degrees(-20, 80));

  for (int i = 0; i < kHumanBoneCount; ++i) {
    const auto bone = static_cast<HumanBone>(i);
    const bool isLeft = nameOf(bone).starts_with("left");
    if (isLeft) at(mirrored(bone)) = mirroredRange(at(bone));
  }
  return table;
}

/// The rotation by |v| about v: the exponential of v / 2, as the eighth power of a rotation so small that a few terms
/// of its series reach full precision. Sines would differ in the last bit between math libraries. |v| up to pi.
Quat turnBy(const Vec3& v) {
  const Vec3 h = v / 16.0;
  const double n = h.squaredNorm();
  const double cosine = 1.0 - n / 2.0 * (1.0 - n / 12.0 * (1.0 - n / 30.0 * (1.0 - n / 56.0 * (1.0 - n / 90.0))));
  const double sineOverLength =
      1.0 - n / 6.0 * (1.0 - n / 20.0 * (1.0 - n / 42.0 * (1.0 - n / 72.0 * (1.0 - n / 110.0))));
  Quat q(cosine, sineOverLength * h.x(), sineOverLength * h.y(), sineOverLength * h.z());
  for (int squared = 0; squared < 3; ++squared) q = q * q;
  return q.normalized();
}

/// An angle as a fraction of its side of a range: 1 at the end. Slack widens both sides and avoids 0 / 0.
double shareOf(const AngleRange& range, double angle, double slack) {
  const double end = angle < 0.0 ? -range.min : range.max;
  return std::abs(angle) / (end + slack);
}

bool isWithin(const JointRange& range, const JointAngles& angles, double tolerance) {
  const double first = shareOf(range.first, angles.first, tolerance);
  const double second = shareOf(range.second, angles.second, tolerance);
  return shareOf(range.twist, angles.twist, tolerance) <= 1.0 && first * first + second * second <= 1.0;
}

/// Uniform over twist and over the ellipse of swings.
JointAngles randomAngles(const JointRange& range, RandomNumbers& random) {
  // Avoids divisions by zero for ranges of 0; too small to admit angles outside the range.
  constexpr double kSlack = 1e-12;
  JointAngles angles;
  angles.twist = random.between(range.twist.min, range.twist.max);
  for (;;) {
    angles.first = random.between(range.first.min, range.first.max);
    angles.second = random.between(range.second.min, range.second.max);
    const double first = shareOf(range.first, angles.first, kSlack);
    const double second = shareOf(range.second, angles.second, kSlack);
    if (first * first + second * second <= 1.0) return angles;
  }
}

}  // namespace

const JointRange& jointRange(HumanBone bone) {
  static const Table table = makeTable();
  return table[ordinalOf(bone)];
}

Quat rotationOf(const JointRange& range, const JointAngles& angles) {
  const Quat twist = turnBy(angles.twist * range.twistAxis);
  const Quat swing = turnBy(angles.first * range.firstAxis + angles.second * range.secondAxis);
  return range.twistAtParent ? twist * swing : swing * twist;
}

JointAngles anglesOf(const JointRange& range, const Quat& rotation) {
  // The swing has no component along the twist axis, so the rotation's component along it belongs to the twist.
  const double along = rotation.vec().dot(range.twistAxis);
  JointAngles angles;
  angles.twist = 2.0 * std::atan2(along, rotation.w());
  if (angles.twist > std::numbers::pi) angles.twist -= 2.0 * std::numbers::pi;
  if (angles.twist < -std::numbers::pi) angles.twist += 2.0 * std::numbers::pi;
  const Quat untwist(Eigen::AngleAxisd(-angles.twist, range.twistAxis));
  const Eigen::AngleAxisd swing(range.twistAtParent ? untwist * rotation : rotation * untwist);
  angles.first = swing.angle() * swing.axis().dot(range.firstAxis);
  angles.second = swing.angle() * swing.axis().dot(range.secondAxis);
  return angles;
}

Pose randomPoseWithinLimits(const Skeleton& skeleton, RandomNumbers& random) {
  Pose pose = restPose(skeleton);
  for (std::size_t i = 0; i < pose.size(); ++i) {
    const std::optional<HumanBone> bone = skeleton.joints()[i].bone;
    if (!bone) continue;
    const JointRange& range = jointRange(*bone);
    pose[i].rotation = rotationOf(range, randomAngles(range, random)) * pose[i].rotation;
  }
  return pose;
}

bool withinLimits(const Skeleton& skeleton, std::span<const JointTransform> pose, double tolerance) {
  for (std::size_t i = 0; i < pose.size(); ++i) {
    const Joint& joint = skeleton.joints()[i];
    if (!joint.bone) continue;
    const JointRange& range = jointRange(*joint.bone);
    const Quat turn = pose[i].rotation * joint.rest.rotation.conjugate();
    if (!isWithin(range, anglesOf(range, turn), tolerance)) return false;
  }
  return true;
}

}  // namespace lorica

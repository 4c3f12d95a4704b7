#include "capture/retarget/human_rig.h"

#include "geometry/result.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lorica {
namespace {

/// Max reach as a fraction of leg length. There the knee is bent by 5 degrees.
constexpr double kLongestReach = 0.999;
constexpr double kNoDirection = 1e-6;

double reachOfLeg(double thigh, double shin) {
  return kLongestReach * (thigh + shin);
}

constexpr double kShortestRigLimb = 1e-4;

constexpr double kUsualLeg = 0.85;
/// Speed limits of ankle or ball to start and to continue standing [m/s].
constexpr double kSlow = 0.30;
constexpr double kStillSlow = 0.45;
/// Limits for the height of the sole's lowest point above the floor, likewise [m].
constexpr double kLow = 0.06;
constexpr double kStillLow = 0.09;
/// A foot at rest in the air: max speed [m/s], min duration [s].
constexpr double kResting = 0.08;
constexpr double kRestSeconds = 0.25;
/// Shorter contacts are no stance, shorter gaps no step [s].
constexpr double kShortestStance = 0.06;
constexpr double kShortestStep = 0.06;

}  // namespace

double dropToReach(const Vec3& hip, const Vec3& knee, const Vec3& ankle, const Vec3& wanted) {
  const double reach = std::max(reachOfLeg((knee - hip).norm(), (ankle - knee).norm()), (ankle - hip).norm());
  if ((wanted - hip).norm() <= reach) return 0.0;
  const double level = std::hypot(wanted.x() - hip.x(), wanted.z() - hip.z());
  const double height = level < reach ? std::sqrt(reach * reach - level * level) : 0.0;
  return std::max(0.0, hip.y() - wanted.y() - height);
}

void evaluatePose(const Skeleton& skeleton, std::span<const JointTransform> pose, std::span<Quat> worldRotation,
                  std::span<Affine3> worldFromJoint) {
  computeWorldFromJoint(skeleton, pose, worldFromJoint);
  for (std::size_t j = 0; j < pose.size(); ++j) {
    const JointIndex parent = skeleton.joint(static_cast<JointIndex>(j)).parent;
    const Quat above = parent == kNoJoint ? Quat::Identity() : worldRotation[parent];
    worldRotation[j] = (above * pose[j].rotation).normalized();
  }
}

LegTurns reachWithLeg(const Vec3& hip, const Vec3& knee, const Vec3& ankle, const Vec3& hinge, const Vec3& wanted) {
  LegTurns turns;
  turns.ankle = ankle;
  const double thigh = (knee - hip).norm();
  const double shin = (ankle - knee).norm();
  const double before = (ankle - hip).norm();
  const double away = (wanted - hip).norm();
  if (thigh < kNoDirection || shin < kNoDirection || before < kNoDirection || away < kNoDirection) return turns;
  const Vec3 thighBefore = (knee - hip) / thigh;
  const Vec3 shinBefore = (ankle - knee) / shin;
  const Vec3 lineBefore = (ankle - hip) / before;
  const Vec3 line = (wanted - hip) / away;

  // The current bending axis; if the bend is small or backwards, the hinge axis.
  constexpr double kMinBend = 0.15;  // sine
  const Vec3 bend = thighBefore.cross(shinBefore);
  const Vec3 straight = hinge - hinge.dot(lineBefore) * lineBefore;
  const Vec3 axis = bend + std::max(0.0, kMinBend - bend.dot(straight)) * straight;

  const Quat swing = swingBetween(lineBefore, line, hinge);
  Vec3 turned = swing * axis;
  turned -= turned.dot(line) * line;
  if (turned.norm() < kNoDirection) return turns;
  // A leg that is already longer than the usual reach may stay so: nothing moves if the target is the current ankle
  // position.
  const double longest = std::max(reachOfLeg(thigh, shin), std::min(before, (1.0 - 1e-9) * (thigh + shin)));
  const double shortest = std::abs(thigh - shin) + 1e-3 * (thigh + shin);
  const double reach = std::clamp(away, std::min(shortest, longest), longest);
  const double cosine = std::clamp((thigh * thigh + reach * reach - shin * shin) / (2.0 * thigh * reach), -1.0, 1.0);
  const double sine = std::sqrt(1.0 - cosine * cosine);
  const Vec3 toKnee = thigh * (cosine * line + sine * line.cross(turned.normalized()));
  turns.ankle = hip + reach * line;
  const Vec3 thighAfter = toKnee / thigh;
  const Vec3 shinAfter = (turns.ankle - hip - toKnee).normalized();
  turns.thigh = (swingBetween(swing * thighBefore, thighAfter, swing * hinge) * swing).normalized();
  turns.shin = (swingBetween(swing * shinBefore, shinAfter, swing * hinge) * swing).normalized();
  return turns;
}

Result<HumanRig> HumanRig::create(const Skeleton& skeleton) {
  LORICA_TRY(RetargetRig rig, RetargetRig::create(skeleton));
  return HumanRig(std::move(rig));
}

HumanRig::HumanRig(RetargetRig ofSkeleton) : PosedBody(std::move(ofSkeleton)), tposeFromJoint_(rig.tposeFromJoint) {
  using B = HumanBone;
  const Skeleton& skeleton = rig.skeleton;
  for (const B bone : {B::kHips, B::kSpine, B::kChest, B::kUpperChest}) {
    if (skeleton.jointOf(bone) != kNoJoint) spine_.push_back(bone);
  }
  if (const JointIndex neck = skeleton.jointOf(B::kNeck); neck != kNoJoint) {
    const Quat upright = swingBetween(rig.neckAxis, Vec3::UnitY(), Vec3::UnitX());
    tposeFromJoint_[neck] = upright * tposeFromJoint_[neck];
  }
  for (std::size_t side = 0; side < 2; ++side) {
    for (const B bone : {side == 0 ? B::kLeftFoot : B::kRightFoot, side == 0 ? B::kLeftToes : B::kRightToes}) {
      const JointIndex joint = skeleton.jointOf(bone);
      if (joint == kNoJoint) continue;
      tposeFromJoint_[joint] = rig.toesHeading[side].conjugate() * tposeFromJoint_[joint];
    }
  }
}

HumanPose HumanRig::read(std::span<const JointTransform> pose) {
  evaluate(pose);
  HumanPose human;
  const auto turnOf = [&](HumanBone bone) -> std::optional<Quat>& {
    return human.turn[static_cast<std::size_t>(bone)];
  };
  for (std::size_t j = 0; j < pose.size(); ++j) {
    const std::optional<HumanBone> bone = rig.skeleton.joint(static_cast<JointIndex>(j)).bone;
    if (bone) turnOf(*bone) = (worldRotation[j] * tposeFromJoint_[j].conjugate()).normalized();
  }
  // Joints between a limb's two ends, and joints that translate relative to their parent, bend it too: use its ends for
  // the direction.
  for (const LimbBones& limb : limbs()) {
    const auto point = [&](HumanBone bone, HumanBone next) {
      const Vec3 along = positionOf(next) - positionOf(bone);
      const double length = along.norm();
      if (length < kShortestRigLimb) return;
      turnOf(bone) = pointed(*turnOf(bone), limb.axis, along / length, limb.hinge);
    };
    point(limb.upper, limb.lower);
    point(limb.lower, limb.end);
  }
  human.middleHip = middleHip();
  for (int side = 0; side < 2; ++side) human.foot[side] = foot(side);
  return human;
}

std::vector<Quat> HumanRig::spineTurnsOf(const HumanPose& human) const {
  std::vector<Quat> turns;
  turns.reserve(spine_.size());
  for (const HumanBone bone : spine_) turns.push_back(*human[bone]);
  return turns;
}

void HumanRig::pose(const HumanPose& human, std::span<const Quat> spineTurns, std::span<JointTransform> pose) {
  using B = HumanBone;
  const Skeleton& skeleton = rig.skeleton;
  LORICA_CHECK(pose.size() == skeleton.joints().size() && !spineTurns.empty(), "the pose must match the skeleton");
  const auto spineTurn = [&](std::size_t i) {
    const double along = static_cast<double>(i * (spineTurns.size() - 1)) / static_cast<double>(spine_.size() - 1);
    const auto below = std::min(static_cast<std::size_t>(along), spineTurns.size() - 1);
    const std::size_t above = std::min(below + 1, spineTurns.size() - 1);
    return spineTurns[below].slerp(along - static_cast<double>(below), spineTurns[above]);
  };
  for (std::size_t j = 0; j < pose.size(); ++j) {
    const Joint& joint = skeleton.joint(static_cast<JointIndex>(j));
    const Quat above = joint.parent == kNoJoint ? Quat::Identity() : worldRotation[joint.parent];
    pose[j] = joint.rest;
    std::optional<Quat> turn;
    if (joint.bone) {
      const auto onSpine = std::find(spine_.begin(), spine_.end(), *joint.bone);
      if (onSpine != spine_.end()) {
        turn = spineTurn(static_cast<std::size_t>(onSpine - spine_.begin()));
      } else if (human[*joint.bone]) {
        turn = human[*joint.bone];
      } else if (*joint.bone == B::kNeck && human[B::kHead]) {
        turn = spineTurns.back().slerp(0.5, *human[B::kHead]);
      }
    }
    if (turn) pose[j].rotation = (above.conjugate() * *turn * tposeFromJoint_[j]).normalized();
    worldRotation[j] = (above * pose[j].rotation).normalized();
  }
  computeWorldFromJoint(skeleton, pose, worldFromJoint);
}

namespace {

/// Speeds of a foot, for each frame the lower one of the two adjacent steps [m/s of a usual leg].
struct FootSpeeds {
  std::vector<double> slower;  ///< of ankle or ball
  std::vector<double> faster;
};

FootSpeeds speedsOf(std::span<const FootPosition> positions, std::span<const double> times, double scale) {
  const double none = positions.size() == 1 ? 0.0 : std::numeric_limits<double>::infinity();
  FootSpeeds speeds{std::vector<double>(positions.size(), none), std::vector<double>(positions.size(), none)};
  for (std::size_t f = 1; f < positions.size(); ++f) {
    const double step = std::max(times[f] - times[f - 1], 1e-4) * scale;
    const double ankle = (positions[f].ankle - positions[f - 1].ankle).norm() / step;
    const double ball = (positions[f].ball - positions[f - 1].ball).norm() / step;
    for (const std::size_t frame : {f - 1, f}) {
      speeds.slower[frame] = std::min(speeds.slower[frame], std::min(ankle, ball));
      speeds.faster[frame] = std::min(speeds.faster[frame], std::max(ankle, ball));
    }
  }
  return speeds;
}

/// A value that few of these are below.
double seldomBelow(std::vector<double>& values) {
  constexpr double kSeldom = 0.05;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(kSeldom * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

double floorUnder(const std::array<std::vector<FootPosition>, 2>& feet, std::span<const double> times,
                  double legLength) {
  const auto& [left, right] = feet;
  LORICA_CHECK(left.size() == right.size() && !left.empty(), "one position per frame and foot is required");
  std::vector<double> lowest;
  lowest.reserve(left.size());
  for (std::size_t f = 0; f < left.size(); ++f) lowest.push_back(std::min(left[f].lowest, right[f].lowest));
  const double below = seldomBelow(lowest);

  constexpr double kPlanted = 0.1;   // share of the frames in which a foot must be planted
  constexpr double kClearly = 0.05;  // soles of planted feet above what toes reach [m]
  const double scale = legLength / kUsualLeg;
  std::vector<double> planted;
  for (const std::vector<FootPosition>& foot : feet) {
    const FootSpeeds speeds = speedsOf(foot, times, scale);
    for (std::size_t f = 0; f < foot.size(); ++f) {
      if (speeds.faster[f] < kSlow) planted.push_back(foot[f].lowest);
    }
  }
  if (static_cast<double>(planted.size()) < kPlanted * static_cast<double>(lowest.size())) return below;
  const double stands = seldomBelow(planted);
  return stands > below + kClearly * scale ? stands : below;
}

std::vector<FootContact> contactsOf(std::span<const FootPosition> positions, std::span<const double> times,
                                    double floor, double legLength) {
  LORICA_CHECK(positions.size() == times.size(), "one position per frame is required");
  const double scale = legLength / kUsualLeg;
  const auto count = static_cast<int>(positions.size());
  const auto [slower, resting] = speedsOf(positions, times, scale);

  const auto secondsOf = [&](int first, int last) { return times[last] - times[first]; };
  std::vector<bool> stands(positions.size(), false);
  bool standing = false;
  for (int f = 0; f < count; ++f) {
    const double height = (positions[f].lowest - floor) / scale;
    standing = standing ? slower[f] < kStillSlow && height < kStillLow : slower[f] < kSlow && height < kLow;
    stands[f] = standing;
  }
  // Backward pass: frames before a stance that meet the limits for continuing also belong to it.
  standing = false;
  for (int f = count - 1; f >= 0; --f) {
    const double height = (positions[f].lowest - floor) / scale;
    standing = (stands[f] || standing) && slower[f] < kStillSlow && height < kStillLow;
    stands[f] = stands[f] || standing;
  }
  for (int f = 0; f < count; ++f) {
    int last = f;
    while (last + 1 < count && resting[last + 1] < kResting) ++last;
    if (resting[f] < kResting && secondsOf(f, last) >= kRestSeconds) {
      std::fill(stands.begin() + f, stands.begin() + last + 1, true);
    }
    f = last;
  }

  std::vector<FootContact> contacts;
  for (int f = 0; f < count; ++f) {
    if (!stands[f]) continue;
    int last = f;
    while (last + 1 < count && stands[last + 1]) ++last;
    if (!contacts.empty() && secondsOf(contacts.back().last, f) < kShortestStep &&
        (positions[f].ankle - positions[contacts.back().last].ankle).norm() < 0.02 * scale) {
      contacts.back().last = last;
    } else {
      contacts.push_back({f, last});
    }
    f = last;
  }
  std::erase_if(contacts,
                [&](const FootContact& c) { return secondsOf(c.first, c.last) < kShortestStance && count > 1; });
  return contacts;
}

}  // namespace lorica

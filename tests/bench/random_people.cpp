#include "tests/bench/random_people.h"

#include "capture/files/joint_csv.h"
#include "capture/retarget/retarget.h"
#include "capture/virtual_sensor/virtual_performer.h"
#include "geometry/counts.h"
#include "skinning/humanoid/joint_limits.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/bench/generators/motion_rig.h"
#include "tests/bench/generators/virtual_clothes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace lorica::bench {
namespace {

constexpr double kPoseSeconds = 1.0 / 30.0;  ///< between two poses of the library

enum class ArmStyle : std::uint8_t { kHanging, kBeforeTrunk, kInFront, kCrossed, kUp, kAngles, kOnHips, kTogether };
/// Probability of each style, added up.
constexpr std::array<double, 8> kArmShare = {0.24, 0.46, 0.60, 0.66, 0.73, 0.80, 0.84, 1.0};

struct Dice {
  RandomNumbers& random;
  double between(double min, double max) { return random.between(min, max); }
  double around(double spread) { return normal(random, spread); }
  bool happens(double probability) { return random.unit() < probability; }
  int below(int count) { return static_cast<int>(random.unit() * count); }
  /// Each coordinate between two values.
  Vec3 within(const Vec3& min, const Vec3& max) {
    Vec3 point;
    for (int i = 0; i < 3; ++i) point[i] = between(min[i], max[i]);
    return point;
  }
};

ArmStyle armStyle(Dice& dice) {
  const double share = dice.random.unit();
  return static_cast<ArmStyle>(std::ranges::lower_bound(kArmShare, share) - kArmShare.begin());
}

/// @param together  where both hands are, chest frame, x to the left of the left shoulder's mirror plane [m]
motion::ArmPose armPose(ArmStyle style, bool left, const Vec3& together, Dice& dice) {
  const auto reach = [&](const Vec3& min, const Vec3& max, const Vec3& poleMin, const Vec3& poleMax) {
    const Vec3 hand = dice.within(min, max);
    return motion::reach(hand, dice.within(poleMin, poleMax));
  };
  switch (style) {
    case ArmStyle::kHanging: {
      const double forward = dice.around(0.2), out = std::abs(dice.around(0.15));
      return motion::swungArm(forward, out, std::abs(dice.around(0.35)));
    }
    case ArmStyle::kBeforeTrunk:
      return reach({-0.45, -0.45, 0.08}, {0.15, 0.15, 0.5}, {0.1, -1.0, -0.6}, {1.0, -0.2, 0.4});
    case ArmStyle::kInFront:
      return reach({-0.3, -0.55, -0.1}, {0.6, 0.6, 0.55}, {0.01, -1.0, -1.0}, {1.0, 0.2, 0.2});
    case ArmStyle::kCrossed:
      return reach({-0.32, -0.32, 0.14}, {-0.2, -0.15, 0.3}, {0.5, -1.0, 0.3}, {0.5, -1.0, 0.3});
    case ArmStyle::kUp:
      return reach({-0.1, 0.2, -0.1}, {0.3, 0.6, 0.4}, {1.0, -0.6, -0.3}, {1.0, 0.3, 0.3});
    case ArmStyle::kAngles: {
      const double forward = dice.between(-0.6, 2.8), out = dice.between(0.0, 1.7);
      return motion::swungArm(forward, out, dice.between(0.0, 2.4));
    }
    case ArmStyle::kOnHips:
      return reach({-0.08, -0.5, 0.0}, {0.1, -0.35, 0.15}, {1.0, 0.0, -0.8}, {1.0, 0.0, -0.1});
    case ArmStyle::kTogether:
      break;
  }
  const Vec3 hand((left ? 1.0 : -1.0) * together.x() - motion::kShoulderHalfWidth, together.y(), together.z());
  return motion::reach(hand, dice.within({0.4, -1.0, -0.3}, {1.0, -0.1, 0.3}));
}

void bendArms(motion::FigurePose& figure, Dice& dice) {
  const Vec3 together = dice.within({-0.2, -0.45, 0.15}, {0.2, 0.5, 0.5});
  const auto isForBoth = [](ArmStyle style) { return style == ArmStyle::kCrossed || style == ArmStyle::kTogether; };
  const ArmStyle first = armStyle(dice), other = armStyle(dice);
  const bool alone = !isForBoth(first) && isForBoth(other);
  const ArmStyle second = isForBoth(first) ? first : alone ? ArmStyle::kBeforeTrunk : other;
  for (const int side : {motion::kLeft, motion::kRight}) {
    motion::ArmPose& arm = figure.arms[side];
    arm = armPose(side == motion::kLeft ? first : second, side == motion::kLeft, together, dice);
    arm.twist += dice.around(0.5);
    arm.bend += dice.around(0.2);
  }
}

/// Standing, squatting, bending, striding, on one leg or sitting.
motion::FigurePose randomFigure(Dice& dice, bool& sits) {
  motion::FigurePose figure;
  const double kind = dice.random.unit(), yaw = dice.around(0.05), width = dice.between(0.05, 0.22);
  double pitch = dice.around(0.06), roll = dice.around(0.05), turn = yaw;
  figure.pelvis = Vec3(0.0, dice.between(0.89, 0.925), 0.0);
  for (const int side : {motion::kLeft, motion::kRight}) {
    const double out = side == motion::kLeft ? 1.0 : -1.0;
    motion::FootPose& foot = figure.feet[side];
    foot.ankle = Vec3{out * width + dice.around(0.02), motion::kAnkle, dice.around(0.05)};
    foot.rotation = motion::turned(out * dice.between(0.0, 0.4), 0.0, 0.0);
    figure.kneeOut[side] = dice.between(-0.1, 0.3);
  }
  const auto lift = [&](const Vec3& min, const Vec3& max) {
    const int side = dice.below(2);
    motion::FootPose& foot = figure.feet[side];
    foot.planted = false;
    foot.ankle = dice.within(min, max);
    if (side == motion::kRight) foot.ankle.x() = -foot.ankle.x();
    foot.follow = 1.0;
  };
  if (kind < 0.44) {  // stands
  } else if (kind < 0.53) {
    const double deep = dice.between(0.1, 0.55);
    figure.pelvis = Vec3(0.0, 0.92 - deep, -0.3 * deep + dice.around(0.04));
    pitch = dice.between(0.0, 0.9) * std::min(1.0, deep / 0.3);
    for (double& knee : figure.kneeOut) knee = dice.between(0.0, 0.6);
  } else if (kind < 0.61) {
    turn += dice.around(0.2);
    pitch = dice.between(0.3, 1.6);
    roll = dice.around(0.1);
    figure.pelvis = Vec3(0.0, dice.between(0.75, 0.91), -0.12);
  } else if (kind < 0.69) {
    const double step = dice.between(0.15, 0.45), deep = dice.between(0.0, 0.35);
    const int front = dice.below(2);
    figure.feet[front].ankle.z() = step;
    figure.feet[1 - front].ankle.z() = -step;
    figure.feet[1 - front].rotation = motion::turned(0.0, dice.between(0.0, 0.8), 0.0);
    const double reach = 0.82 * 0.82 - step * step;
    figure.pelvis = Vec3(0.0, std::sqrt(std::max(0.1, reach)) + motion::kAnkle - 0.6 * deep, dice.around(0.08));
    pitch = dice.between(-0.1, 0.5);
  } else if (kind < 0.75) {
    lift({0.02, 0.15, -0.3}, {0.4, 0.75, 0.6});
    pitch = dice.between(-0.3, 0.4);
    roll = dice.around(0.15);
  } else {
    sits = true;
    const double seat = dice.between(0.38, 0.55), reach = dice.between(0.25, 0.5);
    figure.pelvis = Vec3{0.0, seat + 0.08, -dice.between(0.33, 0.45)};
    pitch = dice.between(-0.45, 0.5);
    for (const int side : {motion::kLeft, motion::kRight}) {
      figure.feet[side].ankle.z() += reach - 0.35 + dice.around(0.08);
      figure.feet[side].ankle.x() *= dice.between(0.8, 1.8);
      figure.kneeOut[side] = dice.between(-0.05, 0.5);
    }
    if (dice.happens(0.2)) lift({-0.25, 0.3, 0.1}, {0.1, 0.5, 0.35});
  }
  figure.worldFromPelvis = motion::turned(turn, pitch, roll);
  const double twist = dice.around(0.3), bend = std::abs(dice.around(0.2));
  figure.pelvisFromChest = motion::turned(twist, bend, dice.around(0.1));
  const double look = dice.around(0.4), nod = dice.around(0.25);
  figure.worldFromHead = figure.worldFromPelvis * motion::turned(look, nod, dice.around(0.1));
  figure.shrug = std::max(0.0, dice.around(0.05));
  bendArms(figure, dice);
  return figure;
}

/// Turns all joints a little; those of some limbs anywhere within their limits.
void disturb(const Skeleton& skeleton, Pose& pose, Dice& dice) {
  RandomNumbers other(dice.random.bits());
  const Pose wild = randomPoseWithinLimits(skeleton, other);
  const bool wildArms = dice.happens(0.12), wildLegs = dice.happens(0.03), wildSpine = dice.happens(0.04);
  const double spread = dice.between(0.0, 0.16);
  for (int j = 1; j < skeleton.jointCount(); ++j) {
    const std::optional<HumanBone> bone = skeleton.joint(j).bone;
    if (!bone || *bone == HumanBone::kHips) continue;
    const bool fingers = *bone >= HumanBone::kLeftThumbMetacarpal, arm = *bone >= HumanBone::kLeftShoulder;
    const bool leg = *bone >= HumanBone::kLeftUpperLeg && *bone <= HumanBone::kRightToes;
    Quat& rotation = pose[j].rotation;
    if (fingers) {
      if (dice.happens(0.5)) rotation = rotation.slerp(dice.between(0.0, 1.0), wild[j].rotation);
    } else if (arm ? wildArms : leg ? wildLegs : wildSpine) {
      rotation = rotation.slerp(dice.between(0.4, 1.0), wild[j].rotation);
    } else {
      const double by = leg ? 0.5 * spread : spread;
      const Vec3 turn{dice.around(by), dice.around(by), dice.around(by)};
      const double angle = turn.norm();
      if (angle > 1e-9) rotation = rotation * Quat(Eigen::AngleAxisd(angle, turn / angle));
    }
  }
}

SkeletalMotion poseLibrary(const Skeleton& skeleton, int count, Dice& dice, std::vector<bool>& sits) {
  std::vector<std::vector<SkeletonFrame>> shipped;
  shipped.reserve(kShippedMotions.size());
  for (const std::string_view name : kShippedMotions) shipped.push_back(shippedFrames(name));
  RetargetSettings settings;
  settings.plantFeet = false;
  SkeletalMotion library{"random", skeleton, {}, {}};
  Pose pose = restPose(skeleton);
  for (int i = 0; i < count; ++i) {
    bool isSitting = false;
    const double time = kPoseSeconds * i;
    SkeletonFrame frame;
    if (dice.happens(0.83)) {
      frame = motion::solve(randomFigure(dice, isSitting), time);
    } else {
      const std::vector<SkeletonFrame>& one = shipped[dice.below(countOf(kShippedMotions))];
      frame = one[dice.below(countOf(one))];
    }
    Retargeter::create(skeleton, settings)->apply(frame, pose);
    disturb(skeleton, pose, dice);
    library.times.push_back(time);
    library.poses.insert(library.poses.end(), pose.begin(), pose.end());
    sits.push_back(isSitting);
  }
  return library;
}

std::vector<Clothes> randomClothes(Dice& dice) {
  const std::array<std::vector<Clothes>, 6> some = {{{Clothes::kTrousers},
                                                     {Clothes::kSkirt},
                                                     {Clothes::kCoat},
                                                     {Clothes::kHair},
                                                     {Clothes::kTrousers, Clothes::kHair},
                                                     {Clothes::kCoat, Clothes::kTrousers}}};
  const auto one = static_cast<std::size_t>(dice.below(12));
  return one < some.size() ? some[one] : std::vector<Clothes>();
}

}  // namespace

double normal(RandomNumbers& random, double spread) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random.unit()));
  return spread * radius * std::cos(2.0 * std::numbers::pi * random.unit());
}

RandomPeople::RandomPeople(int bodies, int poses, RandomNumbers& random) {
  Dice dice{random};
  const Character mannequin = makeMannequin();
  const SkeletalMotion library = poseLibrary(mannequin.skeleton, poses, dice, sits_);
  for (int i = 0; i < bodies; ++i) {
    const bool child = i % 6 == 5;
    BodyProportions proportions;
    proportions.height = child ? dice.between(0.55, 0.86) : dice.between(0.86, 1.12);
    proportions.girth = dice.between(0.82, 1.4);
    proportions.arms = dice.between(0.93, 1.07);
    proportions.legs = child ? dice.between(0.85, 1.0) : dice.between(0.93, 1.07);
    proportions.trunk = dice.between(0.94, 1.06);
    Character body = withClothes(withProportions(mannequin, proportions), randomClothes(dice));
    Result<VirtualPerformer> performer = VirtualPerformer::create(std::move(body), library);
    LORICA_CHECK(performer, "the mannequin has all human bones");
    bodies_.push_back(std::move(*performer));
  }
}

RandomPeople::Person RandomPeople::draw(RandomNumbers& random) {
  Dice dice{random};
  VirtualPerformer& body = bodies_[dice.below(countOf(bodies_))];
  const int pose = dice.below(countOf(sits_));
  body.pose(kPoseSeconds * pose, Isometry3::Identity());
  const SkeletonFrame& joints = body.joints();
  const Vec3 hips = 0.5 * (joints[BodyJoint::kLeftHip].position + joints[BodyJoint::kRightHip].position);
  double low = 1e9;
  for (const Vec3& position : body.positions()) low = std::min(low, position.y());
  Person person;
  for (const Vec3& position : body.positions()) {
    person.positions.emplace_back(position.x() - hips.x(), position.y() - low, position.z() - hips.z());
  }
  person.triangles = body.triangles();
  person.sides = body.sides();
  person.hips = hips.y() - low;
  person.sits = sits_[pose];
  return person;
}

}  // namespace lorica::bench

#include "tests/bench/generators/motion_rig.h"

#include "geometry/result.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lorica::motion {

double quintic(const CurvePoint& from, const CurvePoint& to, double duration, double u) {
  // Hermite form; the rates and accelerations are first scaled to the unit interval.
  const double u2 = u * u;
  const double u3 = u2 * u;
  const double u4 = u3 * u;
  const double u5 = u4 * u;
  const double blend = 10.0 * u3 - 15.0 * u4 + 6.0 * u5;
  const double rateIn = u - 6.0 * u3 + 8.0 * u4 - 3.0 * u5;
  const double rateOut = -4.0 * u3 + 7.0 * u4 - 3.0 * u5;
  const double bendIn = 0.5 * (u2 - 3.0 * u3 + 3.0 * u4 - u5);
  const double bendOut = 0.5 * (u3 - 2.0 * u4 + u5);
  return from.value + (to.value - from.value) * blend + duration * (from.rate * rateIn + to.rate * rateOut) +
         duration * duration * (from.acceleration * bendIn + to.acceleration * bendOut);
}

double minimumJerk(double u) {
  const double v = std::clamp(u, 0.0, 1.0);
  return v * v * v * (10.0 + v * (6.0 * v - 15.0));
}

Track::Track(std::vector<TrackKey> keys) {
  LORICA_CHECK(!keys.empty(), "a track needs at least one key");
  const std::size_t count = keys.size();
  for (std::size_t i = 0; i < count; ++i) {
    LORICA_CHECK(i == 0 || keys[i].time > keys[i - 1].time, "track key times must increase");
    CurvePoint point{keys[i].value, 0.0, 0.0};
    if (i > 0 && i + 1 < count) {
      const double before = keys[i].time - keys[i - 1].time;
      const double after = keys[i + 1].time - keys[i].time;
      const double slopeIn = (keys[i].value - keys[i - 1].value) / before;
      const double slopeOut = (keys[i + 1].value - keys[i].value) / after;
      if (slopeIn * slopeOut > 0.0) {
        // Harmonic mean (Fritsch and Butland 1984): flows through the key without overshoot.
        point.rate = 2.0 * slopeIn * slopeOut / (slopeIn + slopeOut);
      } else if (slopeIn * slopeOut < 0.0) {
        // A sine over both halves would have pi^2 / 2 times slope over duration.
        const double sharpness = std::min(std::abs(slopeIn) / before, std::abs(slopeOut) / after);
        point.acceleration = (slopeIn > 0.0 ? -4.9 : 4.9) * sharpness;
      }
    }
    if (keys[i].rate) {
      point.rate = *keys[i].rate;
      point.acceleration = 0.0;
    }
    keys_.push_back(point);
    times_.push_back(keys[i].time);
  }
}

double Track::operator()(double time) const {
  if (time <= times_.front()) return keys_.front().value;
  if (time >= times_.back()) return keys_.back().value;
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  const std::size_t i = after - times_.begin();
  const double duration = times_[i] - times_[i - 1];
  return quintic(keys_[i - 1], keys_[i], duration, (time - times_[i - 1]) / duration);
}

Wander::Wander(std::uint64_t seed, double amplitude, double slowest, double fastest) {
  RandomNumbers random(seed);
  constexpr int kWaves = 5;
  for (int i = 0; i < kWaves; ++i) {
    const double frequency = slowest + (fastest - slowest) * (i + random.unit()) / kWaves;
    // Slow waves have the largest amplitudes, as in quiet standing.
    const double share = 0.45 * slowest / frequency + 0.1;
    waves_.push_back({amplitude * share, frequency, random.between(0.0, 2.0 * std::numbers::pi)});
  }
}

double Wander::operator()(double time) const {
  double sum = 0.0;
  for (const Wave& w : waves_) sum += w.amplitude * std::sin(2.0 * std::numbers::pi * w.frequency * time + w.phase);
  return sum;
}

namespace {

constexpr std::array kShoulders{BodyJoint::kLeftShoulder, BodyJoint::kRightShoulder};
constexpr std::array kElbows{BodyJoint::kLeftElbow, BodyJoint::kRightElbow};
constexpr std::array kHands{BodyJoint::kLeftHand, BodyJoint::kRightHand};
constexpr std::array kHips{BodyJoint::kLeftHip, BodyJoint::kRightHip};
constexpr std::array kKnees{BodyJoint::kLeftKnee, BodyJoint::kRightKnee};
constexpr std::array kFeet{BodyJoint::kLeftFoot, BodyJoint::kRightFoot};

Quat about(const Vec3& axis, double angle) {
  return Quat(Eigen::AngleAxisd(angle, axis));
}

Quat fromRotationVector(const Vec3& v) {
  const double angle = v.norm();
  return angle < 1e-12 ? Quat::Identity() : about(v / angle, angle);
}

Vec3 toRotationVector(const Quat& q) {
  const Eigen::AngleAxisd turn(q.w() < 0.0 ? Quat(-q.coeffs()) : q);
  return turn.axis() * turn.angle();
}

Quat mirrored(const Quat& q) {
  return Quat(q.w(), q.x(), -q.y(), -q.z());
}

void put(SkeletonFrame& frame, BodyJoint joint, const Vec3& position, const Quat& orientation) {
  TrackedJoint& j = frame[joint];
  j.position = position;
  const Quat unit = orientation.normalized();
  j.orientation = unit.w() < 0.0 ? Quat(-unit.coeffs()) : unit;
  j.confidence = 1.0;
}

void solveArm(const FigurePose& pose, Side side, const Vec3& neck, const Quat& worldFromChest, SkeletonFrame& frame) {
  const ArmPose& arm = pose.arms[side];
  const double mirror = side == kLeft ? 1.0 : -1.0;
  const auto forSide = [&](const Quat& q) { return side == kLeft ? q : mirrored(q); };

  // The shoulder girdle follows the arm: up with a raised arm, forward with a reaching one.
  const Quat chestFromUpper = fromRotationVector(arm.swing);
  const Vec3 direction = chestFromUpper * Vec3::UnitX();
  const double raised = std::max(0.0, (direction.y() + 0.5) / 1.5);
  const double forward = std::max(0.0, direction.z());
  const Quat girdle =
      about(Vec3::UnitZ(), 0.30 * raised * raised + pose.shrug) * about(Vec3::UnitY(), -0.22 * forward * forward);
  const Vec3 shoulder =
      neck + worldFromChest * (forSide(girdle) * Vec3(mirror * kShoulderHalfWidth, -kShoulderDrop, 0.0));

  const Quat worldFromUpper = worldFromChest * forSide(chestFromUpper);
  const Quat worldFromForearm = worldFromUpper * forSide(about(Vec3::UnitY(), -arm.elbow));
  const Vec3 elbow = shoulder + worldFromUpper * Vec3(mirror * kUpperArm, 0.0, 0.0);
  const Vec3 hand = elbow + worldFromForearm * Vec3(mirror * kForearm, 0.0, 0.0);
  put(frame, kShoulders[side], shoulder, worldFromUpper);
  // Half of the twist is visible in the forearm, because radius and ulna cross.
  put(frame, kElbows[side], elbow, worldFromForearm * forSide(about(Vec3::UnitX(), 0.5 * arm.twist)));
  put(frame, kHands[side], hand,
      worldFromForearm * forSide(about(Vec3::UnitX(), arm.twist) * about(Vec3::UnitZ(), -arm.bend)));
}

void solveLeg(const FigurePose& pose, Side side, SkeletonFrame& frame) {
  const FootPose& foot = pose.feet[side];
  const double mirror = side == kLeft ? 1.0 : -1.0;
  const Vec3 hip = pose.pelvis + pose.worldFromPelvis * Vec3(mirror * kHipHalfWidth, 0.0, 0.0);
  Vec3 leg = foot.ankle - hip;
  double distance = leg.norm();
  leg /= distance;
  constexpr double kSoft = 0.93 * kLeg;
  constexpr double kRoom = 0.066 * kLeg;
  if (distance > kSoft) {  // a kick beyond the leg's reach is limited softly
    const double soft = kSoft + kRoom * std::tanh((distance - kSoft) / kRoom);
    distance += std::min(1.0, 4.0 * foot.follow) * (soft - distance);
  }
  distance = std::min(distance, 0.9992 * kLeg);

  // The knee points in the mean direction of pelvis and toes, and follows the leg as it swings up from hanging.
  const Vec3 toes = foot.rotation * Vec3::UnitZ();
  const Quat footYaw = turned(std::atan2(toes.x(), toes.z()), 0.0, 0.0);
  const Quat base = pose.worldFromPelvis.slerp(foot.planted ? 0.5 : 0.5 * (1.0 - foot.follow), footYaw) *
                    about(Vec3::UnitY(), mirror * pose.kneeOut[side]);
  const Quat swing = rotationBetween(-Vec3::UnitY(), base.conjugate() * leg);
  const Vec3 pole = base * (swing * Vec3::UnitZ());

  const double cosHip = (kThigh * kThigh + distance * distance - kShin * kShin) / (2.0 * kThigh * distance);
  const double hipAngle = std::acos(std::clamp(cosHip, -1.0, 1.0));
  const Vec3 thigh = std::cos(hipAngle) * leg + std::sin(hipAngle) * pole;
  const Vec3 kneeForward = std::cos(hipAngle) * pole - std::sin(hipAngle) * leg;
  const Vec3 knee = hip + kThigh * thigh;
  const Vec3 ankle = hip + distance * leg;
  const Vec3 shin = (ankle - knee) / kShin;

  Mat3 worldFromThigh;
  worldFromThigh.col(1) = -thigh;
  worldFromThigh.col(2) = kneeForward;
  worldFromThigh.col(0) = worldFromThigh.col(1).cross(worldFromThigh.col(2));
  Mat3 worldFromShin;
  worldFromShin.col(0) = worldFromThigh.col(0);
  worldFromShin.col(1) = -shin;
  worldFromShin.col(2) = worldFromShin.col(0).cross(worldFromShin.col(1));
  const Quat hanging = Quat(worldFromShin) * about(Vec3::UnitX(), foot.followPitch);
  put(frame, kHips[side], hip, Quat(worldFromThigh));
  put(frame, kKnees[side], knee, Quat(worldFromShin));
  put(frame, kFeet[side], ankle, foot.rotation.slerp(foot.follow, hanging));
}

}  // namespace

Quat turned(double yaw, double pitch, double roll) {
  return about(Vec3::UnitY(), yaw) * about(Vec3::UnitX(), pitch) * about(Vec3::UnitZ(), roll);
}

ArmPose reach(const Vec3& hand, const Vec3& elbowPole) {
  const double distance = std::min(hand.norm(), 0.9995 * (kUpperArm + kForearm));
  const Vec3 line = hand.normalized();
  const Vec3 pole = (elbowPole - elbowPole.dot(line) * line).normalized();
  const double cosShoulder =
      (kUpperArm * kUpperArm + distance * distance - kForearm * kForearm) / (2.0 * kUpperArm * distance);
  const double angle = std::acos(std::clamp(cosShoulder, -1.0, 1.0));
  Mat3 chestFromUpper;
  chestFromUpper.col(0) = std::cos(angle) * line + std::sin(angle) * pole;
  chestFromUpper.col(2) = std::sin(angle) * line - std::cos(angle) * pole;  // the side towards which the elbow folds
  chestFromUpper.col(1) = chestFromUpper.col(2).cross(chestFromUpper.col(0));
  const double cosElbow =
      (kUpperArm * kUpperArm + kForearm * kForearm - distance * distance) / (2.0 * kUpperArm * kForearm);
  ArmPose arm;
  arm.swing = toRotationVector(Quat(chestFromUpper));
  arm.elbow = degrees(180.0) - std::acos(std::clamp(cosElbow, -1.0, 1.0));
  return arm;
}

ArmPose swungArm(double forward, double out, double elbow) {
  ArmPose arm;
  arm.swing = toRotationVector(about(Vec3::UnitX(), -forward) * about(Vec3::UnitZ(), out - degrees(90.0)));
  arm.elbow = elbow;
  return arm;
}

SkeletonFrame solve(const FigurePose& pose, double time) {
  SkeletonFrame frame;
  frame.time = time;
  const Quat worldFromChest = pose.worldFromPelvis * pose.pelvisFromChest;
  // The neck bends half as far as the head.
  const Quat worldFromNeck = worldFromChest.slerp(0.5, pose.worldFromHead);
  const Vec3 torso = pose.pelvis + pose.worldFromPelvis * Vec3(0.0, kHipsToTorso, 0.0);
  const Vec3 neck = torso + worldFromChest * Vec3(0.0, kTorsoToNeck, 0.0);
  put(frame, BodyJoint::kTorso, torso, worldFromChest);
  put(frame, BodyJoint::kNeck, neck, worldFromNeck);
  put(frame, BodyJoint::kHead, neck + worldFromNeck * Vec3(0.0, kNeckToHead, 0.0), pose.worldFromHead);
  for (const Side side : {kLeft, kRight}) {
    solveArm(pose, side, neck, worldFromChest, frame);
    solveLeg(pose, side, frame);
  }
  return frame;
}

Vec3 centreOfMass(const SkeletonFrame& frame) {
  const auto at = [&](BodyJoint j) -> const Vec3& { return frame[j].position; };
  const Vec3 hips = 0.5 * (at(BodyJoint::kLeftHip) + at(BodyJoint::kRightHip));
  Vec3 sum = 0.081 * at(BodyJoint::kHead);
  sum += 0.284 * (0.5 * at(BodyJoint::kTorso) + 0.5 * at(BodyJoint::kNeck));
  sum += 0.213 * (0.5 * hips + 0.5 * at(BodyJoint::kTorso));
  for (const Side side : {kLeft, kRight}) {
    const std::size_t s = side;
    sum += 0.028 * (0.56 * at(kShoulders[s]) + 0.44 * at(kElbows[s]));
    sum += 0.022 * (0.32 * at(kElbows[s]) + 0.68 * at(kHands[s]));
    sum += 0.100 * (0.57 * at(kHips[s]) + 0.43 * at(kKnees[s]));
    sum += 0.0465 * (0.57 * at(kKnees[s]) + 0.43 * at(kFeet[s]));
    sum += 0.0145 * at(kFeet[s]);
  }
  return sum;  // the fractions add up to 1
}

}  // namespace lorica::motion

#include "capture/files/rest_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace lorica {
namespace {

using enum HumanBone;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kZeroStands = 50.0 * kDegree;
constexpr double kFrameStands = 35.0 * kDegree;
constexpr double kFirstFrameBonus = 10.0 * kDegree;
constexpr double kBetterThanZero = 20.0 * kDegree;
constexpr double kShape = 20.0 * kDegree;      // by which feet and hands differ
constexpr double kEndTurned = 10.0 * kDegree;  // a foot or hand that is not at rest, where another frame has it so
constexpr int kSamples = 256;

struct Limb {
  HumanBone collar, upper, lower, end, tip;
};
constexpr int kFirstLeg = 2;
constexpr std::array<Limb, 4> kLimbs = {
    {{kLeftShoulder, kLeftUpperArm, kLeftLowerArm, kLeftHand, kLeftMiddleProximal},
     {kRightShoulder, kRightUpperArm, kRightLowerArm, kRightHand, kRightMiddleProximal},
     {kLeftUpperLeg, kLeftUpperLeg, kLeftLowerLeg, kLeftFoot, kLeftToes},
     {kRightUpperLeg, kRightUpperLeg, kRightLowerLeg, kRightFoot, kRightToes}}};

double angleBetween(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// How far a pose is from that of a body which stands straight [rad].
struct Posture {
  double trunk = 0.0;
  std::array<double, kLimbs.size()> limb{};
  std::array<double, kLimbs.size()> end{};  ///< of the hand or foot alone, beyond what shapes differ
  std::optional<double> armsBelowLevel;     ///< mean of the arms that are known
  std::optional<Vec3> up;                   ///< of the trunk; none if the skeleton does not tell it
  Vec3 left = Vec3::Zero();                 ///< at a right angle to it

  [[nodiscard]] double strain() const { return std::max(trunk, *std::max_element(limb.begin(), limb.end())); }
  [[nodiscard]] double sum() const {
    double squares = trunk * trunk;
    for (const double one : limb) squares += one * one;
    return std::sqrt(squares);
  }
};

class PostureReader {
 public:
  explicit PostureReader(const Skeleton& skeleton) : skeleton_(skeleton), world_(skeleton.jointCount()) {}

  Posture read(std::span<const JointTransform> pose) {
    computeWorldFromJoint(skeleton_, pose, world_);
    Posture posture;
    const std::optional<Vec3> hips = between(kRightUpperLeg, kLeftUpperLeg);
    const std::optional<Vec3> shoulders = between(kRightUpperArm, kLeftUpperArm);
    const std::optional<Vec3> low = hips ? middle(kLeftUpperLeg, kRightUpperLeg) : at(kHips);
    std::optional<Vec3> high = at(kNeck);
    if (!high) high = shoulders ? middle(kLeftUpperArm, kRightUpperArm) : at(kHead);
    if (!low || !high || !(hips || shoulders)) return posture;
    const Vec3 up = (*high - *low).normalized();
    const auto levelled = [&](const Vec3& v) { return Vec3((v - v.dot(up) * up).normalized()); };
    const Vec3 left = levelled(hips ? *hips : *shoulders);
    const Vec3 ahead = left.cross(up);
    if (!(ahead.norm() > 0.5)) return posture;
    posture.up = up;
    posture.left = left;
    if (const std::optional<Vec3> head = between(kNeck, kHead)) posture.trunk = angleBetween(*head, up);
    if (hips && shoulders) posture.trunk = std::max(posture.trunk, angleBetween(left, levelled(*shoulders)));

    double armsBelow = 0.0;
    int arms = 0;
    for (std::size_t i = 0; i < kLimbs.size(); ++i) {
      const Limb& limb = kLimbs[i];
      const std::optional<Vec3> upper = between(limb.upper, limb.lower);
      const std::optional<Vec3> lower = between(limb.lower, limb.end);
      if (!upper) continue;
      double& strain = posture.limb[i];
      if (i >= kFirstLeg) {
        strain = std::max(angleBetween(*upper, -up), lower ? angleBetween(*lower, -up) : 0.0);
        // Feet differ in shape, and those that point down are set flat by whoever reads the rest pose.
        constexpr double kSlope = 23.0 * kDegree;
        const Vec3 usual = std::cos(kSlope) * ahead - std::sin(kSlope) * up;
        const std::optional<Vec3> foot = between(limb.end, limb.tip);
        if (foot) posture.end[i] = std::max(0.0, angleBetween(*foot, usual) - kShape);
        strain = std::max(strain, 0.5 * posture.end[i]);
        continue;
      }
      const std::optional<Vec3> hand = between(limb.end, limb.tip);
      if (hand && lower) posture.end[i] = std::max(0.0, angleBetween(*hand, *lower) - kShape);
      constexpr double kRaised = 15.0 * kDegree, kCrossed = 100.0 * kDegree;
      const double outwards = (i == 0 ? 1.0 : -1.0) * upper->dot(left);
      const double below = std::atan2(-upper->dot(up), outwards);
      strain = std::max({std::asin(std::min(1.0, std::abs(upper->dot(ahead)))), -below - kRaised, below - kCrossed,
                         lower ? angleBetween(*upper, *lower) : 0.0});
      armsBelow += below;
      ++arms;
    }
    if (arms > 0) posture.armsBelowLevel = armsBelow / arms;
    return posture;
  }

  /// Straightens a bent limb of the last pose: about the axis of its elbow or knee, which then is where it is in a
  /// T-pose. So a limb that never hangs straight is not twisted.
  void straighten(std::size_t i, const Posture& posture, Pose& pose) const {
    constexpr double kBent = 20.0 * kDegree;
    const std::optional<Vec3> upper = between(kLimbs[i].upper, kLimbs[i].lower);
    const std::optional<Vec3> lower = between(kLimbs[i].lower, kLimbs[i].end);
    if (!upper || !lower || !posture.up || angleBetween(*upper, *lower) < kBent) return;
    const double side = i % 2 == 0 ? 1.0 : -1.0;
    const Vec3 axis = upper->cross(*lower).normalized();
    const Vec3 along = i < kFirstLeg ? Vec3(side * posture.left) : Vec3(-*posture.up);
    const Vec3 hinge = i < kFirstLeg ? Vec3(-side * *posture.up) : posture.left;
    const auto frame = [](const Vec3& a, const Vec3& b) {
      Mat3 columns;
      columns << a, b, a.cross(b);
      return columns;
    };
    const auto turn = [&](HumanBone bone, const Mat3& by) {
      const JointIndex joint = skeleton_.jointOf(bone);
      const JointIndex parent = skeleton_.joint(joint).parent;
      const Mat3 above = parent == kNoJoint ? Mat3(Mat3::Identity()) : Mat3(world_[parent].linear());
      pose[joint].rotation = Quat(Mat3(above.transpose() * by * world_[joint].linear())).normalized();
    };
    turn(kLimbs[i].upper, frame(along, hinge) * frame(*upper, axis).transpose());
    turn(kLimbs[i].lower, Eigen::AngleAxisd(-angleBetween(*upper, *lower), axis).toRotationMatrix());
  }

 private:
  [[nodiscard]] std::optional<Vec3> at(HumanBone bone) const {
    const JointIndex joint = skeleton_.jointOf(bone);
    return joint == kNoJoint ? std::nullopt : std::optional<Vec3>(world_[joint].translation());
  }
  /// The direction from one bone to another; none if one is unknown or both are at one point.
  [[nodiscard]] std::optional<Vec3> between(HumanBone from, HumanBone to) const {
    if (from == to || !at(from) || !at(to)) return std::nullopt;
    const Vec3 way = *at(to) - *at(from);
    return way.norm() > 0.0 ? std::optional<Vec3>(way.normalized()) : std::nullopt;
  }
  [[nodiscard]] Vec3 middle(HumanBone a, HumanBone b) const { return 0.5 * (*at(a) + *at(b)); }

  const Skeleton& skeleton_;
  std::vector<Affine3> world_;
};

std::string nameOf(const Posture& posture, double limit) {
  constexpr double kTPose = 25.0 * kDegree, kAPose = 65.0 * kDegree;
  if (!posture.up) return {};
  if (posture.strain() > limit) return "no usual pose";
  if (!posture.armsBelowLevel) return "straight";
  return *posture.armsBelowLevel < kTPose ? "a T-pose" : *posture.armsBelowLevel < kAPose ? "an A-pose" : "an I-pose";
}

bool isBelow(const Skeleton& skeleton, JointIndex joint, JointIndex top) {
  while (joint != kNoJoint && joint != top) joint = skeleton.joint(joint).parent;
  return joint == top;
}

/// In a walk no frame has both feet at rest: one that swings and points down would be taken as level, and the body
/// would float on its toes. So each foot and hand is turned as in the frame in which its limb and itself are
/// straightest.
/// @return words for the guess, empty if all of them stay
std::string straightenEnds(const SkeletalMotion& motion, std::span<const int> frames, std::span<const Posture> postures,
                           const Posture& found, Pose& pose) {
  const Skeleton& skeleton = motion.skeleton;
  std::string words;
  for (std::size_t i = 0; i < kLimbs.size(); ++i) {
    const JointIndex end = skeleton.jointOf(kLimbs[i].end);
    if (end == kNoJoint || found.end[i] < kEndTurned) continue;
    const auto worst = [&](const Posture& posture) { return std::max(posture.limb[i], posture.end[i]); };
    const auto best = std::ranges::min_element(postures, {}, worst);
    if (best->end[i] > found.end[i] - kEndTurned) continue;
    const int frame = frames[best - postures.begin()];
    for (JointIndex j = end; j < skeleton.jointCount(); ++j) {
      if (isBelow(skeleton, j, end)) pose[j] = motion.pose(frame)[j];
    }
    words +=
        fmt::format(", its {} {} from frame {}", i % 2 == 0 ? "left" : "right", i < kFirstLeg ? "hand" : "foot", frame);
  }
  return words;
}

}  // namespace

std::string namePose(const Skeleton& skeleton, std::span<const JointTransform> pose) {
  return nameOf(PostureReader(skeleton).read(pose), kZeroStands);
}

RestPose findRestPose(const SkeletalMotion& motion) {
  const Skeleton& skeleton = motion.skeleton;
  PostureReader reader(skeleton);
  const Posture zero = reader.read(restPose(skeleton));
  RestPose rest{restPose(skeleton), true, "the zero pose"};
  if (zero.up) rest.words += ", " + nameOf(zero, kZeroStands);
  if (!zero.up || zero.strain() <= kZeroStands) return rest;

  std::vector<int> frames;
  std::vector<Posture> postures;
  const int stride = std::max(1, motion.frameCount() / kSamples);
  Vec3 upright = Vec3::Zero();
  for (int f = 0; f < motion.frameCount(); f += stride) {
    frames.push_back(f);
    postures.push_back(reader.read(motion.pose(f)));
    upright += postures.back().up.value_or(Vec3::Zero());
  }
  // Most people stand most of the time; if these do, a frame in which they lie is not their rest pose.
  constexpr double kClear = 0.8;
  if (upright.norm() > kClear * static_cast<double>(frames.size())) {
    for (Posture& posture : postures)
      posture.trunk = std::max(posture.trunk, angleBetween(posture.up.value_or(upright), upright));
  }
  const auto lowest = [&](auto&& measure) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < postures.size(); ++i) {
      if (measure(postures[i]) < measure(postures[best])) best = i;
    }
    return best;
  };
  std::size_t best = lowest([](const Posture& posture) { return posture.sum(); });
  if (postures[0].strain() <= postures[best].strain() + kFirstFrameBonus) best = 0;
  Posture found = postures[best];
  Pose pose(motion.pose(frames[best]).begin(), motion.pose(frames[best]).end());
  std::string words = fmt::format("frame {}, {}", frames[best], nameOf(found, kFrameStands));
  if (found.strain() > kFrameStands) {
    const std::size_t trunk = lowest([](const Posture& posture) { return posture.trunk; });
    pose.assign(motion.pose(frames[trunk]).begin(), motion.pose(frames[trunk]).end());
    for (std::size_t i = 0; i < kLimbs.size(); ++i) {
      const std::size_t straightest = lowest([&](const Posture& posture) { return posture.limb[i]; });
      const JointIndex collar = skeleton.jointOf(kLimbs[i].collar);
      const JointIndex top = collar == kNoJoint ? skeleton.jointOf(kLimbs[i].upper) : collar;
      if (top == kNoJoint) continue;
      for (JointIndex j = top; j < skeleton.jointCount(); ++j) {
        if (isBelow(skeleton, j, top)) pose[j] = motion.pose(frames[straightest])[j];
      }
    }
    found = reader.read(pose);
    for (std::size_t i = 0; i < kLimbs.size(); ++i) reader.straighten(i, found, pose);
    found = reader.read(pose);
    words = "each limb from the frame in which it is straightest";
  }
  if (found.strain() > zero.strain() - kBetterThanZero) return rest;
  words += straightenEnds(motion, frames, postures, found, pose);
  // Where the body stands says nothing of its pose.
  for (JointIndex j = 0; j < skeleton.jointCount(); ++j) {
    if (skeleton.joint(j).parent == kNoJoint) pose[j].translation = skeleton.joint(j).rest.translation;
  }
  return {std::move(pose), false, std::move(words)};
}

}  // namespace lorica

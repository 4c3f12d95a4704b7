#pragma once

#include "capture/confidence_hold.h"
#include "capture/retarget/root_and_feet.h"
#include "capture/skeleton_frame.h"
#include "skinning/skeleton.h"

#include <array>
#include <optional>
#include <span>

namespace lorica {

/// How a person's joints become a pose.
struct RetargetSettings {
  ConfidenceHoldSettings hold;  ///< for bones that are not seen
  bool plantFeet = true;        ///< see FootLock; if false, limbs point exactly as the person's
};

/// Converts tracked joints to a pose of one character, whatever its rest pose, joint axes and proportions.
///
/// Hips and chest take their frames from the hip line, the shoulder line and the trunk; the spine distributes the bend
/// between them. Neck, arms and legs take the directions of the person's limbs. Twist about a limb comes from the
/// joint's orientation if there is one, else from the plane in which elbow or knee bends, else it is minimal. Knees
/// never bend backwards: a shin that noise puts in front of its thigh's line is projected onto that line.
///
/// The root starts at the person's position and moves with the person's motion, scaled by the ratio of leg lengths. Its
/// height puts the lower foot as high above the floor as the person's foot is above its own standing height, scaled; no
/// foot stays below the floor. A foot that stands still keeps its position (FootLock): its leg bends for that.
///
/// Bones with unknown joints hold, then ease to rest (ConfidenceHold). Fingers stay at rest; toes bend at the floor.
/// Stateful: use one instance per person. The same frames give the same poses. Allocates nothing per frame.
class Retargeter {
 public:
  /// @return the retargeter, or an error with the humanoid bones that the skeleton lacks
  static Result<Retargeter> create(const Skeleton& skeleton, const RetargetSettings& settings = {});

  /// @param pose  jointCount local transforms, written
  void apply(const SkeletonFrame& frame, std::span<JointTransform> pose);

  /// Character's leg length over the person's, as estimated so far; 1 until both legs were seen.
  [[nodiscard]] double legRatio() const { return legRatio_; }

 private:
  /// A frame without its unusable numbers, and the trunk frames derived from it.
  struct Person {
    std::array<bool, kBodyJointCount> seen{};
    std::array<Vec3, kBodyJointCount> position;
    std::array<std::optional<Quat>, kBodyJointCount> orientation;
    std::optional<Quat> hips;  ///< worldFromBody frames: left, up, forward
    std::optional<Quat> chest;
    std::optional<Vec3> middleHip;

    [[nodiscard]] bool has(BodyJoint j) const { return seen[static_cast<std::size_t>(j)]; }
    [[nodiscard]] const Vec3& at(BodyJoint j) const { return position[static_cast<std::size_t>(j)]; }
    [[nodiscard]] const std::optional<Quat>& turnOf(BodyJoint j) const {
      return orientation[static_cast<std::size_t>(j)];
    }
    /// Unit vector from a to b; nullopt if either is unknown or they coincide.
    [[nodiscard]] std::optional<Vec3> direction(BodyJoint a, BodyJoint b) const;
  };

  /// Source of a bone's twist; a change of source must not cause a visible jump.
  enum class TwistSource : std::uint8_t { kNone, kMin, kHinge, kOrientation };
  struct Twist {
    double angle = 0.0;  ///< about the bone, relative to the least-twisted orientation [rad]
    TwistSource source = TwistSource::kNone;
    bool catchingUp = false;
  };

  Retargeter(RetargetRig rig, const RetargetSettings& settings);

  [[nodiscard]] static Person readPerson(const SkeletonFrame& frame);
  [[nodiscard]] std::optional<Quat> orientationOf(HumanBone bone, JointIndex joint, const Person& person);
  [[nodiscard]] std::optional<Quat> solveSpine(JointIndex joint, const Person& person) const;
  [[nodiscard]] std::optional<Quat> solveNeck(const Person& person) const;
  [[nodiscard]] std::optional<Quat> solveHead(const Person& person) const;
  [[nodiscard]] std::optional<Quat> solveClavicle(std::size_t limb, const Person& person) const;
  [[nodiscard]] std::optional<Quat> solveUpper(std::size_t limb, const Person& person);
  [[nodiscard]] std::optional<Quat> solveLower(std::size_t limb, const Person& person);
  [[nodiscard]] std::optional<Quat> solveFoot(std::size_t limb, const Person& person) const;
  [[nodiscard]] std::optional<Quat> solveToes(std::size_t side, const Person& person) const;
  [[nodiscard]] std::optional<Vec3> lowerDirection(std::size_t limb, const Person& person) const;
  [[nodiscard]] Quat twisted(const Quat& min, const Vec3& direction, double wanted, TwistSource source, Twist& twist);
  /// Orientation of a bone as defined for TrackedJoint, as shown in this frame.
  [[nodiscard]] Quat shown(JointIndex joint) const;
  [[nodiscard]] Quat shown(HumanBone bone) const { return shown(body_.rig.skeleton.jointOf(bone)); }

  void measureLegs(const Person& person);
  void measureFloor(const Person& person);
  void placeRoot(const Person& person, std::span<JointTransform> pose);
  void plantFeet(const Person& person, std::span<JointTransform> pose);

  static constexpr std::size_t kLegSamples = 63;

  PosedBody body_;  ///< as shown; the root position follows last
  RetargetSettings settings_;
  ConfidenceHold hold_;
  FootLock footLock_;
  std::array<Twist, kLimbCount> upperTwist_;
  std::array<Twist, kLimbCount> lowerTwist_;

  std::array<double, kLegSamples> legLengths_{};  ///< the person's, from the first frames that show both legs [m]
  std::size_t legLengthCount_ = 0;
  double medianLegLength_ = 0.0;
  double legRatio_ = 1.0;
  std::optional<double> standingFoot_;  ///< height of the person's foot joint while standing [m]
  std::optional<Vec3> lastMiddleHip_;   ///< of the person
  Vec3 root_ = Vec3::Zero();            ///< of the character: the point below the middle of its hips, y = 0
  std::optional<double> footLift_;      ///< offset that the feet add to the scaled height of the hips [m]
};

}  // namespace lorica

#pragma once

#include "capture/confidence_hold.h"
#include "capture/retarget/foot_lock.h"
#include "capture/retarget/retarget_rig.h"
#include "capture/skeleton_frame.h"
#include "skinning/skeleton.h"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

struct RetargetSettings {
  ConfidenceHoldSettings hold;
  bool plantFeet = true;  ///< see FootLock; without it limbs point exactly as the person's
};

/// Turns tracked joints into a pose of one character, whatever its rest pose, joint axes and proportions.
///
/// Hips and chest take the frames of the hip line, the shoulder line and the trunk; the spine shares out the bend
/// between them. Neck, arms and legs take the directions of the person's limbs. Twist about a limb comes from the
/// joint's orientation where there is one, else from the plane in which elbow or knee bends, else it is the least.
/// Knees never bend backwards: a shin that noise puts in front of its thigh's line is laid into that line.
///
/// The root starts where the person stands and moves by the person's motion scaled by the ratio of leg lengths. Its
/// height puts the lower foot as high above the floor as the person's is above its own standing height, scaled; no
/// foot is left under the floor. A foot that stands still keeps its place (FootLock): its leg bends for that.
///
/// Bones whose joints are unknown hold, then ease to rest (ConfidenceHold). Fingers stay at rest; toes give way to the
/// floor.
/// One instance a person: it remembers. The same frames give the same poses. Allocates nothing per frame.
class Retargeter {
 public:
  /// @return the retargeter, or which humanoid bones the skeleton lacks (bonesNeededToRetarget)
  static Result<Retargeter> create(const Skeleton& skeleton, const RetargetSettings& settings = {});

  /// @param pose  jointCount local transforms, written
  void apply(const SkeletonFrame& frame, std::span<JointTransform> pose);

  /// Character's leg length over the person's, as estimated so far; 1 until a leg was seen.
  [[nodiscard]] double legRatio() const { return legRatio_; }

 private:
  /// A frame with unusable numbers weeded out, and what the trunk makes of it.
  struct Person {
    std::array<bool, kBodyJointCount> seen{};
    std::array<Vec3, kBodyJointCount> place;
    std::array<std::optional<Quat>, kBodyJointCount> orientation;
    std::optional<Quat> hips;  ///< worldFromBody frames: left, up, forward
    std::optional<Quat> chest;
    std::optional<Vec3> middleHip;

    [[nodiscard]] bool has(BodyJoint j) const { return seen[static_cast<std::size_t>(j)]; }
    [[nodiscard]] const Vec3& at(BodyJoint j) const { return place[static_cast<std::size_t>(j)]; }
    [[nodiscard]] const std::optional<Quat>& turnOf(BodyJoint j) const {
      return orientation[static_cast<std::size_t>(j)];
    }
    /// Unit vector from a to b; nothing when either is unknown or they coincide.
    [[nodiscard]] std::optional<Vec3> direction(BodyJoint a, BodyJoint b) const;
  };

  /// Where a bone's twist comes from; a change of source may not show as a jump.
  enum class TwistSource : std::uint8_t { kNone, kLeast, kHinge, kOrientation };
  struct Twist {
    double angle = 0.0;  ///< about the bone, against the least-twisted orientation [rad]
    TwistSource source = TwistSource::kNone;
    bool catchingUp = false;
  };

  Retargeter(RetargetRig rig, const RetargetSettings& settings);

  [[nodiscard]] static Person readPerson(const SkeletonFrame& frame);
  [[nodiscard]] std::optional<Quat> solve(HumanBone bone, JointIndex joint, const Person& person);
  [[nodiscard]] std::optional<Quat> solveSpine(JointIndex joint, const Person& person) const;
  [[nodiscard]] std::optional<Quat> solveNeck(const Person& person) const;
  [[nodiscard]] std::optional<Quat> solveHead(const Person& person) const;
  [[nodiscard]] std::optional<Quat> solveClavicle(std::size_t limb, const Person& person) const;
  [[nodiscard]] std::optional<Quat> solveUpper(std::size_t limb, const Person& person);
  [[nodiscard]] std::optional<Quat> solveLower(std::size_t limb, const Person& person);
  [[nodiscard]] std::optional<Quat> solveFoot(std::size_t limb, const Person& person) const;
  [[nodiscard]] std::optional<Quat> solveToes(std::size_t side, const Person& person) const;
  [[nodiscard]] std::optional<Vec3> lowerDirection(std::size_t limb, const Person& person) const;
  [[nodiscard]] Quat twisted(const Quat& least, const Vec3& direction, double wanted, TwistSource source, Twist& twist);
  /// Orientation of a bone in TrackedJoint's sense, as shown in this frame.
  [[nodiscard]] Quat shown(JointIndex joint) const;
  [[nodiscard]] Quat shown(HumanBone bone) const { return shown(rig_.skeleton.jointOf(bone)); }

  void measureLegs(const Person& person);
  void measureFloor(const Person& person);
  void placeRoot(const Person& person, std::span<JointTransform> pose);
  void plantFeet(const Person& person, std::span<JointTransform> pose);

  static constexpr std::size_t kLegSamples = 63;

  RetargetRig rig_;
  RetargetSettings settings_;
  ConfidenceHold hold_;
  FootLock footLock_;
  std::vector<Quat> worldRotation_;      ///< one a joint, as shown
  std::vector<Affine3> worldFromJoint_;  ///< one a joint, as shown but for the root's place
  std::array<Twist, kLimbCount> upperTwist_;
  std::array<Twist, kLimbCount> lowerTwist_;

  std::array<double, kLegSamples> legLengths_{};  ///< the person's, of the first frames that showed both legs [m]
  std::size_t legLengthCount_ = 0;
  double medianLegLength_ = 0.0;
  double legRatio_ = 1.0;
  std::optional<double> standingFoot_;  ///< height of the person's foot joint when it stands [m]
  std::optional<Vec3> lastMiddleHip_;   ///< of the person
  Vec3 root_ = Vec3::Zero();            ///< of the character: below the middle of its hips, y = 0
  std::optional<double> footLift_;      ///< what the feet add to the scaled height of the hips [m]
};

}  // namespace lorica

#pragma once

#include "capture/retarget/bone_pose.h"
#include "capture/retarget/retarget.h"

#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// Poses a character with another one's bones, frame by frame as they arrive.
///
/// Each bone takes the sender's rotation; bones that the character lacks pass theirs on to their children. The root
/// moves as Retargeter's does: from the sender's position on, scaled by the ratio of leg lengths, which come from the
/// sender's offsets. If these are missing or zero, the sender is taken to be as large as the character. Feet that stand
/// still keep their place. A sender of the character's own proportions moves it exactly as its own. Without legs, as
/// from a webcam, the character stands; its height changes as the sender's hips do, if they come.
///
/// A sender whose feet are more than 5 cm above or below the floor in the first second is moved onto it.
/// Bones that do not come hold, then ease to rest, and come back without a jump (ConfidenceHold). Allocates nothing per
/// frame.
class StreamRetargeter {
 public:
  /// @return the retargeter, or an error with the humanoid bones that the skeleton lacks
  static Result<StreamRetargeter> create(const Skeleton& skeleton, const RetargetSettings& settings = {});

  /// @param time   [s]
  /// @param known  false while the sender is silent: the pose is held
  /// @param pose   jointCount local transforms, written
  void apply(const BonePose& sent, double time, bool known, std::span<JointTransform> pose);

  /// Character's leg length over the sender's.
  [[nodiscard]] double legRatio() const { return legRatio_; }
  /// World transforms of the last pose.
  [[nodiscard]] std::span<const Affine3> worldFromJoint() const { return body_.worldFromJoint; }

 private:
  /// The sender's body in one frame.
  struct Sender : WorldBones {
    double legLength = 0.0;  ///< 0 if its offsets do not tell
    Vec3 middleHip = Vec3::Zero();
  };
  StreamRetargeter(RetargetRig rig, const RetargetSettings& settings);

  [[nodiscard]] Sender readSender(const BonePose& sent) const;
  void measure(const Sender& sender, double time);
  void turnBones(const BonePose& sent, const Sender& sender, bool known, std::span<JointTransform> pose);
  void placeRoot(const BonePose& sent, const Sender& sender, bool known, std::span<JointTransform> pose);
  void plantFeet(const Sender& sender, bool known, std::span<JointTransform> pose);

  PosedBody body_;
  RetargetSettings settings_;
  std::vector<Quat> referenceFromJoint_;
  ConfidenceHold hold_;
  FootLock footLock_;
  double legRatio_ = 1.0;
  bool hasLegs_ = false;
  std::optional<double> firstTime_;
  double lowestAnkle_ = 0.0;  ///< of the sender in the first second [m]
  double floor_ = 0.0;        ///< the sender's [m]
  std::optional<Vec3> firstHip_;
  std::optional<double> firstHipHeight_;  ///< of hips that came [m]
};

}  // namespace lorica

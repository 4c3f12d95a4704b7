#pragma once

#include "capture/skeleton_frame.h"
#include "capture/smoothing.h"
#include "skinning/character.h"
#include "skinning/clip.h"

#include <memory>
#include <optional>
#include <span>

namespace lorica {

/// Source of a character's motion: one pose of its skeleton per frame, recorded or live, from joints or from bones.
class PoseSource {
 public:
  virtual ~PoseSource() = default;

  /// @param pose  jointCount local transforms of the character. Input: the last frame (at first the rest pose);
  ///              output: this frame. Unchanged at the end of the stream.
  /// @return the frame's time [s]; nothing at the end of the stream; an error if the data is bad
  [[nodiscard]] virtual Result<std::optional<double>> next(std::span<JointTransform> pose) = 0;

  /// Delay that smoothing adds to the poses [s], as measured so far; none without smoothing.
  [[nodiscard]] virtual std::optional<double> smoothingDelay() const { return std::nullopt; }

  /// Trust of each joint's position in the last pose, 0 to 1, see JointTrust; empty if all joints are fully trusted.
  [[nodiscard]] virtual std::span<const double> trust() const { return {}; }

  /// Expressions of the face that belong to the last pose, valid until the next call of next(); empty if the source has
  /// none.
  [[nodiscard]] virtual std::span<const NamedWeight> expressions() const { return {}; }

  /// Time that the last next() waited for joints, including tracking [s]; 0 if they were available.
  [[nodiscard]] virtual double waited() const { return 0.0; }

  /// Whether anybody is there to be followed, as of the last next(): false for a place of several that is empty.
  [[nodiscard]] virtual bool present() const { return true; }

  /// Whether a leg was refused so far because it cannot be, see LegJudge.
  [[nodiscard]] virtual bool refusedLegs() const { return false; }
};

/// Processing of joints before they pose a character.
struct JointSettings {
  std::optional<OneEuroSettings> smoothing;  ///< none = no smoothing
  bool mirror = false;                       ///< swaps left and right
  bool upperBody = false;                    ///< the person's legs are not used, see StandingLegs
};

/// Poses a skeleton from tracked joints, see Retargeter.
/// @return the source, or an error with the humanoid bones that the skeleton lacks
[[nodiscard]] Result<std::unique_ptr<PoseSource>> makeJointPoseSource(const Skeleton& skeleton,
                                                                      std::unique_ptr<SkeletonSource> joints,
                                                                      const JointSettings& settings = {});
/// The same for a character whose skeleton may lack lower limbs, hands and feet, or have them elsewhere in the
/// hierarchy, see ProxySkeleton.
[[nodiscard]] Result<std::unique_ptr<PoseSource>> makeJointPoseSource(const Character& character,
                                                                      std::unique_ptr<SkeletonSource> joints,
                                                                      const JointSettings& settings = {});

/// Plays back a motion of the character's own skeleton frame by frame.
[[nodiscard]] std::unique_ptr<PoseSource> makeMotionPoseSource(SkeletalMotion motion);

/// Retargets a whole recording to a character, as a session does.
/// @param recording  at least one frame, times rising
/// @return the motion of the character's skeleton, or an error with the humanoid bones that it lacks
[[nodiscard]] Result<SkeletalMotion> perform(const Skeleton& skeleton, std::span<const SkeletonFrame> recording,
                                             const JointSettings& settings = {});
/// The same with a ProxySkeleton if the character's skeleton needs one.
[[nodiscard]] Result<SkeletalMotion> perform(const Character& character, std::span<const SkeletonFrame> recording,
                                             const JointSettings& settings = {});

}  // namespace lorica

#pragma once

#include "capture/retarget/retarget.h"
#include "capture/skeleton_frame.h"
#include "capture/smoothing.h"
#include "skinning/character.h"
#include "skinning/clip.h"

#include <memory>
#include <optional>
#include <span>

namespace lorica {

/// Who moves a character: one pose of its skeleton a frame. Recorded or live, from joints or from bones.
class PoseSource {
 public:
  virtual ~PoseSource() = default;

  /// @param pose  jointCount local transforms of the character: in, the last frame's (at first the rest pose); out,
  /// this
  ///              frame's. Untouched at the end of the stream.
  /// @return the frame's time [s]; nothing at the end of the stream; an error when the data is bad
  [[nodiscard]] virtual Result<std::optional<double>> next(std::span<JointTransform> pose) = 0;

  /// How long smoothing has the poses lag behind the data [s], as measured so far; none where nothing is smoothed.
  [[nodiscard]] virtual std::optional<double> smoothingDelay() const { return std::nullopt; }

  /// How far each joint of the character can be believed to be where next() put it, 0 to 1, see JointTrust; empty where
  /// all of them can.
  [[nodiscard]] virtual std::span<const double> trust() const { return {}; }

  /// How long the last next() waited for joints and whoever finds them [s]; 0 where they were there.
  [[nodiscard]] virtual double waited() const { return 0.0; }
};

/// What is done to joints before they pose a character.
struct JointSettings {
  std::optional<OneEuroSettings> smoothing;  ///< none = as measured
  bool mirror = false;                       ///< left becomes right
};

/// Poses a skeleton by joints as they come, see Retargeter.
/// @return the source, or which humanoid bones the skeleton lacks
[[nodiscard]] Result<std::unique_ptr<PoseSource>> makeJointPoseSource(const Skeleton& skeleton,
                                                                      std::unique_ptr<SkeletonSource> joints,
                                                                      const JointSettings& settings = {});
/// The same of a character whose skeleton may lack lower limbs, hands and feet, or have them elsewhere, see
/// StandInSkeleton.
[[nodiscard]] Result<std::unique_ptr<PoseSource>> makeJointPoseSource(const Character& character,
                                                                      std::unique_ptr<SkeletonSource> joints,
                                                                      const JointSettings& settings = {});

/// Plays a motion of the character's own skeleton, frame by frame.
[[nodiscard]] std::unique_ptr<PoseSource> makeMotionPoseSource(SkeletalMotion motion);

/// A recording performed by a character from its first frame to its last, as a session does it.
/// @param recording  at least one frame, times rising
/// @return the motion of the character's skeleton, or which humanoid bones it lacks
[[nodiscard]] Result<SkeletalMotion> perform(const Skeleton& skeleton, std::span<const SkeletonFrame> recording,
                                             const JointSettings& settings = {});
/// The same by a StandInSkeleton, where the character's own needs one.
[[nodiscard]] Result<SkeletalMotion> perform(const Character& character, std::span<const SkeletonFrame> recording,
                                             const JointSettings& settings = {});

/// The same of several recordings: each is another performance, nothing is held over from the one before.
[[nodiscard]] Result<std::vector<SkeletalMotion>> performAll(const Skeleton& skeleton,
                                                             std::span<const std::vector<SkeletonFrame>> recordings);
[[nodiscard]] Result<std::vector<SkeletalMotion>> performAll(const Character& character,
                                                             std::span<const std::vector<SkeletonFrame>> recordings);

}  // namespace lorica

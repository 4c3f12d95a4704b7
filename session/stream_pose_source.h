#pragma once

#include "capture/retarget/bone_pose.h"
#include "capture/retarget/proxy_skeleton.h"
#include "capture/skeleton_frame.h"
#include "capture/streams/bone_stream.h"
#include "session/pose_source.h"
#include "skinning/character.h"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// The expression of the other side: `blinkLeft` is `blinkRight`, `Blink_L` is `Blink_R`, `mouthSmileLeft` is
/// `mouthSmileRight`. Names that end in no side are their own.
[[nodiscard]] std::string mirroredExpression(std::string_view name);

/// A face with left and right swapped. Allocates when names change only.
class MirroredExpressions {
 public:
  /// @return the weights of `sent`, in its order, under the names of the other side. Valid until the next call
  [[nodiscard]] std::span<const NamedWeight> of(std::span<const NamedWeight> sent);

 private:
  std::vector<std::string> names_;  ///< as sent
  std::vector<NamedWeight> mirrored_;
};

/// Maps the poses of a proxy skeleton back to its character.
[[nodiscard]] std::unique_ptr<PoseSource> makeProxyPoseSource(ProxySkeleton proxy, std::unique_ptr<PoseSource> source);

struct StreamSettings {
  bool mirror = false;                    ///< swaps left and right, in the face too
  std::optional<SenderRest> sender = {};  ///< of a sender whose zero rotations are no T-pose
  bool waits = true;                      ///< for a new frame; false for avatars that do not lead, see AlignedSource
};

/// Poses a character with what another program sends, see StreamRetargeter. Ends with the stream.
///
/// Without new frames the pose is held, and time goes on in steps of at most 1/30 s. After half a second of silence, or
/// while the sender says that it is not tracking, the trust of all joints is 0. It is also 0 for limbs that the sender
/// leaves out. It recovers within 0.3 s.
/// @return the source, or an error with the humanoid bones that the character lacks
[[nodiscard]] Result<std::unique_ptr<PoseSource>> makeStreamPoseSource(const Character& character,
                                                                       std::unique_ptr<BoneStream> stream,
                                                                       const StreamSettings& settings = {});

}  // namespace lorica

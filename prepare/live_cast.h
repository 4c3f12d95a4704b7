#pragma once

#include "capture/tracking/live_joints.h"
#include "prepare/cameras.h"
#include "prepare/cast.h"
#include "prepare/vmc_input.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace lorica {

/// What avatars follow instead of motions: people in front of a camera, programs that send, or a headset.
struct LiveRequest {
  DepthOptions depth;
  std::string nite;         ///< library of NiTE 2; empty = Lorica's own tracker
  VmcInputOptions vmc;      ///< instead of a camera
  int person = 0;           ///< number of the one to follow, by order of appearance; 0 = the nearest
  int people = 1;           ///< avatars of a camera
  bool lowerBody = false;   ///< see TrackerSettings
  bool threePoint = false;  ///< one avatar follows head and hands of the wearer of a headset, instead of a camera
  bool headset = false;     ///< the same if there is no camera and none was asked for

  /// One avatar for each person or for each program that sends.
  [[nodiscard]] std::size_t avatars() const;
};

/// Where the poses of a live cast come from. The camera or the streams are open.
class LiveSources final : public CastSources {
 public:
  Result<std::unique_ptr<PoseSource>> open(const PreparedAvatar& avatar, std::size_t index,
                                           const MotionOptions& performing, std::shared_ptr<SourceLog> log) override;

  /// A person of the last image as they are now: moved with their headset, if it is theirs.
  /// @param person  world frame
  [[nodiscard]] SkeletonFrame withHead(SkeletonFrame person) const;

  std::vector<std::shared_ptr<SkeletonSource>> joints;  ///< of each avatar; empty if programs send
  const LiveJoints* tracked = nullptr;                  ///< the first; null unless Lorica tracks people
  std::shared_ptr<WornHeadset> headset;                 ///< of somebody who is followed, by a tracker or by it
  std::vector<VmcInput> vmc;                            ///< of each avatar; empty unless programs send
  std::string name;

  /// Whether an avatar follows head and hands, without a camera.
  [[nodiscard]] bool threePoint() const { return headset != nullptr && tracked == nullptr; }
};

/// A cast and what it follows.
struct LiveCast {
  Cast cast;
  std::shared_ptr<LiveSources> sources;  ///< those of `cast`
};

/// Rejects options of the streams that cannot be, and too many people, before any work.
[[nodiscard]] Result<void> checkLive(const LiveRequest& live, const Host& host);

/// Reads the characters, in the order in which people appear; opens the scene, and the camera or the streams.
/// The scene's own avatars stay away, with a warning.
/// @param request  its motion is not used
/// @param sources  those of an earlier cast, which stay open; null = they are opened
[[nodiscard]] Result<LiveCast> prepareLiveCast(const CastRequest& request, const LiveRequest& live, Host& host,
                                               std::shared_ptr<LiveSources> sources = nullptr);

}  // namespace lorica

#pragma once

#include "capture/retarget/bone_pose.h"
#include "capture/streams/depth_stream.h"
#include "capture/streams/vmc_stream.h"
#include "capture/tracking/depth_joints.h"
#include "collision/hulls/host.h"
#include "session/prepare/cameras.h"
#include "session/prepare/cast.h"
#include "session/session.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// How a program is listened to.
struct VmcInputOptions {
  std::string listenAt;  ///< PORT or HOST:PORT; empty = not at all
  int delayMs = 0;       ///< of the frames
  std::string sender;    ///< see readSenderRest()
};

/// Rejects a bad address or sender before any work.
[[nodiscard]] Result<void> checkVmcInput(const VmcInputOptions& options, const Host& host);

/// A VMC stream that a session follows, and what is told of it.
class VmcInput {
 public:
  /// @param options  with an address
  /// @return the opened stream, or why there is none
  [[nodiscard]] static Result<VmcInput> open(const VmcInputOptions& options, const Host& host);

  /// The poses of a character that follows the stream; once. The source must outlive this object's later use.
  /// @param leads  whether the session waits for its frames
  [[nodiscard]] Result<std::unique_ptr<PoseSource>> makeSource(const Character& character, bool mirror,
                                                               bool leads = true);

  /// "VMC on 127.0.0.1:39539"
  [[nodiscard]] const std::string& name() const { return name_; }

  /// Whether the session should step now: there is a new frame, or none came for a thirtieth of a second.
  [[nodiscard]] bool ready(const Session& session) const;
  /// Adds a frame whose hulls have been posed; tells the host when the sender comes and goes.
  void add(const Session& session, Host& host);
  /// For the caption: "no program is sending", or empty.
  [[nodiscard]] std::string state() const;

  [[nodiscard]] VmcStream::Counts counts() const { return view_->counts(); }
  [[nodiscard]] int delayMs() const { return delayMs_; }
  /// From the packet to the posed hulls [us], of each frame.
  [[nodiscard]] const std::vector<double>& latency() const { return latency_; }

 private:
  VmcInput(std::unique_ptr<VmcStream> stream, std::string name, std::optional<SenderRest> sender, int delayMs);

  const VmcStream* view_;
  std::unique_ptr<BoneStream> stream_;
  std::string name_;
  std::optional<SenderRest> sender_;
  int delayMs_;
  std::vector<double> latency_;  // from the packet to the posed hulls [us]
  bool receives_ = false;        // a frame came within half a second
};

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
  const DepthStream* sent = nullptr;                    ///< the depth that they are tracked in; null = of a camera
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

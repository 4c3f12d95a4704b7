#pragma once

#include "capture/streams/tracker_writer.h"
#include "capture/streams/udp.h"
#include "capture/streams/vmc_writer.h"
#include "geometry/result.h"
#include "session/prepare/live_cast.h"
#include "session/prepare/subject.h"
#include "session/session.h"

#include <memory>
#include <optional>
#include <span>
#include <string>

namespace lorica {

/// Where a session's pose is sent.
struct PoseOutputOptions {
  std::optional<NetworkAddress> vmc;     ///< none = nowhere
  std::optional<VmcBones> bones;         ///< that are sent by VMC; none = all
  std::optional<NetworkAddress> vrchat;  ///< none = nowhere
  std::optional<NetworkAddress> vmt;     ///< Virtual Motion Tracker; none = nowhere
  TrackerGroups trackers;                ///< that are sent to both; none = all

  [[nodiscard]] bool any() const { return vmc || vrchat || vmt; }
};

/// What was sent, in packets.
struct PosesSent {
  int vmc = 0, contacts = 0;  ///< poses and contacts by VMC
  int vrchat = 0, vmt = 0;    ///< poses as trackers
};

/// "60 poses and 12 contacts to 127.0.0.1:39539; 60 poses to VRChat"
[[nodiscard]] std::string inWords(const PosesSent& sent, const PoseOutputOptions& options);

/// Sends a session's pose and face after each step, at most 60 times per second of its own time, by the VMC protocol
/// and as trackers; by VMC also the contacts of each step. A recording is slowed down to real time. A receiver that is
/// not there is no error. No tracker is sent while tracking is lost.
/// @param subject      the session's character
/// @param expressions  that were chosen for it, see chosenExpressions()
/// @param live         who is followed: trackers are sent in the stage of their headset, once it is registered; may be
/// null
/// @param next         another watcher of the same session; may be null
/// @param sent         counts, until the watcher is gone
/// @return the watcher; `next` itself if nothing is to be sent; or an error: an address that cannot be had, or the
/// humanoid bones that the character lacks
[[nodiscard]] Result<std::shared_ptr<StepWatcher>> makePoseOutput(const PoseOutputOptions& options,
                                                                  const Subject& subject,
                                                                  std::span<const std::string> expressions,
                                                                  std::shared_ptr<const LiveSources> live,
                                                                  std::shared_ptr<StepWatcher> next, PosesSent& sent);

}  // namespace lorica

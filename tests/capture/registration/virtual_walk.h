#pragma once

#include "capture/registration/head_registration.h"

#include <cstdint>
#include <vector>

namespace lorica::test {

/// How somebody walks in front of a camera with a headset on, and how badly both are measured.
struct WalkSettings {
  enum class Shape { kWander, kLine, kStand, kTurnHead, kTurnAndNod };

  double seconds = 5.0;
  double distance = 5.0;    ///< walked altogether [m]
  double room = kInfinity;  ///< at this distance from where they began they turn back [m]
  Shape shape = Shape::kWander;
  double noise = 0.015;               ///< of the tracked head, 1.4 times that in depth [m]
  double lasting = 0.0;               ///< how much of it stays from frame to frame, beyond half of it for one frame
  double lag = 0.06;                  ///< of the tracked head [s]
  double dropouts = 0.15;             ///< share of the tracked heads, roughly
  double outliers = 0.02;             ///< share of the tracked heads
  double drift = 0.0;                 ///< of the headset from begin to end [m]
  Vec3 head = kNominalHeadInHeadset;  ///< mean of where people's heads are in the headset
};

/// What is measured of it, and the truth.
struct VirtualWalk {
  std::vector<HeadRegistration::TrackedHead> heads;
  std::vector<HeadRegistration::HeadsetPose> poses;
  Registration truth;

  /// The same seed gives the same walk.
  VirtualWalk(const WalkSettings& settings, std::uint64_t seed);
  /// Hands all of it over, in the order of time.
  void walk(HeadRegistration& registration) const;
};

/// How far a registration is from the truth.
struct RegistrationErrors {
  double yaw = 0.0;     ///< [rad]
  double level = 0.0;   ///< of the places that were walked, root mean square [m]
  double height = 0.0;  ///< [m]
  double head = 0.0;    ///< of the head joint that is foretold, root mean square [m]
  double lag = 0.0;     ///< [s]
};
[[nodiscard]] RegistrationErrors errorsOf(const Registration& found, const VirtualWalk& walk);

}  // namespace lorica::test

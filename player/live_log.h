#pragma once

#include "capture/tracking/live_joints.h"
#include "prepare/host.h"

#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// Messages and statistics of a live performance.
class LiveLog {
 public:
  /// Adds a frame whose hulls have been posed; tells the host what changes in front of the camera.
  /// @param seconds  since the first frame [s]
  void add(const LiveJoints& joints, double seconds, Host& host);

  /// For the caption: "no person is visible", "the sensor is unplugged", what to do where person and room
  /// cannot be told apart, or empty.
  [[nodiscard]] std::string state() const;

  struct Figures {
    std::vector<double> track, latency;  ///< [us], of the images whose joints were used
    int frames = 0;                      ///< tracked images
    int followed = 0;                    ///< images with a person
    int maxPeople = 0;
    int unplugs = 0;
    std::optional<double> firstPose;  ///< since the first frame [s]
  };
  [[nodiscard]] const Figures& figures() const { return figures_; }

 private:
  Figures figures_;
  bool unplugged_ = false;
  bool wasFollowed_ = false;
  bool wasUncertain_ = false;
};

}  // namespace lorica

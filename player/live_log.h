#pragma once

#include "geometry/text.h"
#include "capture/tracking/live_joints.h"

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// Messages and statistics of a live performance.
class LiveLog {
 public:
  /// Adds a frame whose hulls have been posed; prints changes before the camera to standard error.
  /// @param seconds  since the first frame [s]
  void add(const LiveJoints& joints, double seconds);

  /// For the caption: "no person is visible", "the sensor is unplugged", what to do where person and room
  /// cannot be told apart, or empty.
  [[nodiscard]] std::string state() const;

  /// "depthFrames", "framesWithPerson", ..., "tracking" and "latency" in microseconds.
  void addTo(nlohmann::ordered_json& json) const;
  void addTo(Report& report) const;

 private:
  std::vector<double> track_, latency_;  // [us], of the images whose joints were used
  int frames_ = 0;                       // tracked images
  int followed_ = 0;                     // images with a person
  int maxPeople_ = 0;
  int unplugs_ = 0;
  std::optional<double> firstPose_;  // since the first frame [s]
  bool unplugged_ = false;
  bool wasFollowed_ = false;
  bool wasUncertain_ = false;
};

}  // namespace lorica

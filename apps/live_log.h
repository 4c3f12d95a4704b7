#pragma once

#include "apps/report.h"
#include "capture/tracking/live_joints.h"

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// What is told of a live performance as it runs and after it.
class LiveLog {
 public:
  /// Takes a frame into account whose hulls are posed by now; says on standard error what changed before the camera.
  /// @param seconds  since the first frame [s]
  void add(const LiveJoints& joints, double seconds);

  /// For the caption: "nobody is seen", "the sensor is unplugged", or empty.
  [[nodiscard]] std::string state() const;

  /// "depthFrames", "framesWithPerson", ..., "tracking" and "latency" in microseconds.
  void addTo(nlohmann::ordered_json& json) const;
  void addTo(Report& report) const;

 private:
  std::vector<double> track_, latency_;  // [us], of the images whose joints were shown
  int frames_ = 0;                       // images that were followed
  int followed_ = 0;                     // those in which there was a person
  int mostPeople_ = 0;
  int unplugs_ = 0;
  std::optional<double> firstPose_;  // since the first frame [s]
  bool unplugged_ = false;
  bool wasFollowed_ = false;
};

}  // namespace lorica

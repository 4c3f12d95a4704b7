#pragma once

#include "capture/tracking/tracker.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <span>

namespace lorica {

/// Writes what a tracker sees in a recording, for programs that judge or train trackers: everyone's joints where they
/// are in front of the camera, and whose each pixel is.
///
/// NAME.cam.csv: `frame,user`, then x, y, z [m] and confidence of the 15 joints in the order of BodyJoint. Camera
/// frame: x to the right in the image, y up, the camera looks along -z. One row for each person and frame; user 0:
/// nobody. NAME.lab: one byte a pixel, frame after frame, see Tracker::labels().
class TrackLog {
 public:
  /// @param base  folder and NAME; written to NAME.cam.csv.part and NAME.lab.part until finish()
  static Result<TrackLog> create(const std::filesystem::path& base);
  TrackLog(TrackLog&&) noexcept = default;
  TrackLog& operator=(TrackLog&&) = delete;
  /// Removes what is not finished.
  ~TrackLog();

  /// @param frame   from 0
  /// @param people  as returned by tracker.track()
  void add(int frame, std::span<const TrackedPerson> people, Tracker& tracker);
  /// Gives the files their names. @return an error if something could not be written
  [[nodiscard]] Result<void> finish();

 private:
  struct Part {
    std::filesystem::path target, path;
    std::ofstream stream;
  };
  TrackLog() = default;

  std::array<Part, 2> parts_;  ///< joints, labels
};

}  // namespace lorica

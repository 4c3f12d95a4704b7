#pragma once

#include "capture/sensor/depth_frame.h"
#include "capture/tracking/fit/body_model.h"
#include "geometry/math.h"

#include <cstdint>
#include <memory>
#include <span>

namespace lorica {

/// One person's pixels in one frame.
struct PersonSegment {
  int user = 1;  ///< kept from frame to frame while the person is seen, and for two seconds after
  int left = 0, top = 0, right = 0, bottom = 0;  ///< bounding box [pixels], right and bottom exclusive
  int pixelCount = 0;
  Vec3 middle = Vec3::Zero();  ///< of its points, floor frame [m]
  double topHeight = 0.0;      ///< the highest point over the floor [m]
  bool cutByBorder = false;    ///< touches the image border
  bool moved = false;          ///< since found; furniture does not move
  bool attached = false;       ///< connected to the room: which pixels are the person's is uncertain, see explain()
};

/// Finds the floor, removes the background, and separates people from it and from each other. See Tracker for frames.
///
/// Use one instance per camera, because it keeps state. Does not allocate after the first frames.
class PeopleFinder {
 public:
  explicit PeopleFinder(const DepthCamera& camera, int maxPeople);
  ~PeopleFinder();

  /// @param frame  width x height of the camera
  void find(const DepthFrame& frame);

  /// A body explains what is seen of this person: they are one person, and no furniture.
  void confirm(int user);
  /// Of someone connected to the room, what the body explains is the person's from the next frame on, the rest the
  /// room's, unless it moves. Of anyone else, pieces apart from the rest that it does not explain may be another's.
  /// @param body  fitted to the last frame, floor frame
  void explain(int user, const fit::PosedModel& body);
  /// What was taken for this person is furniture: it becomes background.
  /// @param user  of the last frame
  void reject(int user);

  /// By increasing user number.
  [[nodiscard]] std::span<const PersonSegment> people() const;
  /// width x height: 0 background, 255 not measured, else the index in people() + 1.
  [[nodiscard]] std::span<const std::uint8_t> labels() const;
  [[nodiscard]] const Isometry3& floorFromCamera() const;
  [[nodiscard]] bool floorFound() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lorica

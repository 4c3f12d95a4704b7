#pragma once

#include "capture/virtual_sensor/depth_render.h"

#include <optional>
#include <vector>

namespace lorica {

/// Pose of a camera at a position in the world, without roll.
/// @param tiltDown  angle of its axis below the horizon [rad]
/// @param heading   0 looks along -Z; positive turns it to its left, about +Y [rad]
[[nodiscard]] Isometry3 worldFromCameraAt(const Vec3& position, double tiltDown, double heading = 0.0);

/// The surroundings of the people seen by a depth camera: world frame, Y up, floor y = 0 [m]. Motions start near the
/// origin and face +Z, towards the camera.
struct VirtualRoom {
  Isometry3 worldFromCamera = worldFromCameraAt({0.0, 1.1, 3.0}, 0.05);
  bool floor = true;
  std::optional<double> wall = -1.6;  ///< a wall at this z, across the view [m]
  std::vector<Aabb> boxes;            ///< furniture
};

/// A chair of six boxes, 0.45 m to the seat, for a person who sits at a position and faces +Z.
/// @param middle  of the seat, on the floor [m]
[[nodiscard]] std::vector<Aabb> chairAt(const Vec3& middle);

/// Draws floor, wall and boxes, all with label 0.
void drawRoom(const VirtualRoom& room, DepthRenderer& renderer);

}  // namespace lorica

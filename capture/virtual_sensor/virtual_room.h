#pragma once

#include "capture/virtual_sensor/depth_render.h"

#include <optional>
#include <vector>

namespace lorica {

/// A camera at a place in the world, without roll.
/// @param tiltDown  how far its axis points below the horizon [rad]
/// @param heading   0 looks along -Z; rising turns it to its left, about +Y [rad]
[[nodiscard]] Isometry3 worldFromCameraAt(const Vec3& place, double tiltDown, double heading = 0.0);

/// What stands around the people whom a depth camera sees: world frame, Y up, floor y = 0 [m]. Motions begin near the
/// origin and face +Z, where the camera stands.
struct VirtualRoom {
  Isometry3 worldFromCamera = worldFromCameraAt({0.0, 1.1, 3.0}, 0.05);
  bool floor = true;
  std::optional<double> wall = -1.6;  ///< a wall z = this, across the view [m]
  std::vector<Aabb> boxes;            ///< furniture
};

/// A chair of six boxes, 0.45 m to the seat, for someone who sits at a place and faces +Z.
/// @param middle  of the seat, on the floor [m]
[[nodiscard]] std::vector<Aabb> chairAt(const Vec3& middle);

/// Draws floor, wall and boxes, all with label 0.
void drawRoom(const VirtualRoom& room, DepthRenderer& renderer);

}  // namespace lorica

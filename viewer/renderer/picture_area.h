#pragma once

#include "viewer/renderer/scene.h"

#include <array>
#include <span>

namespace lorica {

/// The directions of a picture in the world, unit vectors.
struct ViewAxes {
  Vec3 forward, right, up;
};
[[nodiscard]] ViewAxes axesOf(const Camera& camera);

/// A direction. @param azimuth  around Y, 0 = +Z, to +X [rad] @param elevation  above the horizon [rad]
[[nodiscard]] Vec3 directionAt(double azimuth, double elevation);

/// A rectangle of a picture in clip space: x to the right and y up, from -1 to 1.
struct PictureArea {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  Eigen::Vector2d half = Eigen::Vector2d::Ones();  ///< half its width and height
};

[[nodiscard]] std::array<Vec3, 8> cornersOf(const Aabb& box);

/// How far a camera has to be from its target, in its present direction, to have all points in an area [m].
/// @param camera  its target is in the middle of the area, see Camera::targetAt
/// @param aspect  width per height of the picture
[[nodiscard]] double distanceToSee(std::span<const Vec3> points, const Camera& camera, const PictureArea& area,
                                   double aspect);

/// A rectangle of a picture [pixels from the upper left].
struct PixelArea {
  float left = 0, top = 0, right = 0, bottom = 0;
};

/// The part of a picture that panels leave free: of all rectangles between them the one whose shorter side is longest,
/// of several such the larger one.
/// @param width,height  of the picture [pixels]
[[nodiscard]] PictureArea freeArea(float width, float height, std::span<const PixelArea> panels);

}  // namespace lorica

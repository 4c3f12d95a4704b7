#pragma once

#include "viewer/renderer/scene.h"

#include <span>

namespace lorica {

/// A rectangle of a picture [pixels from the upper left].
struct PixelArea {
  float left = 0, top = 0, right = 0, bottom = 0;
};

/// A rectangle of a picture in clip space: x to the right and y up, from -1 to 1.
struct PictureArea {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  Eigen::Vector2d half = Eigen::Vector2d::Ones();  ///< half its width and height
};

/// The part of a picture that panels leave free: of all rectangles between them the one whose shorter side is longest,
/// of several such the larger one.
/// @param width,height  of the picture [pixels]
[[nodiscard]] PictureArea freeArea(float width, float height, std::span<const PixelArea> panels);

/// How far a camera has to be from its target, in its present direction, to have a whole box in an area [m].
/// @param camera  its target is in the middle of the area, see Camera::targetAt
/// @param aspect  width per height of the picture
[[nodiscard]] double distanceToSee(const Aabb& box, const Camera& camera, const PictureArea& area, double aspect);

}  // namespace lorica

#pragma once

#include "viewer/renderer/picture_area.h"

#include <span>

namespace lorica {

/// A rectangle of a picture [pixels from the upper left].
struct PixelArea {
  float left = 0, top = 0, right = 0, bottom = 0;
};

/// The part of a picture that panels leave free: of all rectangles between them the one whose shorter side is longest,
/// of several such the larger one.
/// @param width,height  of the picture [pixels]
[[nodiscard]] PictureArea freeArea(float width, float height, std::span<const PixelArea> panels);

}  // namespace lorica

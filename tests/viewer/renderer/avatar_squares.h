#pragma once

// Squares of 73 x 73 pixels that show a material, for tests of avatars.

#include "tests/viewer/renderer/avatars.h"
#include "tests/viewer/renderer/pictures.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace lorica::test {

inline constexpr int kSquareWidth = 160, kSquareHeight = 120;  ///< of the pictures
using Pixel = std::array<int, 3>;

inline void expectNear(const Pixel& found, const Pixel& expected, int tolerance, const std::string& what = "") {
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], tolerance) << what << ", channel " << c;
}

/// Where a point at the plane of the squares is seen, x and y from the centre of the square [m].
inline Pixel seen(const Image& image, double x = 0.0, double y = 0.0) {
  const auto [column, row] = seenAt({x, 1.0 + y, 0.0}, image.width, image.height);
  return pixelAt(image, static_cast<int>(column), static_cast<int>(row));
}

inline Image drawn(Studio& studio, const AvatarMaker& maker, const SceneOptions& options) {
  return studio.draw(AvatarOnStage(maker.avatar).scene(), options, frontCamera(), kSquareWidth, kSquareHeight);
}

inline Material unlit() {
  Material material;
  material.shading = Shading::kUnlit;
  return material;
}

}  // namespace lorica::test

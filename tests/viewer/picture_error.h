#pragma once

#include "viewer/image.h"

#include <string>

namespace lorica::test {

/// How two pictures of the same size differ, so that other processors' rounding does not count and a missing thing
/// does.
struct PictureError {
  double wrong = 1.0;  ///< share of pixels wholly wrong, 0 to 1
  Image shown;         ///< the first picture in grey, wholly wrong pixels in red
};

/// A pixel is wholly wrong when the other picture has no like colour at its place nor at the eight around it: edges may
/// move by a pixel. It is asked of both pictures, so that a thin line counts whichever of them lacks it. Colours are
/// alike when no channel differs by more than 40 of 255.
/// @return all wrong where the sizes differ
[[nodiscard]] PictureError pictureError(const Image& a, const Image& b);

/// Compares a picture with tests/golden/<name>.png. Above `kMostWrong` the test fails, and expected, found and
/// difference are kept side by side in the build folder, whose path the failure names. With LORICA_RENEW_GOLDEN=1 in
/// the environment the picture is written there instead.
void expectGolden(const std::string& name, const Image& picture);

/// The golden picture, or an empty one and a failed test.
[[nodiscard]] Image readGolden(const std::string& name);

/// Largest share of wholly wrong pixels that other processors and drivers may cause: 38 of 320 x 240.
inline constexpr double kMostWrong = 0.0005;

}  // namespace lorica::test

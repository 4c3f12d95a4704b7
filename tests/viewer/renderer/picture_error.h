#pragma once

#include "viewer/renderer/image.h"

#include <string>

namespace lorica::test {

/// How far a's pixel is from the most similar of b's nine at and around that position: the greatest difference of a
/// channel, 0 to 255. Edges may so move by a pixel. Both pictures have the same size.
[[nodiscard]] int differenceNearby(const Image& a, const Image& b, int x, int y);

/// Difference of two pictures of the same size, insensitive to rounding differences of other processors but sensitive
/// to missing objects.
struct PictureError {
  double wrong = 1.0;  ///< share of wrong pixels, 0 to 1
  Image shown;         ///< the first picture in grey, wrong pixels in red
};

/// A pixel is wrong if the other picture has no similar colour at its position or at the eight positions around it, so
/// edges may move by a pixel. Both pictures are tested, so a thin line counts if either picture lacks it. Colours are
/// similar if no channel differs by more than 40 of 255.
/// @return all pixels wrong if the sizes differ
[[nodiscard]] PictureError pictureError(const Image& a, const Image& b);

/// Compares a picture with tests/data/golden/<name>.png. Above `kMaxWrong` the test fails, and expected, found and
/// difference are saved side by side in the build folder; the failure message has the path. If the environment has
/// LORICA_RENEW_GOLDEN=1, the golden picture is replaced instead.
void expectGolden(const std::string& name, const Image& picture);

/// The golden picture, or an empty one and a failed test.
[[nodiscard]] Image readGolden(const std::string& name);

/// Maximum share of wrong pixels that other processors and drivers may cause: 38 of 320 x 240.
inline constexpr double kMaxWrong = 0.0005;

}  // namespace lorica::test

#pragma once

#include "viewer/renderer/image.h"

namespace lorica::test {

/// A picture of something on a plain background, and which pixels it covers.
struct MaskedPicture {
  Image picture;
  Image
      mask;  ///< grey, of the same size: the share of a pixel that is covered; from 120 on it counts as covered (half)
};

/// How alike two pictures of the same thing are.
struct Likeness {
  /// Pixels that both cover, as a share of those that either covers, 0 to 1.
  double silhouettes = 0.0;
  /// Share of the pixels covered by both that are wholly wrong, 0 to 1: no pixel at or next to the same position of the
  /// other picture, in either direction, is within 48 of 255 in each channel.
  double wrong = 1.0;
  /// Mean over the pixels covered by both, and over the channels, of the difference at the same position, 0 to 255.
  double meanDifference = 255.0;
  /// The differences: grey for likeness, brighter for more, red for wholly wrong; covered by one only: blue if by the
  /// first, yellow if by the second.
  Image shown;
};

/// @return nothing alike if the sizes differ or no pixel is covered by both
[[nodiscard]] Likeness likenessOf(const MaskedPicture& a, const MaskedPicture& b);

}  // namespace lorica::test

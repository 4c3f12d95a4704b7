#pragma once

#include "skinning/look/picture.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Reduces a picture row by row: each pixel of the result is the mean over its exact area, with colours weighted by
/// alpha. Where all is transparent, the plain mean of the colours. Sums are whole numbers, so the only error is the
/// last rounding to 8 bits.
class PictureShrink {
 public:
  /// `to` is at most as large as `from` in each direction.
  PictureShrink(PictureSize from, PictureSize to);

  /// Adds the next row of the stored picture: RGBA, from.width pixels.
  void add(std::span<const std::uint8_t> row);

  /// The result, after from.height rows.
  [[nodiscard]] Picture take() { return std::move(to_); }

 private:
  void finishRow();

  PictureSize from_;
  Picture to_;
  std::int64_t rowsAdded_ = 0;
  int toRow_ = 0;
  std::vector<std::uint32_t> across_;  ///< sums of one stored row, kSums for each pixel of a result row
  std::vector<std::uint64_t> sums_;    ///< sums of the stored rows of one result row
};

/// Reduces a whole picture to limitedSize().
[[nodiscard]] Picture shrunk(Picture picture, int largestSide);

}  // namespace lorica

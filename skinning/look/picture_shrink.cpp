#include "skinning/look/picture_shrink.h"

#include <algorithm>

namespace lorica {
namespace {

// Of each pixel of the result: red, green and blue times alpha, alpha, and red, green and blue alone.
constexpr std::size_t kSums = 7;

}  // namespace

PictureSize limitedSize(PictureSize size, int largestSide) {
  const std::int64_t largest = std::max(size.width, size.height);
  if (largestSide <= 0 || largest <= largestSide) return size;
  const auto limited = [&](std::int64_t side) {
    return std::max(1, static_cast<int>((2 * side * largestSide + largest) / (2 * largest)));
  };
  return {limited(size.width), limited(size.height)};
}

PictureShrink::PictureShrink(PictureSize from, PictureSize to) : from_(from) {
  to_.width = to.width;
  to_.height = to.height;
  const std::size_t width = to.width;
  to_.rgba.resize(width * to.height * 4);
  across_.resize(width * kSums);
  sums_.resize(width * kSums);
}

// Lengths are counted in steps of which a stored pixel has as many as the result has pixels, and a pixel of the result
// as many as are stored. Then all borders are whole, and a stored pixel lies in at most two of the result.
void PictureShrink::add(std::span<const std::uint8_t> row) {
  // A row's sums are at most 16,384 x 255 x 255, which 32 bits hold.
  std::ranges::fill(across_, 0U);
  const std::uint32_t steps = to_.width;
  std::uint32_t left = from_.width;
  std::uint32_t* sums = across_.data();
  const auto addPixel = [&](const std::uint8_t* pixel, std::uint32_t weight) {
    const std::uint32_t alpha = weight * pixel[3];
    for (std::size_t c = 0; c < 3; ++c) {
      sums[c] += alpha * pixel[c];
      sums[4 + c] += weight * pixel[c];
    }
    sums[3] += alpha;
  };
  for (std::size_t x = 0; x < static_cast<std::size_t>(from_.width); ++x) {
    const std::uint8_t* pixel = &row[x * 4];
    const std::uint32_t here = std::min(steps, left);
    addPixel(pixel, here);
    left -= here;
    if (left > 0) continue;
    left = from_.width;
    if (x + 1 < static_cast<std::size_t>(from_.width)) sums += kSums;
    if (here < steps) {
      addPixel(pixel, steps - here);
      left -= steps - here;
    }
  }

  const auto addRow = [&](std::int64_t weight) {
    for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += static_cast<std::uint64_t>(weight) * across_[i];
  };
  const std::int64_t begin = rowsAdded_ * to_.height;
  const std::int64_t border = (std::int64_t{toRow_} + 1) * from_.height;
  const std::int64_t end = begin + to_.height;
  ++rowsAdded_;
  addRow(std::min(end, border) - begin);
  if (end < border) return;
  finishRow();
  if (end > border) addRow(end - border);
}

void PictureShrink::finishRow() {
  const auto area = static_cast<std::uint64_t>(from_.width) * from_.height;
  const auto mean = [](std::uint64_t sum, std::uint64_t count) {
    return static_cast<std::uint8_t>((sum + count / 2) / count);
  };
  const std::size_t width = to_.width;
  std::uint8_t* pixel = &to_.rgba[static_cast<std::size_t>(toRow_) * width * 4];
  for (std::size_t x = 0; x < width; ++x, pixel += 4) {
    const std::uint64_t* sums = &sums_[x * kSums];
    const std::uint64_t alpha = sums[3];
    for (std::size_t c = 0; c < 3; ++c) pixel[c] = alpha > 0 ? mean(sums[c], alpha) : mean(sums[4 + c], area);
    pixel[3] = mean(alpha, area);
  }
  std::ranges::fill(sums_, 0U);
  ++toRow_;
}

Picture shrunk(Picture picture, int largestSide) {
  const PictureSize size{picture.width, picture.height};
  const PictureSize wanted = limitedSize(size, largestSide);
  if (wanted.width == size.width && wanted.height == size.height) return picture;
  PictureShrink shrink(size, wanted);
  const std::size_t rowBytes = static_cast<std::size_t>(size.width) * 4;
  for (std::size_t y = 0; y < static_cast<std::size_t>(size.height); ++y) {
    shrink.add(std::span(picture.rgba).subspan(y * rowBytes, rowBytes));
  }
  return shrink.take();
}

}  // namespace lorica

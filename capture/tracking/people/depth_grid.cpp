#include "capture/tracking/people/depth_grid.h"

#include "capture/tracking/fit/body_view.h"

#include <algorithm>
#include <cstdlib>

namespace lorica {

namespace {

constexpr int kMarginShare = 12;  // sensors leave margins empty that are narrower than one of so many parts ...
constexpr int kWideShare = 5;     // ... or of so many, if the image is full up to there: depth aligned to a picture
constexpr int kFilledShare = 3;   // then at least one of so many parts of the line beside the margin is measured

}  // namespace

float depthNoise(float depth) {
  const float past = depth - 0.4F;
  return 0.0012F + 0.0019F * past * past + 0.0003F * depth * depth;
}

DepthGrid::DepthGrid(const DepthCamera& camera)
    : step(fit::isSmall(camera) ? 1 : 2),
      width(camera.width / step),
      height(camera.height / step),
      cellArea(static_cast<double>(step) * step / (camera.focalX() * camera.focalY())),
      depthMm(static_cast<std::size_t>(width) * height),
      imageWidth_(camera.width),
      columnCount_(width),
      rowCount_(height) {
  const double half = 0.5 * (step - 1);
  rayX.reserve(width);
  rayY.reserve(height);
  for (int c = 0; c < width; ++c) rayX.push_back(camera.positionOf(c * step + half, 0, 1.0).x());
  for (int r = 0; r < height; ++r) rayY.push_back(camera.positionOf(0, r * step + half, 1.0).y());
}

void DepthGrid::fill(std::span<const std::uint16_t> image) {
  std::ranges::fill(columnCount_, std::uint16_t{0});
  firstRow = height;
  lastRow = -1;
  for (int r = 0; r < height; ++r) {
    const std::uint16_t* upper = image.data() + static_cast<std::size_t>(r) * step * imageWidth_;
    const std::uint16_t* lower = upper + (step == 2 ? imageWidth_ : 0);
    std::uint16_t* cells = depthMm.data() + index(0, r);
    int measured = 0;
    for (int c = 0; c < width; ++c) {
      std::uint16_t d = 0;
      if (step == 2) {
        // The upper left pixel; if it is missing, another one of the block.
        const std::uint16_t a = upper[2 * c], b = lower[2 * c + 1], e = upper[2 * c + 1], f = lower[2 * c];
        const std::uint16_t others = b != 0 ? b : (e != 0 ? e : f);
        d = a != 0 ? a : others;
      } else {
        d = upper[c];
      }
      cells[c] = d;
      const std::uint16_t one = d != 0;
      columnCount_[c] = columnCount_[c] + one;
      measured += one;
    }
    rowCount_[r] = measured;
    if (measured * 20 >= width) {
      firstRow = std::min(firstRow, r);
      lastRow = r;
    }
  }
  firstColumn = width;
  lastColumn = -1;
  for (int c = 0; c < width; ++c) {
    if (columnCount_[c] * 20 < height) continue;
    firstColumn = std::min(firstColumn, c);
    lastColumn = c;
  }
  // A wider margin is no property of the sensor: nothing is there.
  const auto bound = [](int& line, int from, int size, int measured, int across) {
    const int share = measured * kFilledShare >= across ? kWideShare : kMarginShare;
    if (std::abs(line - from) > size / share) line = from;
  };
  const auto inColumn = [&](int c) { return c >= 0 && c < width ? int{columnCount_[c]} : 0; };
  const auto inRow = [&](int r) { return r >= 0 && r < height ? int{rowCount_[r]} : 0; };
  bound(firstColumn, 0, width, inColumn(firstColumn), height);
  bound(lastColumn, width - 1, width, inColumn(lastColumn), height);
  bound(firstRow, 0, height, inRow(firstRow), width);
  bound(lastRow, height - 1, height, inRow(lastRow), width);
}

}  // namespace lorica

#include "capture/tracking/people/depth_grid.h"

#include <algorithm>

namespace lorica {

namespace {

constexpr int kMarginShare = 12;  // sensors leave margins empty that are narrower than one of so many parts

}  // namespace

float depthNoise(float depth) {
  const float past = depth - 0.4F;
  return 0.0012F + 0.0019F * past * past + 0.0003F * depth * depth;
}

DepthGrid::DepthGrid(const DepthCamera& camera)
    : step(camera.width < 400 ? 1 : 2),
      width(camera.width / step),
      height(camera.height / step),
      cellArea(static_cast<double>(step) * step / (camera.focalX() * camera.focalY())),
      depthMm(static_cast<std::size_t>(width) * height),
      imageWidth_(camera.width),
      columnCount_(width) {
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
  if (firstColumn > width / kMarginShare) firstColumn = 0;
  if (lastColumn < width - 1 - width / kMarginShare) lastColumn = width - 1;
  if (firstRow > height / kMarginShare) firstRow = 0;
  if (lastRow < height - 1 - height / kMarginShare) lastRow = height - 1;
}

}  // namespace lorica

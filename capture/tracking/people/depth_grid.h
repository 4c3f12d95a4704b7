#pragma once

#include "capture/sensor/depth_frame.h"
#include "geometry/math.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Noise of measured depth, about one standard deviation [m]: axial noise and quantisation of a Kinect-like sensor
/// (Khoshelham & Elberink 2012; Nguyen et al. 2012).
/// @param depth  [m]
[[nodiscard]] float depthNoise(float depth);

/// Lookup table of a function of depth. Steps of 16 mm, up to the largest depth that 16 bits hold.
class DepthTable {
 public:
  template <typename Function>
  explicit DepthTable(const Function& metresOfMetres) {
    for (std::size_t i = 0; i < values_.size(); ++i) values_[i] = metresOfMetres((i + 0.5) * 0.016);
  }
  [[nodiscard]] float operator[](std::uint16_t depthMm) const { return values_[depthMm >> 4U]; }

 private:
  std::array<float, 4096> values_{};
};

/// A depth image at about half its size, in which people are searched for. A cell holds one measured pixel of its
/// block.
struct DepthGrid {
  /// Blocks of 2 x 2 pixels; of one pixel if the image is small.
  explicit DepthGrid(const DepthCamera& camera);

  /// @param depthMm  width x height of the camera
  void fill(std::span<const std::uint16_t> depthMm);

  /// @return camera frame [m]
  [[nodiscard]] Vec3f positionOf(int column, int row) const {
    const float depth = 0.001F * depthMm[index(column, row)];
    return {depth * rayX[column], depth * rayY[row], -depth};
  }
  [[nodiscard]] std::size_t index(int column, int row) const { return static_cast<std::size_t>(row) * width + column; }
  [[nodiscard]] std::size_t cellCount() const { return depthMm.size(); }
  /// Calls visit(cell) for the cells to the left and right of a cell, above and below it, that are in the image.
  template <typename Visit>
  void visitNeighbours(std::size_t cell, const Visit& visit) const {
    const std::size_t w = width, column = cell % w, row = cell / w;
    if (column > 0) visit(cell - 1);
    if (column + 1 < w) visit(cell + 1);
    if (row > 0) visit(cell - w);
    if (row + 1 < static_cast<std::size_t>(height)) visit(cell + w);
  }
  /// Width of the original image; its last column and row are left out if the size is not a multiple of the block.
  [[nodiscard]] int imageWidth() const { return imageWidth_; }

  int step = 2;  ///< pixels to a cell, along either axis
  int width = 0;
  int height = 0;
  double cellArea = 0.0;               ///< of a cell that faces the camera at a depth of 1 m [m^2]
  std::vector<std::uint16_t> depthMm;  ///< width x height, top row first; 0 = nothing measured in the block
  std::vector<float> rayX;             ///< x of a column at depth 1
  std::vector<float> rayY;             ///< y of a row at depth 1
  int firstColumn = 0,
      lastColumn = 0;  ///< range in which the sensor measures, inclusive: it may leave narrow margins empty
  int firstRow = 0, lastRow = 0;

 private:
  int imageWidth_ = 0;
  std::vector<std::uint16_t> columnCount_, rowCount_;  ///< of measured cells
};

}  // namespace lorica

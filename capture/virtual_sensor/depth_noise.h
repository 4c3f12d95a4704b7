#pragma once

#include "capture/virtual_sensor/depth_render.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Error model of a structured-light camera of 2010. Each error can be disabled with a zero; clean() disables all.
struct DepthNoiseSettings {
  std::uint64_t seed = 2026;
  /// Factor of the axial noise 0.0012 + 0.0019 (z - 0.4)^2 m (Nguyen et al. 2012), including quantisation; more at
  /// grazing angles.
  double axial = 1.0;
  double lateral = 0.8;     ///< standard deviation of edge positions [pixels]
  double baseline = 0.075;  ///< projector position to the right of the camera; areas that it does not illuminate are
                            ///< missing [m]
  /// Factor of the depth steps, 1/8 pixel of disparity (Khoshelham and Elberink 2012): 2.9e-3 z^2 m. 0 = whole mm.
  double steps = 1.0;
  double dropout = 0.02;  ///< fraction of pixels missing at random, in clumps
  bool grazing = true;    ///< surfaces at more than about 70 degrees from their normal are missing
  double min = 0.5;       ///< min range; nearer pixels are missing [m]
  double max = 8.0;       ///< max range; farther pixels are missing [m]

  /// Depth rounded to whole millimetres; nothing is missing within the range.
  [[nodiscard]] static DepthNoiseSettings clean();
  /// All kinds of errors, but a fifth of the axial noise and of the dropout: compresses well.
  [[nodiscard]] static DepthNoiseSettings mild();

  friend bool operator==(const DepthNoiseSettings&, const DepthNoiseSettings&) = default;
};

/// Converts ideal depth to the depth of a Kinect v1. See docs/VIRTUAL_SENSOR.md for the model and its sources.
///
/// The same seed and frame number give the same image on every machine. Allocates nothing per frame.
class DepthNoise {
 public:
  DepthNoise(const DepthCamera& camera, const DepthNoiseSettings& settings);

  [[nodiscard]] const DepthNoiseSettings& settings() const { return settings_; }

  /// @param inverseDepth  width x height, see DepthRenderer [1/m]
  /// @param frame         frame number: selects the noise
  /// @param depthMm       width x height, written [mm]
  void apply(std::span<const float> inverseDepth, std::uint64_t frame, std::span<std::uint16_t> depthMm);

 private:
  /// Normal deviates on a lattice of square cells; bilinear interpolation of four values, normalised to variance 1.
  struct Field {
    int cell = 4, columns = 0, rows = 0;
    std::vector<float> values;   ///< columns x rows
    std::vector<float> weights;  ///< cell x cell x 4
    void resize(const DepthCamera& camera, int cellSize);
    void draw(std::uint64_t seed);
    /// Writes the values of one pixel row.
    void readRow(int row, std::span<float> out) const;
  };

  void findLit(std::span<const float> inverseDepth);
  void findSurface(std::span<const float> inverseDepth);

  DepthCamera camera_;
  DepthNoiseSettings settings_;
  float disparityOfInverse_;                ///< disparity steps per 1/m
  std::vector<float> lit_;                  ///< inverse depth; 0 where the projector does not reach
  std::vector<float> spread_;               ///< standard deviation of the disparity [steps]
  std::vector<float> threshold_;            ///< the pixel is missing if its deviate exceeds this
  std::vector<std::int8_t> jitter_;         ///< lattice of offsets: columns, rows
  std::vector<std::uint16_t> millimetres_;  ///< depth of a disparity [mm], one per step
  Field smooth_, clumps_;
  std::vector<float> smoothRow_, clumpsRow_;
  std::vector<float> rayX_;  ///< x of a ray at depth 1, one per column
};

}  // namespace lorica

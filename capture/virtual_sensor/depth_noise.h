#pragma once

#include "capture/virtual_sensor/depth_render.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// How a structured-light camera of 2010 errs. Each part can be turned off by a zero; clean() turns off all.
struct DepthNoiseSettings {
  std::uint64_t seed = 2026;
  /// Times the axial noise 0.0012 + 0.0019 (z - 0.4)^2 m (Nguyen et al. 2012), quantisation included; more at grazing
  /// angles.
  double axial = 1.0;
  double lateral = 0.8;     ///< standard deviation of where edges lie [pixels]
  double baseline = 0.075;  ///< projector, to the right of the camera; what it cannot light up is missing [m]
  /// Times the steps of depth, 1/8 pixel of disparity (Khoshelham and Elberink 2012): 2.9e-3 z^2 m. 0 = whole mm.
  double steps = 1.0;
  double dropout = 0.02;  ///< part of the pixels that are missing at random, in clumps
  bool grazing = true;    ///< surfaces seen under more than about 70 degrees go missing
  double least = 0.5;     ///< range; nearer is missing [m]
  double most = 8.0;      ///< range; further is missing [m]

  /// Depth rounded to whole millimetres, nothing missing within the range.
  [[nodiscard]] static DepthNoiseSettings clean();
  /// All of the kinds, but a fifth of the axial noise and of the dropout: what compresses well.
  [[nodiscard]] static DepthNoiseSettings mild();

  friend bool operator==(const DepthNoiseSettings&, const DepthNoiseSettings&) = default;
};

/// Makes of clean depth what a Kinect v1 would give. See docs/VIRTUAL_SENSOR.md for the model and its sources.
///
/// The same seed and frame number give the same image, on every machine. Allocates nothing per frame.
class DepthNoise {
 public:
  DepthNoise(const DepthCamera& camera, const DepthNoiseSettings& settings);

  [[nodiscard]] const DepthNoiseSettings& settings() const { return settings_; }

  /// @param inverseDepth  width x height, see DepthRenderer [1/m]
  /// @param frame         number of the frame: chooses the noise
  /// @param depthMm       width x height, written [mm]
  void apply(std::span<const float> inverseDepth, std::uint64_t frame, std::span<std::uint16_t> depthMm);

 private:
  /// Normal deviates on a lattice of square cells; four values a cell, read bilinearly, variance 1 everywhere.
  struct Field {
    int cell = 4, columns = 0, rows = 0;
    std::vector<float> values;   ///< columns x rows
    std::vector<float> weights;  ///< cell x cell x 4
    void resize(const DepthCamera& camera, int cellSize);
    void draw(std::uint64_t seed);
    /// The values of a row of pixels.
    void readRow(int row, std::span<float> out) const;
  };

  void findLit(std::span<const float> inverseDepth);
  void findSurface(std::span<const float> inverseDepth);

  DepthCamera camera_;
  DepthNoiseSettings settings_;
  float disparityOfInverse_;                ///< steps of disparity per 1/m
  std::vector<float> lit_;                  ///< inverse depth; 0 where the projector does not reach
  std::vector<float> spread_;               ///< standard deviation of the disparity [steps]
  std::vector<float> threshold_;            ///< deviate above which the pixel is missing
  std::vector<std::int8_t> jitter_;         ///< a lattice of offsets: columns, rows
  std::vector<std::uint16_t> millimetres_;  ///< depth of a disparity [mm], one a step
  Field smooth_, clumps_;
  std::vector<float> smoothRow_, clumpsRow_;
  std::vector<float> rayX_;  ///< of a ray of depth 1, one a column
};

}  // namespace lorica

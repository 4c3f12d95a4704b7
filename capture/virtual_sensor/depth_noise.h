#pragma once

#include "capture/virtual_sensor/depth_render.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace lorica {

/// The named error models, see docs/VIRTUAL_SENSOR.md.
enum class DepthNoiseKind : std::uint8_t {
  kKinect,  ///< structured light, Kinect v1: set from recordings
  kMild,    ///< a fifth of the axial noise and of the missing pixels of 2012's models of a Kinect v1
  kNone,    ///< whole millimetres
};
inline constexpr int kDepthNoiseKindCount = 3;

/// "kinect", "mild", "none".
[[nodiscard]] std::string_view nameOf(DepthNoiseKind kind);
[[nodiscard]] std::optional<DepthNoiseKind> depthNoiseNamed(std::string_view name);

/// Standard deviation of the depth of a surface at distance z under an angle theta from its normal, in metres:
/// base + quadratic (z - nearest)^2 + (angle + angleFar z^2) z^-1/2 theta^2 / (pi/2 - theta)^2.
struct AxialNoise {
  double base = 0.0012, quadratic = 0.0019, nearest = 0.4;
  double angle = 0.0001, angleFar = 0.0;

  friend bool operator==(const AxialNoise&, const AxialNoise&) = default;
};

/// Error model of a depth camera; the default is a Kinect v1. Each error can be disabled with a zero; clean() disables
/// all. Sizes in pixels are those of `sensor`; an image of another resolution is treated as if it were scaled.
struct DepthNoiseSettings {
  std::uint64_t seed = 2026;
  DepthCamera sensor;  ///< resolution and view of the modelled camera
  double axial = 1.0;  ///< factor of the axial noise, which includes quantisation
  AxialNoise axialNoise;
  /// Shares of the variance of axial noise, without quantisation, that neighbouring pixels have in common: the part
  /// that stays as long as the scene does, and the part that is new in each frame. The rest is each pixel's own.
  double lasting = 0.9, shared = 0.0;
  double smoothness = 5.0;  ///< distance at which pixels have little in common [pixels]
  double lateral = 0.8;     ///< standard deviation of edge positions [pixels]
  double smear = 0.0;       ///< edges become ramps, twice this wide; holes within them are filled [pixels]
  double baseline = 0.075;  ///< projector position to the right of the camera; areas that it does not illuminate are
                            ///< missing [m]
  double edgeLoss = 3.0;    ///< width of the missing strip right of near things [pixels]
  /// Factor of the depth steps of a Kinect v1, 1/8 pixel of disparity (Khoshelham and Elberink 2012): 2.9e-3 z^2 m,
  /// whatever the resolution. 0 = whole mm.
  double steps = 1.0;
  double dropout = 0.004;  ///< fraction of pixels missing at random, in clumps
  bool grazing = true;     ///< surfaces at more than about 70 degrees from their normal are missing
  double min = 0.5;        ///< min range; nearer pixels are missing [m]
  double max = 8.0;        ///< max range; farther pixels are missing [m]

  [[nodiscard]] static DepthNoiseSettings of(DepthNoiseKind kind);
  /// Depth rounded to whole millimetres; nothing is missing within the range.
  [[nodiscard]] static DepthNoiseSettings clean();
  /// All kinds of errors, but little axial noise, new in each frame, and few missing pixels: compresses well.
  [[nodiscard]] static DepthNoiseSettings mild();

  friend bool operator==(const DepthNoiseSettings&, const DepthNoiseSettings&) = default;
};

/// Converts ideal depth to the depth of a real camera. See docs/VIRTUAL_SENSOR.md for the model and its sources.
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
  void loseEdges(std::span<const float> inverseDepth);
  void smear();
  void findSurface(std::span<const float> inverseDepth);

  DepthCamera camera_;
  DepthNoiseSettings settings_;
  double scale_;                            ///< pixels of the image for each pixel of the modelled sensor
  int jitterCell_;                          ///< edges are displaced in blocks of this size [pixels]
  int smearWidth_;                          ///< [pixels]
  int edgeLossWidth_;                       ///< [pixels]
  float disparityOfInverse_;                ///< disparity steps per 1/m
  std::vector<float> lit_;                  ///< inverse depth; 0 where the projector does not reach
  std::vector<float> spread_;               ///< standard deviation of the disparity [steps]
  std::vector<float> threshold_;            ///< the pixel is missing if its deviate exceeds this
  std::vector<std::int8_t> jitter_;         ///< lattice of offsets: columns, rows
  std::vector<std::uint16_t> millimetres_;  ///< depth of a disparity [mm], one per step
  Field lasting_, smooth_, clumps_;
  std::vector<float> lastingRow_, smoothRow_, clumpsRow_;
  std::vector<float> weight_, sums_;  ///< of smear(); empty if nothing is smeared
  std::vector<float> rayX_;           ///< x of a ray at depth 1, one per column
};

}  // namespace lorica

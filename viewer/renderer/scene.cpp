#include "viewer/renderer/scene.h"

#include <array>
#include <cmath>
#include <numbers>

namespace lorica {
namespace {

/// OKLCH to linear sRGB (B. Ottosson, "A perceptual color space for image processing", 2020); may be outside 0 to 1.
Vec3 linearFromOklch(double lightness, double chroma, double hue) {
  const double a = chroma * std::cos(hue);
  const double b = chroma * std::sin(hue);
  const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
  const double m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
  const double s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

}  // namespace

Vec3f partColor(PartIndex part) {
  // Four levels of lightness; in each, the 32 parts are distributed over the hues. The angle was found by search: the
  // nearest two of 32 colours differ by 0.06 in OKLab (0.02 is just noticeable), consecutive ones by 0.24.
  constexpr std::array<double, 4> kLightness = {0.74, 0.62, 0.84, 0.68};
  constexpr std::array<double, 4> kChroma = {0.14, 0.14, 0.11, 0.14};
  constexpr double kStep = 140.0 * std::numbers::pi / 180.0;
  constexpr double kYellow = 1.83;  // hue that gets more lightness, and blues less, otherwise yellow looks brown
  const auto i = static_cast<std::uint32_t>(part);
  const double hue = 4.0 + kStep * i;
  const double lightness = kLightness[i % 4] + 0.05 * std::cos(hue - kYellow);
  Vec3 color = Vec3::Zero();
  for (double chroma = kChroma[i % 4]; chroma > 0.0; chroma -= 0.01) {
    color = linearFromOklch(lightness, chroma, hue);
    if (color.minCoeff() >= 0.0 && color.maxCoeff() <= 1.0) break;
  }
  return color.cwiseMax(0.0).cwiseMin(1.0).cast<float>();
}

}  // namespace lorica

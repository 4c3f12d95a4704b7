#include "viewer/player/depth_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lorica {
namespace {

constexpr double kNearest = 500.0, kFar = 5000.0;  // depths of the lightest and the darkest grey [mm]
constexpr int kDot = 3;                            // radius [pixels of the picture]

using Color = std::array<std::uint8_t, 3>;
constexpr Color kSeen = {60, 220, 90}, kGuessed = {250, 160, 40};

void paint(Image& picture, int x, int y, const Color& color) {
  if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return;
  const std::size_t at = 4 * (static_cast<std::size_t>(y) * picture.width + x);
  std::copy(color.begin(), color.end(), picture.rgba.begin() + at);
}

std::uint8_t shade(std::uint16_t depthMm) {
  if (depthMm == 0) return 0;
  const double nearness = (kFar - depthMm) / (kFar - kNearest);
  return std::lround(40.0 + 190.0 * std::clamp(nearness, 0.0, 1.0));
}

}  // namespace

void drawDepthPicture(const DepthCamera& camera, const DepthSight& sight, Image& picture) {
  const DepthFrame& depth = sight.image;
  if (depth.depthMm.empty()) return;
  picture.width = camera.width / 2;
  picture.height = camera.height / 2;
  picture.rgba.assign(4 * static_cast<std::size_t>(picture.width) * picture.height, 255);
  for (int y = 0; y < picture.height; ++y) {
    const std::uint16_t* row = depth.depthMm.data() + 2 * static_cast<std::ptrdiff_t>(y) * camera.width;
    for (int x = 0; x < picture.width; ++x) {
      const std::uint8_t value = shade(row[2 * x]);
      paint(picture, x, y, {value, value, value});
    }
  }
  for (const TrackedJoint& joint : sight.joints.joints) {
    if (joint.confidence <= 0.0) continue;
    const Vec3 position = sight.cameraFromWorld * joint.position;
    if (position.z() > -0.1) continue;
    const Eigen::Vector2d middle = 0.5 * camera.imagePointOf(position);
    const int cx = std::lround(middle.x()), cy = std::lround(middle.y());
    for (int dy = -kDot; dy <= kDot; ++dy) {
      for (int dx = -kDot; dx <= kDot; ++dx) {
        if (dx * dx + dy * dy <= kDot * kDot)
          paint(picture, cx + dx, cy + dy, joint.confidence < 0.75 ? kGuessed : kSeen);
      }
    }
  }
}

}  // namespace lorica

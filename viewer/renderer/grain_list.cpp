#include "viewer/renderer/grain_list.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lorica {

GrainLook lookOfGrain(std::uint32_t index) {
  // PCG's output function: M. O'Neill, "PCG", 2014.
  const auto mixed = [](std::uint32_t h) {
    h = h * 747796405u + 2891336453u;
    return ((h >> ((h >> 28u) + 4u)) ^ h) * 277803737u;
  };
  const std::uint32_t h = mixed(index), k = mixed(h);
  const Vec3f shift((k & 0x3ffu) / 1023.0f, (k >> 10u & 0x3ffu) / 1023.0f, (k >> 20u & 0x3ffu) / 1023.0f);
  return {0.8f + 0.4f / 65535.0f * (h >> 16u), 0.85f + 0.3f / 65535.0f * (h & 0xffffu),
          0.4f * (2.0f * shift - Vec3f::Ones())};
}

const std::vector<std::uint32_t>& GrainList::choose(std::span<const Vec3f> centers, const GrainView& view,
                                                    float margin) {
  chosen_.clear();
  const bool hides = std::isfinite(margin);
  const std::size_t count = centers.size();
  depth_.resize(count);
  cell_.resize(count);
  nearest_.assign(static_cast<std::size_t>(view.columns) * view.rows, std::numeric_limits<float>::max());
  const Eigen::Matrix4f& m = view.clipFromWorld;
  const float perX = 0.5f / kBeside * view.columns;
  const float perY = 0.5f / kBeside * view.rows;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f& p = centers[i];
    const float w = m(3, 0) * p.x() + m(3, 1) * p.y() + m(3, 2) * p.z() + m(3, 3);
    const float x = m(0, 0) * p.x() + m(0, 1) * p.y() + m(0, 2) * p.z() + m(0, 3);
    const float y = m(1, 0) * p.x() + m(1, 1) * p.y() + m(1, 2) * p.z() + m(1, 3);
    cell_[i] = -1;
    const float reach = kBeside * w;
    if (!(std::abs(x) < reach && std::abs(y) < reach)) continue;  // behind, outside or not finite
    const auto column = std::min<int>((x / w + kBeside) * perX, view.columns - 1);
    const auto row = std::min<int>((y / w + kBeside) * perY, view.rows - 1);
    cell_[i] = row * view.columns + column;
    const Eigen::Vector4f& d = view.depthFromWorld;
    depth_[i] = d.x() * p.x() + d.y() * p.y() + d.z() * p.z() + d.w();
    float& nearest = nearest_[cell_[i]];
    nearest = std::min(nearest, depth_[i]);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (cell_[i] < 0) continue;
    if (hides && depth_[i] > nearest_[cell_[i]] + margin) continue;
    chosen_.push_back(i);
  }
  return chosen_;
}

}  // namespace lorica

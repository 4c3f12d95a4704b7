#include "capture/tracking/people/person_split.h"

#include <cmath>
#include <cstdlib>

namespace lorica {

namespace {

constexpr float kCore = 0.2F;    // within this distance of a person's axis, a cell is certainly theirs [m]
constexpr float kAlien = 0.35F;  // nearer to another's axis by this: no longer the person's [m]
constexpr int kSameDepth = 120;  // [mm]

bool holds(unsigned slotMask, int slot) {
  return (slotMask & (1U << slot)) != 0;
}

}  // namespace

void PersonSplit::apply(const DepthGrid& grid, const ComponentFinder& finder, const FloorPositions& positions,
                        std::size_t component, unsigned slotMask, std::span<const SplitShare> shares,
                        const LastCells& last, std::span<std::uint8_t> person) {
  const DepthComponent& one = finder.components()[component];
  const std::int32_t label = component;
  const std::span<const std::int32_t> labels = finder.labels();
  queue_.clear();
  for (int r = one.top; r <= one.bottom; ++r) {
    for (int c = one.left; c <= one.right; ++c) {
      const std::size_t i = grid.index(c, r);
      if (labels[i] != label) continue;

      const Vec3f position = positions(grid, c, r);
      std::array<float, kPersonSlots> away{};
      int closest = -1;
      float next = 1e9F;  // distance of the second closest axis
      for (int k = 0; k < kPersonSlots; ++k) {
        if (!holds(slotMask, k)) continue;
        const Vec3f apart = position - shares[k].middle;
        const float distance = away[k] = std::hypot(apart.x(), apart.z());
        if (closest < 0 || distance < away[closest]) {
          if (closest >= 0) next = away[closest];
          closest = k;
        } else if (distance < next) {
          next = distance;
        }
      }
      const float min = away[closest];
      if (min < kCore && min < 0.5F * next) {
        person[i] = closest + 1;
        queue_.push_back(i);
        continue;
      }
      int nearest = kSameDepth;
      for (int k = 0; k < kPersonSlots; ++k) {
        if (!holds(slotMask, k) || away[k] > min + kAlien) continue;
        const SplitShare& share = shares[k];
        const int column = c - share.columns, row = r - share.rows;
        if (column < 0 || column >= grid.width || row < 0 || row >= grid.height) continue;
        const std::size_t before = grid.index(column, row);
        const int off = std::abs(grid.depthMm[i] - last.depthMm[before]);
        if (last.person[before] != k + 1 || off >= nearest) continue;
        nearest = off;
        person[i] = k + 1;
      }
      if (person[i] != 0) queue_.push_back(i);
    }
  }
  grow(grid, finder, label, 0.5F, person);
  grow(grid, finder, label, 1.0F, person);
}

void PersonSplit::grow(const DepthGrid& grid, const ComponentFinder& finder, std::int32_t label, float steps,
                       std::span<std::uint8_t> person) {
  const std::span<const std::int32_t> labels = finder.labels();
  const std::size_t w = grid.width;
  for (std::size_t next = 0; next < queue_.size(); ++next) {
    const std::size_t i = queue_[next];
    const std::size_t column = i % w, row = i / w;
    const float step = 1000.0F * steps * finder.step(grid.depthMm[i]);
    const auto visit = [&](bool inside, std::size_t j) {
      if (!inside || labels[j] != label || person[j] != 0) return;
      if (std::abs(grid.depthMm[i] - grid.depthMm[j]) >= step) return;
      person[j] = person[i];
      queue_.push_back(j);
    };
    visit(column > 0, i - 1);
    visit(column + 1 < w, i + 1);
    visit(row > 0, i - w);
    visit(row + 1 < static_cast<std::size_t>(grid.height), i + w);
  }
}

}  // namespace lorica

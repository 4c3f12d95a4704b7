#include "capture/tracking/people/person_image.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace lorica {

void paintPeople(const DepthGrid& grid, const ComponentFinder& finder, std::span<const std::uint16_t> depthMm,
                 std::span<const std::uint8_t> numbers, std::span<const std::uint8_t> person,
                 std::span<PersonSegment> people, std::span<std::uint8_t> labels) {
  for (std::size_t i = 0; i < labels.size(); ++i) labels[i] = depthMm[i] == 0 ? 255 : 0;
  if (people.empty()) return;

  const int pixelWidth = grid.width * grid.step;
  const std::size_t stride = grid.imageWidth();
  for (int r = 0; r < grid.height; ++r) {
    for (int c = 0; c < grid.width; ++c) {
      // Most cells are surrounded by cells of the same label.
      const int left = std::max(c - 1, 0), right = std::min(c + 1, grid.width - 1);
      const int above = std::max(r - 1, 0), below = std::min(r + 1, grid.height - 1);
      const std::size_t cell = grid.index(c, r);
      const std::uint8_t own = person[cell];
      bool same = true;
      for (int y = above; y <= below && same; ++y) {
        for (int x = left; x <= right; ++x) same = same && person[grid.index(x, y)] == own;
      }
      if (same && own == 0) continue;
      for (int dy = 0; dy < grid.step; ++dy) {
        for (int dx = 0; dx < grid.step; ++dx) {
          const std::size_t pixel = static_cast<std::size_t>(r * grid.step + dy) * stride + (c * grid.step + dx);
          const int depth = depthMm[pixel];
          if (depth == 0) continue;
          std::uint8_t slot = own;
          const float step = 1000.0F * finder.step(depth);
          int nearest = std::abs(depth - grid.depthMm[cell]);
          if (!same && nearest > 0.5F * step) {
            for (int y = above; y <= below; ++y) {
              for (int x = left; x <= right; ++x) {
                const std::size_t other = grid.index(x, y);
                const int off = std::abs(depth - grid.depthMm[other]);
                if (off >= nearest) continue;
                nearest = off;
                slot = person[other];
              }
            }
          }
          // Noise within a person still belongs to the person; a hole in the middle does not.
          if (nearest > (same ? 3.0F : 1.0F) * step) slot = 0;
          if (slot == 0 || numbers[slot - 1U] == 0) continue;
          labels[pixel] = numbers[slot - 1U];
          PersonSegment& one = people[numbers[slot - 1U] - 1U];
          const int x = c * grid.step + dx, y = r * grid.step + dy;
          one.left = std::min(one.left, x);
          one.right = std::max(one.right, x + 1);
          one.top = std::min(one.top, y);
          one.bottom = std::max(one.bottom, y + 1);
          ++one.pixelCount;
        }
      }
    }
  }
  for (PersonSegment& one : people) {
    if (one.pixelCount == 0) one.left = one.top = 0;
    const int step = grid.step;
    one.cutByBorder = one.left < (grid.firstColumn + 1) * step || one.top < (grid.firstRow + 1) * step ||
                      one.right > std::min(grid.lastColumn * step, pixelWidth) || one.bottom > grid.lastRow * step;
  }
}

}  // namespace lorica

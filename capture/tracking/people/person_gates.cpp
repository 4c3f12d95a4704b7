#include "capture/tracking/people/person_gates.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lorica {

bool isOversize(const DepthComponent& one) {
  const Vec3f size = one.max - one.min;
  return std::hypot(size.x(), size.z()) > 2.4F || size.y() > 2.5F || one.area > 2.0;
}

bool goesOnIntoBackground(const DepthComponent& one) {
  return 2 * one.newCells < one.cells && !isAffirmed(one) &&
         one.backgroundContacts > std::max(6, one.borderCells * 3 / 20);
}

bool isTooNear(const DepthComponent& one, const DepthGrid& grid) {
  constexpr double kNearest = 1.2;  // [m]
  return one.area < kNearest * kNearest * grid.cellArea * one.cells;
}

bool isAffirmed(const DepthComponent& one) {
  return 2 * one.affirmed > one.cells;
}

bool isMainPiece(const DepthComponent& one, int cells, int slot) {
  return 2 * one.overlap[slot] > cells;
}

bool mayBePerson(const DepthComponent& one, const DepthGrid& grid, bool floorFound) {
  const bool cutAbove = one.top <= grid.firstRow + 1, cutBelow = one.bottom >= grid.lastRow - 1;
  const bool cut = cutAbove || cutBelow || one.left <= grid.firstColumn + 1 || one.right >= grid.lastColumn - 1;
  const bool moving = 5 * one.newCells > 3 * one.cells;
  const Vec3f size = one.max - one.min;
  if (isOversize(one) || std::min(size.x(), size.z()) > 1.3F) return false;
  // Little of a person close to the camera fits into the image, but that part fills much of it.
  const bool closeUp = cut && one.cells * 25 >= static_cast<int>(grid.cellCount());
  if (one.area < (cut ? 0.1 : 0.15) && !closeUp) return false;
  if (floorFound && !closeUp) {
    if (one.max.y() < (moving || isAffirmed(one) ? 0.8F : 1.1F) && !cutAbove) return false;
    if (one.min.y() > 0.5F && !cutBelow && !moving) return false;
  }
  if (!floorFound && size.norm() < 0.45F) return false;
  const float depth = std::sqrt(static_cast<float>(one.area / (grid.cellArea * one.cells)));
  if (depth > 5.5F) return false;
  return one.thickness() > 0.008F + 0.6F * depthNoise(depth);
}

bool mayBePartOfPerson(const DepthComponent& one) {
  return one.area > 0.03 && (2 * one.newCells > one.cells || isAffirmed(one)) && !isOversize(one);
}

bool hasHeadAndShoulders(const DepthGrid& grid, const FloorPositions& positions, std::span<const std::uint8_t> person,
                         int slot, float top, bool cutAside) {
  // Widths of two slices, perpendicular to the viewing direction.
  std::array<float, 2> min{1e9F, 1e9F}, max{-1e9F, -1e9F};
  for (int r = 0; r < grid.height; ++r) {
    for (int c = 0; c < grid.width; ++c) {
      if (person[grid.index(c, r)] != slot + 1) continue;
      const Vec3f position = positions(grid, c, r);
      const float down = top - position.y();
      const bool head = down > 0.06F && down < 0.16F;
      const bool shoulders = down > 0.33F && down < 0.55F;
      if (!head && !shoulders) continue;
      const std::size_t slice = head ? 0 : 1;
      min[slice] = std::min(min[slice], position.x());
      max[slice] = std::max(max[slice], position.x());
    }
  }
  const float head = max[0] - min[0], shoulders = max[1] - min[1];
  const float part = cutAside ? 0.5F : 1.0F;
  return head > 0.1F * part && head < 0.34F && shoulders > 0.26F * part && shoulders < 0.8F && shoulders > 1.35F * head;
}

}  // namespace lorica

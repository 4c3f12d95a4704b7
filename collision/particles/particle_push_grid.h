#pragma once

#include "collision/particles/particle_push_hulls.h"
#include "geometry/math.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lorica {

/// Lists which planes matter where: cubic cells over the box of all hulls. Internal to ParticlePush.
///
/// For each hull that reaches into a cell, the cell has the planes that can be the highest one above some point of the
/// cell: among the planes that may lead out, and among all planes. So for every point of the cell, the highest of them
/// is the highest of all the hull's planes, and the result is exact.
class PushGrid {
 public:
  static constexpr std::size_t kWidth = 8;

  /// Planes side by side; surplus entries of a block are infinitely far away.
  struct alignas(32) Block {
    std::array<float, kWidth> x, y, z, offset;
  };
  using PlanesOfBlock = std::array<std::uint32_t, kWidth>;

  /// A hull's planes in a cell.
  struct List {
    std::uint32_t hull = 0;
    std::uint32_t firstBlock = 0;
    std::uint32_t exitCount = 0;   ///< blocks of planes that may lead out; these come first
    std::uint32_t blockCount = 0;  ///< of all
    bool last = true;              ///< of the cell
  };

  /// @param cells  approximate number of cells: any number gives the same result
  void build(const PushHulls& hulls, double cells);

  /// The cell of a point in the box of all hulls.
  [[nodiscard]] std::size_t cellOf(const Vec3f& p) const {
    const std::size_t x = p.x() * inverseSize;
    const std::size_t y = p.y() * inverseSize;
    const std::size_t z = p.z() * inverseSize;
    return (z * count[1] + y) * count[0] + x;
  }

  float size = 1.0F;  ///< edge of a cell [m]
  float inverseSize = 1.0F;
  std::array<std::int32_t, 3> count = {1, 1, 1};
  std::vector<std::uint32_t> firstList;  ///< for each cell; 0: no hull reaches into it
  std::vector<std::uint32_t> occupied;   ///< a bit for each cell
  std::vector<List> lists;
  std::vector<Block> blocks;
  std::vector<PlanesOfBlock> planes;  ///< plane numbers in the hulls, for each block

  /// Planes of one hull that matter in a group of cells: scratch.
  struct Chosen {
    std::uint32_t hull = 0;
    std::size_t exitCount = 0;  ///< in whole blocks of PushHulls::kBlock, as in PushHulls::Hull
    std::size_t count = 0;
    std::vector<float> x, y, z, offset;
    std::vector<std::uint32_t> plane;
    std::vector<float> height;  ///< of the planes to choose from
    void reserveRows(std::size_t planeCount);
  };
  std::vector<Chosen> chosen;  ///< one for each hull, and one for the current cell
};

}  // namespace lorica

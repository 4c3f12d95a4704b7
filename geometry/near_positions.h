#pragma once

#include "geometry/tri_mesh.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace lorica {

/// Finds vertices at nearly the same position. Used for lookups only: a hash table has no defined order. Internal: not
/// installed.
class NearPositions {
 public:
  /// @param samePosition  up to this distance positions are the same [m]
  /// @param origin        near the positions
  NearPositions(double samePosition, const Vec3& origin)
      : samePosition_(samePosition), cell_(kCell * samePosition), origin_(origin) {}

  /// The first kept vertex at the same position for which `fits(kept)`; else `vertex` itself, which is then kept.
  VertexIndex firstAt(VertexIndex vertex, std::span<const Vec3> vertices, const auto& fits) {
    const Vec3& p = vertices[vertex];
    const Cell low = cellOf(p - Vec3::Constant(samePosition_));
    const Cell high = cellOf(p + Vec3::Constant(samePosition_));
    VertexIndex found = vertex;
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          const auto there = cells_.find({x, y, z});
          if (there == cells_.end()) continue;
          for (const VertexIndex v : there->second) {
            const double distanceSq = (vertices[v] - p).squaredNorm();
            if (v < found && distanceSq <= samePosition_ * samePosition_ && fits(v)) found = v;
          }
        }
      }
    }
    if (found == vertex) cells_[cellOf(p)].push_back(vertex);
    return found;
  }

 private:
  static constexpr double kCell = 16.0;  // times the distance, so that most points look up only one cell

  using Cell = std::array<std::int64_t, 3>;

  struct CellHash {
    std::size_t operator()(const Cell& cell) const {
      std::uint64_t h = 0x9e3779b97f4a7c15u;
      for (const std::int64_t k : cell) {
        h = (h ^ k) * 0xff51afd7ed558ccdu;
        h ^= h >> 32;
      }
      return h;
    }
  };

  [[nodiscard]] Cell cellOf(const Vec3& p) const {
    Cell cell{};
    for (std::size_t i = 0; i < 3; ++i) {
      cell[i] = cell_ > 0.0 ? std::floor((p - origin_)[i] / cell_) : 0;
    }
    return cell;
  }

  double samePosition_, cell_;
  Vec3 origin_;
  std::unordered_map<Cell, std::vector<VertexIndex>, CellHash> cells_;
};

}  // namespace lorica

#include "acd/volume_coverage.h"

#include "geometry/random_numbers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace lorica {

namespace {

constexpr int kReplicates = 16;

/// A point where a line in +z direction enters or leaves a surface.
struct Crossing {
  std::int32_t line;
  std::int16_t meshStep;  ///< +1 into the mesh, -1 out of it, 0 for a hull
  std::int16_t hullStep;
  double z;
};

/// One line along z in each cell of a square grid over a rectangle.
class LineGrid {
 public:
  LineGrid(const Aabb& box, int cellsPerSide, std::uint64_t seed)
      : cells_(cellsPerSide), origin_(box.min), cell_((box.max - box.min) / cellsPerSide) {
    lines_.reserve(static_cast<std::size_t>(cells_) * cells_);
    for (int row = 0; row < cells_; ++row) {
      for (int column = 0; column < cells_; ++column) {
        const auto counter = 2 * std::uint64_t{lines_.size()};
        lines_.push_back({origin_.x() + (column + randomUnit(seed, counter)) * cell_.x(),
                          origin_.y() + (row + randomUnit(seed, counter + 1)) * cell_.y()});
      }
    }
  }

  /// Appends a crossing for each line that intersects a triangle. The side of an edge that a line is on is computed
  /// from the edge's ends in a fixed order, so that triangles that share an edge agree: no line passes between them.
  void cross(std::span<const Vec3> vertices, std::span<const Triangle> triangles, int meshStep, int hullStep,
             std::vector<Crossing>& crossings) const {
    for (const Triangle& t : triangles) {
      const Vec3& a = vertices[t[0]];
      const Vec3& b = vertices[t[1]];
      const Vec3& c = vertices[t[2]];
      const auto [firstColumn, lastColumn] = cellRange(a.x(), b.x(), c.x(), 0);
      const auto [firstRow, lastRow] = cellRange(a.y(), b.y(), c.y(), 1);
      for (int row = firstRow; row <= lastRow; ++row) {
        for (int column = firstColumn; column <= lastColumn; ++column) {
          const std::int32_t line = row * cells_ + column;
          const std::array<double, 3> side = {sideOf(vertices, t[1], t[2], line), sideOf(vertices, t[2], t[0], line),
                                              sideOf(vertices, t[0], t[1], line)};
          const int left = (side[0] > 0.0) + (side[1] > 0.0) + (side[2] > 0.0);
          if (left != 0 && left != 3) continue;
          // Counter-clockwise seen from above: an upper surface, where the line leaves.
          const int step = left == 3 ? -1 : 1;
          const double z = (side[0] * a.z() + side[1] * b.z() + side[2] * c.z()) / (side[0] + side[1] + side[2]);
          const auto [low, high] = std::minmax({a.z(), b.z(), c.z()});
          crossings.push_back({line, static_cast<std::int16_t>(step * meshStep),
                               static_cast<std::int16_t>(step * hullStep), std::clamp(z, low, high)});
        }
      }
    }
  }

 private:
  /// Twice the signed area of edge and line, never 0: a line on the edge counts as left of the ascending direction.
  [[nodiscard]] double sideOf(std::span<const Vec3> vertices, VertexIndex from, VertexIndex to,
                              std::int32_t line) const {
    const bool ascending = from < to;
    const Vec3& p = vertices[ascending ? from : to];
    const Vec3& q = vertices[ascending ? to : from];
    const Eigen::Vector2d& r = lines_[line];
    double area = (q.x() - p.x()) * (r.y() - p.y()) - (q.y() - p.y()) * (r.x() - p.x());
    if (area == 0.0) area = std::numeric_limits<double>::min();
    return ascending ? area : -area;
  }

  [[nodiscard]] std::pair<int, int> cellRange(double a, double b, double c, int axis) const {
    const auto [low, high] = std::minmax({a, b, c});
    // Add a margin on either side: rounding here must not break the consistency along edges.
    const double first = std::floor((low - origin_[axis]) / cell_[axis] - 1e-6);
    const double last = std::floor((high - origin_[axis]) / cell_[axis] + 1e-6);
    return {static_cast<int>(std::clamp<double>(first, 0.0, cells_)),
            static_cast<int>(std::clamp<double>(last, -1.0, cells_ - 1))};
  }

  int cells_;
  Vec3 origin_;
  Vec3 cell_;
  std::vector<Eigen::Vector2d> lines_;
};

struct Lengths {
  double inside = 0.0;
  double covered = 0.0;
};

/// Sums lengths over all lines. A line whose steps do not add up to 0 (rounding at a corner) is skipped; this has never
/// been observed.
Lengths sumLengths(std::vector<Crossing>& crossings) {
  std::sort(crossings.begin(), crossings.end(),
            [](const Crossing& a, const Crossing& b) { return a.line != b.line ? a.line < b.line : a.z < b.z; });
  Lengths sum;
  for (std::size_t from = 0; from < crossings.size();) {
    Lengths onLine;
    int meshWinding = 0;
    int hullCount = 0;
    std::size_t i = from;
    for (; i < crossings.size() && crossings[i].line == crossings[from].line; ++i) {
      if (meshWinding > 0) {
        const double length = crossings[i].z - crossings[i - 1].z;
        onLine.inside += length;
        if (hullCount > 0) onLine.covered += length;
      }
      meshWinding += crossings[i].meshStep;
      hullCount += crossings[i].hullStep;
    }
    if (meshWinding == 0 && hullCount == 0) {
      sum.inside += onLine.inside;
      sum.covered += onLine.covered;
    }
    from = i;
  }
  return sum;
}

}  // namespace

Coverage estimateCoverage(const TriMesh& mesh, std::span<const ConvexHull> hulls, int lines, std::uint64_t seed) {
  const Aabb box = surfaceBounds(mesh);
  const int cellsPerSide = std::max(1, static_cast<int>(std::sqrt(lines / kReplicates)));
  std::vector<Crossing> crossings;
  std::array<Lengths, kReplicates> replicates;
  Lengths total;
  for (int k = 0; k < kReplicates; ++k) {
    const LineGrid grid(box, cellsPerSide, randomBits(seed, k));
    crossings.clear();
    grid.cross(mesh.vertices, mesh.triangles, 1, 0, crossings);
    for (const ConvexHull& hull : hulls) grid.cross(hull.vertices, hull.triangles, 0, 1, crossings);
    replicates[k] = sumLengths(crossings);
    total.inside += replicates[k].inside;
    total.covered += replicates[k].covered;
  }
  if (total.inside <= 0.0) return {0.0, 1.0};  // so thin that no line hit it: unknown

  // Standard error of a ratio of means, linearized (delta method).
  Coverage coverage;
  coverage.fraction = total.covered / total.inside;
  double squares = 0.0;
  for (const Lengths& r : replicates) {
    const double residual = r.covered - coverage.fraction * r.inside;
    squares += residual * residual;
  }
  coverage.standardError = std::sqrt(squares * kReplicates / (kReplicates - 1)) / total.inside;
  return coverage;
}

double commonVolume(const TriMesh& mesh, const ConvexHull& hull, int lines, std::uint64_t seed) {
  const Aabb box = boundsOf(hull.vertices);
  const int cellsPerSide = std::max(1, static_cast<int>(std::sqrt(lines)));
  const LineGrid grid(box, cellsPerSide, seed);
  std::vector<Crossing> crossings;
  grid.cross(mesh.vertices, mesh.triangles, 1, 0, crossings);
  grid.cross(hull.vertices, hull.triangles, 0, 1, crossings);
  const Vec3 size = box.max - box.min;
  const double whole = size.x() * size.y();
  return sumLengths(crossings).covered * whole / (cellsPerSide * cellsPerSide);
}

}  // namespace lorica

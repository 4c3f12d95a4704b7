#pragma once

/// The edges of a mesh, each with its triangles, and what repairs ask of triangles. Internal to geometry/.

#include "geometry/counts.h"
#include "geometry/tri_mesh.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace lorica {

[[nodiscard]] inline Triangle sortedCorners(Triangle t) {
  std::sort(t.begin(), t.end());
  return t;
}

/// Whether corners are vertices of the mesh and positions are numbers.
[[nodiscard]] inline bool isReadable(const TriMesh& mesh) {
  const auto inRange = [&](VertexIndex v) { return v >= 0 && v < countOf(mesh.vertices); };
  return std::all_of(mesh.triangles.begin(), mesh.triangles.end(),
                     [&](const Triangle& t) { return std::all_of(t.begin(), t.end(), inRange); }) &&
         std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [](const Vec3& p) { return p.allFinite(); });
}

/// One side of a triangle, stored under the smaller of its two vertex indices.
struct TriangleSide {
  VertexIndex larger;
  std::int32_t triangle;
  bool ascending;  ///< the triangle runs from the smaller vertex to the larger
};

/// All triangle sides of a mesh, grouped by edge. Grouping by the smaller vertex and sorting the few sides of each
/// group is several times faster than sorting all sides, and needs no hash table.
class EdgeTable {
 public:
  EdgeTable(std::size_t vertexCount, std::span<const Triangle> triangles)
      : begin_(vertexCount + 1, 0), sides_(3 * triangles.size()) {
    for (const Triangle& t : triangles) {
      for (int i = 0; i < 3; ++i) ++begin_[std::min(t[i], t[(i + 1) % 3]) + 1];
    }
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      const Triangle& t = triangles[k];
      for (int i = 0; i < 3; ++i) {
        const VertexIndex a = t[i];
        const VertexIndex b = t[(i + 1) % 3];
        sides_[next[std::min(a, b)]++] = {std::max(a, b), static_cast<std::int32_t>(k), a < b};
      }
    }
  }

  /// Calls visit(smaller vertex, sides of the edge in triangle order) for each edge, in lexicographic order of edges.
  template <typename Visit>
  void forEachEdge(Visit&& visit) {
    for (std::size_t v = 0; v + 1 < begin_.size(); ++v) {
      const std::span<TriangleSide> fan(sides_.data() + begin_[v], begin_[v + 1] - begin_[v]);
      std::sort(fan.begin(), fan.end(), [](const TriangleSide& a, const TriangleSide& b) {
        return a.larger != b.larger ? a.larger < b.larger : a.triangle < b.triangle;
      });
      for (std::size_t from = 0; from < fan.size();) {
        std::size_t to = from + 1;
        while (to < fan.size() && fan[to].larger == fan[from].larger) ++to;
        visit(static_cast<VertexIndex>(v), fan.subspan(from, to - from));
        from = to;
      }
    }
  }

 private:
  std::vector<std::size_t> begin_;  ///< sides with smaller vertex v: begin_[v] to begin_[v + 1]
  std::vector<TriangleSide> sides_;
};

}  // namespace lorica

#include "geometry/tri_mesh.h"

#include "geometry/edge_table.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "geometry/union_find.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace lorica {

namespace {

/// One kind of fault: the number of occurrences, and a description of the first.
struct Fault {
  std::size_t count = 0;
  std::string first;
};

std::string suchEdges(std::size_t count) {
  return counted(static_cast<long long>(count), "such edge");
}

/// "17, 20, 31", truncated after five.
std::string triangleList(std::span<const TriangleSide> sides) {
  std::string list;
  for (std::size_t i = 0; i < std::min<std::size_t>(sides.size(), 5); ++i) {
    list += fmt::format("{}{}", i == 0 ? "" : ", ", sides[i].triangle);
  }
  return list + (sides.size() > 5 ? ", ..." : "");
}

std::string describe(const Vec3& p) {
  return fmt::format("({}, {}, {})", p.x(), p.y(), p.z());
}

Result<void> checkIndicesAndPositions(const TriMesh& mesh) {
  const std::size_t vertexCount = mesh.vertices.size();
  if (mesh.triangles.empty())
    return badMesh("the mesh has {} and no triangle", counted(std::ssize(mesh.vertices), "vertex", "vertices"));
  Fault outside;
  Fault repeated;
  Fault notFinite;
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const Triangle& t = mesh.triangles[k];
    for (const VertexIndex v : t) {
      if (v >= 0 && std::cmp_less(v, vertexCount)) continue;
      if (outside.count++ == 0) {
        outside.first = fmt::format("triangle {}: vertex index {} is out of range, expected 0 to {} ({} vertices)", k,
                                    v, static_cast<std::int64_t>(vertexCount) - 1, vertexCount);
      }
    }
    if (hasRepeatedCorner(t)) {
      if (repeated.count++ == 0) {
        repeated.first =
            fmt::format("triangle {}: vertices {}, {}, {}, expected three different ones", k, t[0], t[1], t[2]);
      }
    }
  }
  if (outside.count > 0)
    return badMesh("{}; {} in all", outside.first, counted(std::int64_t(outside.count), "such index", "such indices"));
  for (std::size_t v = 0; v < vertexCount; ++v) {
    if (mesh.vertices[v].allFinite()) continue;
    if (notFinite.count++ == 0) {
      notFinite.first = fmt::format("vertex {}: position {} is not finite", v, describe(mesh.vertices[v]));
    }
  }
  if (notFinite.count > 0) {
    return badMesh("{}; {} in all", notFinite.first,
                   counted(std::int64_t(notFinite.count), "such vertex", "such vertices"));
  }
  if (repeated.count > 0)
    return badMesh("{}; {} in all", repeated.first, counted(std::int64_t(repeated.count), "such triangle"));
  return {};
}

Result<void> checkEdges(const TriMesh& mesh) {
  Fault open;
  Fault nonManifold;
  Fault turned;
  bool balanced = true;  // along each edge, equally many triangles run in both directions
  EdgeTable(mesh.vertices.size(), mesh.triangles).forEachEdge([&](VertexIndex v, std::span<const TriangleSide> sides) {
    if (sides.size() == 2 && sides[0].ascending != sides[1].ascending) return;
    const VertexIndex w = sides[0].larger;
    const auto upward = std::count_if(sides.begin(), sides.end(), [](const TriangleSide& s) { return s.ascending; });
    balanced &= 2 * upward == std::ssize(sides);
    if (sides.size() == 1) {
      if (open.count++ == 0) {
        open.first = fmt::format("edge {}-{} belongs to one triangle ({}), expected two", v, w, sides[0].triangle);
      }
    } else if (sides.size() > 2) {
      if (nonManifold.count++ == 0) {
        nonManifold.first = fmt::format("edge {}-{} belongs to {} triangles ({}), expected two", v, w, sides.size(),
                                        triangleList(sides));
      }
    } else if (turned.count++ == 0) {
      turned.first =
          fmt::format("edge {}-{}: triangles {} and {} run along it in the same direction, expected opposite", v, w,
                      sides[0].triangle, sides[1].triangle);
    }
  });
  if (open.count > 0) {
    std::string message = fmt::format("{}; {}: the mesh is open", open.first, suchEdges(open.count));
    TriMesh welded = mesh;
    const std::size_t removed = weldEqualVertices(welded);
    const std::size_t left = removed == 0 ? open.count : openEdgeCount(welded);
    if (left < open.count) {
      message +=
          fmt::format("; welding {} at positions of others would leave {}",
                      counted(std::int64_t(removed), "vertex", "vertices"), counted(std::int64_t(left), "open edge"));
    }
    if (nonManifold.count > 0)
      message += "; also, " + counted(std::int64_t(nonManifold.count), "edge belongs", "edges belong") +
                 " to more than two triangles";
    return badMesh(std::move(message));
  }
  if (nonManifold.count > 0) {
    return badMesh("{}; {}: the mesh is not a two-manifold{}", nonManifold.first, suchEdges(nonManifold.count),
                   balanced ? "; repairClosedMesh() can separate the triangles" : "");
  }
  if (turned.count > 0) {
    return badMesh("{}; {}: the triangles are not consistently oriented", turned.first, suchEdges(turned.count));
  }
  return {};
}

Result<void> checkVolume(const TriMesh& mesh) {
  const double diagonal = surfaceBounds(mesh).diagonal();
  const double cube = diagonal * diagonal * diagonal;
  if (!std::isfinite(cube) || cube < std::numeric_limits<double>::min()) {
    return badMesh("the mesh's diagonal is {:g}: too {} to measure a volume", diagonal,
                   std::isfinite(cube) ? "small" : "large");
  }
  // Rounding errors alone are about 1e-16 of the cube; a needle of 1 : 1000 : 10000 still has 1e-7.
  const double volume = signedVolume(mesh.vertices, mesh.triangles);
  if (std::abs(volume) < 1e-12 * cube) {
    return badMesh("the mesh is flat: its volume is {:g} with a diagonal of {:g}", volume, diagonal);
  }
  if (volume < 0.0) {
    return badMesh("the mesh is inside out: its signed volume is {:g}, expected above 0; reverse all triangles",
                   volume);
  }
  return {};
}

/// Key that is equal for positions that are equal as numbers, so that -0 equals 0.
std::array<std::uint64_t, 3> positionKey(const Vec3& p) {
  return {std::bit_cast<std::uint64_t>(p.x() + 0.0), std::bit_cast<std::uint64_t>(p.y() + 0.0),
          std::bit_cast<std::uint64_t>(p.z() + 0.0)};
}

std::uint64_t mixed(const std::array<std::uint64_t, 3>& key) {
  std::uint64_t h = 0x9e3779b97f4a7c15u;
  for (const std::uint64_t k : key) {
    h = (h ^ k) * 0xff51afd7ed558ccdu;
    h ^= h >> 32;
  }
  return h;
}

/// For each vertex, the first one at the same position.
std::vector<VertexIndex> firstAtSamePosition(std::span<const Vec3> vertices) {
  std::vector<VertexIndex> first(vertices.size());
  std::vector<VertexIndex> slots(std::bit_ceil(2 * vertices.size() + 2), -1);
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const auto key = positionKey(vertices[v]);
    std::size_t slot = mixed(key) & (slots.size() - 1);
    while (slots[slot] >= 0 && positionKey(vertices[slots[slot]]) != key) slot = (slot + 1) & (slots.size() - 1);
    if (slots[slot] < 0) slots[slot] = v;
    first[v] = slots[slot];
  }
  return first;
}

}  // namespace

std::vector<bool> usedVertices(std::size_t vertexCount, std::span<const Triangle> triangles) {
  std::vector<bool> used(vertexCount, false);
  for (const Triangle& t : triangles) {
    for (const VertexIndex v : t) used[v] = true;
  }
  return used;
}

double signedVolume(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
  if (triangles.empty()) return 0.0;
  // Tetrahedra from a vertex of the mesh rather than the origin, to avoid cancellation far from the origin.
  const Vec3& apex = vertices[triangles.front()[0]];
  double sixfold = 0.0;
  for (const Triangle& t : triangles) {
    const Vec3 a = vertices[t[0]] - apex;
    const Vec3 b = vertices[t[1]] - apex;
    const Vec3 c = vertices[t[2]] - apex;
    sixfold += a.dot(b.cross(c));
  }
  return sixfold / 6.0;
}

double surfaceArea(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
  double twofold = 0.0;
  for (const Triangle& t : triangles) twofold += areaNormal(vertices, t).norm();
  return 0.5 * twofold;
}

Aabb surfaceBounds(const TriMesh& mesh) {
  Aabb box;
  for (const Triangle& t : mesh.triangles) {
    for (const VertexIndex v : t) box.extend(mesh.vertices[v]);
  }
  return box;
}

Components connectedComponents(std::size_t vertexCount, std::span<const Triangle> triangles) {
  UnionFind connected(vertexCount);
  for (const Triangle& t : triangles) {
    for (int i = 1; i < 3; ++i) connected.unite(t[0], t[i]);
  }
  Components components;
  components.componentOfTriangle.reserve(triangles.size());
  std::vector<std::int32_t> label(vertexCount, -1);
  for (const Triangle& t : triangles) {
    std::int32_t& l = label[connected.find(t[0])];
    if (l < 0) l = components.count++;
    components.componentOfTriangle.push_back(l);
  }
  return components;
}

std::size_t openEdgeCount(const TriMesh& mesh) {
  std::size_t count = 0;
  EdgeTable(mesh.vertices.size(), mesh.triangles).forEachEdge([&](VertexIndex, std::span<const TriangleSide> sides) {
    if (sides.size() == 1) ++count;
  });
  return count;
}

std::size_t weldEqualVertices(TriMesh& mesh) {
  const std::vector<VertexIndex> first = firstAtSamePosition(mesh.vertices);
  std::vector<VertexIndex> renumbered(first.size());
  VertexIndex kept = 0;
  for (std::size_t v = 0; v < first.size(); ++v) {
    if (first[v] != static_cast<VertexIndex>(v)) {
      renumbered[v] = renumbered[first[v]];
      continue;
    }
    mesh.vertices[kept] = mesh.vertices[v];
    renumbered[v] = kept++;
  }
  const std::size_t removed = first.size() - kept;
  if (removed == 0) return 0;
  mesh.vertices.resize(kept);
  for (Triangle& t : mesh.triangles) {
    for (VertexIndex& v : t) v = renumbered[v];
  }
  std::erase_if(mesh.triangles, hasRepeatedCorner);
  return removed;
}

Result<void> checkClosedTwoManifold(const TriMesh& mesh) {
  LORICA_TRY_DO(checkIndicesAndPositions(mesh));
  LORICA_TRY_DO(checkEdges(mesh));
  return checkVolume(mesh);
}

}  // namespace lorica

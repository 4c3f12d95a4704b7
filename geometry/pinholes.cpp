#include "geometry/pinholes.h"

#include "geometry/edge_table.h"

#include <algorithm>
#include <limits>

namespace lorica {
namespace {

constexpr double kFold = -0.5;     // cosine of the largest angle between normals in a cap
constexpr double kNoArea = 1e-12;  // of the hole's extent squared: such a triangle has no direction

using Loop = std::vector<VertexIndex>;

struct HalfEdge {
  VertexIndex from, to;
};

/// The directed edges that caps need, by start: the reverse of those that lack a partner.
std::vector<HalfEdge> missingHalfEdges(const TriMesh& mesh) {
  std::vector<HalfEdge> missing;
  EdgeTable(mesh.vertices.size(), mesh.triangles).forEachEdge([&](VertexIndex v, std::span<const TriangleSide> sides) {
    int excess = 0;  // of triangles that run v -> larger
    for (const TriangleSide& s : sides) excess += s.ascending ? 1 : -1;
    for (; excess > 0; --excess) missing.push_back({sides[0].larger, v});
    for (; excess < 0; ++excess) missing.push_back({v, sides[0].larger});
  });
  std::stable_sort(missing.begin(), missing.end(),
                   [](const HalfEdge& a, const HalfEdge& b) { return a.from < b.from; });
  return missing;
}

/// Loops that pass no vertex twice. Nothing if one has more than kPinholeEdges edges.
std::optional<std::vector<Loop>> loopsOf(const std::vector<HalfEdge>& edges, std::size_t vertexCount) {
  std::vector<std::size_t> next(vertexCount + 1, 0);
  for (const HalfEdge& e : edges) ++next[e.from + 1];
  for (std::size_t v = 0; v < vertexCount; ++v) next[v + 1] += next[v];
  std::vector<std::size_t> end(next.begin() + 1, next.end());
  std::vector<Loop> loops;
  std::vector<std::ptrdiff_t> positionInPath(vertexCount, -1);
  Loop path;
  for (const HalfEdge& start : edges) {
    VertexIndex at = start.from;
    while (next[at] < end[at]) {
      positionInPath[at] = std::ssize(path);
      path.push_back(at);
      at = edges[next[at]++].to;
      if (positionInPath[at] < 0) continue;
      // Back at a vertex of the path: what lies between is a loop.
      const auto first = path.begin() + positionInPath[at];
      loops.emplace_back(first, path.end());
      for (const VertexIndex v : loops.back()) positionInPath[v] = -1;
      path.erase(first, path.end());
      if (loops.back().size() > kPinholeEdges) return std::nullopt;
    }
    LORICA_CHECK(path.empty(), "as many edges of holes must end at a vertex as start there");
  }
  return loops;
}

Vec3 doubleArea(const TriMesh& mesh, const Triangle& t) {
  const Vec3& a = mesh.vertices[t[0]];
  return (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a);
}

/// The triangulation of a loop with the least area, by dynamic programming: best[i][j] is that of the polygon from i to
/// j. Each triangle's second corner lies between its first and third one in the loop.
std::vector<Triangle> leastArea(const TriMesh& mesh, const Loop& loop) {
  const std::size_t n = loop.size();
  std::vector<double> best(n * n, 0.0);
  std::vector<std::size_t> middle(n * n, 0);
  for (std::size_t length = 2; length < n; ++length) {
    for (std::size_t i = 0; i + length < n; ++i) {
      const std::size_t j = i + length;
      double& least = best[i * n + j];
      least = std::numeric_limits<double>::infinity();
      for (std::size_t k = i + 1; k < j; ++k) {
        const double area = best[i * n + k] + best[k * n + j] + doubleArea(mesh, {loop[i], loop[k], loop[j]}).norm();
        if (area >= least) continue;
        least = area;
        middle[i * n + j] = k;
      }
    }
  }
  std::vector<Triangle> caps;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, n - 1}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i < 2) continue;
    const std::size_t k = middle[i * n + j];
    caps.push_back({loop[i], loop[k], loop[j]});
    open.emplace_back(i, k);
    open.emplace_back(k, j);
  }
  return caps;
}

bool shareAnEdge(const Triangle& a, const Triangle& b) {
  int shared = 0;
  for (const VertexIndex v : a) shared += std::find(b.begin(), b.end(), v) != b.end() ? 1 : 0;
  return shared == 2;
}

bool folds(const TriMesh& mesh, std::span<const Triangle> caps, double extent) {
  for (std::size_t i = 0; i < caps.size(); ++i) {
    const Vec3 own = doubleArea(mesh, caps[i]);
    for (std::size_t j = 0; j < i; ++j) {
      if (!shareAnEdge(caps[i], caps[j])) continue;
      const Vec3 other = doubleArea(mesh, caps[j]);
      if (std::min(own.norm(), other.norm()) <= kNoArea * extent * extent) continue;
      if (own.dot(other) < kFold * own.norm() * other.norm()) return true;
    }
  }
  return false;
}

Triangle sorted(Triangle t) {
  std::sort(t.begin(), t.end());
  return t;
}

}  // namespace

std::optional<Pinholes> closePinholes(const TriMesh& mesh) {
  const std::vector<HalfEdge> missing = missingHalfEdges(mesh);
  Pinholes result;
  if (missing.empty()) return result;
  const std::optional<std::vector<Loop>> loops = loopsOf(missing, mesh.vertices.size());
  if (!loops) return std::nullopt;

  const double largest = kPinholeExtent * surfaceBounds(mesh).diagonal();
  const Components components = connectedComponents(mesh.vertices.size(), mesh.triangles);
  std::vector<double> area(components.count, 0.0);
  std::vector<double> capArea(area.size(), 0.0), finArea(area.size(), 0.0);
  std::vector<std::int32_t> componentOf(mesh.vertices.size(), -1);
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const std::int32_t c = components.componentOfTriangle[k];
    area[c] += doubleArea(mesh, mesh.triangles[k]).norm();
    for (const VertexIndex v : mesh.triangles[k]) componentOf[v] = c;
  }
  std::vector<Triangle> known;
  known.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) known.push_back(sorted(t));
  std::sort(known.begin(), known.end());
  for (const Loop& loop : *loops) {
    if (loop.size() < 3) return std::nullopt;
    Aabb box;
    for (const VertexIndex v : loop) box.extend(mesh.vertices[v]);
    const std::vector<Triangle> caps = leastArea(mesh, loop);
    if (folds(mesh, caps, box.diagonal())) return std::nullopt;
    const std::int32_t piece = componentOf[loop.front()];
    double own = 0.0;
    for (const Triangle& cap : caps) {
      const bool fin = std::binary_search(known.begin(), known.end(), sorted(cap));
      (fin ? finArea[piece] : own) += doubleArea(mesh, cap).norm();
    }
    const bool small = loop.size() == 3 || (box.max - box.min).maxCoeff() <= largest;
    if (!small && own > kSlitArea * area[piece]) return std::nullopt;
    capArea[piece] += own;
    result.caps.insert(result.caps.end(), caps.begin(), caps.end());
    ++result.count;
  }
  for (std::size_t c = 0; c < area.size(); ++c) {
    if (capArea[c] > kPinholeArea * area[c] || finArea[c] > kFinArea * area[c]) return std::nullopt;
  }
  return result;
}

}  // namespace lorica

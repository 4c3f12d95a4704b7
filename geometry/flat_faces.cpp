#include "geometry/flat_faces.h"

#include "geometry/counts.h"
#include "geometry/edge_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <unordered_map>
#include <utility>

namespace lorica {
namespace {

// So far from a plane or a line counts as in it, as a share of the diagonal. What is exactly flat first: it goes in the
// same way wherever it was divided.
constexpr std::array kFlat = {1e-9, 3e-7};
constexpr double kShorter = 1.0 - 1e-6;       // of a length: a shorter one is not the same with rounding
constexpr double kUneven = 1e-6;              // sine of a sum of angles that counts as none
constexpr std::size_t kMostAround = 256;      // triangles at a vertex that may go, ...
constexpr std::size_t kMostBeside = 1 << 14;  // ... and at one beside it: lists of them are searched
constexpr std::size_t kFlips = 16;            // exchanges of a diagonal, for each triangle: they end long before

using TriangleIndex = std::int32_t;

/// Merges flat faces at one tolerance.
class FaceMerger {
 public:
  /// @param flat  so far from a plane or a line counts as in it [m]
  FaceMerger(const std::vector<Vec3>& vertices, FlatFaces faces, double flat)
      : vertices_(vertices), triangles_(std::move(faces.triangles)), sources_(std::move(faces.sources)), flat_(flat) {}

  /// Gives each triangle its face. Returns whether any face has several.
  bool findFaces() {
    const std::size_t count = triangles_.size();
    std::vector<std::array<TriangleIndex, 3>> across(count, {-1, -1, -1});  // a side is from corner i to the next
    const auto sideOf = [&](TriangleIndex t, VertexIndex v, const TriangleSide& s) {
      const VertexIndex start = s.ascending ? v : s.larger;
      return std::find(triangles_[t].begin(), triangles_[t].end(), start) - triangles_[t].begin();
    };
    EdgeTable(vertices_.size(), triangles_).forEachEdge([&](VertexIndex v, std::span<const TriangleSide> sides) {
      if (sides.size() != 2 || sides[0].ascending == sides[1].ascending) return;
      const TriangleIndex a = sides[0].triangle, b = sides[1].triangle;
      across[a][sideOf(a, v, sides[0])] = b;
      across[b][sideOf(b, v, sides[1])] = a;
    });
    std::vector<Vec3> normals(count);
    for (std::size_t t = 0; t < count; ++t) normals[t] = areaNormal(vertices_, triangles_[t]);
    std::vector<TriangleIndex> seeds(count), open;
    std::iota(seeds.begin(), seeds.end(), 0);
    std::stable_sort(seeds.begin(), seeds.end(), [&](TriangleIndex a, TriangleIndex b) {
      return normals[a].squaredNorm() > normals[b].squaredNorm();
    });
    faceOf_.assign(count, -1);
    for (const TriangleIndex seed : seeds) {
      if (faceOf_[seed] >= 0) continue;
      const TriangleIndex face = countOf(normals_);
      normals_.push_back(normals[seed].stableNormalized());
      origins_.push_back(vertices_[triangles_[seed][0]]);
      const Vec3& normal = normals_.back();
      faceOf_[seed] = face;
      open.assign({seed});
      while (!open.empty() && normal.squaredNorm() > 0.5) {
        const TriangleIndex from = open.back();
        open.pop_back();
        for (const TriangleIndex t : across[from]) {
          if (t < 0 || faceOf_[t] >= 0 || !(normals[t].dot(normal) > 0.0)) continue;
          const auto here = [&](VertexIndex v) { return inPlane(v, face); };
          if (!std::all_of(triangles_[t].begin(), triangles_[t].end(), here)) continue;
          faceOf_[t] = face;
          open.push_back(t);
        }
      }
    }
    return normals_.size() < count;
  }

  /// Removes vertices until none can go.
  void removeVertices() {
    at_.assign(vertices_.size(), {});
    for (TriangleIndex t = 0; t < countOf(triangles_); ++t) {
      if (alive(t)) {
        for (const VertexIndex v : triangles_[t]) at_[v].push_back(t);
      }
    }
    std::vector<VertexIndex> open(vertices_.size());
    std::iota(open.rbegin(), open.rend(), 0);
    std::vector<bool> waits(vertices_.size(), true);
    while (!open.empty()) {
      const VertexIndex v = open.back();
      open.pop_back();
      waits[v] = false;
      if (!remove(v)) continue;
      for (const VertexIndex u : around_) {
        if (waits[u]) continue;
        waits[u] = true;
        open.push_back(u);
      }
    }
  }

  /// Exchanges diagonals within faces until none is uneven.
  void evenOut() {
    std::vector<TriangleIndex> open;
    for (TriangleIndex t = countOf(triangles_); t-- > 0;) {
      if (alive(t)) open.push_back(t);
    }
    std::size_t left = kFlips * open.size();
    while (!open.empty() && left > 0) {
      const TriangleIndex t = open.back();
      open.pop_back();
      for (int i = 0; i < 3; ++i) {
        const TriangleIndex other = flip(t, i);
        if (other < 0) continue;
        --left;
        open.insert(open.end(), {t, other});
        break;
      }
    }
  }

  [[nodiscard]] FlatFaces result() const {
    FlatFaces kept;
    for (TriangleIndex t = 0; t < countOf(triangles_); ++t) {
      if (!alive(t)) continue;
      kept.triangles.push_back(triangles_[t]);
      kept.sources.push_back(sources_[t]);
    }
    return kept;
  }

 private:
  [[nodiscard]] bool alive(TriangleIndex t) const { return triangles_[t][0] >= 0; }

  static std::uint64_t keyOf(VertexIndex a, VertexIndex b) {
    return static_cast<std::uint64_t>(std::min(a, b)) << 32 | static_cast<std::uint32_t>(std::max(a, b));
  }
  /// How far vertices that were removed from an edge of the border are from it [m].
  [[nodiscard]] double bent(VertexIndex a, VertexIndex b) const {
    const auto found = bent_.find(keyOf(a, b));
    return found == bent_.end() ? 0.0 : found->second;
  }

  [[nodiscard]] bool isCrowded(VertexIndex v) const { return at_[v].size() > kMostBeside; }

  static int cornerOf(const Triangle& t, VertexIndex v) { return t[0] == v ? 0 : t[1] == v ? 1 : 2; }

  [[nodiscard]] bool inPlane(VertexIndex v, TriangleIndex face) const {
    return std::abs(normals_[face].dot(vertices_[v] - origins_[face])) <= flat_;
  }

  /// The vertices around a vertex, in order, in around_. Those of an open fan start and end on the border.
  /// @return whether the triangles form one fan; nothing is known of it otherwise
  bool walkAround(VertexIndex v, bool& closed) {
    const std::vector<TriangleIndex>& fan = at_[v];
    std::vector<std::pair<VertexIndex, VertexIndex>>& steps = steps_;  // counter-clockwise
    steps.clear();
    for (const TriangleIndex t : fan) {
      const int i = cornerOf(triangles_[t], v);
      steps.emplace_back(triangles_[t][(i + 1) % 3], triangles_[t][(i + 2) % 3]);
    }
    const auto stepFrom = [&](VertexIndex u) {
      return std::find_if(steps.begin(), steps.end(), [&](const auto& s) { return s.first == u; });
    };
    VertexIndex start = steps[0].first;
    for (const auto& step : steps) {
      const auto leadsHere = [&](const auto& s) { return s.second == step.first; };
      if (std::none_of(steps.begin(), steps.end(), leadsHere)) start = step.first;
    }
    around_.assign({start});
    for (std::size_t n = 0; n < fan.size(); ++n) {
      const auto step = stepFrom(around_.back());
      if (step == steps.end()) return false;
      around_.push_back(step->second);
    }
    closed = around_.back() == start;
    if (closed) around_.pop_back();
    std::vector<VertexIndex> sorted = around_;
    std::sort(sorted.begin(), sorted.end());
    return std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
  }

  /// Moves a vertex that is not needed onto a neighbor. Returns whether it was.
  bool remove(VertexIndex v) {
    const std::vector<TriangleIndex>& fan = at_[v];
    if (fan.empty() || fan.size() > kMostAround) return false;
    bool closed = false;
    if (!walkAround(v, closed)) return false;
    if (std::any_of(around_.begin(), around_.end(), [&](VertexIndex u) { return isCrowded(u); })) return false;
    // Those in the planes of all faces here: any, the next ones along an edge, or none.
    candidates_.clear();
    for (const VertexIndex u : around_) {
      if (std::all_of(fan.begin(), fan.end(), [&](TriangleIndex t) { return inPlane(u, faceOf_[t]); })) {
        candidates_.push_back(u);
      }
    }
    double bend = 0.0;
    const VertexIndex from = around_.front(), to = around_.back();
    if (!closed) {
      const Vec3 along = vertices_[to] - vertices_[from];
      const Vec3 way = vertices_[v] - vertices_[from];
      const double share = along.squaredNorm() > 0.0 ? way.dot(along) / along.squaredNorm() : -1.0;
      if (!(share > 0.0 && share < 1.0)) return false;
      bend = (way - share * along).norm() + std::max(bent(from, v), bent(v, to));
      if (!(bend <= flat_)) return false;
      std::erase_if(candidates_, [&](VertexIndex u) { return u != from && u != to; });
    }
    // Onto the nearest neighbor that folds nothing over.
    std::vector<double> lengths(candidates_.size());
    for (std::size_t i = 0; i < lengths.size(); ++i) lengths[i] = (vertices_[candidates_[i]] - vertices_[v]).norm();
    for (std::size_t tried = 0; tried < lengths.size(); ++tried) {
      std::size_t nearest = 0;
      for (std::size_t i = 1; i < lengths.size(); ++i) {
        if (lengths[i] < kShorter * lengths[nearest]) nearest = i;
      }
      lengths[nearest] = kInfinity;
      if (!canMove(v, candidates_[nearest], closed)) continue;
      if (bend > 0.0) bent_[keyOf(from, to)] = bend;
      move(v, candidates_[nearest]);
      return true;
    }
    return false;
  }

  [[nodiscard]] bool canMove(VertexIndex v, VertexIndex to, bool closed) {
    // The edge between the two goes with its triangles; no other triangle may come to lie on another one.
    std::size_t shared = 0;
    for (const VertexIndex u : around_) {
      if (u != to && neighbors(u, to)) ++shared;
    }
    if (shared != (closed ? 2u : 1u) || around_.size() < 3) return false;
    for (const TriangleIndex t : at_[v]) {
      Triangle moved = triangles_[t];
      if (std::find(moved.begin(), moved.end(), to) != moved.end()) continue;
      moved[cornerOf(moved, v)] = to;
      if (!isWide(moved, faceOf_[t])) return false;
    }
    return true;
  }

  [[nodiscard]] bool neighbors(VertexIndex a, VertexIndex b) const {
    const std::vector<TriangleIndex>& fan = at_[at_[a].size() < at_[b].size() ? a : b];
    const VertexIndex other = at_[a].size() < at_[b].size() ? b : a;
    return std::any_of(fan.begin(), fan.end(), [&](TriangleIndex t) {
      return std::find(triangles_[t].begin(), triangles_[t].end(), other) != triangles_[t].end();
    });
  }

  /// Whether a triangle faces as its face does and is wider than what counts as flat.
  [[nodiscard]] bool isWide(const Triangle& t, TriangleIndex face) const {
    const Vec3 &a = vertices_[t[0]], &b = vertices_[t[1]], &c = vertices_[t[2]];
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    return normals_[face].dot(areaNormal(vertices_, t)) > flat_ * longest;
  }

  void move(VertexIndex v, VertexIndex to) {
    for (const TriangleIndex t : at_[v]) {
      Triangle& corners = triangles_[t];
      if (std::find(corners.begin(), corners.end(), to) != corners.end()) {
        for (const VertexIndex u : corners) {
          if (u != v) std::erase(at_[u], t);
        }
        corners = {-1, -1, -1};
        continue;
      }
      corners[cornerOf(corners, v)] = to;
      at_[to].push_back(t);
    }
    at_[v].clear();
  }

  /// Exchanges the side from corner i of a triangle for the other diagonal, if that is more even (Lawson 1977). Returns
  /// the triangle on its other side, or -1.
  TriangleIndex flip(TriangleIndex t, int i) {
    const VertexIndex a = triangles_[t][i], b = triangles_[t][(i + 1) % 3], c = triangles_[t][(i + 2) % 3];
    if (isCrowded(a) || isCrowded(b)) return -1;
    TriangleIndex other = -1;
    int count = 0;
    const bool fewer = at_[a].size() < at_[b].size();
    for (const TriangleIndex o : at_[fewer ? a : b]) {
      const Triangle& corners = triangles_[o];
      if (o == t || std::find(corners.begin(), corners.end(), fewer ? b : a) == corners.end()) continue;
      other = o;
      ++count;
    }
    if (count != 1 || faceOf_[other] != faceOf_[t]) return -1;
    const int j = cornerOf(triangles_[other], b);
    if (triangles_[other][(j + 1) % 3] != a) return -1;
    const VertexIndex d = triangles_[other][(j + 2) % 3];
    const auto cosine = [&](VertexIndex at) {
      return (vertices_[a] - vertices_[at]).stableNormalized().dot((vertices_[b] - vertices_[at]).stableNormalized());
    };
    const auto sine = [&](VertexIndex at) { return std::sqrt(std::max(0.0, 1.0 - cosine(at) * cosine(at))); };
    // The sine of the sum of both opposite angles is negative beyond 180 degrees. Of a square, or another quadrilateral
    // whose corners are on a circle, the diagonal is taken that has the first vertex.
    const double excess = sine(c) * cosine(d) + cosine(c) * sine(d);
    if (!(excess < -kUneven || (excess < kUneven && std::min(c, d) < std::min(a, b)))) return -1;
    const Triangle here = {c, d, b}, there = {d, c, a};
    if (neighbors(c, d) || !isWide(here, faceOf_[t]) || !isWide(there, faceOf_[t])) return -1;
    std::erase(at_[a], t);
    std::erase(at_[b], other);
    at_[d].push_back(t);
    at_[c].push_back(other);
    triangles_[t] = here;
    triangles_[other] = there;
    return other;
  }

  const std::vector<Vec3>& vertices_;
  std::vector<Triangle> triangles_;  // -1 once removed
  std::vector<std::int32_t> sources_;
  double flat_;                                 // [m]
  std::vector<TriangleIndex> faceOf_;           // of each triangle
  std::vector<Vec3> normals_, origins_;         // of the plane of each face; normals are zero where it has no area
  std::vector<std::vector<TriangleIndex>> at_;  // of each vertex
  std::unordered_map<std::uint64_t, double> bent_;
  std::vector<VertexIndex> around_, candidates_;
  std::vector<std::pair<VertexIndex, VertexIndex>> steps_;
};

}  // namespace

FlatFaces mergeFlatFaces(const TriMesh& mesh) {
  FlatFaces faces{mesh.triangles, std::vector<std::int32_t>(mesh.triangles.size())};
  std::iota(faces.sources.begin(), faces.sources.end(), 0);
  if (!isReadable(mesh)) return faces;
  const double diagonal = surfaceBounds(mesh).diagonal();
  for (const double flat : kFlat) {
    FaceMerger merger(mesh.vertices, std::move(faces), flat * diagonal);
    if (merger.findFaces()) {
      merger.removeVertices();
      merger.evenOut();
      merger.removeVertices();
      merger.evenOut();
    }
    faces = merger.result();
  }
  // In an order that does not tell how the faces were divided.
  std::vector<std::size_t> order(faces.triangles.size());
  std::iota(order.begin(), order.end(), 0);
  for (Triangle& t : faces.triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return faces.triangles[a] < faces.triangles[b]; });
  FlatFaces sorted;
  for (const std::size_t i : order) {
    sorted.triangles.push_back(faces.triangles[i]);
    sorted.sources.push_back(faces.sources[i]);
  }
  return sorted;
}

}  // namespace lorica

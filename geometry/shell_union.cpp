#include "geometry/shell_union.h"

#include "geometry/counts.h"
#include "geometry/edge_table.h"
#include "geometry/errors.h"
#include "geometry/mesh_pieces.h"
#include "geometry/mesh_repair.h"
#include "geometry/near_positions.h"
#include "geometry/triangle_tree.h"
#include "geometry/union_find.h"
#include "geometry/work_budgets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace lorica {
namespace {

// Positions closer than this share of the diagonal are the same. Files of few digits need the larger ones.
constexpr std::array<double, 3> kTolerances = {1e-9, 1e-6, 1e-5};
constexpr double kOverlap = 1e-6;  // share of the volume: pieces that overlap by less only touch
constexpr double kInside = 0.5;    // winding number
constexpr double kMuch =
    0.01;  // share that overlaps: less is left as it is, and counted twice, where no union is found
constexpr std::size_t kMaxPieces = 2'000'000;  // pairs of pieces whose boxes overlap
constexpr std::size_t kApartSteps = 4;         // of a test of two triangles
constexpr std::size_t kSamples = 500;
constexpr std::size_t kManySamples = 20'000;  // where a share is compared with kMuch: of thin things few are inside
constexpr std::size_t kMinSamples = 64;
constexpr std::size_t kSampledTriangles = 20'000'000;  // for all samples: of slivers, each sees every triangle

using Corners = std::vector<Vec3>;

/// A convex piece of a triangle.
struct Facet {
  Corners corners;
  std::int32_t triangle = 0;
  Aabb box = boundsOf(corners);
};

Vec3 polygonNormal(std::span<const Vec3> polygon) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    sum += (polygon[i] - polygon[0]).cross(polygon[i + 1] - polygon[0]);
  }
  return 0.5 * sum;
}

Aabb grown(Aabb box, double by) {
  box.min.array() -= by;
  box.max.array() += by;
  return box;
}

/// Whether a plane separates two convex polygons by more than the tolerance: across one of them, through an edge of
/// one, or along an edge of each.
bool apart(std::span<const Vec3> a, std::span<const Vec3> b, double tolerance) {
  const auto separates = [&](const Vec3& axis, double sizes) {  // sizes: squared lengths of what it is a product of
    const double squared = axis.squaredNorm();
    if (squared <= 1e-28 * sizes) return false;
    const auto range = [&axis](std::span<const Vec3> polygon) {
      double low = kInfinity, high = -kInfinity;
      for (const Vec3& p : polygon) {
        const double along = axis.dot(p);
        low = std::min(low, along);
        high = std::max(high, along);
      }
      return std::pair(low, high);
    };
    const auto [lowA, highA] = range(a);
    const auto [lowB, highB] = range(b);
    const double gap = std::max(lowA - highB, lowB - highA);
    return gap > 0.0 && gap * gap > tolerance * tolerance * squared;
  };
  const auto edge = [](std::span<const Vec3> polygon, std::size_t i) -> Vec3 {
    return polygon[i + 1 < polygon.size() ? i + 1 : 0] - polygon[i];
  };
  const Vec3 normalA = polygonNormal(a), normalB = polygonNormal(b);
  const double sizeA = normalA.squaredNorm(), sizeB = normalB.squaredNorm();
  if (separates(normalA, sizeA) || separates(normalB, sizeB)) return true;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vec3 own = edge(a, i);
    const double size = own.squaredNorm();
    if (separates(own.cross(normalA), size * sizeA)) return true;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const Vec3 other = edge(b, j);
      if (separates(own.cross(other), size * other.squaredNorm())) return true;
    }
  }
  for (std::size_t j = 0; j < b.size(); ++j) {
    const Vec3 other = edge(b, j);
    if (separates(other.cross(normalB), other.squaredNorm() * sizeB)) return true;
  }
  return false;
}

/// Cuts a convex polygon in two. @return the second half, empty if the plane does not divide it
Corners cutOff(Corners& polygon, const Vec3& normal, double offset, double tolerance) {
  std::vector<double> height(polygon.size());
  bool above = false, below = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    height[i] = normal.dot(polygon[i]) - offset;
    above = above || height[i] > tolerance;
    below = below || height[i] < -tolerance;
  }
  if (!above || !below) return {};
  std::array<Corners, 2> halves;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const std::size_t next = (i + 1) % polygon.size();
    if (height[i] >= -tolerance) halves[0].push_back(polygon[i]);
    if (height[i] <= tolerance) halves[1].push_back(polygon[i]);
    const bool crosses =
        (height[i] > tolerance && height[next] < -tolerance) || (height[i] < -tolerance && height[next] > tolerance);
    if (!crosses) continue;
    const Vec3 at = polygon[i] + height[i] / (height[i] - height[next]) * (polygon[next] - polygon[i]);
    for (Corners& half : halves) half.push_back(at);
  }
  polygon = std::move(halves[0]);
  return std::move(halves[1]);
}

/// The triangulation of a nearly convex polygon whose thinnest triangle is as thick as possible: corners may lie on its
/// edges.
void triangulate(std::span<const VertexIndex> polygon, std::span<const Vec3> vertices, std::vector<Triangle>& into) {
  const std::size_t n = polygon.size();
  std::vector<double> best(n * n, kInfinity);
  std::vector<std::size_t> middle(n * n, 0);
  for (std::size_t span = 2; span < n; ++span) {
    for (std::size_t i = 0; i + span < n; ++i) {
      const std::size_t k = i + span;
      best[i * n + k] = -1.0;
      for (std::size_t j = i + 1; j < k; ++j) {
        const Vec3& a = vertices[polygon[i]];
        const Vec3 ab = vertices[polygon[j]] - a, ac = vertices[polygon[k]] - a;
        const double longest = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
        const double height = longest > 0.0 ? ab.cross(ac).norm() / longest : 0.0;
        const double thinnest = std::min({best[i * n + j], best[j * n + k], height});
        if (thinnest <= best[i * n + k]) continue;
        best[i * n + k] = thinnest;
        middle[i * n + k] = j;
      }
    }
  }
  std::vector<std::pair<std::size_t, std::size_t>> open = {{0, n - 1}};
  while (!open.empty()) {
    const auto [i, k] = open.back();
    open.pop_back();
    if (k < i + 2) continue;
    const std::size_t j = middle[i * n + k];
    into.push_back({polygon[i], polygon[j], polygon[k]});
    open.insert(open.end(), {{i, j}, {j, k}});
  }
}

/// Removes corners that repeat, and spikes that run out and back. @return false if nothing is left
bool tidy(std::vector<VertexIndex>& polygon) {
  for (std::size_t i = 0; i < polygon.size() && polygon.size() > 2;) {
    const std::size_t next = (i + 1) % polygon.size(), after = (i + 2) % polygon.size();
    if (polygon[i] == polygon[next] || polygon[i] == polygon[after]) {
      polygon.erase(polygon.begin() + next);
      i = 0;
    } else {
      ++i;
    }
  }
  return polygon.size() > 2;
}

class Union {
 public:
  Union(const TriMesh& mesh, const MeshPieces& pieces)
      : mesh_(mesh), pieceOf_(pieces.pieceOfTriangle), tree_(mesh.vertices, mesh.triangles) {
    diagonal_ = surfaceBounds(mesh).diagonal();
    pieceBoxes_.resize(pieces.members.size());
    for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
      for (const Vec3& p : cornersOf(k)) pieceBoxes_[pieceOf_[k]].extend(p);
    }
    reached_.resize(pieceBoxes_.size());
    std::vector<std::size_t> order(pieceBoxes_.size());  // along x: a file may have very many pieces
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [this](std::size_t p) { return pieceBoxes_[p].min.x(); });
    std::size_t pairs = 0;
    for (auto a = order.begin(); a != order.end(); ++a) {
      const Aabb box = grown(pieceBoxes_[*a], 1e-6 * diagonal_);
      for (auto b = a + 1; b != order.end() && pieceBoxes_[*b].min.x() <= box.max.x(); ++b) {
        if (!overlap(pieceBoxes_[*b], box)) continue;
        if (++pairs > kMaxPieces) {
          stepsLeft_ = 0;
          return;
        }
        reached_[*a].push_back(*b);
        reached_[*b].push_back(*a);
      }
    }
  }

  [[nodiscard]] const TriangleTree& tree() const { return tree_; }

  /// Whether boxes of pieces overlap.
  [[nodiscard]] bool possible() const {
    return std::ranges::any_of(reached_, [](const auto& others) { return !others.empty(); });
  }

  /// The union as far as the tolerance finds it: not necessarily closed; empty once all this takes too many steps.
  /// @param within  also unite pieces with themselves
  TriMesh make(double tolerance, bool within) {
    tolerance_ = tolerance * diagonal_;
    within_ = within;
    if (!tookTooLong()) findPartners();
    if (tookTooLong()) return {};
    TriMesh made = assemble(keptFacets());
    return tookTooLong() ? TriMesh() : made;
  }

  /// Whether pieces lie across each other in too many places.
  [[nodiscard]] bool tookTooLong() const { return stepsLeft_ == 0; }

  /// Pieces of which a part is gone.
  [[nodiscard]] std::size_t overlapping() const { return std::ranges::count(cut_, true); }

 private:
  /// @return whether so many steps are still allowed; if not, none is from then on
  bool spend(std::size_t steps) {
    stepsLeft_ = steps < stepsLeft_ ? stepsLeft_ - steps : 0;
    return stepsLeft_ > 0;
  }

  [[nodiscard]] std::array<Vec3, 3> cornersOf(std::int32_t k) const {
    const Triangle& t = mesh_.triangles[k];
    return {mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]]};
  }

  [[nodiscard]] Facet facetOf(std::int32_t k) const {
    const std::array<Vec3, 3> corners = cornersOf(k);
    return {Corners(corners.begin(), corners.end()), k};
  }

  /// Finds the triangles that each triangle touches, of other pieces unless within_, in order along the longest axis.
  void findPartners() {
    partners_.assign(mesh_.triangles.size(), {});
    struct Entry {
      Aabb box;
      std::int32_t triangle;
    };
    std::vector<Entry> entries;
    for (std::size_t k = 0; k < mesh_.triangles.size(); ++k) {
      const Aabb box = grown(boundsOf(cornersOf(k)), tolerance_);
      if (within_ ||
          std::ranges::any_of(reached_[pieceOf_[k]], [&](std::size_t p) { return overlap(pieceBoxes_[p], box); })) {
        entries.push_back({box, static_cast<std::int32_t>(k)});
      }
    }
    const Aabb all = surfaceBounds(mesh_);
    Eigen::Index axis = 0;
    (all.max - all.min).maxCoeff(&axis);
    std::ranges::stable_sort(entries, {}, [axis](const Entry& e) { return e.box.min[axis]; });
    std::vector<std::size_t> rank(mesh_.triangles.size(), 0);
    for (std::size_t i = 0; i < entries.size(); ++i) rank[entries[i].triangle] = i;
    std::vector<std::size_t> near;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const std::int32_t a = entries[i].triangle;
      near.clear();
      tree_.forEachNear(grown(entries[i].box, tolerance_), [&](std::int32_t b) {
        const bool other = pieceOf_[a] != pieceOf_[b] || (within_ && disjoint(a, b));
        if (other && rank[b] > i && overlap(entries[i].box, entries[rank[b]].box)) near.push_back(rank[b]);
      });
      if (!spend(kApartSteps * near.size() + 1)) return;
      std::ranges::sort(near);
      const std::array<Vec3, 3> own = cornersOf(a);
      for (const std::size_t j : near) {
        const std::int32_t b = entries[j].triangle;
        if (apart(own, cornersOf(b), tolerance_)) continue;
        partners_[a].push_back(b);
        partners_[b].push_back(a);
      }
    }
  }

  /// Whether two triangles have no corner in common.
  [[nodiscard]] bool disjoint(std::int32_t a, std::int32_t b) const {
    return std::ranges::find_first_of(mesh_.triangles[a], mesh_.triangles[b]) == mesh_.triangles[a].end();
  }

  [[nodiscard]] bool coplanar(std::int32_t a, std::int32_t b) const {
    const Vec3 normal = polygonNormal(cornersOf(a)).normalized();
    return std::ranges::all_of(cornersOf(b), [&, corner = cornersOf(a)[0]](const Vec3& p) {
      return std::abs(normal.dot(p - corner)) <= tolerance_;
    });
  }

  /// Cuts a triangle where the others pass through it. One in the same plane cuts along its edges.
  [[nodiscard]] std::vector<Facet> facetsOf(std::int32_t k) {
    std::vector<Facet> facets = {facetOf(k)};
    const Vec3 own = polygonNormal(facets[0].corners).normalized();
    for (const std::int32_t other : partners_[k]) {
      const std::array<Vec3, 3> corners = cornersOf(other);
      const Aabb box = grown(boundsOf(corners), tolerance_);
      std::vector<std::pair<Vec3, double>> planes;
      if (coplanar(k, other)) {
        for (std::size_t i = 0; i < 3; ++i) {
          const Vec3 across = own.cross(corners[(i + 1) % 3] - corners[i]).normalized();
          planes.emplace_back(across, across.dot(corners[i]));
        }
      } else {
        const Vec3 normal = polygonNormal(corners).normalized();
        planes.emplace_back(normal, normal.dot(corners[0]));
      }
      for (const auto& [normal, offset] : planes) {
        if (!spend(facets.size() / kApartSteps)) return facets;
        for (std::size_t f = 0, count = facets.size(); f < count; ++f) {
          if (!overlap(facets[f].box, box)) continue;
          if (!spend(kApartSteps)) return facets;
          if (apart(facets[f].corners, corners, tolerance_)) continue;
          Corners rest = cutOff(facets[f].corners, normal, offset, tolerance_);
          if (rest.empty()) continue;
          facets[f].box = boundsOf(facets[f].corners);
          facets.push_back({std::move(rest), k});
        }
      }
    }
    return facets;
  }

  /// Whether a facet is on the surface of the union: there is nothing in front of it and something behind. Of several
  /// in the same plane, the one of the first piece.
  [[nodiscard]] bool onSurface(const Facet& facet) {
    const Vec3 area = polygonNormal(facet.corners);
    Vec3 center = Vec3::Zero();
    double around = 0.0;
    for (std::size_t i = 0; i < facet.corners.size(); ++i) {
      center += facet.corners[i] / facet.corners.size();
      around += (facet.corners[(i + 1) % facet.corners.size()] - facet.corners[i]).norm();
    }
    const double thickness = around > 0.0 ? area.norm() / around : 0.0;
    std::vector<std::int32_t> inPlane;  // their planes may be the tolerance away
    for (const std::int32_t other : partners_[facet.triangle]) {
      if (coplanar(facet.triangle, other)) inPlane.push_back(other);
    }
    const double least = inPlane.empty() ? 1e-3 * tolerance_ : 4.0 * tolerance_;
    const Vec3 step = std::clamp(0.01 * thickness, least, 40.0 * tolerance_) * area.normalized();
    std::size_t looked = partners_[facet.triangle].size();
    const bool between = tree_.windingNumber(center + step, &looked) <= kInside &&
                         tree_.windingNumber(center - step, &looked) >= kInside;
    if (!spend(looked) || !between) return false;
    return std::ranges::none_of(inPlane, [&](std::int32_t other) {
      const std::array<Vec3, 3> corners = cornersOf(other);
      return std::pair(pieceOf_[other], other) < std::pair(pieceOf_[facet.triangle], facet.triangle) &&
             polygonNormal(corners).dot(area) > 0.0 &&
             std::sqrt(nearestOnTriangle(center, {corners[0], corners[1], corners[2]}).first) <= 2.0 * tolerance_;
    });
  }

  /// Triangles that no other touches are on the surface together with their neighbours.
  [[nodiscard]] std::vector<Facet> keptFacets() {
    UnionFind groups(mesh_.triangles.size());
    EdgeTable(mesh_.vertices.size(), mesh_.triangles)
        .forEachEdge([&](VertexIndex, std::span<const TriangleSide> sides) {
          const std::int32_t a = sides.front().triangle, b = sides.back().triangle;
          if (!partners_[a].empty() || !partners_[b].empty()) return;
          groups.unite(a, b);
        });
    cut_.assign(pieceBoxes_.size(), false);
    std::vector<std::int32_t> largest(mesh_.triangles.size(), -1);  // of a group, at its root
    const auto areaOf = [&](std::int32_t k) { return polygonNormal(cornersOf(k)).norm(); };
    for (std::int32_t k = 0; k < countOf(mesh_.triangles); ++k) {
      std::int32_t& shown = largest[groups.find(k)];
      if (shown < 0 || areaOf(k) > areaOf(shown)) shown = k;
    }
    std::vector<bool> kept(mesh_.triangles.size());  // of a group, at its largest triangle
    for (const std::int32_t k : largest) {
      if (tookTooLong()) return {};
      if (k >= 0)
        kept[k] = partners_[k].empty() && ((reached_[pieceOf_[k]].empty() && !within_) || onSurface(facetOf(k)));
    }
    std::vector<Facet> facets;
    for (std::int32_t k = 0; k < countOf(mesh_.triangles); ++k) {
      const bool whole = partners_[k].empty();
      if (tookTooLong()) return {};
      for (Facet& facet : whole ? std::vector<Facet>{facetOf(k)} : facetsOf(k)) {
        if (whole ? kept[largest[groups.find(k)]] : onSurface(facet)) {
          facets.push_back(std::move(facet));
        } else {
          cut_[pieceOf_[k]] = true;
        }
      }
    }
    return facets;
  }

  /// Joins facets at common vertices: those that lie on an edge of another become its corners.
  [[nodiscard]] TriMesh assemble(const std::vector<Facet>& facets) {
    TriMesh result;
    result.vertices = mesh_.vertices;
    NearPositions positions(tolerance_, surfaceBounds(mesh_).min);
    const auto always = [](VertexIndex) { return true; };
    std::vector<VertexIndex> numberOf(mesh_.vertices.size());
    for (VertexIndex v = 0; v < countOf(mesh_.vertices); ++v)
      numberOf[v] = positions.firstAt(v, mesh_.vertices, always);
    std::vector<std::vector<VertexIndex>> polygons;
    std::vector<VertexIndex> onEdges;  // may lie on edges of others
    for (const Facet& facet : facets) {
      std::vector<VertexIndex>& polygon = polygons.emplace_back();
      if (partners_[facet.triangle].empty()) {
        for (const VertexIndex v : mesh_.triangles[facet.triangle]) polygon.push_back(numberOf[v]);
        continue;
      }
      for (const Vec3& p : facet.corners) {
        const VertexIndex own = countOf(result.vertices);
        result.vertices.push_back(p);
        const VertexIndex first = positions.firstAt(own, result.vertices, always);
        if (first != own) result.vertices.pop_back();
        polygon.push_back(first);
        onEdges.push_back(first);
      }
    }
    const auto byX = [&](VertexIndex a, VertexIndex b) {
      const double xa = result.vertices[a].x(), xb = result.vertices[b].x();
      return xa != xb ? xa < xb : a < b;
    };
    std::ranges::sort(onEdges, byX);
    onEdges.erase(std::unique(onEdges.begin(), onEdges.end()), onEdges.end());
    for (const std::vector<VertexIndex>& polygon : polygons) {
      std::vector<VertexIndex> full;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        full.push_back(polygon[i]);
        addVerticesOn(polygon[i], polygon[(i + 1) % polygon.size()], onEdges, result.vertices, full);
      }
      if (!spend(full.size() * full.size() * full.size() / 64)) break;  // of a triangulation's smaller steps
      if (tidy(full)) triangulate(full, result.vertices, result.triangles);
    }
    return result;
  }

  /// Appends the vertices that lie between two others, in order from `from` to `to`.
  void addVerticesOn(VertexIndex from, VertexIndex to, std::span<const VertexIndex> onEdges,
                     std::span<const Vec3> vertices, std::vector<VertexIndex>& into) {
    const Vec3& a = vertices[from];
    const Vec3 along = vertices[to] - a;
    const double lengthSq = along.squaredNorm();
    if (lengthSq <= 0.0) return;
    const Aabb box = grown(boundsOf(std::array{a, vertices[to]}), tolerance_);
    std::vector<std::pair<double, VertexIndex>> between;
    for (auto at = std::ranges::lower_bound(onEdges, box.min.x(), {}, [&](VertexIndex v) { return vertices[v].x(); });
         at != onEdges.end() && vertices[*at].x() <= box.max.x() && spend(1); ++at) {
      const Vec3& p = vertices[*at];
      if (*at == from || *at == to || !overlap(box, Aabb{p, p})) continue;
      const double share = (p - a).dot(along) / lengthSq;
      if (share <= 0.0 || share >= 1.0 || (p - a - share * along).squaredNorm() > tolerance_ * tolerance_) continue;
      between.emplace_back(share, *at);
    }
    std::ranges::sort(between);
    for (const auto& [share, v] : between) into.push_back(v);
  }

  const TriMesh& mesh_;
  const std::vector<std::int32_t>& pieceOf_;  ///< of each triangle
  TriangleTree tree_;
  std::size_t stepsLeft_ = kMaxUnionSteps;
  double diagonal_ = 0.0;
  double tolerance_ = 0.0;  ///< [mesh units]
  bool within_ = false;
  std::vector<Aabb> pieceBoxes_;
  std::vector<std::vector<std::size_t>> reached_;    ///< for each piece, others whose boxes overlap its own
  std::vector<std::vector<std::int32_t>> partners_;  ///< for each triangle, others that it touches
  std::vector<bool> cut_;                            ///< for each piece: a part of it is gone
};

/// Calls visit(point) for points that fill the bounds of a surface evenly, but not for those very near to it.
void forEachSample(const TriMesh& mesh, const TriangleTree& tree, std::size_t samples, const auto& visit) {
  const Aabb box = surfaceBounds(mesh);
  const double near = 1e-4 * box.diagonal();
  const std::size_t count = std::clamp(kSampledTriangles / mesh.triangles.size(), kMinSamples, samples);
  for (std::size_t i = 1; i <= count; ++i) {
    // An additive recurrence with powers of a root of x^4 = x + 1.
    const Vec3 at(std::fmod(i * 0.8191725133961645, 1.0), std::fmod(i * 0.6710436067037893, 1.0),
                  std::fmod(i * 0.5497004779019703, 1.0));
    const Vec3 p = box.min + at.cwiseProduct(box.max - box.min);
    if (tree.distance(p) > near) visit(p);
  }
}

/// The share of a solid that its surface winds around more than once, as far as samples show.
double shareTwice(const TriMesh& mesh, const TriangleTree& tree, std::size_t samples) {
  int inside = 0, twice = 0;
  forEachSample(mesh, tree, samples, [&](const Vec3& p) {
    const double winding = tree.windingNumber(p);
    inside += winding > kInside ? 1 : 0;
    twice += winding > 1.0 + kInside ? 1 : 0;
  });
  return inside > 0 ? static_cast<double>(twice) / inside : 0.0;
}

/// Whether a surface winds once around what another winds around at all, as far as samples show.
bool holdsOnce(const TriMesh& whole, const TriMesh& pieces, const TriangleTree& before) {
  const TriangleTree after(whole.vertices, whole.triangles);
  bool same = true;
  forEachSample(pieces, before, kSamples, [&](const Vec3& p) {
    const double winding = after.windingNumber(p);
    same = same && (before.windingNumber(p) > kInside) == (winding > kInside) && winding < 1.0 + kInside;
  });
  return same;
}

}  // namespace

Result<std::optional<ShellUnion>> uniteShells(const TriMesh& mesh) {
  const MeshPieces pieces = findPieces(mesh);
  Union shells(mesh, pieces);
  if (!shells.possible() && shareTwice(mesh, shells.tree(), kSamples) == 0.0) return std::optional<ShellUnion>();
  const double sum = signedVolume(mesh.vertices, mesh.triangles);
  for (const double tolerance : kTolerances) {
    for (const bool within : {false, true}) {  // pieces that overlap themselves are rare and take longer
      if (!within && !shells.possible()) continue;
      const TriMesh made = shells.make(tolerance, within);
      if (made.triangles.empty()) continue;
      Result<MeshRepair> repaired = repairClosedMesh(made);
      if (!repaired || !checkClosedTwoManifold(repaired->mesh) || !holdsOnce(repaired->mesh, mesh, shells.tree()))
        continue;
      const double volume = signedVolume(repaired->mesh.vertices, repaired->mesh.triangles);
      if (std::abs(volume - sum) <= kOverlap * sum) return std::optional<ShellUnion>();
      return std::optional(ShellUnion{std::move(repaired->mesh), shells.overlapping()});
    }
  }
  if (shells.tookTooLong()) return badMesh("pieces lie across each other in more places than can be resolved");
  if (shareTwice(mesh, shells.tree(), kManySamples) < kMuch) return std::optional<ShellUnion>();
  return badMesh("{} of {} pieces overlap in a way that cannot be resolved", shells.overlapping(),
                 pieces.members.size());
}

}  // namespace lorica

#include "geometry/mesh_repair.h"

#include "geometry/counts.h"
#include "geometry/edge_table.h"
#include "geometry/text.h"
#include "geometry/union_find.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>

namespace lorica {

namespace {

/// Whether the corners are an even permutation of the sorted corners.
bool isEven(const Triangle& t) {
  const auto smallest = std::min_element(t.begin(), t.end()) - t.begin();
  return t[static_cast<std::size_t>(smallest + 1) % 3] < t[static_cast<std::size_t>(smallest + 2) % 3];
}

std::size_t edgeOf(const Triangle& t, VertexIndex a, VertexIndex b) {
  for (std::size_t e = 0; e < 3; ++e) {
    if (t[e] == a && t[(e + 1) % 3] == b) return e;
  }
  LORICA_CHECK(false, "the edge table must list only edges of this triangle");
}

/// Two triangles that stay joined at an edge: `up` runs along the edge from its smaller vertex to its larger one.
struct Seam {
  std::int32_t up, down;
};

class ManifoldRepairer {
 public:
  explicit ManifoldRepairer(const TriMesh& mesh) : input_(mesh) {
    alive_.assign(mesh.triangles.size(), true);
    repair_.mesh.vertices = mesh.vertices;
    repair_.origin.reserve(mesh.vertices.size());
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      repair_.origin.push_back({static_cast<VertexIndex>(v), static_cast<VertexIndex>(v)});
    }
  }

  MeshRepair unchanged() {
    gatherTriangles();
    return std::move(repair_);
  }

  /// Returns nothing if an edge is not closed or no triangle is left.
  std::optional<MeshRepair> run() {
    dropRepeatedCorners();
    dropCopies();
    gatherTriangles();
    if (triangles().empty() || !joinTriangles()) return std::nullopt;
    doubleVertices();
    halveEdges();
    return std::move(repair_);
  }

 private:
  [[nodiscard]] std::vector<Triangle>& triangles() { return repair_.mesh.triangles; }

  void dropRepeatedCorners() {
    for (std::size_t i = 0; i < alive_.size(); ++i) {
      if (!hasRepeatedCorner(input_.triangles[i])) continue;
      alive_[i] = false;
      ++repair_.repeatedCorners;
    }
  }

  // Handles triangles with the same three corners: removes pairs with opposite orientation, which enclose nothing, and
  // copies that keep an edge open. Only at edges with more than two triangles, so a manifold mesh is not changed.
  void dropCopies() {
    gatherTriangles();
    std::vector<int> excess;  // for each edge, ascending minus descending triangles
    std::vector<std::array<std::size_t, 3>> edges(triangles().size());
    std::vector<bool> nonManifold(triangles().size(), false);
    EdgeTable table(input_.vertices.size(), triangles());
    table.forEachEdge([&](VertexIndex v, std::span<const TriangleSide> sides) {
      for (const TriangleSide& s : sides) {
        const std::size_t t = s.triangle;
        edges[t][edgeOf(triangles()[t], s.ascending ? v : s.larger, s.ascending ? s.larger : v)] = excess.size();
        if (sides.size() > 2) nonManifold[t] = true;
      }
      const auto upward = std::count_if(sides.begin(), sides.end(), [](const TriangleSide& s) { return s.ascending; });
      excess.push_back(2 * upward - std::ssize(sides));
    });
    const auto directionOf = [&](std::size_t t, std::size_t e) {
      return triangles()[t][e] < triangles()[t][(e + 1) % 3] ? 1 : -1;
    };
    const auto isTooMany = [&](std::size_t t) {
      for (std::size_t e = 0; e < 3; ++e) {
        if (excess[edges[t][e]] * directionOf(t, e) <= 0) return false;
      }
      return true;
    };
    std::vector<std::size_t> order(triangles().size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return sortedCorners(triangles()[a]) < sortedCorners(triangles()[b]);
    });
    for (std::size_t from = 0; from < order.size();) {
      std::size_t to = from + 1;
      while (to < order.size() && sortedCorners(triangles()[order[to]]) == sortedCorners(triangles()[order[from]]))
        ++to;
      std::array<std::vector<std::size_t>, 2> facing;
      for (std::size_t i = from; i < to; ++i) facing[isEven(triangles()[order[i]]) ? 1 : 0].push_back(order[i]);
      while (!facing[0].empty() && !facing[1].empty() && nonManifold[facing[0].back()]) {
        for (std::vector<std::size_t>& side : facing) {
          drop(side.back());
          side.pop_back();
        }
        repair_.backToBack += 2;
      }
      for (std::vector<std::size_t>& side : facing) {
        while (side.size() > 1 && isTooMany(side.back())) {
          drop(side.back());
          for (std::size_t e = 0; e < 3; ++e) excess[edges[side.back()][e]] -= directionOf(side.back(), e);
          side.pop_back();
          ++repair_.duplicateTriangles;
        }
      }
      from = to;
    }
  }

  void drop(std::size_t gathered) { alive_[repair_.sourceTriangle[gathered]] = false; }

  void gatherTriangles() {
    triangles().clear();
    repair_.sourceTriangle.clear();
    for (std::size_t i = 0; i < alive_.size(); ++i) {
      if (!alive_[i]) continue;
      triangles().push_back(input_.triangles[i]);
      repair_.sourceTriangle.push_back(i);
    }
  }

  // Finds, for each side of a triangle, the side that it stays joined to. Corners at a vertex that are connected across
  // such seams form a fan.
  bool joinTriangles() {
    fans_ = UnionFind(3 * triangles().size());
    bool closed = true;
    EdgeTable table(input_.vertices.size(), triangles());
    table.forEachEdge([&](VertexIndex v, std::span<const TriangleSide> sides) {
      const VertexIndex w = sides[0].larger;
      const auto upward = std::count_if(sides.begin(), sides.end(), [](const TriangleSide& s) { return s.ascending; });
      if (2 * upward != std::ssize(sides)) {
        closed = false;
        return;
      }
      if (sides.size() == 2) {
        join(v, w,
             sides[0].ascending ? Seam{sides[0].triangle, sides[1].triangle}
                                : Seam{sides[1].triangle, sides[0].triangle});
        return;
      }
      ++repair_.nonManifoldEdges;
      for (const Seam& seam : pairedByAngle(v, w, sides)) {
        join(v, w, seam);
        nonManifoldSeams_.push_back({v, w, seam});
      }
    });
    return closed;
  }

  void join(VertexIndex v, VertexIndex w, const Seam& seam) {
    const std::size_t up = edgeOf(triangles()[seam.up], v, w);
    const std::size_t down = edgeOf(triangles()[seam.down], w, v);
    fans_.unite(cornerIndex(seam.up, up), cornerIndex(seam.down, down + 1));
    fans_.unite(cornerIndex(seam.up, up + 1), cornerIndex(seam.down, down));
  }

  static std::size_t cornerIndex(std::int32_t triangle, std::size_t corner) {
    return 3 * static_cast<std::size_t>(triangle) + corner % 3;
  }

  // A counter-clockwise sweep about v -> w leaves the solid at a triangle that runs v -> w and enters it at a triangle
  // that runs w -> v. Entries and exits are matched like nested brackets; each pair bounds one wedge of solid.
  [[nodiscard]] std::vector<Seam> pairedByAngle(VertexIndex v, VertexIndex w,
                                                std::span<const TriangleSide> sides) const {
    const Vec3& origin = vertex(v);
    const Vec3 axis = vertex(w) - origin;
    const bool hasDirection = axis.squaredNorm() > 0.0;
    const Vec3 x = hasDirection ? axis.normalized().unitOrthogonal() : Vec3::Zero();
    const Vec3 y = hasDirection ? Vec3(axis.normalized().cross(x)) : Vec3::Zero();
    struct Leaf {
      double angle;
      TriangleSide side;
    };
    std::vector<Leaf> leaves;
    leaves.reserve(sides.size());
    for (const TriangleSide& s : sides) {
      Vec3 apex = origin;
      for (const VertexIndex corner : repair_.mesh.triangles[s.triangle]) {
        if (corner != v && corner != w) apex = vertex(corner);
      }
      leaves.push_back({std::atan2(y.dot(apex - origin), x.dot(apex - origin)), s});
    }
    // At equal angles, exits first: two solids that share a face, rather than one solid of zero thickness.
    std::stable_sort(leaves.begin(), leaves.end(), [](const Leaf& a, const Leaf& b) {
      return a.angle != b.angle ? a.angle < b.angle : a.side.ascending > b.side.ascending;
    });
    // Start after the position of minimum depth, where no bracket is open.
    std::size_t start = 0;
    int depth = 0, lowest = 0;
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      depth += leaves[i].side.ascending ? -1 : 1;
      if (depth < lowest) {
        lowest = depth;
        start = i + 1;
      }
    }
    std::vector<Seam> seams;
    seams.reserve(sides.size() / 2);
    std::vector<std::int32_t> entered;
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      const TriangleSide& s = leaves[(start + i) % leaves.size()].side;
      if (s.ascending) {
        LORICA_CHECK(!entered.empty(), "after the position of minimum depth, every exit must have an entry");
        seams.push_back({s.triangle, entered.back()});
        entered.pop_back();
      } else {
        entered.push_back(s.triangle);
      }
    }
    return seams;
  }

  [[nodiscard]] const Vec3& vertex(VertexIndex v) const { return input_.vertices[v]; }

  // At the ends of non-manifold edges, gives each fan except the first its own vertex.
  void doubleVertices() {
    std::vector<bool> isEnd(input_.vertices.size(), false);
    for (const NonManifoldSeam& c : nonManifoldSeams_) isEnd[c.v] = isEnd[c.w] = true;
    std::vector<std::size_t> firstFan(input_.vertices.size(), kNone);
    std::vector<VertexIndex> vertexOfFan(fans_.count(), -1);
    for (std::size_t t = 0; t < triangles().size(); ++t) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        VertexIndex& v = triangles()[t][corner];
        if (!isEnd[v]) continue;
        const std::size_t fan = fans_.find(cornerIndex(t, corner));
        std::size_t& first = firstFan[v];
        if (first == kNone) first = fan;
        if (first == fan) continue;
        if (vertexOfFan[fan] < 0) {
          vertexOfFan[fan] = add({v, v}, vertex(v));
          ++repair_.doubledVertices;
        }
        v = vertexOfFan[fan];
      }
    }
  }

  VertexIndex add(const VertexOrigin& origin, const Vec3& position) {
    repair_.origin.push_back(origin);
    repair_.mesh.vertices.push_back(position);
    return countOf(repair_.origin) - 1;
  }

  // If two seams of an edge have the same vertices at both ends, gives the second seam a vertex at the midpoint.
  void halveEdges() {
    std::set<std::array<VertexIndex, 2>> taken;  // an edge may have very many seams
    std::vector<std::array<VertexIndex, 3>> middle(triangles().size(), {-1, -1, -1});  // of the edge at each corner
    bool any = false;
    for (std::size_t i = 0; i < nonManifoldSeams_.size(); ++i) {
      const auto& [v, w, seam] = nonManifoldSeams_[i];
      if (i == 0 || nonManifoldSeams_[i - 1].v != v || nonManifoldSeams_[i - 1].w != w) taken.clear();
      const std::size_t up = seam.up;
      const std::size_t down = seam.down;
      const std::size_t upEdge = edgeOf(input_.triangles[repair_.sourceTriangle[up]], v, w);
      const std::size_t downEdge = edgeOf(input_.triangles[repair_.sourceTriangle[down]], w, v);
      const std::array<VertexIndex, 2> ends = {triangles()[up][upEdge], triangles()[up][(upEdge + 1) % 3]};
      if (taken.insert(ends).second) continue;
      middle[up][upEdge] = middle[down][downEdge] = add({v, w}, 0.5 * (vertex(v) + vertex(w)));
      ++repair_.halvedEdges;
      any = true;
    }
    if (!any) return;
    std::vector<Triangle> split;
    std::vector<std::int32_t> source;
    split.reserve(triangles().size() + 2 * repair_.halvedEdges);
    source.reserve(split.capacity());
    for (std::size_t t = 0; t < triangles().size(); ++t) {
      // Corners and midpoints around the triangle, as a fan from a midpoint: no piece has all its corners on one edge.
      std::vector<VertexIndex> ring;
      std::size_t apex = 0;
      for (std::size_t corner = 0; corner < 3; ++corner) {
        ring.push_back(triangles()[t][corner]);
        if (middle[t][corner] < 0) continue;
        apex = ring.size();
        ring.push_back(middle[t][corner]);
      }
      std::rotate(ring.begin(), ring.begin() + apex, ring.end());
      for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
        split.push_back({ring[0], ring[i], ring[i + 1]});
        source.push_back(repair_.sourceTriangle[t]);
      }
    }
    triangles() = std::move(split);
    repair_.sourceTriangle = std::move(source);
  }

  static constexpr std::size_t kNone = -1;

  struct NonManifoldSeam {
    VertexIndex v, w;
    Seam seam;
  };
  const TriMesh& input_;
  MeshRepair repair_;
  std::vector<bool> alive_;
  UnionFind fans_;  // of corners
  std::vector<NonManifoldSeam> nonManifoldSeams_;
};

}  // namespace

bool MeshRepair::changed() const {
  return nonManifoldEdges + repeatedCorners + backToBack + duplicateTriangles > 0;
}

std::string MeshRepair::summary() const {
  std::vector<std::string> done;
  if (nonManifoldEdges > 0) {
    done.push_back(counted(nonManifoldEdges, "non-manifold edge", "non-manifold edges") + " separated");
  }
  if (doubledVertices > 0) done.push_back(counted(doubledVertices, "vertex", "vertices") + " duplicated");
  if (halvedEdges > 0) done.push_back(counted(halvedEdges, "edge", "edges") + " split at the midpoint");
  if (backToBack > 0) done.push_back(fmt::format("{} back-to-back triangles removed", backToBack));
  if (duplicateTriangles > 0) {
    done.push_back(counted(duplicateTriangles, "duplicate triangle", "duplicate triangles") + " removed");
  }
  if (repeatedCorners > 0) {
    done.push_back(counted(repeatedCorners, "triangle", "triangles") + " with a repeated corner removed");
  }
  return fmt::format("{}", fmt::join(done, ", "));
}

std::vector<Vec3> MeshRepair::carried(std::span<const Vec3> posed) const {
  std::vector<Vec3> result;
  result.reserve(origin.size());
  for (const auto& [first, second] : origin) {
    const Vec3& a = posed[first];
    result.push_back(first == second ? a : Vec3(0.5 * (a + posed[second])));
  }
  return result;
}

Result<MeshRepair> repairClosedMesh(const TriMesh& mesh) {
  const Result<void> checked = checkClosedTwoManifold(mesh);
  if (!checked && !isReadable(mesh)) return checked.error();
  ManifoldRepairer repairer(mesh);
  if (checked) return repairer.unchanged();
  std::optional<MeshRepair> repair = repairer.run();
  if (!repair) return checked.error();
  return std::move(*repair);
}

}  // namespace lorica

#include "geometry/mesh_pieces.h"

#include "geometry/edge_table.h"
#include "geometry/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace lorica {
namespace {

/// A triangle across an edge.
struct Neighbour {
  std::int32_t triangle = -1;
  bool agrees = true;  ///< it runs along the edge in the opposite direction, as it should
};

/// Of one triangle, across edges that exactly two triangles share.
struct Neighbours {
  std::array<Neighbour, 3> all;
  std::size_t count = 0;

  void add(const Neighbour& neighbour) {
    if (count < all.size()) all[count++] = neighbour;
  }
};

/// One piece of a closed surface.
struct Shell {
  std::vector<Triangle> triangles;
  Aabb box;
  double volume = 0.0;
  Vec3 sample = Vec3::Zero();                ///< a point on it, in the middle of its largest triangle
  std::unique_ptr<const TriangleTree> tree;  ///< made when it is asked for
  std::vector<std::size_t> around;           ///< the shells that it lies in
  bool reversed = false;

  [[nodiscard]] int sign() const { return (volume < 0.0) != reversed ? -1 : 1; }
};

bool holds(const Aabb& outer, const Aabb& inner) {
  return (outer.min.array() <= inner.min.array()).all() && (outer.max.array() >= inner.max.array()).all();
}

std::vector<Shell> shellsOf(const TriMesh& mesh, const MeshPieces& pieces) {
  std::vector<Shell> shells(pieces.members.size());
  std::vector<double> largest(shells.size(), -1.0);
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const std::size_t s = pieces.pieceOfTriangle[k];
    const Triangle& t = mesh.triangles[k];
    shells[s].triangles.push_back(t);
    for (const VertexIndex v : t) shells[s].box.extend(mesh.vertices[v]);
    if (const double area = areaNormal(mesh.vertices, t).norm(); area > largest[s]) {
      largest[s] = area;
      shells[s].sample = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0;
    }
  }
  for (Shell& shell : shells) shell.volume = signedVolume(mesh.vertices, shell.triangles);
  return shells;
}

/// @return false if too many shells may lie in others
bool findAround(const TriMesh& mesh, std::vector<Shell>& shells) {
  constexpr double kInside = 0.5;              // winding number, of either sign
  constexpr std::size_t kMaxNested = 500'000;  // pairs of a shell and one in its box: cavities make few
  std::vector<std::pair<std::size_t, std::size_t>> nested;
  for (std::size_t s = 0; s < shells.size(); ++s) {
    for (std::size_t other = 0; other < shells.size() && nested.size() <= kMaxNested; ++other) {
      if (other != s && holds(shells[other].box, shells[s].box)) nested.emplace_back(s, other);
    }
  }
  if (nested.size() > kMaxNested) return false;
  for (const auto& [s, other] : nested) {
    std::unique_ptr<const TriangleTree>& tree = shells[other].tree;
    if (!tree) tree = std::make_unique<const TriangleTree>(mesh.vertices, shells[other].triangles);
    if (std::abs(tree->windingNumber(shells[s].sample)) > kInside) shells[s].around.push_back(other);
  }
  return true;
}

}  // namespace

MeshPieces findPieces(const TriMesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  MeshPieces pieces;
  std::vector<Neighbours> across(count);
  std::vector<bool> border(count, false);
  EdgeTable(mesh.vertices.size(), mesh.triangles).forEachEdge([&](VertexIndex, std::span<const TriangleSide> sides) {
    if (sides.size() == 1) {
      ++pieces.openEdges;
      border[sides[0].triangle] = true;
    } else if (sides.size() == 2) {
      const bool agrees = sides[0].ascending != sides[1].ascending;
      across[sides[0].triangle].add({sides[1].triangle, agrees});
      across[sides[1].triangle].add({sides[0].triangle, agrees});
    } else {
      ++pieces.nonManifoldEdges;
    }
  });

  pieces.pieceOfTriangle.assign(count, -1);
  pieces.triangles = mesh.triangles;
  std::vector<bool> turned(count, false);
  for (std::size_t start = 0; start < count; ++start) {
    if (pieces.pieceOfTriangle[start] >= 0) continue;
    const std::int32_t number = pieces.members.size();
    std::vector<std::int32_t> walk{static_cast<std::int32_t>(start)};
    pieces.pieceOfTriangle[start] = number;
    bool open = false;
    double area = 0.0;
    double turnedArea = 0.0;
    for (std::size_t next = 0; next < walk.size(); ++next) {
      const std::size_t k = walk[next];
      const double own = areaNormal(mesh.vertices, mesh.triangles[k]).norm();
      area += own;
      if (turned[k]) turnedArea += own;
      open = open || border[k];
      for (std::size_t i = 0; i < across[k].count; ++i) {
        const auto [neighbour, agrees] = across[k].all[i];
        const bool other = turned[k] != !agrees;
        if (pieces.pieceOfTriangle[neighbour] >= 0) {
          pieces.orientable = pieces.orientable && turned[neighbour] == other;
          continue;
        }
        pieces.pieceOfTriangle[neighbour] = number;
        turned[neighbour] = other;
        walk.push_back(neighbour);
      }
    }
    const bool mostTurned = turnedArea > 0.5 * area;
    for (const std::int32_t k : walk) {
      if (turned[k] == mostTurned) continue;
      ++pieces.turned;
      std::swap(pieces.triangles[k][1], pieces.triangles[k][2]);
    }
    pieces.open.push_back(open);
    pieces.members.push_back(std::move(walk));
  }
  return pieces;
}

TurnedPieces turnPiecesOutward(TriMesh& mesh) {
  const MeshPieces pieces = findPieces(mesh);
  std::vector<Shell> shells = shellsOf(mesh, pieces);
  if (std::none_of(shells.begin(), shells.end(), [](const Shell& s) { return s.volume < 0.0; }) ||
      !findAround(mesh, shells)) {
    return {shells.size(), 0};
  }
  // Outer shells before those inside them.
  std::vector<std::size_t> order(shells.size());
  for (std::size_t s = 0; s < order.size(); ++s) order[s] = s;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return shells[a].around.size() < shells[b].around.size(); });
  for (const std::size_t s : order) {
    Shell& shell = shells[s];
    int depth = 0;  // how often solids wind around it
    bool alternate = false;
    for (const std::size_t outer : shell.around) {
      depth += shells[outer].sign();
      alternate = alternate || (shells[outer].around.empty() && shells[outer].reversed);
    }
    const bool wantsCavity = alternate ? shell.around.size() % 2 == 1 : shell.sign() < 0 && depth > 0;
    shell.reversed = wantsCavity != (shell.volume < 0.0);
  }
  TurnedPieces result{shells.size(), 0};
  for (const Shell& shell : shells) result.reversed += shell.reversed ? 1 : 0;
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    if (shells[pieces.pieceOfTriangle[k]].reversed) std::swap(mesh.triangles[k][1], mesh.triangles[k][2]);
  }
  return result;
}

}  // namespace lorica

#include "geometry/small_faults.h"

#include "geometry/counts.h"
#include "geometry/edge_table.h"
#include "geometry/mesh_pieces.h"
#include "geometry/mesh_repair.h"
#include "geometry/near_positions.h"
#include "geometry/shell_union.h"
#include "geometry/text.h"
#include "geometry/triangle_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

namespace lorica {
namespace {

/// A hole is a pinhole if it has at most this many edges, ...
constexpr std::size_t kPinholeEdges = 64;
/// ... its longest extent is at most this share of the surface's diagonal (any size if it has three edges: one triangle
/// is missing), ...
constexpr double kPinholeExtent = 0.05;
/// ... or its cap has at most this share of the connected piece's area: a slit, ...
constexpr double kSlitArea = 0.002;
/// ... and all holes of a connected piece have at most this share of the piece's area. A flat card is not a pinhole's
/// surroundings.
constexpr double kPinholeArea = 0.5;
/// Fins, triangles that a cap would close into a body without volume, have at most this share of their piece's area.
constexpr double kFinArea = 0.01;

struct Pinholes {
  std::size_t count = 0;
  std::vector<Triangle> caps;  ///< to be added to the mesh
};

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
        const double area =
            best[i * n + k] + best[k * n + j] + areaNormal(mesh.vertices, {loop[i], loop[k], loop[j]}).norm();
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
    const Vec3 own = areaNormal(mesh.vertices, caps[i]);
    for (std::size_t j = 0; j < i; ++j) {
      if (!shareAnEdge(caps[i], caps[j])) continue;
      const Vec3 other = areaNormal(mesh.vertices, caps[j]);
      if (std::min(own.norm(), other.norm()) <= kNoArea * extent * extent) continue;
      if (own.dot(other) < kFold * own.norm() * other.norm()) return true;
    }
  }
  return false;
}

/// Finds the holes of a surface and triangles that close them: those with the least area in total. They add no vertex.
/// Where a cap is the reverse of a triangle that is there, that one is a fin: repairClosedMesh() drops both.
/// @param mesh  triangles of one piece must face the same way
/// @return nothing if a hole is not a pinhole, if fins have too much area, or if a hole cannot be closed without
/// folding:
///         if two neighbouring triangles of its cap would face away from each other by more than 120 degrees
[[nodiscard]] std::optional<Pinholes> closePinholes(const TriMesh& mesh) {
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
    area[c] += areaNormal(mesh.vertices, mesh.triangles[k]).norm();
    for (const VertexIndex v : mesh.triangles[k]) componentOf[v] = c;
  }
  std::vector<Triangle> known;
  known.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) known.push_back(sortedCorners(t));
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
      const bool fin = std::binary_search(known.begin(), known.end(), sortedCorners(cap));
      (fin ? finArea[piece] : own) += areaNormal(mesh.vertices, cap).norm();
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

constexpr double kSamePosition = 1e-6;  // of the diagonal

/// The triangle with its smallest corner first, facing as before.
Triangle rotated(const Triangle& t) {
  const std::size_t first = std::min_element(t.begin(), t.end()) - t.begin();
  return {t[first], t[(first + 1) % 3], t[(first + 2) % 3]};
}

/// Keeps the first of triangles with equal keys. @return the number of dropped ones
template <typename Key>
std::size_t dropRepeated(std::vector<Triangle>& triangles, Key&& key) {
  std::vector<std::pair<Triangle, std::size_t>> keys;
  keys.reserve(triangles.size());
  for (std::size_t k = 0; k < triangles.size(); ++k) keys.emplace_back(key(triangles[k]), k);
  std::sort(keys.begin(), keys.end());
  std::vector<bool> repeated(triangles.size(), false);
  for (std::size_t i = 1; i < keys.size(); ++i) repeated[keys[i].second] = keys[i].first == keys[i - 1].first;
  std::size_t kept = 0;
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    if (!repeated[k]) triangles[kept++] = triangles[k];
  }
  const std::size_t dropped = triangles.size() - kept;
  triangles.resize(kept);
  return dropped;
}

/// How triangles with the same corners are told to be the same.
enum class Repeats {
  kSameWay,    ///< if they face the same way; others may be two solids that touch
  kEitherWay,  ///< always: a surface whose triangles are all there from both sides
};

std::vector<VertexIndex> leftOutOf(const TriMesh& input, const TriMesh& repaired) {
  std::vector<char> uses(input.vertices.size(), 0);
  for (const Triangle& t : input.triangles) {
    for (const VertexIndex v : t) uses[v] = 1;
  }
  for (const Triangle& t : repaired.triangles) {
    for (const VertexIndex v : t) {
      if (static_cast<std::size_t>(v) < uses.size()) uses[v] = 0;
    }
  }
  std::vector<VertexIndex> leftOut;
  for (std::size_t v = 0; v < uses.size(); ++v) {
    if (uses[v] != 0) leftOut.push_back(v);
  }
  return leftOut;
}

class FaultRepairer {
 public:
  explicit FaultRepairer(const TriMesh& mesh) : input_(mesh) { repair_.mesh = mesh; }

  /// Returns nothing if the result is not a closed two-manifold.
  std::optional<FaultRepair> run(Repeats repeats) {
    weld();
    repair_.repeatedCorners = std::erase_if(triangles(), hasRepeatedCorner);
    repair_.repeatedTriangles =
        repeats == Repeats::kSameWay ? dropRepeated(triangles(), rotated) : dropRepeated(triangles(), sortedCorners);
    if (triangles().empty()) return std::nullopt;
    dropSpecks();
    MeshPieces pieces = findPieces(repair_.mesh);
    if (!pieces.orientable) return std::nullopt;
    repair_.turnedTriangles = pieces.turned;
    triangles() = std::move(pieces.triangles);
    std::optional<Pinholes> pinholes = closePinholes(repair_.mesh);
    if (!pinholes) return std::nullopt;
    repair_.pinholes = pinholes->count;
    repair_.capTriangles = pinholes->caps.size();
    triangles().insert(triangles().end(), pinholes->caps.begin(), pinholes->caps.end());
    return finish();
  }

  TriMesh withoutRepeats() {
    weld();
    std::erase_if(triangles(), hasRepeatedCorner);
    dropRepeated(triangles(), sortedCorners);
    return std::move(repair_.mesh);
  }

  /// Without repairing anything but whole pieces and non-manifold edges.
  std::optional<FaultRepair> finish() {
    TriMesh& mesh = repair_.mesh;
    Result<MeshRepair> repair = repairClosedMesh(mesh);
    if (!repair) return std::nullopt;
    const bool insideOut = signedVolume(mesh.vertices, mesh.triangles) < 0.0;
    if (insideOut && repair->changed()) {
      // The repair tells the solid's wedges from the air's, so it must see the solid.
      for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
      repair_.reversed = true;
      repair = repairClosedMesh(mesh);
      if (!repair) return std::nullopt;
    }
    if (repair->changed()) {
      repair_.repaired = repair->summary();
      mesh = std::move(repair->mesh);
    }
    if (insideOut || connectedComponents(mesh.vertices.size(), mesh.triangles).count > 1) {
      const TurnedPieces turned = turnPiecesOutward(mesh);
      const bool all = turned.reversed == turned.pieces;
      repair_.reversed = repair_.reversed || all;
      repair_.reversedPieces = all ? 0 : turned.reversed;
    }
    if (!checkClosedTwoManifold(mesh)) return std::nullopt;
    repair_.leftOut = leftOutOf(input_, mesh);
    return std::move(repair_);
  }

 private:
  [[nodiscard]] std::vector<Triangle>& triangles() { return repair_.mesh.triangles; }

  void weld() {
    const std::size_t open = openEdgeCount(repair_.mesh);
    if (open == 0) return;
    const Aabb box = surfaceBounds(repair_.mesh);
    NearPositions positions(kSamePosition * box.diagonal(), box.min);
    const std::vector<bool> used = usedVertices(input_.vertices.size(), input_.triangles);
    std::vector<VertexIndex> first(used.size(), -1);
    std::size_t welded = 0;
    for (std::size_t v = 0; v < used.size(); ++v) {
      if (!used[v]) continue;
      const VertexIndex own = v;
      first[v] = positions.firstAt(own, input_.vertices, [](VertexIndex) { return true; });
      welded += first[v] == own ? 0 : 1;
    }
    TriMesh mesh = repair_.mesh;
    for (Triangle& t : mesh.triangles) {
      for (VertexIndex& v : t) v = first[v];
    }
    std::vector<Triangle> whole = mesh.triangles;
    std::erase_if(whole, hasRepeatedCorner);
    if (openEdgeCount({input_.vertices, whole}) >= open) return;
    repair_.weldedVertices = welded;
    repair_.mesh = std::move(mesh);
  }

  void dropSpecks() {
    const MeshPieces pieces = findPieces(repair_.mesh);
    const std::size_t count = pieces.members.size();
    std::vector<Aabb> boxes(count);
    std::vector<double> area(count, 0.0);
    for (std::size_t k = 0; k < triangles().size(); ++k) {
      const std::int32_t p = pieces.pieceOfTriangle[k];
      for (const VertexIndex v : triangles()[k]) boxes[p].extend(input_.vertices[v]);
      area[p] += surfaceArea(input_.vertices, std::span(triangles()).subspan(k, 1));
    }
    const double largest = kSpeckExtent * surfaceBounds(repair_.mesh).diagonal();
    std::vector<bool> speck(count, false);
    std::size_t specks = 0;
    double speckArea = 0.0;
    for (std::size_t p = 0; p < count; ++p) {
      speck[p] = pieces.open[p] && (boxes[p].max - boxes[p].min).maxCoeff() <= largest;
      if (!speck[p]) continue;
      ++specks;
      speckArea += area[p];
    }
    if (specks == 0 || speckArea > kSpeckArea * std::accumulate(area.begin(), area.end(), 0.0)) return;
    std::size_t kept = 0;
    for (std::size_t k = 0; k < triangles().size(); ++k) {
      if (!speck[pieces.pieceOfTriangle[k]]) triangles()[kept++] = triangles()[k];
    }
    triangles().resize(kept);
    repair_.specks = specks;
  }

  const TriMesh& input_;
  FaultRepair repair_;
};

}  // namespace

std::size_t dropDuplicates(std::vector<Triangle>& triangles) {
  return dropRepeated(triangles, sortedCorners);
}

bool FaultRepair::changed() const {
  return weldedVertices + repeatedCorners + repeatedTriangles + specks + turnedTriangles + pinholes + reversedPieces +
                 unitedPieces >
             0 ||
         reversed || !repaired.empty();
}

std::string FaultRepair::summary() const {
  std::vector<std::string> done;
  if (weldedVertices > 0) done.push_back(counted(weldedVertices, "vertex", "vertices") + " welded to others");
  if (repeatedCorners > 0) {
    done.push_back(counted(repeatedCorners, "triangle", "triangles") + " with a repeated corner dropped");
  }
  if (repeatedTriangles > 0) {
    done.push_back(counted(repeatedTriangles, "repeated triangle", "repeated triangles") + " dropped");
  }
  if (specks > 0) {
    done.push_back(counted(specks, "tiny open piece", "tiny open pieces") + " dropped, but inside the hulls");
  }
  if (turnedTriangles > 0) done.push_back(counted(turnedTriangles, "triangle", "triangles") + " turned");
  if (pinholes > 0) {
    done.push_back(fmt::format("{} closed with {}", counted(pinholes, "pinhole", "pinholes"),
                               counted(capTriangles, "triangle", "triangles")));
  }
  if (reversed) done.emplace_back("reversed, for it was inside out");
  if (!repaired.empty()) done.push_back(repaired);
  if (reversedPieces > 0)
    done.push_back(counted(reversedPieces, "inside-out piece", "inside-out pieces") + " reversed");
  if (unitedPieces > 0) {
    done.push_back(fmt::format("{} united: volume {:.6g}, together {:.6g}",
                               counted(unitedPieces, "overlapping piece", "overlapping pieces"), volume, sumOfVolumes));
  }
  return fmt::format("{}", fmt::join(done, ", "));
}

TriMesh withoutRepeats(const TriMesh& mesh) {
  return FaultRepairer(mesh).withoutRepeats();
}

Result<FaultRepair> repairSmallFaults(const TriMesh& mesh) {
  const Result<void> checked = checkClosedTwoManifold(mesh);
  if (!checked && (mesh.triangles.empty() || !isReadable(mesh))) return checked.error();
  std::optional<FaultRepair> repair = FaultRepairer(mesh).finish();
  const double diagonal = surfaceBounds(mesh).diagonal();
  if (!repair && !std::isfinite(diagonal * diagonal * diagonal)) return checked.error();
  if (!repair) repair = FaultRepairer(mesh).run(Repeats::kSameWay);
  if (!repair) repair = FaultRepairer(mesh).run(Repeats::kEitherWay);
  if (!repair) return checked.error();
  LORICA_TRY(std::optional<ShellUnion> united, uniteShells(repair->mesh));
  if (!united) return std::move(*repair);
  repair->unitedPieces = united->pieces;
  repair->sumOfVolumes = signedVolume(repair->mesh.vertices, repair->mesh.triangles);
  repair->volume = signedVolume(united->mesh.vertices, united->mesh.triangles);
  repair->mesh = std::move(united->mesh);
  // Parts cover the union, so vertices in it need no care.
  repair->leftOut = leftOutOf(mesh, repair->mesh);
  const TriangleTree tree(repair->mesh.vertices, repair->mesh.triangles);
  constexpr double kOutside = 0.1;  // winding number: 1/8 at a box's corner
  std::erase_if(repair->leftOut, [&](VertexIndex v) { return tree.windingNumber(mesh.vertices[v]) > kOutside; });
  return std::move(*repair);
}

}  // namespace lorica

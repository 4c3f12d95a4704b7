#include "geometry/small_faults.h"

#include "geometry/counts.h"
#include "geometry/mesh_pieces.h"
#include "geometry/mesh_repair.h"
#include "geometry/near_positions.h"
#include "geometry/pinholes.h"
#include "geometry/shell_union.h"
#include "geometry/triangle_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace lorica {
namespace {

constexpr double kSamePosition = 1e-6;  // of the diagonal

bool hasRepeatedCorner(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// The triangle with its smallest corner first, facing as before.
Triangle rotated(const Triangle& t) {
  const std::size_t first = std::min_element(t.begin(), t.end()) - t.begin();
  return {t[first], t[(first + 1) % 3], t[(first + 2) % 3]};
}

Triangle sorted(Triangle t) {
  std::sort(t.begin(), t.end());
  return t;
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

class Repairer {
 public:
  explicit Repairer(const TriMesh& mesh) : input_(mesh) { repair_.mesh = mesh; }

  /// Returns nothing if the result is not a closed two-manifold.
  std::optional<FaultRepair> run(Repeats repeats) {
    weld();
    repair_.repeatedCorners = std::erase_if(triangles(), hasRepeatedCorner);
    repair_.repeatedTriangles =
        repeats == Repeats::kSameWay ? dropRepeated(triangles(), rotated) : dropRepeated(triangles(), sorted);
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
    dropRepeated(triangles(), sorted);
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
    std::vector<bool> used(input_.vertices.size(), false);
    for (const Triangle& t : input_.triangles) {
      for (const VertexIndex v : t) used[v] = true;
    }
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

std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

bool isReadable(const TriMesh& mesh) {
  const auto inRange = [&](VertexIndex v) { return v >= 0 && v < countOf(mesh.vertices); };
  return !mesh.triangles.empty() && std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(), inRange);
  }) && std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [](const Vec3& p) { return p.allFinite(); });
}

}  // namespace

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
  return Repairer(mesh).withoutRepeats();
}

Result<FaultRepair> repairSmallFaults(const TriMesh& mesh) {
  const Result<void> checked = checkClosedTwoManifold(mesh);
  if (!checked && !isReadable(mesh)) return checked.error();
  std::optional<FaultRepair> repair = Repairer(mesh).finish();
  const double diagonal = surfaceBounds(mesh).diagonal();
  if (!repair && !std::isfinite(diagonal * diagonal * diagonal)) return checked.error();
  if (!repair) repair = Repairer(mesh).run(Repeats::kSameWay);
  if (!repair) repair = Repairer(mesh).run(Repeats::kEitherWay);
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

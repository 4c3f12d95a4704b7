#include "collision/hulls/mesh_walls.h"

#include "acd/part_concavity.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/mesh_repair.h"
#include "geometry/sheets.h"
#include "geometry/shell_union.h"
#include "geometry/small_faults.h"
#include "geometry/text.h"
#include "skinning/body/mesh_body.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace lorica {
namespace {

constexpr std::ptrdiff_t kMaxSheets = 512;                                     // with a wall each
constexpr std::array<const char*, 3> kWallNames = {"auto", "solid", "shell"};  // in the order of WallChoice

enum class ShellRole : std::uint8_t { kShell, kSolid, kSealed, kDropped };

/// Some triangles as a mesh of its own.
TriMesh meshOf(const TriMesh& mesh, std::span<const Triangle> triangles) {
  TriMesh own;
  own.triangles.assign(triangles.begin(), triangles.end());
  std::vector<VertexIndex> used;
  for (const Triangle& t : triangles) used.insert(used.end(), t.begin(), t.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  for (const VertexIndex v : used) own.vertices.push_back(mesh.vertices[v]);
  for (Triangle& t : own.triangles) {
    for (VertexIndex& v : t) v = std::lower_bound(used.begin(), used.end(), v) - used.begin();
  }
  return own;
}

class WallMaker {
 public:
  WallMaker(const TriMesh& mesh, const CharacterOptions& options, const BodySettings& settings)
      : mesh_(withoutRepeats(mesh)), options_(options), settings_(settings), sheets_(findSheets(mesh_)) {}

  Result<std::optional<WallBody>> make() {
    measure();
    chooseRoles(true);
    if (std::ranges::find(roles_, ShellRole::kShell) == roles_.end()) return std::optional<WallBody>();
    WallBody body;
    if (manySheets()) return oneShell();
    for (const TriMesh& solid : solids_) append(body.mesh, solid);
    body.figures.solids = solids_.size();
    if (const std::vector<Triangle> sealed = trianglesOf(ShellRole::kSealed); !sealed.empty()) {
      LORICA_TRY(const TriMesh solid, solidOf(meshOf(mesh_, sealed), body.figures));
      append(body.mesh, solid);
    }
    if (!body.mesh.triangles.empty()) {  // space that two solids fill would count twice
      Result<std::optional<ShellUnion>> whole = uniteShells(body.mesh);
      if (!whole) {
        LORICA_TRY(body.mesh, solidOf(body.mesh, body.figures));
      } else if (*whole) {
        body.mesh = std::move((*whole)->mesh);
      }
    }
    addWalls(body);
    // Two sheets, or two places of one, may touch along an edge.
    LORICA_TRY(MeshRepair repair, repairClosedMesh(body.mesh));
    body.mesh = std::move(repair.mesh);
    body.figures.firstOriginal = countOf(body.mesh.vertices);
    LORICA_TRY_DO(checkClosedTwoManifold(body.mesh));
    return std::optional(std::move(body));
  }

  WallTriangles triangles() {
    measure();
    chooseRoles(false);
    double whole = 0.0;
    for (const double area : area_) whole += area;
    for (std::size_t s = 0; s < roles_.size() && options_.walls != WallChoice::kShell; ++s) {
      if (roles_[s] == ShellRole::kShell && area_[s] < kWorthAWall * whole) roles_[s] = ShellRole::kDropped;
    }
    return {mesh_, trianglesWithWalls()};
  }

 private:
  /// A closed surface around all that a mesh encloses, built with voxels.
  Result<TriMesh> solidOf(const TriMesh& mesh, RebuiltMesh& figures) const {
    LORICA_TRY(MeshBody made, makeMeshBody(mesh, settings_));
    figures.resolution = made.resolution;
    figures.distances = made.distances;
    made.mesh.vertices.resize(made.firstOriginal);
    return std::move(made.mesh);
  }

  /// Of very many sheets (leaves, a soup of triangles): one shell around everything.
  Result<std::optional<WallBody>> oneShell() const {
    const Aabb box = surfaceBounds(mesh_);
    const double usual = kWallShare * (box.max - box.min).maxCoeff();
    LORICA_TRY(MeshBody made, makeShellBody(mesh_, options_.thickness > 0.0 ? options_.thickness : usual));
    WallBody body{std::move(made.mesh), {}};
    body.figures.firstOriginal = made.firstOriginal;
    body.figures.shells = 1;
    body.figures.shellShare = 1.0;
    body.figures.thickness = std::max(options_.thickness, 2.0 * made.resolution);
    return std::optional(std::move(body));
  }

  [[nodiscard]] bool manySheets() const { return std::ranges::count(roles_, ShellRole::kShell) > kMaxSheets; }

  void measure() {
    const std::size_t count = sheets_.count;
    area_.assign(count, 0.0);
    members_.resize(count);
    for (std::size_t k = 0; k < mesh_.triangles.size(); ++k) {
      const std::size_t sheet = sheets_.sheetOfTriangle[k];
      members_[sheet].push_back(sheets_.triangles[k]);
      area_[sheet] += surfaceArea(mesh_.vertices, std::span(mesh_.triangles).subspan(k, 1));
    }
  }

  /// @param together  very many sheets are left to oneShell()
  void chooseRoles(bool together) {
    const std::size_t count = members_.size();
    roles_.assign(count, ShellRole::kShell);
    for (std::size_t s = 0; s < count; ++s) {
      if (!(area_[s] > 0.0)) roles_[s] = ShellRole::kDropped;
    }
    if (options_.walls == WallChoice::kShell) return;
    bool allSolid = true;
    for (std::size_t s = 0; s < count; ++s) {
      if (roles_[s] != ShellRole::kShell) continue;
      Result<FaultRepair> repair = repairSmallFaults(meshOf(mesh_, members_[s]));
      allSolid = allSolid && repair;
      if (!repair) continue;
      roles_[s] = ShellRole::kSolid;
      solids_.push_back(std::move(repair->mesh));
    }
    if (allSolid || (together && manySheets())) return;
    const std::vector<bool> sealed = aroundSealedSpace(mesh_);
    std::vector<double> sealedArea(count, 0.0);
    for (std::size_t k = 0; k < sealed.size(); ++k) {
      if (!sealed[k]) continue;
      sealedArea[sheets_.sheetOfTriangle[k]] += surfaceArea(mesh_.vertices, std::span(mesh_.triangles).subspan(k, 1));
    }
    for (std::size_t s = 0; s < count; ++s) {
      if (roles_[s] == ShellRole::kShell && sealedArea[s] > 0.5 * area_[s]) roles_[s] = ShellRole::kSealed;
    }
    dropSpecks();
  }

  /// Tiny sheets are not worth walls; the hulls hold their vertices.
  void dropSpecks() {
    const double largest = kSpeckExtent * surfaceBounds(mesh_).diagonal();
    std::vector<std::size_t> specks;
    double whole = 0.0, small = 0.0;
    for (std::size_t s = 0; s < members_.size(); ++s) {
      whole += area_[s];
      if (roles_[s] != ShellRole::kShell) continue;
      Aabb box;
      for (const Triangle& t : members_[s]) {
        for (const VertexIndex v : t) box.extend(mesh_.vertices[v]);
      }
      if ((box.max - box.min).maxCoeff() > largest) continue;
      specks.push_back(s);
      small += area_[s];
    }
    if (small > kSpeckArea * whole) return;
    for (const std::size_t s : specks) roles_[s] = ShellRole::kDropped;
  }

  [[nodiscard]] std::vector<Triangle> trianglesOf(ShellRole role) const {
    std::vector<Triangle> triangles;
    for (std::size_t s = 0; s < members_.size(); ++s) {
      if (roles_[s] == role) triangles.insert(triangles.end(), members_[s].begin(), members_[s].end());
    }
    return triangles;
  }

  [[nodiscard]] std::vector<bool> trianglesWithWalls() const {
    std::vector<bool> which(mesh_.triangles.size());
    for (std::size_t k = 0; k < which.size(); ++k) {
      which[k] = roles_[sheets_.sheetOfTriangle[k]] == ShellRole::kShell;
    }
    return which;
  }

  void addWalls(WallBody& body) const {
    const std::vector<bool> which = trianglesWithWalls();
    double whole = 0.0, shell = 0.0;
    for (std::size_t s = 0; s < members_.size(); ++s) {
      whole += area_[s];
      if (roles_[s] != ShellRole::kShell) continue;
      shell += area_[s];
      ++body.figures.shells;
    }
    const Aabb box = surfaceBounds(mesh_);
    const double most = kWallShare * (box.max - box.min).maxCoeff();
    // A gap of twice the thickness leaves half of itself free.
    body.figures.thickness =
        options_.thickness > 0.0 ? options_.thickness : 0.5 * narrowestGap(mesh_, which, 2.0 * most);
    body.figures.shellShare = shell / whole;
    append(body.mesh, wallsAround(mesh_, sheets_, which, body.figures.thickness));
  }

  TriMesh mesh_;
  const CharacterOptions& options_;
  const BodySettings& settings_;
  Sheets sheets_;
  std::vector<double> area_;                    // of each sheet
  std::vector<std::vector<Triangle>> members_;  // of each sheet
  std::vector<ShellRole> roles_;                // of each sheet
  std::vector<TriMesh> solids_;
};

}  // namespace

std::optional<WallChoice> wallChoiceNamed(std::string_view name) {
  const auto found = std::find(kWallNames.begin(), kWallNames.end(), name);
  return found == kWallNames.end() ? std::nullopt : std::optional(static_cast<WallChoice>(found - kWallNames.begin()));
}

const char* nameOf(WallChoice walls) {
  return kWallNames[static_cast<std::size_t>(walls)];
}

void append(TriMesh& mesh, const TriMesh& other) {
  const VertexIndex first = countOf(mesh.vertices);
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Triangle& t : other.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

std::string wallsInWords(const RebuiltMesh& body) {
  return fmt::format("{} of {:.4g}, {:.0f} % of the surface; {}{}", counted(body.shells, "thin wall"), body.thickness,
                     100.0 * body.shellShare, counted(body.solids, "piece is", "pieces are"),
                     body.resolution > 0.0 ? " closed, others around space that is closed off" : " solid");
}

WallTriangles trianglesOfWalls(const TriMesh& mesh, const CharacterOptions& options) {
  return WallMaker(mesh, options, {}).triangles();
}

Result<void> checkThickness(const std::string& name, double thickness, std::span<const Vec3> vertices) {
  constexpr double kThickest = 0.125;  // of the longest side
  const double size = 2.0 * concavityUnit(vertices);
  if (thickness >= 0.0 && !(thickness > kThickest * size && std::isfinite(size))) return {};
  return invalidArgument("{}: thickness of walls: found {:g}, expected 0 to {:.4g}, an eighth of the longest side",
                         name, thickness, kThickest * size);
}

Result<std::optional<WallBody>> makeWalls(const TriMesh& mesh, const CharacterOptions& options,
                                          const BodySettings& settings) {
  const Aabb box = surfaceBounds(mesh);
  const double size = box.empty() ? 0.0 : (box.max - box.min).maxCoeff();
  if (!(size > 0.0) || !std::isfinite(size * size * size)) {
    return badMesh("the longest side of its surface is {:g}, expected a surface", size);
  }
  return WallMaker(mesh, options, settings).make();
}

}  // namespace lorica

// Damaged meshes through repair and bodies. Input: a folder of closed meshes, and meshes as they are. Output: one CSV
// row for each mesh and damage, then counts for each kind of damage on lines that start with #.

#include "acd/decompose.h"
#include "acd/held_vertices.h"
#include "acd/transfer.h"
#include "bench/measure.h"
#include "geometry/mesh_files.h"
#include "geometry/mesh_repair.h"
#include "geometry/small_faults.h"
#include "skinning/body/mesh_body.h"
#include "skinning/import/character_file.h"
#include "tests/support/damaged_meshes.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <map>

namespace lorica::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kParts = 16;

/// What became of one mesh.
struct Row {
  std::string mesh;
  std::string damage;
  bool before = false;         ///< accepted without repair: closed, but for non-manifold edges
  std::string way;             ///< "repaired", "body" or "refused"
  double volumeRatio = 0.0;    ///< to the undamaged mesh; 0 if there is none
  std::size_t outside = 0;     ///< vertices of the surface that are outside all hulls by more than 1e-6 of the diagonal
  std::size_t attached = 0;    ///< vertices that no part contains but the hulls do
  std::size_t vertices = 0;    ///< that triangles of the damaged mesh use
  double bareError = 0.0;      ///< like error, without attached vertices
  double error = 0.0;          ///< volume of the hulls / volume of what was decomposed, minus 1
  double repairSeconds = 0.0;  ///< until the mesh or its body is closed
  double seconds = 0.0;        ///< of the decomposition
};

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The surface's vertices outside all hulls, each compared with every hull.
std::size_t countOutside(const TriMesh& mesh, std::span<const ConvexHull> hulls) {
  const double tolerance = 1e-6 * surfaceBounds(mesh).diagonal();
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const Triangle& t : mesh.triangles) {
    for (const VertexIndex v : t) used[v] = true;
  }
  std::vector<Aabb> boxes;
  for (const ConvexHull& hull : hulls) boxes.push_back(boundsOf(hull.vertices));
  std::size_t outside = 0;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    bool held = false;
    for (std::size_t i = 0; i < hulls.size() && !held; ++i) {
      const Vec3& p = mesh.vertices[v];
      const double toBox = (boxes[i].min - p).cwiseMax(p - boxes[i].max).maxCoeff();
      held = !hulls[i].degenerate() && toBox <= tolerance && largestViolation(hulls[i], {&p, 1}) <= tolerance;
    }
    outside += held ? 0 : 1;
  }
  return outside;
}

/// The same steps as `lorica decompose`.
Row tried(const std::string& name, const std::string& damage, const TriMesh& damagedMesh, double volume) {
  Row row;
  row.mesh = name;
  row.damage = damage;
  // Readers of files weld equal positions if that closes edges.
  TriMesh mesh = damagedMesh;
  (void)weldEqualVertices(mesh);
  if (openEdgeCount(mesh) >= openEdgeCount(damagedMesh)) mesh = damagedMesh;
  const Result<MeshRepair> repaired = repairClosedMesh(mesh);
  row.before = repaired && checkClosedTwoManifold(repaired->mesh);
  row.vertices = mesh.vertices.size();
  auto start = std::chrono::steady_clock::now();
  TriMesh closed;
  std::vector<VertexIndex> held;
  if (Result<FaultRepair> repair = repairSmallFaults(mesh)) {
    row.way = "repaired";
    closed = std::move(repair->mesh);
    held = std::move(repair->leftOut);
  } else {
    Result<MeshBody> body = makeMeshBody(mesh);
    if (!body) {
      row.way = "refused";
      fmt::print(stderr, "{}, {}: {}\n", name, damage, body.error().message);
      return row;
    }
    row.way = "body";
    std::vector<bool> used(mesh.vertices.size(), false);
    for (const Triangle& t : mesh.triangles) {
      for (const VertexIndex v : t) used[v] = true;
    }
    for (std::size_t v = 0; v < used.size(); ++v) {
      if (used[v]) held.push_back(body->firstOriginal + static_cast<VertexIndex>(v));
    }
    closed = std::move(body->mesh);
  }
  row.repairSeconds = secondsSince(start);
  const double closedVolume = signedVolume(closed.vertices, closed.triangles);
  if (volume > 0.0) row.volumeRatio = closedVolume / volume;

  start = std::chrono::steady_clock::now();
  DecomposeSettings settings;
  settings.maxParts = kParts;
  const Result<Decomposition> parts =
      decompose(closed, {closed.vertices, static_cast<int>(closed.vertices.size())}, settings);
  if (!parts) {
    row.way = "refused";
    fmt::print(stderr, "{}, {}: {}\n", name, damage, parts.error().message);
    return row;
  }
  const auto assigned = assignHeldVertices(*parts, closed.vertices, held);
  for (const std::vector<PointIndex>& own : assigned) row.attached += own.size();
  const Decomposition with = withHeldVertices(*parts, assigned);
  row.seconds = secondsSince(start);
  std::vector<Vec3> points(static_cast<std::size_t>(with.pointCount()));
  transfer(with, closed.vertices, points);
  const std::vector<ConvexHull> hulls = partHulls(with, points);
  double hullVolume = 0.0;
  for (const ConvexHull& hull : hulls) hullVolume += hull.volume;
  row.error = hullVolume / closedVolume - 1.0;
  row.bareError = errorInPose(*parts, closed, closed.vertices).relative();
  row.outside = countOutside(mesh, hulls);
  return row;
}

void print(const Row& row) {
  fmt::print("{},{},{},{},{},{},{},{:.9f},{:.4f},{:.4f},{:.3f},{:.3f}\n", row.mesh, csvField(row.damage),
             row.before ? 1 : 0, row.way, row.vertices, row.attached, row.outside, row.volumeRatio, row.bareError,
             row.error, row.repairSeconds, row.seconds);
  std::fflush(stdout);
}

void summarize(const std::vector<Row>& rows) {
  std::vector<std::string> kinds;
  for (const Row& row : rows) {
    if (std::find(kinds.begin(), kinds.end(), row.damage) == kinds.end()) kinds.push_back(row.damage);
  }
  kinds.emplace_back();  // all
  for (const std::string& kind : kinds) {
    int count = 0, before = 0, repaired = 0, body = 0;
    std::size_t outside = 0;
    double volumeOff = 0.0, slowest = 0.0;
    for (const Row& row : rows) {
      if (!kind.empty() && row.damage != kind) continue;
      ++count;
      before += row.before ? 1 : 0;
      repaired += row.way == "repaired" ? 1 : 0;
      body += row.way == "body" ? 1 : 0;
      outside += row.outside;
      if (row.volumeRatio > 0.0) volumeOff = std::max(volumeOff, std::abs(row.volumeRatio - 1.0));
      slowest = std::max(slowest, row.repairSeconds);
    }
    fmt::print(
        "# {}: {} meshes, accepted before {}, repaired {}, body {}, refused {}, vertices outside {}, volume off by "
        "at most {:.2g}, repair at most {:.2f} s\n",
        kind.empty() ? "all" : kind, count, before, repaired, body, count - repaired - body, outside, volumeOff,
        slowest);
  }
}

int run(const std::string& folder, const std::vector<std::string>& only, const std::vector<std::string>& asTheyAre) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".off" || entry.path().extension() == ".obj") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  if (files.empty()) {
    fmt::print(stderr, "{}: no meshes, expected .off or .obj\n", folder);
    return 2;
  }
  std::vector<Row> rows;
  fmt::print("mesh,damage,before,way,vertices,attached,outside,volume_ratio,bare_error,error,repair_seconds,seconds\n");
  for (const fs::path& file : files) {
    if (!only.empty() && std::find(only.begin(), only.end(), file.stem().string()) == only.end()) continue;
    const Result<TriMesh> read = readMesh(file);
    const Result<MeshRepair> sound = read ? repairClosedMesh(*read) : Result<MeshRepair>(read.error());
    if (!sound) {
      fmt::print(stderr, "{}\n", sound.error().message);
      continue;
    }
    const double volume = signedVolume(sound->mesh.vertices, sound->mesh.triangles);
    for (const test::DamagedMesh& damaged : test::damagedMeshes(sound->mesh)) {
      rows.push_back(tried(file.stem().string(), damaged.damage, damaged.mesh, volume));
      print(rows.back());
    }
  }
  for (const std::string& file : asTheyAre) {
    TriMesh mesh;
    if (isCharacterFile(file)) {
      Result<CharacterFile> read = readCharacterFile(file);
      if (!read) {
        fmt::print(stderr, "{}\n", read.error().message);
        continue;
      }
      mesh = std::move(read->character.mesh);
    } else if (Result<TriMesh> read = readMesh(file)) {
      mesh = std::move(*read);
    }
    rows.push_back(tried(fs::path(file).stem().string(), "a character's surface", mesh, 0.0));
    print(rows.back());
  }
  summarize(rows);
  return 0;
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  CLI::App app("Damages closed meshes in 14 ways, and decomposes the results.");
  std::string folder;
  std::vector<std::string> asTheyAre;
  app.add_option("FOLDER", folder, "Folder of closed meshes (.off, .obj)")->required();
  std::vector<std::string> only;
  app.add_option("--only", only, "Meshes of the folder, by name without extension")->delimiter(',');
  app.add_option("FILES", asTheyAre, "Meshes and characters that are taken as they are");
  CLI11_PARSE(app, argc, argv);
  return lorica::bench::run(folder, only, asTheyAre);
}

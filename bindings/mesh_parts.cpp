#include "bindings/mesh_parts.h"

#include "acd/held_vertices.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/mesh_mending.h"
#include "prepare/hull_export.h"
#include "prepare/quality.h"
#include "prepare/training.h"
#include "skinning/body/mesh_body.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <utility>

namespace lorica {
namespace {

constexpr const char* kName = "the mesh";

/// A mesh that can be decomposed.
struct Solid {
  TriMesh mesh;
  std::vector<VertexIndex> held;  ///< vertices of no triangle that the hulls contain nevertheless
  std::string repaired;
};

/// Builds a closed surface around a mesh. @param problem  why; empty if that was asked for
Result<Solid> rebuilt(const TriMesh& mesh, const MeshPartsSettings& settings, const std::string& problem) {
  BodySettings making;
  making.threads = settings.decompose.threads;
  if (settings.decompose.progress) {
    making.progress = [&](int, int) { return settings.decompose.progress(0, settings.decompose.maxParts); };
  }
  Result<MeshBody> body = makeMeshBody(mesh, making);
  if (!body) {
    if (body.error().code == ErrorCode::kCancelled || problem.empty()) return body.error();
    return Error{body.error().code, fmt::format("{}; no closed body can be made: {}", problem, body.error().message)};
  }
  Solid solid;
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const Triangle& t : mesh.triangles) {
    for (const VertexIndex v : t) used[v] = true;
  }
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v]) solid.held.push_back(body->firstOriginal + v);
  }
  solid.mesh = std::move(body->mesh);
  solid.repaired = fmt::format("closed body built with voxels of {:.4g}{}", body->resolution,
                               problem.empty() ? "" : ", because " + problem);
  return solid;
}

Result<Solid> solidOf(TriMesh mesh, const MeshPartsSettings& settings) {
  if (settings.closed == ClosedSurface::kAlways) return rebuilt(mesh, settings, "");
  Result<MeshMending> mending = mendMesh(mesh);
  if (mending) return Solid{std::move(mending->mesh), std::move(mending->leftOut), mending->summary()};
  if (settings.closed == ClosedSurface::kNever) return mending.error();
  return rebuilt(mesh, settings, mending.error().message);
}

Result<void> checkSettings(const MeshPartsSettings& settings) {
  const int vertices = settings.hullVertices;
  if (vertices == 0 || vertices >= 4) return {};
  return invalidArgument("vertices of a hull: found {}, expected at least 4, or 0 for no limit", vertices);
}

/// The hulls of a decomposition, and the content of its file.
Result<MeshParts> assemble(Solid solid, Decomposition decomposition, const MeshPartsSettings& settings) {
  const std::vector<Vec3>& vertices = solid.mesh.vertices;
  const Decomposition parts = withHeldVertices(decomposition, assignHeldVertices(decomposition, vertices, solid.held));
  HullExport made = exportHulls(parts, vertices, settings.hullVertices, settings.decompose.threads);
  LORICA_TRY_DO(checkHullsHold(made, vertices, solid.held));

  MeshParts result;
  result.hulls.reserve(made.objects.size());
  for (NamedMesh& object : made.objects) {
    ConvexHull hull;
    hull.volume = signedVolume(object.mesh.vertices, object.mesh.triangles);
    hull.vertices = std::move(object.mesh.vertices);
    hull.triangles = std::move(object.mesh.triangles);
    result.hullVolume += hull.volume;
    result.hulls.push_back(std::move(hull));
  }
  result.meshVolume = signedVolume(vertices, solid.mesh.triangles);
  result.repaired = std::move(solid.repaired);
  const PoseView pose{vertices, countOf(vertices)};
  result.content =
      fileContent(kName, solid.mesh, nullptr, nullptr, pose, std::move(decomposition), hullsOfParts(parts, pose));
  if (!solid.held.empty()) result.content.cover = coverWithHeldVertices(parts);
  return result;
}

}  // namespace

Result<TriMesh> checkedMesh(std::span<const double> positions, std::span<const std::int64_t> corners) {
  TriMesh mesh;
  const std::size_t vertexCount = positions.size() / 3;
  mesh.vertices.reserve(vertexCount);
  for (std::size_t v = 0; v < vertexCount; ++v) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (std::isfinite(positions[3 * v + axis])) continue;
      return badMesh("vertex {}: {} is {}, expected a finite number", v, "xyz"[axis], positions[3 * v + axis]);
    }
    mesh.vertices.emplace_back(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]);
  }
  mesh.triangles.reserve(corners.size() / 3);
  for (std::size_t c = 0; c < corners.size(); ++c) {
    if (corners[c] < 0 || corners[c] >= static_cast<std::int64_t>(vertexCount)) {
      return badMesh("triangle {}: found vertex {}, expected 0 to {}, for there are {}", c / 3, corners[c],
                     static_cast<std::int64_t>(vertexCount) - 1, vertexCount);
    }
    if (c % 3 != 2) continue;
    const auto index = [&](std::size_t i) { return static_cast<VertexIndex>(corners[i]); };
    mesh.triangles.push_back({index(c - 2), index(c - 1), index(c)});
  }
  return mesh;
}

Result<MeshParts> partsOfMesh(TriMesh mesh, const MeshPartsSettings& settings) {
  LORICA_TRY_DO(checkSettings(settings));
  LORICA_TRY(Solid solid, solidOf(std::move(mesh), settings));
  const PoseView pose{solid.mesh.vertices, countOf(solid.mesh.vertices)};
  LORICA_TRY(Decomposition made, decompose(solid.mesh, pose, settings.decompose));
  return assemble(std::move(solid), std::move(made), settings);
}

Result<MeshParts> partsFromFile(const std::filesystem::path& file, TriMesh mesh, const MeshPartsSettings& settings) {
  LORICA_TRY_DO(checkSettings(settings));
  LORICA_TRY(DecompositionFile read, readDecomposition(file));
  LORICA_TRY(Solid solid, solidOf(std::move(mesh), settings));
  if (read.meshHash != topologyHash(solid.mesh)) {
    return invalidArgument("{}: made from {} with {} vertices, expected a decomposition of this mesh with {}",
                           file.string(), read.source, read.decomposition.vertexCount, solid.mesh.vertices.size());
  }
  return assemble(std::move(solid), std::move(read.decomposition), settings);
}

}  // namespace lorica

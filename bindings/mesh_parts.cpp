#include "bindings/mesh_parts.h"

#include "bindings/program_host.h"
#include "export/export_source.h"
#include "geometry/errors.h"
#include "session/prepare/body.h"
#include "session/prepare/hull_fit.h"
#include "session/prepare/mesh_subject.h"
#include "session/prepare/mesh_walls.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace lorica {
namespace {

Result<Subject> subjectOf(TriMesh mesh, const MeshPartsSettings& settings, Host& host) {
  LORICA_TRY_DO(checkCounts(settings.decompose.maxParts, settings.hullVertices, settings.decompose.threads));
  CharacterOptions reading;
  reading.body = settings.closed;
  reading.walls = settings.walls;
  reading.thickness = settings.thickness;
  return meshSubject("mesh", std::move(mesh), reading, host);
}

std::string repairsOf(const Subject& subject) {
  if (!subject.rebuilt) return subject.repaired;
  const std::string because = subject.rebuilt->problem.empty() ? "" : ", because " + subject.rebuilt->problem;
  if (subject.rebuilt->shells > 0) return wallsInWords(*subject.rebuilt) + because;
  return fmt::format("closed body built with voxels of {:.4g}{}", subject.rebuilt->resolution, because);
}

MeshParts partsOf(const Subject& subject, PartHulls made, DecompositionFile content) {
  MeshParts result;
  result.hulls.reserve(made.objects.size());
  for (NamedMesh& object : made.objects) {
    const double volume = signedVolume(object.mesh.vertices, object.mesh.triangles);
    result.hullVolume += volume;
    result.hulls.push_back({{}, std::move(object.mesh.vertices), std::move(object.mesh.triangles), volume});
  }
  result.meshVolume = signedVolume(subject.mesh.vertices, subject.mesh.triangles);
  result.repaired = repairsOf(subject);
  result.content = std::move(content);
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
  ProgramHost host(settings.decompose.progress, settings.decompose.threads, settings.decompose.maxParts);
  LORICA_TRY(const Subject subject, subjectOf(std::move(mesh), settings, host));
  const Keyframes keyframes{subject.mesh.vertices, 1, {}, 0.0};
  FitRequest request{subject, keyframes, nullptr, {std::nullopt, settings.hullVertices}, true, settings.decompose};
  request.settings.maxConcavity = settings.maxConcavity * concavityUnitOf(subject);
  LORICA_TRY(Fit fit, fitHulls(request, host));
  LORICA_TRY_DO(prefixed(subject.name, checkHullsHold(fit.exported, subject.mesh.vertices, verticesToHold(subject))));
  return partsOf(subject, std::move(fit.exported), fileContent(request, nullptr, fit));
}

Result<MeshParts> partsFromFile(const std::filesystem::path& file, TriMesh mesh, const MeshPartsSettings& settings) {
  ProgramHost host(settings.decompose.progress, settings.decompose.threads);
  ExportSource source;
  LORICA_TRY(source.subject, subjectOf(std::move(mesh), settings, host));
  LORICA_TRY(source.content, readDecompositionOf(source.subject, file));
  LORICA_TRY(PartHulls made, restHulls(source, settings.hullVertices, host));
  return partsOf(source.subject, std::move(made), std::move(source.content));
}

}  // namespace lorica

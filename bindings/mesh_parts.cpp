#include "bindings/mesh_parts.h"

#include "bindings/program_host.h"
#include "collision/hulls/frame_hulls.h"
#include "collision/hulls/hull_fit.h"
#include "collision/hulls/mesh_subject.h"
#include "collision/hulls/mesh_walls.h"
#include "collision/hulls/quality.h"
#include "geometry/errors.h"
#include "geometry/work_budgets.h"

#include <fmt/ranges.h>

#include <cmath>
#include <utility>

namespace lorica {
namespace {

CharacterOptions readingOf(const MeshPartsSettings& settings) {
  CharacterOptions reading;
  reading.body = settings.closed;
  reading.thickness = settings.thickness;
  if (settings.walls != WallChoice::kByReach) reading.walls = settings.walls;
  return reading;
}

Result<Subject> subjectOf(MeshSequence mesh, const MeshPartsSettings& settings, Host& host) {
  CharacterOptions reading = readingOf(settings);
  reading.walls = settings.walls;
  return meshSubject("mesh", {std::move(mesh.positions), std::move(mesh.triangles)}, reading, host);
}

MeshParts partsOf(const Subject& subject, PartHulls made, DecompositionFile content) {
  MeshParts result;
  std::vector<ConvexHull>& hulls = result.frames.emplace_back();
  PoseError& error = result.errors.emplace_back();
  hulls.reserve(made.objects.size());
  for (NamedMesh& object : made.objects) {
    const double volume = signedVolume(object.mesh.vertices, object.mesh.triangles);
    error.hullVolume += volume;
    hulls.push_back({{}, std::move(object.mesh.vertices), std::move(object.mesh.triangles), volume});
  }
  error.meshVolume = signedVolume(subject.mesh.vertices, subject.mesh.triangles);
  result.keyframes = {0};
  result.repaired = repairsOf(subject);
  result.warning = doubtAboutHulls(meanErrorOf(result.errors));
  result.content = std::move(content);
  return result;
}

/// @param earlier  parts that were made before; null = to be made
Result<MeshParts> partsWith(const EarlierParts* earlier, MeshSequence mesh, const MeshPartsSettings& settings) {
  LORICA_TRY_DO(checkCounts(settings.decompose.maxParts, settings.budget(), settings.decompose.threads));
  ProgramHost host(settings.decompose.progress, settings.decompose.threads,
                   earlier != nullptr ? 0 : settings.decompose.maxParts);
  if (mesh.frameCount() > 1) return partsOfFrames(std::move(mesh), settings, readingOf(settings), earlier, host);
  LORICA_TRY(const Subject subject, subjectOf(std::move(mesh), settings, host));
  if (earlier != nullptr) LORICA_TRY_DO(checkMadeFrom(subject, earlier->content, earlier->from));
  const Keyframes keyframes{subject.mesh.vertices, 1, {}, 0.0};
  FitRequest request{subject, keyframes, nullptr, {std::nullopt, settings.hullVertices, settings.hullPlanes}, true, {}};
  request.settings.threads = settings.decompose.threads;
  if (earlier == nullptr) {
    request.settings = settings.decompose;
    request.settings.maxConcavity = settings.maxConcavity * concavityUnitOf(subject);
  }
  LORICA_TRY(Fit fit, earlier != nullptr ? fitOf(request, {earlier->content.decomposition, 0.0}, host)
                                         : fitHulls(request, host));
  LORICA_TRY_DO(prefixed(subject.name, checkHullsHold(fit.exported, subject.mesh.vertices, verticesToHold(subject))));
  return partsOf(subject, std::move(fit.exported),
                 earlier != nullptr ? earlier->content : fileContent(request, nullptr, fit));
}

}  // namespace

Result<MeshSequence> checkedMesh(std::span<const double> positions, std::size_t vertexCount,
                                 std::span<const std::int64_t> corners) {
  MeshSequence mesh;
  mesh.vertexCount = static_cast<int>(vertexCount);
  const std::size_t count = positions.size() / 3;
  if (count > kMaxSequencePoints && count > vertexCount) {
    return unsupported("found {} points in all frames, expected at most {}", count, kMaxSequencePoints);
  }
  mesh.positions.reserve(count);
  for (std::size_t v = 0; v < count; ++v) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (std::isfinite(positions[3 * v + axis])) continue;
      const std::string frame = count > vertexCount ? fmt::format("frame {}, ", v / vertexCount) : "";
      return badMesh("{}vertex {}: {} is {}, expected a finite number", frame, v % vertexCount, "xyz"[axis],
                     positions[3 * v + axis]);
    }
    mesh.positions.emplace_back(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]);
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

std::string repairsOf(const Subject& subject) {
  if (subject.character) return fmt::format("{}", fmt::join(subject.file->notes, "\n"));
  if (!subject.rebuilt) return subject.repaired;
  const std::string because = subject.rebuilt->problem.empty() ? "" : ", because " + subject.rebuilt->problem;
  if (subject.rebuilt->shells > 0) return wallsInWords(*subject.rebuilt) + because;
  return fmt::format("closed body built with voxels of {:.4g}{}", subject.rebuilt->resolution, because);
}

Result<MeshParts> partsOfMesh(MeshSequence mesh, const MeshPartsSettings& settings) {
  return partsWith(nullptr, std::move(mesh), settings);
}

Result<EarlierParts> earlierPartsIn(const std::filesystem::path& file) {
  LORICA_TRY(DecompositionFile content, readDecomposition(file));
  return EarlierParts{file.string(), std::move(content)};
}

Result<MeshParts> partsAsBefore(const EarlierParts& earlier, MeshSequence mesh, const MeshPartsSettings& settings) {
  return partsWith(&earlier, std::move(mesh), settings);
}

}  // namespace lorica

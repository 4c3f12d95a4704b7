#include "bindings/mesh_parts.h"

#include "bindings/program_host.h"
#include "export/export_source.h"
#include "geometry/errors.h"
#include "geometry/work_budgets.h"
#include "session/prepare/body.h"
#include "session/prepare/frame_hulls.h"
#include "session/prepare/hull_fit.h"
#include "session/prepare/mesh_subject.h"
#include "session/prepare/mesh_walls.h"
#include "session/prepare/quality.h"

#include <fmt/ranges.h>

#include <cmath>
#include <utility>

namespace lorica {
namespace {

Result<Subject> subjectOf(MeshSequence mesh, const MeshPartsSettings& settings, Host& host) {
  LORICA_TRY_DO(checkCounts(settings.decompose.maxParts, settings.hullVertices, settings.decompose.threads));
  CharacterOptions reading;
  reading.body = settings.closed;
  reading.thickness = settings.thickness;
  mesh.name = "mesh";
  if (mesh.frameCount() <= 1) {
    reading.walls = settings.walls;
    return meshSubject(mesh.name, {std::move(mesh.positions), std::move(mesh.triangles)}, reading, host);
  }
  if (settings.hullVertices > 0)
    return invalidArgument(
        "hull_vertices: found {} for several frames, whose hulls are "
        "exact: expected 0",
        settings.hullVertices);
  if (settings.walls != WallChoice::kByReach) reading.walls = settings.walls;
  LORICA_TRY(mesh, checkedSequence(std::move(mesh)));
  return sequenceSubject(std::move(mesh), reading, host);
}

std::string repairsOf(const Subject& subject) {
  if (subject.character) return fmt::format("{}", fmt::join(subject.file->notes, "\n"));
  if (!subject.rebuilt) return subject.repaired;
  const std::string because = subject.rebuilt->problem.empty() ? "" : ", because " + subject.rebuilt->problem;
  if (subject.rebuilt->shells > 0) return wallsInWords(*subject.rebuilt) + because;
  return fmt::format("closed body built with voxels of {:.4g}{}", subject.rebuilt->resolution, because);
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

/// Of a mesh in several poses. @param given  parts that were made before; null = to be made
Result<MeshParts> partsOfFrames(const Subject& subject, const MeshPartsSettings& settings,
                                const DecompositionFile* given, Host& host) {
  const Character& character = *subject.character;
  const std::optional<int> count = settings.keyframes > 0 ? std::optional(settings.keyframes) : std::nullopt;
  LORICA_TRY(const Training training, trainingMotions(subject, {}));
  LORICA_TRY(const Keyframes keyframes, prefixed("keyframes", trainingKeyframes(character, training, count)));
  FitRequest request{subject, keyframes, nullptr, {}, false, settings.decompose};
  request.settings.maxConcavity = settings.maxConcavity * concavityUnitOf(subject);
  LORICA_TRY(const Fit fit,
             given != nullptr ? fitOf(request, {given->decomposition, 0.0}, host) : fitHulls(request, host));
  LORICA_TRY(const SkeletalMotion motion, framesOf(character.skeleton, subject.file->clips.front()));
  Task task(host, "Hulls of the frames", "frames");
  LORICA_TRY(FrameHulls frames,
             hullsOfFrames(character, fit.held, std::span(&motion, 1), settings.decompose.threads, task.progress()));
  MeshParts result;
  result.keyframes = keyframesAmong(frames, {keyframes.positions, countOf(subject.mesh.vertices)});
  result.frames = std::move(frames.hulls);
  result.errors = std::move(frames.errors);
  result.repaired = repairsOf(subject);
  result.warning = doubtAboutHulls(meanErrorOf(result.errors));
  result.content = given != nullptr ? *given : fileContent(request, &training, fit);
  return result;
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

Result<MeshParts> partsOfMesh(MeshSequence mesh, const MeshPartsSettings& settings) {
  ProgramHost host(settings.decompose.progress, settings.decompose.threads, settings.decompose.maxParts);
  LORICA_TRY(const Subject subject, subjectOf(std::move(mesh), settings, host));
  if (subject.character) return partsOfFrames(subject, settings, nullptr, host);
  const Keyframes keyframes{subject.mesh.vertices, 1, {}, 0.0};
  FitRequest request{subject, keyframes, nullptr, {std::nullopt, settings.hullVertices}, true, settings.decompose};
  request.settings.maxConcavity = settings.maxConcavity * concavityUnitOf(subject);
  LORICA_TRY(Fit fit, fitHulls(request, host));
  LORICA_TRY_DO(prefixed(subject.name, checkHullsHold(fit.exported, subject.mesh.vertices, verticesToHold(subject))));
  return partsOf(subject, std::move(fit.exported), fileContent(request, nullptr, fit));
}

Result<MeshParts> partsFromFile(const std::filesystem::path& file, MeshSequence mesh,
                                const MeshPartsSettings& settings) {
  ProgramHost host(settings.decompose.progress, settings.decompose.threads);
  ExportSource source;
  LORICA_TRY(source.subject, subjectOf(std::move(mesh), settings, host));
  LORICA_TRY(source.content, readDecompositionOf(source.subject, file));
  if (source.subject.character) return partsOfFrames(source.subject, settings, &source.content, host);
  LORICA_TRY(PartHulls made, restHulls(source, settings.hullVertices, host));
  return partsOf(source.subject, std::move(made), std::move(source.content));
}

}  // namespace lorica

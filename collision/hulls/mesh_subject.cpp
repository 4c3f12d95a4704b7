#include "collision/hulls/mesh_subject.h"

#include "acd/part_concavity.h"
#include "collision/hulls/mesh_walls.h"
#include "geometry/errors.h"
#include "geometry/small_faults.h"
#include "skinning/body/mesh_body.h"

#include <fmt/format.h>

#include <utility>

namespace lorica {
namespace {

/// A closed body for a mesh, with or without the file's vertices.
Result<WallBody> makeClosedBody(const TriMesh& mesh, const CharacterOptions& options, const BodySettings& settings) {
  if (options.walls != WallChoice::kSolid) {
    LORICA_TRY(std::optional<WallBody> walls, makeWalls(mesh, options, settings));
    if (walls) return std::move(*walls);
  }
  LORICA_TRY(MeshBody body, makeMeshBody(mesh, settings));
  body.mesh.vertices.resize(body.firstOriginal);
  return WallBody{std::move(body.mesh), {{}, body.resolution, body.distances, body.firstOriginal}};
}

/// Replaces the subject's mesh by a closed body.
Result<void> rebuild(Subject& subject, const CharacterOptions& options, std::string problem, Host& host) {
  Task task(host, "Making a closed body for " + subject.name, "steps");
  BodySettings settings;
  settings.resolution = options.bodyResolution;
  settings.threads = host.threads;
  settings.progress = task.progress();
  Result<WallBody> body = makeClosedBody(subject.mesh, options, settings);
  if (!body) {
    if (body.error().code == ErrorCode::kCancelled) return body.error();
    return Error{body.error().code, fmt::format("{}: {}{}no closed body can be made: {}", subject.name, problem,
                                                problem.empty() ? "" : "; ", body.error().message)};
  }
  const std::vector<bool> used = usedVertices(subject.mesh.vertices.size(), subject.mesh.triangles);
  subject.held.clear();
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v]) subject.held.push_back(body->figures.firstOriginal + v);
  }
  std::vector<Triangle> original = std::move(subject.mesh.triangles);
  body->mesh.vertices.insert(body->mesh.vertices.end(), subject.mesh.vertices.begin(), subject.mesh.vertices.end());
  subject.mesh = std::move(body->mesh);
  body->figures.problem = std::move(problem);
  body->figures.original = std::move(original);
  subject.rebuilt = std::move(body->figures);
  return {};
}

}  // namespace

Result<Subject> meshSubject(const std::string& name, TriMesh mesh, const CharacterOptions& options, Host& host) {
  LORICA_TRY_DO(checkThickness(name, options.thickness, mesh.vertices));
  Subject subject{name, std::move(mesh), std::nullopt, "", std::nullopt, std::nullopt};
  if (options.body == BodyChoice::kAlways || options.walls == WallChoice::kShell) {
    LORICA_TRY_DO(rebuild(subject, options, "", host));
    return subject;
  }
  Result<FaultRepair> repair = repairSmallFaults(subject.mesh);
  if (repair) {
    subject.repaired = repair->summary();
    subject.mesh = std::move(repair->mesh);
    subject.held = std::move(repair->leftOut);
  } else if (options.body == BodyChoice::kIfNeeded) {
    LORICA_TRY_DO(rebuild(subject, options, repair.error().message, host));
  } else if (checkClosedTwoManifold(subject.mesh)) {  // its pieces overlap
    return Error{repair.error().code, fmt::format("{}: {}", name, repair.error().message)};
  }
  return subject;
}

double concavityUnitOf(const Subject& subject) {
  std::vector<Vec3> surface;
  if (subject.rebuilt) {
    for (const VertexIndex v : subject.held) surface.push_back(subject.mesh.vertices[v]);
  } else {
    for (const VertexIndex v : verticesToHold(subject)) surface.push_back(subject.mesh.vertices[v]);
  }
  return concavityUnit(surface);
}

std::vector<VertexIndex> verticesToHold(const Subject& subject) {
  std::vector<bool> hold(subject.mesh.vertices.size(), subject.character.has_value());
  for (const Triangle& t : subject.mesh.triangles) {
    for (const VertexIndex v : t) hold[v] = true;
  }
  for (const VertexIndex v : subject.held) hold[v] = true;
  std::vector<VertexIndex> which;
  for (std::size_t v = 0; v < hold.size(); ++v) {
    if (hold[v]) which.push_back(v);
  }
  return which;
}

}  // namespace lorica

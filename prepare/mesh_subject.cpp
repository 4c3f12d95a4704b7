#include "prepare/mesh_subject.h"

#include "geometry/small_faults.h"
#include "skinning/body/mesh_body.h"

#include <fmt/format.h>

#include <utility>

namespace lorica {
namespace {

/// Replaces the subject's mesh by a closed body.
Result<void> rebuild(Subject& subject, const CharacterOptions& options, std::string problem, Host& host) {
  Task task(host, "Making a closed body for " + subject.name, "steps");
  BodySettings settings;
  settings.resolution = options.bodyResolution;
  settings.threads = host.threads;
  settings.progress = task.progress();
  Result<MeshBody> body = makeMeshBody(subject.mesh, settings);
  if (!body) {
    if (body.error().code == ErrorCode::kCancelled) return body.error();
    return Error{body.error().code, fmt::format("{}: {}{}no closed body can be made: {}", subject.name, problem,
                                                problem.empty() ? "" : "; ", body.error().message)};
  }
  std::vector<bool> used(subject.mesh.vertices.size(), false);
  for (const Triangle& t : subject.mesh.triangles) {
    for (const VertexIndex v : t) used[v] = true;
  }
  subject.held.clear();
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v]) subject.held.push_back(body->firstOriginal + v);
  }
  subject.mesh = std::move(body->mesh);
  subject.rebuilt = RebuiltMesh{std::move(problem), body->resolution, body->distances, body->firstOriginal};
  return {};
}

}  // namespace

Result<Subject> meshSubject(const std::string& name, TriMesh mesh, const CharacterOptions& options, Host& host) {
  Subject subject{name, std::move(mesh), std::nullopt, "", std::nullopt, std::nullopt};
  if (options.body == BodyChoice::kAlways) {
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

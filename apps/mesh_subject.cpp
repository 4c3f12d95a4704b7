#include "apps/mesh_subject.h"

#include "apps/options.h"
#include "apps/progress_bar.h"
#include "geometry/mesh_mending.h"
#include "skinning/body/mesh_body.h"

#include <fmt/format.h>

#include <utility>

namespace lorica {
namespace {

/// Replaces the subject's mesh by a closed body. Ctrl-C cancels.
Result<void> rebuild(Subject& subject, const CharacterOptions& options, std::string problem) {
  ProgressBar bar("Making a closed body for " + subject.name, "steps");
  BodySettings settings;
  settings.resolution = options.bodyResolution;
  settings.progress = progressOf(bar);
  Result<MeshBody> body = makeMeshBody(subject.mesh, settings);
  if (!body) {
    if (body.error().code == ErrorCode::kCancelled) return body.error();
    return Error{body.error().code, fmt::format("{}: {}; no closed body can be made: {}", subject.name,
                                                problem.empty() ? "--body always" : problem, body.error().message)};
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

void addBodyOption(CommandLine& app, std::string& body) {
  app.addOption(
         "--body", body,
         "Replace the surface by a closed body: `auto` = if it cannot be repaired, `never` = refuse such a mesh, "
         "`always` = even a closed one [default: auto]")
      ->typeName("WHEN")
      ->check(oneOf({"auto", "never", "always"}));
}

BodyChoice bodyChoice(const std::string& name) {
  return name == "never" ? BodyChoice::kNever : name == "always" ? BodyChoice::kAlways : BodyChoice::kIfNeeded;
}

Result<Subject> meshSubject(const std::string& name, TriMesh mesh, const CharacterOptions& options) {
  Subject subject{name, std::move(mesh), std::nullopt, "", std::nullopt, std::nullopt};
  if (options.body == BodyChoice::kAlways) {
    LORICA_TRY_DO(rebuild(subject, options, ""));
    return subject;
  }
  Result<MeshMending> mending = mendMesh(subject.mesh);
  if (mending) {
    subject.repaired = mending->summary();
    subject.mesh = std::move(mending->mesh);
    subject.held = std::move(mending->leftOut);
  } else if (options.body == BodyChoice::kIfNeeded) {
    LORICA_TRY_DO(rebuild(subject, options, mending.error().message));
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

void addMeshTo(Report& report, const Subject& subject) {
  if (!subject.repaired.empty()) report.line("repaired", subject.repaired);
  if (!subject.rebuilt) return;
  const auto& [problem, resolution, far, firstOriginal] = *subject.rebuilt;
  report.line("closed body",
              fmt::format("built with voxels of {:.4g}, {}; from its surface to the original {:.4g} on average, {:.4g} "
                          "at most; the original's vertices are up to {:.4g} outside, and in the hulls",
                          resolution, problem.empty() ? "for --body always was given" : "because " + problem,
                          far.meanToOriginal, far.farthestToOriginal, far.farthestOutside));
}

void addMeshTo(nlohmann::ordered_json& json, const Subject& subject) {
  if (!subject.repaired.empty()) json["repaired"] = subject.repaired;
  if (!subject.rebuilt) return;
  const auto& [problem, resolution, far, firstOriginal] = *subject.rebuilt;
  json["body"] = {{"problem", problem.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(problem)},
                  {"voxel", resolution},
                  {"vertices", firstOriginal},
                  {"meanDistance", far.meanToOriginal},
                  {"farthestDistance", far.farthestToOriginal},
                  {"farthestOutside", far.farthestOutside}};
}

}  // namespace lorica

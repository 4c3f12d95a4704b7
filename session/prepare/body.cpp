#include "session/prepare/body.h"

#include "collision/hulls/quality.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "session/prepare/training_motions.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

namespace lorica {
namespace {

/// The requested decomposition, or the default one.
Result<DecompositionFile> chooseDecomposition(const BodyOptions& options, const Subject& subject, Host& host) {
  if (!options.decomposition.empty()) return readDecompositionOf(subject, options.decomposition);
  LORICA_TRY(CachedDecomposition made, defaultDecomposition(subject, host));
  return std::move(made.file);
}

/// A cover of the body: from the user's cache, or chosen in poses of the character's default training.
Result<HullCover> coverOf(const Subject& subject, const DecompositionFile& body, const CoverRequest& request,
                          Host& host) {
  const Character& character = *subject.character;
  LORICA_TRY(const Training training, trainingMotions(subject, {}));
  LORICA_TRY(const CoverPoses poses, coverPoses(character, training.motions));
  const auto choose = [&] { return chooseCover(character, body.decomposition, poses, request, host); };
  return cachedCover(character, body, poses, request, choose, userCache(host));
}

}  // namespace

DecompositionCache userCache(Host& host) {
  // One cause often keeps both the body and its decomposition from the cache.
  return {userCacheFolder(), [&host](const std::string& sentence) { host.warn(sentence); }};
}

Result<CachedDecomposition> defaultDecomposition(const Subject& subject, Host& host) {
  LORICA_TRY(const Training training, trainingMotions(subject, {}));
  Task task(host, "Decomposing " + subject.character->name, "parts");
  DecomposeSettings settings;
  settings.threads = host.threads;
  settings.progress = task.progress();
  Result<CachedDecomposition> made = defaultDecomposition(*subject.character, training, settings, userCache(host));
  // The last cut may have finished before the progress callback was called.
  if (host.cancelled()) return cancelled();
  return made;
}

Result<CachedDecomposition> meshDecomposition(const std::string& name, const TriMesh& mesh, DecomposeSettings settings,
                                              Host& host) {
  Task task(host, "Decomposing " + name, "parts");
  settings.progress = task.progress();
  Result<CachedDecomposition> made = meshDecomposition(name, mesh, settings, userCache(host));
  if (host.cancelled()) return cancelled();
  return made;
}

Result<DecompositionFile> chooseBody(const BodyOptions& options, const Subject& subject, Host& host) {
  const bool covered = options.cover.given() && !options.cover.exact();
  const Stage whole(host);
  std::optional<Stage> stage(std::in_place, host, 0.0, covered ? kPartsOfCover : 1.0);
  Result<DecompositionFile> body = chooseDecomposition(options, subject, host);
  stage.reset();
  if (!body) return body;
  if (const std::string doubt = doubtAboutHulls(body->meanError); !doubt.empty()) {
    host.warn(subject.name + ": " + doubt);
  }
  if (!options.cover.given()) return body;
  body->cover.reset();
  body->errorPerKeyframe.clear();  // it was that of other hulls
  if (!covered) return body;
  stage.emplace(host, kPartsOfCover, 1.0);
  LORICA_TRY(body->cover, coverOf(subject, *body, options.cover, host));
  return body;
}

DecompositionFile wholeBody(const Subject& subject) {
  const TriMesh& mesh = subject.character->mesh;
  Part part{mesh.triangles, std::vector<std::int32_t>(mesh.triangles.size()), {}};
  std::iota(part.sourceTriangle.begin(), part.sourceTriangle.end(), 0);
  for (const Triangle& t : mesh.triangles) part.points.insert(part.points.end(), t.begin(), t.end());
  std::ranges::sort(part.points);
  part.points.erase(std::unique(part.points.begin(), part.points.end()), part.points.end());
  DecompositionFile whole;
  whole.decomposition = {countOf(mesh.vertices), countOf(mesh.triangles), {}, {}, {std::move(part)}};
  whole.source = subject.name;
  whole.meshHash = topologyHash(mesh);
  return whole;
}

}  // namespace lorica

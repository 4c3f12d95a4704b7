#include "apps/body_choice.h"

#include "apps/interrupt.h"
#include "apps/options.h"
#include "apps/progress_bar.h"
#include "apps/report.h"
#include "apps/training.h"
#include "geometry/errors.h"

#include <utility>

namespace lorica {
namespace {

/// The requested decomposition, checked against the character, or the default one.
Result<DecompositionFile> chooseDecomposition(const BodyOptions& options, const Subject& subject, int threads) {
  const Character& character = *subject.character;
  if (options.decomposition.empty()) {
    LORICA_TRY(CachedDecomposition made, defaultDecomposition(subject, threads));
    return std::move(made.file);
  }
  LORICA_TRY(DecompositionFile read, readDecomposition(options.decomposition));
  if (read.meshHash != topologyHash(character.mesh)) {
    return invalidArgument("{}: made from {} ({} vertices), expected a decomposition of {} ({} vertices)",
                           options.decomposition, read.source, grouped(read.decomposition.vertexCount), character.name,
                           grouped(std::ssize(character.mesh.vertices)));
  }
  return read;
}

/// A cover of the body: from the user's cache, or chosen in poses of the character's default training.
Result<HullCover> coverOf(const Subject& subject, const DecompositionFile& body, const CoverRequest& request,
                          int threads) {
  const Character& character = *subject.character;
  LORICA_TRY(const Training training, trainingMotions(subject, {}));
  LORICA_TRY(const CoverPoses poses, coverPoses(character, training.motions));
  const auto choose = [&] { return chooseCoverWithProgress(character, body.decomposition, poses, request, threads); };
  return cachedCover(character, body, poses, request, choose, userCache());
}

}  // namespace

DecompositionCache userCache() {
  // One cause often keeps both the body and its decomposition from the cache.
  return {userCacheFolder(), warn};
}

Result<CachedDecomposition> defaultDecomposition(const Subject& subject, int threads) {
  LORICA_TRY(const Training training, trainingMotions(subject, {}));
  ProgressBar bar("Decomposing " + subject.character->name, "parts");
  DecomposeSettings settings;
  settings.threads = threads;
  settings.progress = progressOf(bar);
  Result<CachedDecomposition> made = defaultDecomposition(*subject.character, training, settings, userCache());
  // The last cut may have finished before the progress callback was called.
  if (interrupted()) return cancelled();
  return made;
}

void addBodyOptions(CommandLine& app, BodyOptions& options) {
  app.addOption("--decomposition", options.decomposition, "Decomposition written by `lorica decompose -o`")
      ->typeName("FILE.lorica");
  addCover(
      app, options.cover.tolerance,
      "Hull cover: `exact` keeps the surface inside the hulls in every pose; a length keeps fewer points, so that the "
      "surface protrudes by at most this length before the hulls are enlarged [default: as decomposed, else exact]");
  addCount(app, "--hull-vertices", options.cover.hullVertices, 4,
           "Limit each hull to N vertices in every frame; hulls are enlarged to contain the body");
}

Result<DecompositionFile> chooseBody(const BodyOptions& options, const Subject& subject, int threads) {
  Result<DecompositionFile> body = chooseDecomposition(options, subject, threads);
  if (!body || !options.cover.given()) return body;
  body->cover.reset();
  body->errorPerKeyframe.clear();  // it was that of other hulls
  if (options.cover.exact()) return body;
  LORICA_TRY(body->cover, coverOf(subject, *body, options.cover, threads));
  return body;
}

}  // namespace lorica

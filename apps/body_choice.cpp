#include "apps/body_choice.h"

#include "apps/decomposition_cache.h"
#include "apps/options.h"

#include <fmt/format.h>

#include <utility>

namespace lorica {
namespace {

/// The decomposition that was asked for, checked against the character, or the default one.
Result<DecompositionFile> chooseDecomposition(const BodyOptions& options, const Subject& subject, int threads) {
  const Character& character = *subject.character;
  if (options.decomposition.empty()) {
    Result<DefaultDecomposition> made = defaultDecomposition(subject, threads);
    if (!made) return made.error();
    return std::move(made->file);
  }
  Result<DecompositionFile> read = readDecomposition(options.decomposition);
  if (!read) return read.error();
  if (read->meshHash != topologyHash(character.mesh)) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{}: made from {} with {} vertices, expected one made from {} with {}",
                             options.decomposition, read->source, grouped(read->decomposition.vertexCount),
                             character.name, grouped(std::ssize(character.mesh.vertices)))};
  }
  return read;
}

}  // namespace

void addBodyOptions(CommandLine& app, BodyOptions& options) {
  app.addOption("--decomposition", options.decomposition, "What `lorica decompose -o` wrote")->typeName("FILE.lorica");
  addCover(
      app, options.cover.tolerance,
      "What the hulls hold: `exact`, the surface in every pose; a length: it may stick out so far before the hulls "
      "of few points are grown [default: as decomposed, else exact]");
  addCount(app, "--hull-vertices", options.cover.hullVertices, 4,
           "At most so many vertices a hull in every frame, grown to hold the body");
}

Result<DecompositionFile> chooseBody(const BodyOptions& options, const Subject& subject, int threads) {
  Result<DecompositionFile> body = chooseDecomposition(options, subject, threads);
  if (!body || !options.cover.given()) return body;
  body->cover.reset();
  if (options.cover.exact()) return body;
  Result<CoverPromise> cover = cachedCover(subject, *body, options.cover, threads);
  if (!cover) return cover.error();
  body->cover = std::move(*cover);
  return body;
}

}  // namespace lorica

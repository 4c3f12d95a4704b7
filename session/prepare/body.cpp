#include "session/prepare/body.h"

#include "acd/level_of_detail.h"
#include "collision/hulls/file_content.h"
#include "collision/hulls/quality.h"
#include "collision/live/lifted_point.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/user_folders.h"
#include "session/prepare/training_motions.h"
#include "session/recording/session_file.h"
#include "skinning/body/body_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <string_view>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr int kParts = 16;

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

void warn(const DecompositionCache& cache, const std::string& sentence) {
  if (cache.warn) cache.warn(sentence);
}

/// The file of an entry; empty if there is no cache.
fs::path entryFile(const DecompositionCache& cache, std::uint64_t key, const char* extension) {
  return cache.folder.empty() ? fs::path() : cache.folder / (hexDigits(key) + extension);
}

/// The content of an entry, if there is one and it is whole. Else a warning says why it is computed again.
/// @param decode  makes a Result<T> of its bytes; errors begin with the name of the file
template <typename T, typename Decode>
std::optional<T> readEntry(const DecompositionCache& cache, const fs::path& file, const Decode& decode) {
  std::error_code ignored;
  if (file.empty() || !fs::exists(file, ignored)) return std::nullopt;
  const auto read = [&]() -> Result<T> {
    // Opening a named pipe would wait.
    LORICA_TRY_DO(checkOwnFolder(file.parent_path()));
    if (!fs::is_regular_file(file, ignored)) return badFormat("{}: is not a regular file", file.string());
    LORICA_TRY(const std::string bytes, readFile(file));
    return decode(bytes);
  };
  Result<T> content = read();
  if (content) return std::move(*content);
  warn(cache, content.error().message + "; it is computed again");
  return std::nullopt;
}

/// Writes an entry. What goes wrong causes a warning.
template <typename Write>
void keepEntry(const DecompositionCache& cache, const fs::path& file, const Write& write) {
  if (file.empty()) {
    warn(cache, "neither XDG_CACHE_HOME nor HOME is an absolute path: what was computed is not cached");
    return;
  }
  Result<void> kept = makeOwnFolder(file.parent_path());
  if (kept) kept = write();
  if (!kept) warn(cache, kept.error().message + "; what was computed is not cached");
}

/// Hash of everything that a decomposition depends on.
std::uint64_t cacheKey(const TriMesh& mesh, const Keyframes& keyframes, const DecomposeSettings& settings) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double), "positions are hashed as bytes");
  const std::string_view positions(reinterpret_cast<const char*>(keyframes.positions.data()),
                                   keyframes.positions.size() * sizeof(Vec3));
  std::string rest = fmt::format("{} {} {} {} {} {}", kAlgorithmVersion, topologyHash(mesh), keyframes.count,
                                 settings.maxParts, static_cast<int>(settings.preset), settings.rigid);
  if (settings.maxConcavity > 0.0) rest += fmt::format(" {}", settings.maxConcavity);
  return contentHash(rest, contentHash(positions));
}

/// Hash of everything that a cover depends on.
std::uint64_t cacheKey(const Character& character, const Decomposition& decomposition, const CoverPoses& poses,
                       const CoverRequest& request) {
  std::vector<double> numbers;
  for (const std::vector<Affine3>* kind : {&poses.sampled, &poses.heldOut}) {
    for (const Affine3& worldFromModel : *kind) {
      numbers.insert(numbers.end(), worldFromModel.data(), worldFromModel.data() + 16);
    }
  }
  for (const LiftedPoint& point : liftPoints(character, decomposition)) {
    for (const LiftedTerm& t : point) {
      numbers.insert(numbers.end(), {static_cast<double>(t.joint), t.moment.x(), t.moment.y(), t.moment.z(), t.weight});
    }
  }
  const std::string_view bytes(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double));
  const std::string rest =
      fmt::format("cover {} {} {} {} {}", kAlgorithmVersion, hashOf(decomposition), poses.sampledView().poseCount(),
                  request.tolerance.value_or(0.0), request.hullVertices);
  return contentHash(rest, contentHash(bytes));
}

constexpr const char* kExtension = ".entry";

/// The first line of an entry, before the bytes of a .lorica file.
std::string firstLine(std::uint64_t key) {
  return fmt::format("lorica cache entry {}\n", hexDigits(key));
}

/// The content of an entry, if it is whole, is that of the key and fits the mesh.
std::optional<DecompositionFile> readCache(const DecompositionCache& cache, std::uint64_t key, const TriMesh& mesh) {
  const fs::path file = entryFile(cache, key, kExtension);
  return readEntry<DecompositionFile>(cache, file, [&](const std::string& bytes) -> Result<DecompositionFile> {
    const std::string line = firstLine(key);
    if (!bytes.starts_with(line)) {
      return badFormat("{}: does not begin with '{}'", file.string(), line.substr(0, line.size() - 1));
    }
    LORICA_TRY(DecompositionFile cached,
               parseDecomposition(std::string_view(bytes).substr(line.size()), file.string()));
    if (cached.meshHash != topologyHash(mesh)) return badFormat("{}: made from another mesh", file.string());
    return cached;
  });
}

void writeCache(const DecompositionCache& cache, std::uint64_t key, const DecompositionFile& content) {
  const fs::path file = entryFile(cache, key, kExtension);
  keepEntry(cache, file, [&]() -> Result<void> {
    LORICA_TRY(const std::string bytes, formatDecomposition(content, file.string()));
    return writeFileAtomically(file, firstLine(key) + bytes, NamedBy::kLorica);
  });
}

/// Reads a decomposition of keyframes from the cache, or computes and caches it.
Result<CachedDecomposition> decomposeCached(const std::string& name, const TriMesh& mesh, const Character* character,
                                            const Training* training, const Keyframes& keyframes,
                                            const DecomposeSettings& settings, const DecompositionCache& cache) {
  const std::uint64_t key = cacheKey(mesh, keyframes, settings);
  if (std::optional<DecompositionFile> cached = readCache(cache, key, mesh)) {
    return CachedDecomposition{std::move(*cached), true, 0.0};
  }
  const PoseView poses{keyframes.positions, countOf(mesh.vertices)};
  LORICA_TRY(TimedDecomposition timed, decomposeTimed(name, mesh, poses, settings));
  Decomposition& made = timed.decomposition;
  UsedHulls hulls = hullsOfParts(made, poses);
  if (character != nullptr) {
    const HullCover cover = coverExactly(made, liftPoints(*character, made));
    hulls = liveHulls(*character, made, cover, {keyframes.worldFromModel, character->skeleton.jointCount()});
  }
  DecompositionFile content = fileContent(name, mesh, character, training, poses, std::move(made), hulls);
  writeCache(cache, key, content);
  return CachedDecomposition{std::move(content), false, timed.seconds};
}

}  // namespace

std::filesystem::path userCacheFolder() {
  return userFolder("XDG_CACHE_HOME", ".cache");
}

Result<CachedDecomposition> defaultDecomposition(const Character& character, const Training& training,
                                                 const DecomposeSettings& settings, const DecompositionCache& cache) {
  LORICA_TRY(const Keyframes keyframes, trainingKeyframes(character, training, std::nullopt));
  DecomposeSettings chosen;
  chosen.maxParts = kParts;
  chosen.threads = settings.threads;
  chosen.progress = settings.progress;
  return decomposeCached(character.name, character.mesh, &character, &training, keyframes, chosen, cache);
}

Result<CachedDecomposition> meshDecomposition(const std::string& name, const TriMesh& mesh,
                                              const DecomposeSettings& settings, const DecompositionCache& cache) {
  Keyframes keyframes;
  keyframes.positions = mesh.vertices;
  keyframes.count = 1;
  DecomposeSettings chosen = settings;
  chosen.rigid = true;
  return decomposeCached(name, mesh, nullptr, nullptr, keyframes, chosen, cache);
}

Result<HullCover> cachedCover(const Character& character, const DecompositionFile& content, const CoverPoses& poses,
                              const CoverRequest& request, const std::function<Result<HullCover>()>& choose,
                              const DecompositionCache& cache) {
  const std::uint64_t key = cacheKey(character, content.decomposition, poses, request);
  std::optional<DecompositionFile> cached = readCache(cache, key, character.mesh);
  if (cached && cached->cover && hashOf(cached->decomposition) == hashOf(content.decomposition)) {
    return std::move(*cached->cover);
  }
  LORICA_TRY(HullCover cover, choose());
  DecompositionFile kept = content;
  kept.cover = cover;
  writeCache(cache, key, kept);
  return cover;
}

Result<ClosedBody> cachedBody(const Character& character, const BodySettings& settings,
                              const DecompositionCache& cache) {
  // Hash of everything that a body depends on.
  const std::uint64_t key = contentHash(
      fmt::format("body {} {} {} {}", kBodyVersion, hashOf(character), settings.resolution, settings.keepClosed));
  const fs::path file = entryFile(cache, key, ".body");
  const auto decode = [&](const std::string& bytes) { return decodeBody(bytes, character, key, file.string()); };
  if (std::optional<ClosedBody> cached = readEntry<ClosedBody>(cache, file, decode)) return std::move(*cached);
  Result<ClosedBody> body = makeBody(character, settings);
  if (body && body->made) {
    keepEntry(cache, file, [&] { return writeFileAtomically(file, encodeBody(*body, key), NamedBy::kLorica); });
  }
  return body;
}

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

#include "prepare/decomposition_cache.h"

#include "acd/level_of_detail.h"
#include "collision/live/lifted_point.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/user_folders.h"
#include "prepare/cache_entries.h"
#include "prepare/file_content.h"

#include <fmt/format.h>

#include <chrono>
#include <optional>
#include <string_view>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr int kParts = 16;

/// Hash of everything that a decomposition depends on.
std::uint64_t cacheKey(const TriMesh& mesh, const Keyframes& keyframes, const DecomposeSettings& settings) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double), "positions are hashed as bytes");
  const std::string_view positions(reinterpret_cast<const char*>(keyframes.positions.data()),
                                   keyframes.positions.size() * sizeof(Vec3));
  std::string rest = fmt::format("{} {} {} {} {}", kAlgorithmVersion, topologyHash(mesh), keyframes.count,
                                 settings.maxParts, static_cast<int>(settings.preset));
  if (settings.maxConcavity > 0.0) rest += fmt::format(" {}", settings.maxConcavity);
  return contentHash(rest, contentHash(positions));
}

/// Hash of everything that a cover depends on.
std::uint64_t cacheKey(const Character& character, const Decomposition& decomposition, const CoverPoses& poses,
                       const CoverRequest& request) {
  std::vector<double> numbers;
  for (const std::vector<Affine3>* of : {&poses.sampled, &poses.heldOut}) {
    for (const Affine3& worldFromModel : *of) {
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
  const fs::path file = cacheFile(cache, key, kExtension);
  if (!hasEntry(cache, file)) return std::nullopt;
  const Result<std::string> bytes = readFile(file);
  if (!bytes) {
    warnOfEntry(cache, bytes.error().message);
    return std::nullopt;
  }
  const std::string line = firstLine(key);
  if (!bytes->starts_with(line)) {
    warnOfEntry(cache, fmt::format("{}: does not begin with '{}'", file.string(), line.substr(0, line.size() - 1)));
    return std::nullopt;
  }
  Result<DecompositionFile> cached = parseDecomposition(std::string_view(*bytes).substr(line.size()), file.string());
  if (!cached) {
    warnOfEntry(cache, cached.error().message);
    return std::nullopt;
  }
  if (cached->meshHash != topologyHash(mesh)) {
    warnOfEntry(cache, file.string() + ": made from another mesh");
    return std::nullopt;
  }
  return std::move(*cached);
}

void writeCache(const DecompositionCache& cache, std::uint64_t key, const DecompositionFile& content) {
  const fs::path file = cacheFile(cache, key, kExtension);
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
  const auto start = std::chrono::steady_clock::now();
  Result<Decomposition> made = decompose(mesh, poses, settings);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!made) {
    // The error names the mesh element; the name of the file is added here.
    if (made.error().code == ErrorCode::kBadMesh) return badMesh(name + ": " + made.error().message);
    return made.error();
  }
  UsedHulls hulls = hullsOfParts(*made, poses);
  if (character != nullptr) {
    const HullCover cover = coverExactly(*made, liftPoints(*character, *made));
    hulls = liveHulls(*character, *made, cover, {keyframes.worldFromModel, character->skeleton.jointCount()});
  }
  DecompositionFile content = fileContent(name, mesh, character, training, poses, std::move(*made), hulls);
  writeCache(cache, key, content);
  return CachedDecomposition{std::move(content), false, seconds};
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
  return decomposeCached(name, mesh, nullptr, nullptr, keyframes, settings, cache);
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

}  // namespace lorica

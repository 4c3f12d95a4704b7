#include "apps/decomposition_cache.h"

#include "apps/quality.h"
#include "apps/report.h"
#include "apps/training.h"
#include "collision/live/lifted_point.h"
#include "geometry/files.h"

#include <fmt/format.h>

#include <type_traits>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr int kParts = 16;
/// Raise it when decompose() or chooseCover() gives something else for the same input, or when files hold more: or
/// caches of older programs would live on.
constexpr std::uint64_t kAlgorithmVersion = 4;

/// Hash of all that the result depends on.
std::uint64_t cacheKey(const TriMesh& mesh, const Keyframes& keyframes, const DecomposeSettings& settings) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double), "positions are hashed as bytes");
  const std::string_view positions(reinterpret_cast<const char*>(keyframes.positions.data()),
                                   keyframes.positions.size() * sizeof(Vec3));
  const std::string rest = fmt::format("{} {} {} {} {}", kAlgorithmVersion, topologyHash(mesh), keyframes.count,
                                       settings.maxParts, static_cast<int>(settings.preset));
  return contentHash(rest, contentHash(positions));
}

/// Hash of all that a cover depends on.
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

fs::path cacheFile(std::uint64_t key) {
  const fs::path folder = cacheFolder();
  return folder.empty() ? fs::path() : folder / (hexDigits(key) + ".lorica");
}

/// What the cache holds, if it is whole and fits the mesh.
std::optional<DecompositionFile> readCache(const fs::path& file, const TriMesh& mesh) {
  std::error_code ignored;
  if (file.empty() || !fs::exists(file, ignored)) return std::nullopt;
  Result<DecompositionFile> cached = readDecomposition(file);
  if (!cached) {
    warn(cached.error().message + "; it is computed again");
    return std::nullopt;
  }
  if (cached->meshHash != topologyHash(mesh)) {
    warn(file.string() + ": made from another mesh; it is computed again");
    return std::nullopt;
  }
  return std::move(*cached);
}

void writeCache(const fs::path& file, const DecompositionFile& content) {
  if (file.empty()) {
    warn(fmt::format("neither XDG_CACHE_HOME nor HOME names a folder, so the {} is not kept for the next start",
                     content.cover ? "cover" : "decomposition"));
    return;
  }
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  std::string problem = error ? fmt::format("{}: {}", file.parent_path().string(), error.message()) : "";
  if (!error) {
    if (const Result<void> written = writeDecomposition(file, content); !written) problem = written.error().message;
  }
  if (!problem.empty()) {
    warn(fmt::format("{}; the {} is not kept for the next start", problem, content.cover ? "cover" : "decomposition"));
  }
}

/// Reads a decomposition of keyframes from the cache, or makes it and keeps it.
Result<DefaultDecomposition> decomposeCached(const std::string& name, const TriMesh& mesh, const Character* character,
                                             const Training* training, const Keyframes& keyframes,
                                             const DecomposeSettings& settings) {
  const fs::path file = cacheFile(cacheKey(mesh, keyframes, settings));
  if (std::optional<DecompositionFile> cached = readCache(file, mesh)) {
    return DefaultDecomposition{std::move(*cached), true, 0.0};
  }
  const PoseView poses{keyframes.positions, static_cast<int>(mesh.vertices.size())};
  Result<TimedDecomposition> made = decomposeWithProgress(name, mesh, poses, settings);
  if (!made) return made.error();
  const Quality quality = measureQuality(made->decomposition, mesh, poses);
  DecompositionFile content =
      fileContent(name, mesh, character, training, poses, std::move(made->decomposition), quality);
  writeCache(file, content);
  return DefaultDecomposition{std::move(content), false, made->seconds};
}

}  // namespace

std::filesystem::path cacheFolder() {
  // The XDG specification has relative paths ignored.
  if (const fs::path cache = environment("XDG_CACHE_HOME"); cache.is_absolute()) return cache / "lorica";
  if (const fs::path home = environment("HOME"); home.is_absolute()) return home / ".cache" / "lorica";
  return {};
}

Result<DefaultDecomposition> defaultDecomposition(const Subject& subject, int threads) {
  const Character& character = *subject.character;
  const Result<Training> training = trainingMotions(subject, {});
  if (!training) return training.error();
  const Result<Keyframes> keyframes = trainingKeyframes(character, *training, std::nullopt);
  if (!keyframes) return keyframes.error();
  DecomposeSettings settings;
  settings.maxParts = kParts;
  settings.threads = threads;

  return decomposeCached(character.name, character.mesh, &character, &*training, *keyframes, settings);
}

Result<Decomposition> cachedMeshDecomposition(const std::string& name, const TriMesh& mesh, int parts) {
  Keyframes keyframes;
  keyframes.positions = mesh.vertices;
  keyframes.count = 1;
  DecomposeSettings settings;
  settings.maxParts = parts;
  Result<DefaultDecomposition> made = decomposeCached(name, mesh, nullptr, nullptr, keyframes, settings);
  if (!made) return made.error();
  return std::move(made->file.decomposition);
}

Result<CoverPromise> cachedCover(const Subject& subject, const DecompositionFile& content, const CoverRequest& request,
                                 int threads) {
  const Character& character = *subject.character;
  const Result<Training> training = trainingMotions(subject, {});
  if (!training) return training.error();
  const Result<CoverPoses> poses = coverPoses(character, training->motions);
  if (!poses) return poses.error();
  const fs::path file = cacheFile(cacheKey(character, content.decomposition, *poses, request));
  std::optional<DecompositionFile> cached = readCache(file, character.mesh);
  if (cached && cached->cover && hashOf(cached->decomposition) == hashOf(content.decomposition)) {
    return std::move(*cached->cover);
  }
  Result<CoverPromise> cover = chooseCoverWithProgress(character, content.decomposition, *poses, request, threads);
  if (!cover) return cover.error();
  DecompositionFile kept = content;
  kept.cover = *cover;
  writeCache(file, kept);
  return std::move(*cover);
}

}  // namespace lorica

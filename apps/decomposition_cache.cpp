#include "apps/decomposition_cache.h"

#include "apps/inputs.h"
#include "apps/quality.h"
#include "apps/report.h"
#include "apps/training.h"
#include "geometry/files.h"

#include <fmt/format.h>

#include <type_traits>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr int kParts = 16;
constexpr int kKeyframes = 12;
/// Raise it when decompose() gives other parts for the same input, or caches of older programs would live on.
constexpr std::uint64_t kAlgorithmVersion = 2;

/// Hash of all that the result depends on.
std::uint64_t cacheKey(const TriMesh& mesh, const Keyframes& keyframes, const DecomposeSettings& settings) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double), "positions are hashed as bytes");
  const std::string_view positions(reinterpret_cast<const char*>(keyframes.positions.data()),
                                   keyframes.positions.size() * sizeof(Vec3));
  const std::string rest = fmt::format("{} {} {} {} {}", kAlgorithmVersion, topologyHash(mesh), keyframes.count,
                                       settings.maxParts, static_cast<int>(settings.preset));
  return contentHash(rest, contentHash(positions));
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
    warn("neither XDG_CACHE_HOME nor HOME names a folder, so the decomposition is not kept for the next start");
    return;
  }
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  std::string problem = error ? fmt::format("{}: {}", file.parent_path().string(), error.message()) : "";
  if (!error) {
    if (const Result<void> written = writeDecomposition(file, content); !written) problem = written.error().message;
  }
  if (!problem.empty()) warn(problem + "; the decomposition is not kept for the next start");
}

}  // namespace

std::filesystem::path cacheFolder() {
  // The XDG specification has relative paths ignored.
  if (const fs::path cache = environment("XDG_CACHE_HOME"); cache.is_absolute()) return cache / "lorica";
  if (const fs::path home = environment("HOME"); home.is_absolute()) return home / ".cache" / "lorica";
  return {};
}

Result<DefaultDecomposition> defaultDecomposition(const Character& character, int threads) {
  const Result<Keyframes> keyframes = trainingKeyframes(character, {}, kKeyframes);
  if (!keyframes) return keyframes.error();
  DecomposeSettings settings;
  settings.maxParts = kParts;
  settings.threads = threads;

  const fs::path folder = cacheFolder();
  const fs::path file =
      folder.empty() ? fs::path() : folder / (hexDigits(cacheKey(character.mesh, *keyframes, settings)) + ".lorica");
  if (std::optional<DecompositionFile> cached = readCache(file, character.mesh)) {
    return DefaultDecomposition{std::move(*cached), true, 0.0};
  }

  const PoseView poses{keyframes->positions, static_cast<int>(character.mesh.vertices.size())};
  Result<TimedDecomposition> made = decomposeWithProgress(character.name, character.mesh, poses, settings);
  if (!made) return made.error();
  const Quality quality = measureQuality(made->decomposition, character.mesh, poses);
  DecompositionFile content =
      fileContent(character.name, character.mesh, &character, poses, std::move(made->decomposition), quality);
  writeCache(file, content);
  return DefaultDecomposition{std::move(content), false, made->seconds};
}

}  // namespace lorica

#include "prepare/cache_entries.h"

#include "geometry/files.h"
#include "session/recording/session_file.h"
#include "skinning/body/body_file.h"

#include <fmt/format.h>

#include <optional>
#include <utility>

namespace lorica {
namespace {

/// Hash of everything that a body depends on.
std::uint64_t bodyKey(const Character& character, const BodySettings& settings) {
  return contentHash(
      fmt::format("body {} {} {} {}", kBodyVersion, hashOf(character), settings.resolution, settings.keepClosed));
}

std::optional<ClosedBody> readBody(const DecompositionCache& cache, const std::filesystem::path& file,
                                   const Character& character, std::uint64_t key) {
  if (!hasEntry(cache, file)) return std::nullopt;
  const Result<std::string> bytes = readFile(file);
  Result<ClosedBody> body = bytes ? decodeBody(*bytes, character, key, file.string()) : bytes.error();
  if (body) return std::move(*body);
  warnOfEntry(cache, body.error().message);
  return std::nullopt;
}

namespace fs = std::filesystem;

void warn(const DecompositionCache& cache, const std::string& sentence) {
  if (cache.warn) cache.warn(sentence);
}

}  // namespace

Result<ClosedBody> cachedBody(const Character& character, const BodySettings& settings,
                              const DecompositionCache& cache) {
  const std::uint64_t key = bodyKey(character, settings);
  const std::filesystem::path file = cacheFile(cache, key, ".body");
  if (std::optional<ClosedBody> cached = readBody(cache, file, character, key)) return std::move(*cached);
  Result<ClosedBody> body = makeBody(character, settings);
  if (body && body->made) {
    keepEntry(cache, file, [&] { return writeFileAtomically(file, encodeBody(*body, key), NamedBy::kLorica); });
  }
  return body;
}

fs::path cacheFile(const DecompositionCache& cache, std::uint64_t key, const char* extension) {
  return cache.folder.empty() ? fs::path() : cache.folder / (hexDigits(key) + extension);
}

bool hasEntry(const DecompositionCache& cache, const fs::path& file) {
  std::error_code ignored;
  if (file.empty() || !fs::exists(file, ignored)) return false;
  if (fs::is_regular_file(file, ignored)) return true;  // opening a named pipe would wait
  warnOfEntry(cache, file.string() + ": is not a regular file");
  return false;
}

void warnOfEntry(const DecompositionCache& cache, const std::string& problem) {
  warn(cache, problem + "; it is computed again");
}

void keepEntry(const DecompositionCache& cache, const fs::path& file, const std::function<Result<void>()>& write) {
  if (file.empty()) {
    warn(cache, "neither XDG_CACHE_HOME nor HOME is an absolute path: what was computed is not cached");
    return;
  }
  Result<void> kept = makeOwnFolder(file.parent_path());
  if (kept) kept = write();
  if (!kept) warn(cache, kept.error().message + "; what was computed is not cached");
}

}  // namespace lorica

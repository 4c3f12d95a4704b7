#include "prepare/body_cache.h"

#include "geometry/files.h"
#include "prepare/cache_entries.h"
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

}  // namespace lorica

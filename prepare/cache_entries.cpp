#include "prepare/cache_entries.h"

#include "geometry/files.h"

#include <fmt/format.h>

namespace lorica {
namespace {

namespace fs = std::filesystem;

void warn(const DecompositionCache& cache, const std::string& sentence) {
  if (cache.warn) cache.warn(sentence);
}

}  // namespace

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

#include "apps/memory_limit.h"

#include "apps/report.h"
#include "geometry/errors.h"
#include "geometry/hard_stop.h"
#include "geometry/sanitizer.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <memory>
#include <new>
#include <vector>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kUsual = std::uint64_t{2} << 30;
constexpr std::uint64_t kPerByte = 200;                       // of files
constexpr std::uint64_t kPerThread = std::uint64_t{9} << 20;  // its stack, and what malloc keeps for it

std::atomic<std::uint64_t> gAllowed = 0;
std::atomic<bool> gEnding = false;
std::optional<rlimit> gBefore;                // the usual limit: what to go back to
std::unique_ptr<std::vector<char>> gReserve;  // for the sentence

std::uint64_t sizeOf(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return 0;
  const std::uintmax_t size = fs::file_size(file, error);
  return error ? 0 : size;
}

/// A .gltf names its buffers and pictures, which lie beside it.
std::uint64_t sizeWithNeighbours(const fs::path& file) {
  if (file.extension() != ".gltf") return sizeOf(file);
  std::uint64_t size = 0;
  std::error_code error;
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    size += sizeOf(entry->path());
  }
  return size;
}

void onTerminate() {
  if (const std::exception_ptr thrown = std::current_exception()) {
    try {
      std::rethrow_exception(thrown);
    } catch (const std::bad_alloc&) {
      endWithoutMemory();
    } catch (...) {
    }
  }
  std::abort();
}

}  // namespace

std::uint64_t usualMemory(std::span<const std::string> words) {
  std::uint64_t bytes = 0;
  for (const std::string& word : words) bytes += sizeWithNeighbours(word);
  return std::max(kUsual, kPerByte * bytes);
}

void limitMemory(std::uint64_t bytes, int threads, LimitOf set) {
  struct rlimit known {};
  if (kReservesAddresses || ::getrlimit(RLIMIT_DATA, &known) != 0) return;
  const std::uint64_t wanted = bytes + kPerThread * static_cast<std::uint64_t>(threads);
  gAllowed = std::min<std::uint64_t>(bytes, known.rlim_cur);
  gReserve = std::make_unique<std::vector<char>>(std::size_t{1} << 20);
  // Processes that this one starts may set their own.
  const struct rlimit limit = {std::min<rlim_t>(wanted, known.rlim_cur), known.rlim_max};
  if (::setrlimit(RLIMIT_DATA, &limit) != 0) return;
  if (set == LimitOf::kUsual) gBefore = known;
  std::set_new_handler([] { endWithoutMemory(); });
  std::set_terminate(onTerminate);
}

void liftUsualLimit() {
  if (gBefore && ::setrlimit(RLIMIT_DATA, &*gBefore) == 0) gAllowed = gBefore->rlim_cur;
}

void endWithoutMemory() noexcept {
  if (gEnding.exchange(true)) {  // another thread is at it, or there is not even memory for the sentence
    ::sleep(1);
    ::_exit(kBadInputStatus);
  }
  gReserve.reset();
  try {
    const std::string sentence = fmt::format(
        "needs more than the {} MB of memory that it may take; --memory SIZE, such as --memory 8G, allows more",
        gAllowed.load() >> 20);
    publishFailure(kOutOfMemory, sentence);
    say("lorica: " + sentence + "\n");
    runHardStop();
  } catch (...) {
    say("lorica: out of memory\n");
  }
  ::_exit(kBadInputStatus);
}

}  // namespace lorica

#include "bindings/program_host.h"

#include "geometry/errors.h"
#include "geometry/work_budgets.h"

#include <dlfcn.h>

#include <cstddef>
#include <vector>

namespace lorica {
namespace {

namespace fs = std::filesystem;

/// An address in the library that this code is in.
void ownLibrary() {}

/// Folders in which the loader looks for modules of that library.
std::vector<fs::path> moduleFolders() {
  std::vector<fs::path> folders;
  Dl_info own = {};
  if (::dladdr(reinterpret_cast<const void*>(&ownLibrary), &own) == 0 || own.dli_fname == nullptr) return folders;
  void* library = ::dlopen(own.dli_fname, RTLD_LAZY | RTLD_NOLOAD);
  if (library == nullptr) return folders;
  Dl_serinfo size = {};
  if (::dlinfo(library, RTLD_DI_SERINFOSIZE, &size) == 0) {
    std::vector<std::max_align_t> memory(size.dls_size / sizeof(std::max_align_t) + 1);
    auto* found = reinterpret_cast<Dl_serinfo*>(memory.data());
    *found = size;
    if (::dlinfo(library, RTLD_DI_SERINFO, found) == 0) {
      for (unsigned i = 0; i < found->dls_cnt; ++i) folders.emplace_back(found->dls_serpath[i].dls_name);
    }
  }
  ::dlclose(library);
  return folders;
}

}  // namespace

Result<void> checkCounts(int parts, int hullVertices, int threads) {
  const auto fits = [](int count, int min, int max) { return count == 0 || (count >= min && count <= max); };
  if (!fits(threads, 1, kMaxThreads)) {
    return invalidArgument("threads: found {}, expected 1 to {}, or 0 for all of the machine's", threads, kMaxThreads);
  }
  if (!fits(hullVertices, 4, kMaxOfAnything)) {
    return invalidArgument("vertices of a hull: found {}, expected at least 4 and at most {}, or 0 for no limit",
                           hullVertices, kMaxOfAnything);
  }
  if (!fits(parts, 1, kMaxOfAnything)) {
    return invalidArgument("parts: found {}, expected 0 to {}", parts, kMaxOfAnything);
  }
  return {};
}

ProgramHost::ProgramHost(const DecomposeProgress& progress, int threadCount, int parts)
    : progress_(progress), parts_(parts) {
  constexpr const char* kProgram = "lorica_character_reader";
  threads = threadCount;
  reader = IsolatedReader{kProgram, {}};
  for (const fs::path& folder : moduleFolders()) {
    std::error_code ignored;
    if (!fs::is_regular_file(folder / kProgram, ignored)) continue;
    reader->program = folder / kProgram;
    break;
  }
}

void ProgramHost::beginTask(const std::string& /*label*/, const std::string& unit) {
  counted_ = unit == "parts";
}

void ProgramHost::report(int done, int total, double /*share*/) {
  if (!progress_ || cancelled_) return;
  cancelled_ = counted_ ? !progress_(done, total) : !progress_(0, parts_);
}

}  // namespace lorica

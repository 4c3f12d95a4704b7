#include "bindings/program_host.h"

#include <dlfcn.h>

#include <cstddef>
#include <filesystem>
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

std::optional<IsolatedReader> characterReader() {
  constexpr const char* kProgram = "lorica_character_reader";
  for (const fs::path& folder : moduleFolders()) {
    std::error_code ignored;
    if (fs::is_regular_file(folder / kProgram, ignored)) return IsolatedReader{folder / kProgram, {}};
  }
  return IsolatedReader{kProgram, {}};
}

}  // namespace lorica

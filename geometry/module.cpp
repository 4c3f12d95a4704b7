#include "geometry/module.h"

#include "geometry/errors.h"

#include <dlfcn.h>
#include <fmt/format.h>

namespace lorica {

Result<const void*> loadModule(std::string_view name, const char* symbol, std::string_view purpose) {
  const std::string file = fmt::format("liblorica_{}.so", name);
  void* library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  const void* address = library == nullptr ? nullptr : ::dlsym(library, symbol);
  if (address == nullptr) {
    const char* problem = ::dlerror();
    return unsupported("{} needs {}, which cannot be loaded: {}", purpose, file,
                       problem == nullptr ? "unknown cause" : problem);
  }
  return address;
}

}  // namespace lorica

#include "geometry/module.h"

#include "geometry/errors.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>

namespace lorica {

std::string packageOf(std::string_view problem) {
  std::string_view library = problem.substr(0, problem.find(": cannot open shared object file"));
  if (library == problem) return "";
  if (library.starts_with("liblorica_")) return "lorica";
  const std::size_t end = library.find(".so.");
  if (!library.starts_with("lib") || end == std::string_view::npos) return "";
  std::string name(library.substr(0, end));
  std::replace(name.begin(), name.end(), '_', '-');
  const bool digit = name.back() >= '0' && name.back() <= '9';
  return fmt::format("{}{}{}", name, digit ? "-" : "", library.substr(end + 4));
}

Result<const void*> loadModule(std::string_view name, const char* symbol, std::string_view purpose) {
  const std::string file = fmt::format("liblorica_{}.so", name);
  void* library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  const void* address = library == nullptr ? nullptr : ::dlsym(library, symbol);
  if (address == nullptr) {
    const char* problem = ::dlerror();
    const std::string package = packageOf(problem == nullptr ? "" : problem);
    return unsupported("{} needs {}, which cannot be loaded: {}{}{}", purpose, file,
                       problem == nullptr ? "unknown cause" : problem,
                       package.empty() ? "" : "; install the Debian package ", package);
  }
  return address;
}

}  // namespace lorica

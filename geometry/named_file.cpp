#include "geometry/named_file.h"

#include "geometry/errors.h"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <system_error>

namespace lorica {

namespace {

namespace fs = std::filesystem;

/// The end of a name, which tells files apart.
std::string shown(std::string_view name) {
  constexpr std::size_t kShown = 120;
  const std::string end(name.size() <= kShown ? name : name.substr(name.size() - kShown));
  return name.size() <= kShown ? end : "..." + end;
}

Error outside(const std::string& name) {
  return badFormat("'{}' is outside the file's folder, expected a file in it (or --trust-paths)", shown(name));
}

/// Whether the name alone stays in the folder.
bool staysInside(const std::string& name) {
  if (name.empty() || name.front() == '~' || name.find(':') != std::string::npos) return false;
  const fs::path path = name;
  return !path.is_absolute() && std::find(path.begin(), path.end(), "..") == path.end();
}

/// Whether a path without symbolic links is in a folder or below.
bool isBeneath(const fs::path& folder, const fs::path& path) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

}  // namespace

Result<fs::path> NamedFiles::find(std::string name) const {
  if (const std::size_t zero = name.find('\0'); zero != std::string::npos) {
    return badFormat(
        "found a name with a zero byte after '{}', expected the name of a "
        "file",
        shown(std::string_view(name).substr(0, zero)));
  }
  const fs::path base = folder.empty() ? fs::path(".") : folder;
  std::replace(name.begin(), name.end(), '\\', '/');  // some exporters write backslashes
  if (trust == PathTrust::kAnywhere) return base / name;
  if (!staysInside(name)) return outside(name);
  std::error_code error;
  const fs::path root = fs::canonical(base, error);
  const fs::path real = error ? fs::path() : fs::weakly_canonical(root / name, error);
  if (error) {
    return unreadable("'{}' cannot be found: {}", shown(name), error.message());
  }
  if (!isBeneath(root, real)) return outside(name);
  return base / fs::path(name);
}

}  // namespace lorica

#include "viewer/page/sent_file.h"

#include "geometry/errors.h"
#include "geometry/files.h"
#include "viewer/player/window_opener.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <system_error>

namespace lorica {
namespace {

namespace fs = std::filesystem;

// What a window opens, but for recordings of cameras and sessions, which it only says more about.
constexpr std::array<std::string_view, 15> kEndings = {"glb", "gltf", "vrm", "vrma", "fbx", "dae", "bvh",   "csv",
                                                       "txt", "json", "obj", "ply",  "stl", "off", "lorica"};

Result<std::string> keep(const fs::path& folder, std::string_view ending, std::string_view bytes) {
  LORICA_TRY_DO(makeOwnFolder(folder));
  std::error_code error;
  std::uintmax_t all = bytes.size();
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    std::error_code gone;
    if (const std::uintmax_t size = entry.file_size(gone); !gone) all += size;
  }
  if (error) return unwritable("{}: {}", folder.string(), error.message());
  if (all > kMaxSentFiles) {
    return unwritable("no room for this file: all that were opened from the page may have {} MiB", kMaxSentFiles >> 20);
  }
  LORICA_TRY(std::string file, newDatedFile(folder, fmt::format(".{}", ending)));
  LORICA_TRY_DO(writeFileAtomically(file, bytes, NamedBy::kLorica));
  return file;
}

}  // namespace

bool mayBeSent(std::string_view ending) {
  return !ending.empty() && std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

const std::string& endingsThatMayBeSent() {
  static const std::string all = fmt::format(".{}", fmt::join(kEndings, ", ."));
  return all;
}

Result<std::string> keepSentFile(const fs::path& folder, std::string_view ending, std::string_view bytes) {
  Result<std::string> kept = keep(folder, ending, bytes);
  if (!kept) return Error{kept.error().code, withoutFolder(kept.error().message, folder)};
  return kept;
}

std::string withoutFolder(std::string sentence, const fs::path& folder) {
  const std::string name = folder.string();
  if (name.empty()) return sentence;
  for (std::size_t at = 0; (at = sentence.find(name, at)) != std::string::npos;) {
    const bool file = at + name.size() < sentence.size() && sentence[at + name.size()] == '/';
    sentence.replace(at, name.size() + (file ? 1 : 0), file ? "" : "the folder");
  }
  return sentence;
}

}  // namespace lorica

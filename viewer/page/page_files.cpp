#include "viewer/page/page_files.h"

#include "geometry/errors.h"
#include "geometry/files.h"
#include "viewer/player/window_opener.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <system_error>

namespace lorica {

std::span<const std::uint8_t> indexPageFile();
std::span<const std::uint8_t> stylePageFile();
std::span<const std::uint8_t> scriptPageFile();
std::span<const std::uint8_t> licencesPageFile();

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kNotBuilt =
    "<!doctype html><html lang=\"en\"><title>Lorica</title><h1>Lorica</h1>"
    "<p>This Lorica was built without its page, which needs node and npm: run <code>scripts/setup --page</code> and "
    "build again. Programs can watch at <code>/live</code>, see docs/WIRE.md.</p></html>\n";

std::span<const std::uint8_t> notBuilt() {
  return {reinterpret_cast<const std::uint8_t*>(kNotBuilt.data()), kNotBuilt.size()};
}

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

bool pageBuilt() {
  return !scriptPageFile().empty();
}

const PageFile* pageFile(std::string_view path) {
  constexpr std::string_view kHtml = "text/html; charset=utf-8";
  static const std::array<PageFile, 4> files = {{{"/", kHtml, pageBuilt() ? indexPageFile() : notBuilt()},
                                                 {"/page.css", "text/css; charset=utf-8", stylePageFile()},
                                                 {"/page.js", "text/javascript; charset=utf-8", scriptPageFile()},
                                                 {"/licences.txt", "text/plain; charset=utf-8", licencesPageFile()}}};
  for (const PageFile& file : files) {
    if (file.path == path && !file.bytes.empty()) return &file;
  }
  return nullptr;
}

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

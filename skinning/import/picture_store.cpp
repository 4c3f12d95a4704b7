#include "skinning/import/picture_store.h"

#include "geometry/counts.h"
#include "geometry/files.h"
#include "geometry/text.h"
#include "skinning/import/uri.h"

#include <fmt/format.h>

#include <system_error>

namespace lorica {

namespace {

namespace fs = std::filesystem;

[[nodiscard]] std::string shortened(const std::string& path) {
  constexpr std::size_t kShown = 120;
  return path.size() <= kShown ? path : "..." + std::string(lastBytes(path, kShown));
}

[[nodiscard]] bool isFile(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

/// What follows the last slash or backslash.
[[nodiscard]] std::string baseName(const std::string& path) {
  const std::size_t slash = path.find_last_of("/\\");
  return slash == std::string::npos ? path : path.substr(slash + 1);
}

}  // namespace

int PictureStore::addBytes(const std::string& name, std::span<const std::byte> bytes) {
  if (bytes.size() > allowance_) {
    return refuse(name, "all pictures together have more than twice the bytes of the file");
  }
  allowance_ -= bytes.size();
  scene_.pictures.push_back({name, {bytes.begin(), bytes.end()}});
  return countOf(scene_.pictures) - 1;
}

int PictureStore::addUri(const std::string& name, const std::string& uri) {
  if (isDataUri(uri)) {
    const Result<std::string> content = decodeDataUri(uri);
    return content ? addBytes(name, std::as_bytes(std::span(*content))) : refuse(name, content.error().message);
  }
  return addFile(name, percentDecoded(uri));
}

int PictureStore::addPath(const std::string& name, const std::string& path) {
  const Result<fs::path> file = files_.find(path);
  if (files_.folder.empty() || (file && isFile(*file))) return addFile(name, file ? path : baseName(path));
  const Result<fs::path> beside = files_.find(baseName(path));
  if (!beside || !isFile(*beside)) {
    return refuse(name, fmt::format("'{}' is neither in the file's folder nor is there a file of that name beside it",
                                    shortened(path)));
  }
  const bool isNew = !known_.contains(beside->lexically_normal());
  const int picture = addFile(name, baseName(path));
  if (isNew && picture >= 0) {
    notes_.add("pictures are on another machine: the files of the same names beside the character are used",
               fmt::format("{}: '{}' is not in the file's folder: '{}' beside it is used", name, shortened(path),
                           baseName(path)));
  }
  return picture;
}

int PictureStore::addFile(const std::string& name, const std::string& relative) {
  const Result<fs::path> found = files_.find(relative);
  if (!found) return refuse(name, found.error().message);
  const fs::path file = found->lexically_normal();
  const auto [known, isNew] = known_.emplace(file, -1);
  if (!isNew) return known->second;
  if (files_.folder.empty()) {
    return refuse(name, fmt::format("is in another file, '{}', which is not available here", shortened(relative)));
  }
  if (!isFile(file)) {
    return refuse(name, fmt::format("'{}' is not a file in the character's folder", shortened(relative)));
  }
  const Result<std::string> content = readFile(file, NamedBy::kFile);
  if (!content) return refuse(name, content.error().message);
  const std::span<const std::byte> bytes = std::as_bytes(std::span(*content));
  scene_.pictures.push_back({name, {bytes.begin(), bytes.end()}});
  return known->second = countOf(scene_.pictures) - 1;
}

int PictureStore::refuse(const std::string& name, const std::string& why) {
  notes_.add("pictures are not available, their materials stay plain",
             fmt::format("{}: {}: its materials stay plain", name, why));
  return -1;
}

}  // namespace lorica

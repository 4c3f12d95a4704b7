#include "export/bake/bake_store.h"

#include "export/bake/bake_list.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/json.h"
#include "geometry/named_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <initializer_list>
#include <system_error>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

/// Whether everything that is read of a description is of its type.
bool isDescription(const ordered_json& json) {
  const auto isText = [](const ordered_json& value) { return value.is_string(); };
  const auto isNumber = [](const ordered_json& value) { return value.is_number(); };
  const auto all = [](const ordered_json& object, std::initializer_list<const char*> names, const auto& is) {
    return object.is_object() &&
           std::ranges::all_of(names, [&](const char* name) { return !object.contains(name) || is(object.at(name)); });
  };
  const auto areFiles = [&](const ordered_json& files) {
    return files.is_array() && std::ranges::all_of(files, [&](const ordered_json& file) {
             return all(file, {"file", "hash"}, isText);
           });
  };
  return all(json, {"item", "input", "settings", "result", "failure"}, isText) &&
         all(json, {"parts", "score", "error", "heldOutError", "seconds", "cpuSeconds", "peakMemory"}, isNumber) &&
         all(json, {"files"}, areFiles);
}

}  // namespace

bool BakeStore::has(const std::string& item) const {
  std::error_code ignored;
  return fs::exists(folderOf(item) / kBakeDescription, ignored);
}

Result<ordered_json> BakeStore::describe(const std::string& item) const {
  const fs::path file = folderOf(item) / kBakeDescription;
  std::error_code ignored;
  const bool there = fs::exists(folderOf(item), ignored);
  const Result<std::string> text = readFile(file, NamedBy::kFile);
  if (!text && there && text.error().code == ErrorCode::kNotFound) return badFormat("{}: is missing", file.string());
  if (!text) return text.error();
  LORICA_TRY(ordered_json json, parseJson<ordered_json>(*text, file.string()));
  if (!isDescription(json)) return badFormat("{}: found other JSON than the description of a result", file.string());
  return json;
}

std::string BakeStore::damageOf(const std::string& item, const ordered_json& description) const {
  for (const ordered_json& described : description.value("files", ordered_json::array())) {
    const Result<fs::path> file = NamedFiles{folderOf(item)}.find(described.value("file", ""));
    if (!file) return file.error().message;
    const Result<std::string> content = readFile(*file, NamedBy::kFile);
    if (!content && content.error().code == ErrorCode::kNotFound) return file->string() + ": is missing";
    if (!content) return content.error().message;
    const std::string found = hexDigits(contentHash(*content)), expected = described.value("hash", "");
    if (found != expected) {
      return fmt::format("{}: found content with the hash {}, expected {}", file->string(), found, expected);
    }
  }
  return "";
}

Result<fs::path> BakeStore::begin() const {
  std::error_code error;
  fs::create_directories(folder_ / "items", error);
  for (int n = 0; !error; ++n) {  // a folder can be made by one process only
    fs::path made = folderOf(fmt::format("{}{}-{}", kBakeWork, ::getpid(), n));
    if (fs::create_directory(made, error)) return made;
  }
  return unwritable(folder_ / "items", error.value());
}

Result<bool> BakeStore::publish(const std::string& item, const fs::path& made, const ordered_json& description) const {
  const std::string text = description.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
  Result<void> done = writeFileAtomically(made / kBakeDescription, text, NamedBy::kLorica);
  if (done && std::rename(made.c_str(), folderOf(item).c_str()) == 0) return true;
  const int error = errno;
  const bool there = done && has(item);  // of another process, or of this one if a file server lost its answer
  std::error_code ignored;
  fs::remove_all(made, ignored);
  if (there) return false;
  return done ? unwritable(folderOf(item), error) : done.error();
}

Result<void> BakeStore::discard(const std::string& item) const {
  LORICA_TRY(const fs::path away, begin());
  std::error_code error;
  fs::rename(folderOf(item), away / item, error);  // as a whole, too
  std::error_code ignored;
  fs::remove_all(away, ignored);
  if (error && error != std::errc::no_such_file_or_directory) return unwritable(folderOf(item), error.value());
  return {};
}

void BakeStore::removeAbandoned(double age) const {
  const Result<fs::path> fresh = begin();
  if (!fresh) return;
  std::error_code ignored, gone;
  const fs::file_time_type now = fs::last_write_time(*fresh, gone);
  fs::remove(*fresh, ignored);
  for (fs::directory_iterator entry(folder_ / "items", ignored), end; !gone && entry != end; entry.increment(ignored)) {
    if (!entry->path().filename().string().starts_with(kBakeWork)) continue;
    std::error_code finished;  // meanwhile
    const fs::file_time_type changed = entry->last_write_time(finished);
    if (!finished && std::chrono::duration<double>(now - changed).count() > age) fs::remove_all(entry->path(), ignored);
  }
}

Result<std::vector<BakedFile>> bakedFiles(const fs::path& folder) {
  std::vector<BakedFile> files;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; entry != end; entry.increment(error)) {
    if (entry->is_directory() || entry->path() == folder / kBakeDescription) continue;
    LORICA_TRY(const std::string content, readFile(entry->path(), NamedBy::kFile));
    files.push_back(
        {entry->path().lexically_relative(folder).generic_string(), hexDigits(contentHash(content)), content.size()});
  }
  if (error) return unreadable("{}: cannot be read: {}", folder.string(), error.message());
  std::ranges::sort(files, {}, &BakedFile::name);
  return files;
}

std::string resultHash(const std::vector<BakedFile>& files) {
  std::string all;
  for (const BakedFile& file : files) all += fmt::format("{} {}\n", file.hash, file.name);
  return hexDigits(contentHash(all));
}

}  // namespace lorica

#include "bake/bake_store.h"

#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* kDescription = "item.json";
constexpr int kTries = 4;
constexpr std::chrono::milliseconds kFirstWait{50};  // doubled after each try

std::string textOf(const ordered_json& json) {
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

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

BakeStore::BakeStore(FileLayer& files, fs::path folder, std::function<void(std::chrono::milliseconds)> wait)
    : files_(&files), folder_(std::move(folder)), wait_(std::move(wait)) {}

bool BakeStore::has(const std::string& item) {
  return files_->exists(folderOf(item) / kDescription);
}

Result<ordered_json> BakeStore::describe(const std::string& item) {
  const fs::path file = folderOf(item) / kDescription;
  LORICA_TRY(const std::string text, files_->read(file));
  LORICA_TRY(ordered_json json, parseJson<ordered_json>(text, file.string()));
  if (!isDescription(json)) return badFormat("{}: found other JSON than the description of a result", file.string());
  return json;
}

Result<fs::path> BakeStore::begin(const std::string& item, int earlier) {
  const fs::path work = folder_ / "work";
  for (int before = 0; before < earlier; ++before) files_->remove(work / fmt::format("{}.{}", item, before));
  fs::path made = work / fmt::format("{}.{}", item, earlier);
  files_->remove(made);
  for (const fs::path& folder : {made, folder_ / "items"}) {
    if (const int error = files_->createFolders(folder); error != 0) return unwritable(folder, error);
  }
  return made;
}

Result<bool> BakeStore::publish(const std::string& item, const fs::path& made, const ordered_json& description) {
  const std::string text = textOf(description);
  if (const int error = files_->create(made / kDescription, text); error != 0) {
    drop(made);
    return unwritable(made / kDescription, error);
  }
  int error = 0;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    if (attempt > 0) wait_(kFirstWait * (1 << attempt));
    error = files_->rename(made, folderOf(item));
    if (error == 0) return true;
    // The answer may be lost of a rename that was done: then our own description is there.
    const Result<std::string> there = files_->read(folderOf(item) / kDescription);
    if (!there && files_->exists(made)) continue;
    if (!there) return false;  // somebody took the item over
    drop(made);
    return *there == text;
  }
  drop(made);
  return unwritable(folderOf(item), error);
}

void BakeStore::drop(const fs::path& made) {
  files_->remove(made);
}

void BakeStore::link(const std::string& item, const std::string& file, const std::string& name) {
  // Some file systems have no links: items/ holds everything.
  (void)files_->link(fs::path("items") / item / file, folder_ / name);
}

Result<void> BakeStore::discard(const std::string& item) {
  if (const int error = files_->remove(folderOf(item)); error != 0) return unwritable(folderOf(item), error);
  return {};
}

Result<std::vector<BakedFile>> bakedFiles(const fs::path& folder) {
  std::vector<BakedFile> files;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; entry != end; entry.increment(error)) {
    if (entry->is_directory() || entry->path() == folder / kDescription) continue;
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

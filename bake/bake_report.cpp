#include "bake/bake_report.h"

#include "geometry/files.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace lorica {
namespace {

using nlohmann::ordered_json;

/// Whether every file of a result is what its description says, and nothing is missing.
std::string damageOf(const ordered_json& result, const std::filesystem::path& folder) {
  const Result<std::vector<BakedFile>> files = bakedFiles(folder);
  if (!files) return files.error().message;
  if (resultHash(*files) == result.value("result", "")) return "";
  for (const ordered_json& described : result.value("files", ordered_json::array())) {
    const std::string name = described.value("file", "");
    const auto found = std::ranges::find(*files, name, &BakedFile::name);
    if (found == files->end()) return fmt::format("{}: is missing", (folder / name).string());
    if (found->hash != described.value("hash", "")) {
      return fmt::format("{}: found content with the hash {}, expected {}", (folder / name).string(), found->hash,
                         described.value("hash", ""));
    }
  }
  return fmt::format("{}: found {} files, expected {}", folder.string(), files->size(),
                     result.value("files", ordered_json::array()).size());
}

}  // namespace

double errorOf(const ordered_json& result) {
  return result.contains("heldOutError") ? result.value("heldOutError", 0.0) : result.value("error", 0.0);
}

std::vector<const ordered_json*> BakeCollection::failed() const {
  std::vector<const ordered_json*> those;
  for (const ordered_json& result : results) {
    if (result.contains("failure")) those.push_back(&result);
  }
  return those;
}

std::vector<const ordered_json*> BakeCollection::worstFirst() const {
  std::vector<const ordered_json*> those;
  for (const ordered_json& result : results) {
    if (!result.contains("failure")) those.push_back(&result);
  }
  std::ranges::stable_sort(those, [](const auto* a, const auto* b) { return errorOf(*a) > errorOf(*b); });
  return those;
}

std::string BakeCollection::hash() const {
  std::vector<std::string> lines;
  for (const ordered_json& result : results) {
    lines.push_back(
        fmt::format("{} {} {}\n", result.value("item", ""), result.value("result", ""), result.contains("failure")));
  }
  std::ranges::sort(lines);
  return hexDigits(contentHash(fmt::format("{}", fmt::join(lines, ""))));
}

BakeCollection collect(std::span<const BakeJob> jobs, BakeStore& store, bool checkFiles) {
  BakeCollection collection;
  for (const BakeJob& job : jobs) {
    Result<ordered_json> result = store.describe(job.name);
    if (!result) {
      if (result.error().code == ErrorCode::kNotFound) collection.missing.push_back(job.item.input);
      if (result.error().code != ErrorCode::kNotFound) collection.damaged.push_back(result.error().message);
      continue;
    }
    if (checkFiles) {
      std::string damage = damageOf(*result, store.folderOf(job.name));
      if (!damage.empty()) collection.damaged.push_back(std::move(damage));
    }
    collection.results.push_back(std::move(*result));
  }
  return collection;
}

void linkResults(const BakeCollection& collection, std::span<const BakeJob> jobs, BakeStore& store) {
  std::map<std::string, const BakeJob*> byName;
  std::map<std::string, int> stems;
  for (const BakeJob& job : jobs) {
    byName[job.name] = &job;
    ++stems[job.stem];
  }
  for (const ordered_json& result : collection.results) {
    const auto found = byName.find(result.value("item", ""));
    if (found == byName.end()) continue;
    const auto& [item, job] = *found;
    std::set<std::string> names;
    for (const ordered_json& file : result.value("files", ordered_json::array())) {
      // The first folder of "hero/part.obj"; the name itself if it is in none.
      const std::string name = file.value("file", "");
      names.insert(name.substr(0, name.find('/')));
    }
    for (const std::string& name : names) {
      if (!name.starts_with(job->stem)) continue;
      store.link(item, name, stems[job->stem] > 1 ? item + name.substr(job->stem.size()) : name);
    }
  }
}

std::string jsonLines(const BakeCollection& collection) {
  std::string text;
  for (const ordered_json& result : collection.results) {
    text += result.dump(-1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
  }
  return text;
}

}  // namespace lorica

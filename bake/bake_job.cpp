#include "bake/bake_job.h"

#include "acd/decompose.h"
#include "bake/triangle_count.h"
#include "geometry/files.h"
#include "geometry/json.h"
#include "geometry/named_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestStem = 60;

struct Content {
  std::string hash;     ///< empty = cannot be read
  std::string refused;  ///< why not, if it is there and no regular file
  std::uint64_t triangles = 0;
  std::vector<std::string> buffers;  ///< files with the geometry of a .gltf
};

std::string lowerEnding(const fs::path& file) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  return ending;
}

/// The files in which a .gltf has its vertices.
std::vector<std::string> buffersOf(const std::string& gltf, std::string_view content) {
  std::vector<std::string> files;
  const Result<nlohmann::json> document = parseJson(content, gltf);
  if (!document || !document->is_object() || !document->contains("buffers")) return files;
  for (const nlohmann::json& buffer : (*document)["buffers"]) {
    if (!buffer.is_object() || !buffer.contains("uri") || !buffer["uri"].is_string()) continue;
    const Result<fs::path> file =
        NamedFiles{fs::path(gltf).parent_path(), PathTrust::kBeneath}.find(buffer["uri"].get<std::string>());
    if (file) files.push_back(file->string());
  }
  return files;
}

Content contentOf(const std::string& file) {
  Content content;
  const Result<std::string> bytes = readFile(file, NamedBy::kFile);
  std::error_code ignored;
  if (!bytes && fs::exists(file, ignored) && !fs::is_regular_file(file, ignored))
    content.refused = bytes.error().message;
  if (!bytes) return content;
  const std::string ending = lowerEnding(file);
  content.hash = hexDigits(contentHash(*bytes));
  content.triangles = trianglesIn(*bytes, ending);
  if (ending == ".gltf") content.buffers = buffersOf(file, *bytes);
  return content;
}

/// Letters, digits and a few signs that every file system takes.
std::string safeStem(const std::string& input) {
  std::string stem = fs::path(input).stem().string().substr(0, kLongestStem);
  for (char& c : stem) {
    const bool safe = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    if (!safe) c = '_';
  }
  return stem.empty() ? "item" : stem;
}

/// The files among the settings.
std::vector<std::string> filesIn(const BakeSettings& settings) {
  std::vector<std::string> files;
  for (const char* name : {"motion", "map"}) {
    const auto setting = settings.find(name);
    if (setting != settings.end()) files.insert(files.end(), setting->second.begin(), setting->second.end());
  }
  return files;
}

/// What cannot be read is known by its path alone, from wherever it is named; what ships with Lorica by its name.
std::string placeOf(const std::string& file) {
  const fs::path path = file;
  if (!path.has_parent_path() && !path.has_extension()) return file;
  std::error_code ignored;
  return fs::absolute(path, ignored).lexically_normal().string();
}

/// What tells items apart: names without folders, so that a list can move with its files, and contents.
std::uint64_t keyOf(const BakeJob& job) {
  BakeSettings settings = job.item.settings;
  for (const char* name : {"motion", "map"}) settings.erase(name);
  std::string text =
      fmt::format("bake {} {}\n", kAlgorithmVersion,
                  nlohmann::json(settings).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  for (const BakeInput& input : job.inputs) {
    const std::string name = input.hash.empty() ? placeOf(input.file) : fs::path(input.file).filename().string();
    text += fmt::format("{} {}\n", name, input.hash);
  }
  return contentHash(text);
}

}  // namespace

std::vector<BakeJob> bakeJobs(std::span<const BakeItem> items) {
  std::map<std::string, Content> known;
  const auto contentOnce = [&known](const std::string& file) -> const Content& {
    const auto found = known.find(file);
    return found != known.end() ? found->second : known.emplace(file, contentOf(file)).first->second;
  };
  std::vector<BakeJob> jobs;
  std::set<std::uint64_t> keys;
  for (const BakeItem& item : items) {
    BakeJob job{item, 0, "", safeStem(item.input), {}, "", 0};
    std::vector<std::string> files = {item.input};
    const Content& content = contentOnce(item.input);
    files.insert(files.end(), content.buffers.begin(), content.buffers.end());
    const std::vector<std::string> others = filesIn(item.settings);
    files.insert(files.end(), others.begin(), others.end());
    for (const std::string& file : files) job.inputs.push_back({file, contentOnce(file).hash});
    job.triangles = content.triangles;
    job.refused = content.refused;
    job.key = keyOf(job);
    job.name = fmt::format("{}-{}", job.stem, hexDigits(job.key));
    if (keys.insert(job.key).second) jobs.push_back(std::move(job));
  }
  return jobs;
}

std::vector<BakeJob> jobsOf(const Shard& shard, std::span<const BakeJob> jobs) {
  std::vector<BakeJob> own;
  for (const BakeJob& job : jobs) {
    if (job.key % shard.count == static_cast<std::uint64_t>(shard.index - 1)) {
      own.push_back(job);
    }
  }
  return own;
}

}  // namespace lorica

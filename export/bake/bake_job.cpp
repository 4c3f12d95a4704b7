#include "export/bake/bake_job.h"

#include "acd/decompose.h"
#include "geometry/files.h"
#include "geometry/json.h"
#include "geometry/named_file.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <set>
#include <utility>

namespace lorica {
namespace {

using nlohmann::json;

constexpr bool isSpace(char c) {
  return c == ' ' || c == '\n' || c == '\t' || c == '\r';
}

/// Takes the next word off the text; empty at its end.
std::string_view nextWord(std::string_view& text) {
  const auto begin = std::ranges::find_if_not(text, isSpace);
  const auto end = std::find_if(begin, text.end(), isSpace);
  const std::string_view word(begin, end);
  text.remove_prefix(end - text.begin());
  return word;
}

std::uint64_t numberIn(std::string_view word) {
  std::uint64_t number = 0;
  (void)std::from_chars(word.data(), word.data() + word.size(), number);
  return number;
}

std::uint64_t wordsIn(std::string_view text) {
  std::uint64_t count = 0;
  bool inWord = false;
  for (const char c : text) {
    count += !isSpace(c) && !inWord;
    inWord = !isSpace(c);
  }
  return count;
}

/// A face of k corners has k + 1 words and k - 2 triangles; colours make this too large.
std::uint64_t trianglesInOff(std::string_view text) {
  std::string_view word = nextWord(text);
  if (word.ends_with("OFF")) word = nextWord(text);
  while (word.starts_with('#')) {
    text.remove_prefix(std::min(text.find('\n'), text.size()));
    word = nextWord(text);
  }
  const std::uint64_t vertices = numberIn(word);
  const std::uint64_t faces = numberIn(nextWord(text));
  nextWord(text);  // edges
  const std::uint64_t words = wordsIn(text);
  return words > 3 * (vertices + faces) ? words - 3 * (vertices + faces) : faces;
}

std::uint64_t trianglesInObj(std::string_view text) {
  std::uint64_t count = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    if (line.starts_with("f ")) count += std::max<std::uint64_t>(wordsIn(line), 4) - 3;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return count;
}

std::uint64_t trianglesInStl(std::string_view content) {
  constexpr std::size_t kHeader = 84;
  constexpr std::size_t kFacet = 50;
  if (content.size() >= kHeader) {
    std::uint32_t count = 0;
    std::memcpy(&count, content.data() + kHeader - sizeof(count), sizeof(count));
    if (content.size() >= kHeader + kFacet * std::uint64_t{count} && !content.starts_with("solid")) return count;
  }
  std::uint64_t count = 0;
  constexpr std::string_view kEnd = "endfacet";
  for (std::size_t at = 0; (at = content.find(kEnd, at)) != std::string_view::npos; at += kEnd.size()) ++count;
  return count > 0 ? count : (content.size() - std::min(content.size(), kHeader)) / kFacet;
}

std::uint64_t trianglesInPly(std::string_view content) {
  constexpr std::string_view kFaces = "element face ";
  const std::size_t at = content.find(kFaces);
  return at == std::string_view::npos ? 0 : 2 * numberIn(content.substr(at + kFaces.size()));
}

std::uint64_t trianglesInGltf(std::string_view content) {
  constexpr std::size_t kGlbHeader = 20;
  if (content.starts_with("glTF") && content.size() > kGlbHeader) {
    std::uint32_t length = 0;
    std::memcpy(&length, content.data() + 12, sizeof(length));
    content = content.substr(kGlbHeader, length);
  }
  const Result<json> parsed = parseJson(content, "");
  if (!parsed) return 0;
  std::uint64_t corners = 0;
  try {
    const auto numberOf = [](const json& value) { return value.get_ref<const json::number_unsigned_t&>(); };
    for (const json& mesh : parsed->at("meshes")) {
      for (const json& primitive : mesh.at("primitives")) {
        const json& accessor =
            primitive.contains("indices") ? primitive.at("indices") : primitive.at("attributes").at("POSITION");
        corners += numberOf(parsed->at("accessors").at(numberOf(accessor)).at("count"));
      }
    }
  } catch (const json::exception&) {  // broken files have some number
  }
  return corners / 3;
}

namespace fs = std::filesystem;

constexpr std::size_t kLongestStem = 60;

struct Content {
  std::string hash;     ///< empty = cannot be read
  std::string refused;  ///< why not, if it is there and no regular file
  std::uint64_t triangles = 0;
  std::vector<std::string> buffers;  ///< files with the geometry of a .gltf
};

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
  const std::string ending = lowerCase(fs::path(file).extension().string());
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

std::uint64_t memoryBound(std::uint64_t triangles) {
  constexpr std::uint64_t kBase = std::uint64_t{512} << 20;
  constexpr std::uint64_t kPerTriangle = std::uint64_t{2} << 10;
  return kBase + kPerTriangle * triangles;
}

std::uint64_t trianglesIn(std::string_view content, const std::string& ending) {
  constexpr std::uint64_t kBytesPerTriangle = 12;
  if (ending == ".off") return trianglesInOff(content);
  if (ending == ".obj") return trianglesInObj(content);
  if (ending == ".stl") return trianglesInStl(content);
  if (ending == ".ply") return trianglesInPly(content);
  if (ending == ".glb" || ending == ".gltf" || ending == ".vrm") return trianglesInGltf(content);
  return content.size() / kBytesPerTriangle;
}

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
    if (job.key % shard.count == static_cast<std::uint64_t>(shard.index - 1)) own.push_back(job);
  }
  return own;
}

}  // namespace lorica

#include "export/bake/bake_list.h"

#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/json.h"
#include "geometry/text.h"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <sstream>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

template <typename Number>
bool above(const std::string& text, Number& number) {
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && stopped == end && std::isfinite(static_cast<double>(number)) && number > Number(0);
}

/// Those that are separated by ", ".
std::vector<std::string> listedWords(std::string_view text) {
  std::vector<std::string> words;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(", "), text.size());
    words.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 2, text.size()));
  }
  return words;
}

bool isCount(const std::string& text) {
  int count = 0;
  return above(text, count);
}

bool isLength(const std::string& text) {
  double length = 0.0;
  return above(text, length);
}

bool isShare(const std::string& text) {
  double share = 0.0;
  return text.ends_with('%') ? isLength(text.substr(0, text.size() - 1)) : above(text, share) && share < 1.0;
}

bool isName(const std::string& text) {
  return !text.starts_with('-');
}

/// A setting of an item.
struct Known {
  std::string_view name;
  std::string_view expected;                         ///< of a value, as a sentence says it
  bool (*fits)(const std::string& value) = nullptr;  ///< null: one of the words that are expected
  bool several = false;
  bool files = false;
};

constexpr std::string_view kCount = "a whole number above 0";
constexpr std::string_view kLength = "a length above 0";
constexpr std::string_view kShare = "a fraction between 0 and 1, such as 0.05, or 5%";
constexpr std::string_view kName = "a name that does not begin with a dash";

constexpr std::array<Known, 18> kKnown = {{
    {"parts", kCount, isCount},
    {"max-error", kShare, isShare},
    {"max-distance", kLength, isLength},
    {"max-concavity", kShare, isShare},
    {"exact", "yes, or nothing", [](const std::string& text) { return text == "yes" || text == "true"; }},
    {"preset", "paper, fast, quality"},
    {"cover", "exact, or a length above 0 in metres",
     [](const std::string& text) { return text == "exact" || isLength(text); }},
    {"hull-vertices", kCount, isCount},
    {"keyframes", "a whole number above 0, or auto",
     [](const std::string& text) { return text == "auto" || isCount(text); }},
    {"motion", kName, isName, true, true},
    {"body", "auto, never, always"},
    {"body-resolution", kLength, isLength},
    {"walls", "auto, solid, shell"},
    {"thickness", kLength, isLength},
    {"map", kName, isName, false, true},
    {"hide", kName, isName, true},
    {"engine", kName, isName},
    {"export", "obj, stl, ply, xml, urdf, glb, vrm", nullptr, true},
}};

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    if (end > begin) words.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

std::string settingNames() {
  std::vector<std::string_view> names;
  names.reserve(kKnown.size());
  for (const Known& known : kKnown) names.push_back(known.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

/// A path relative to a folder; a word without folder and ending is the name of something that ships with Lorica.
std::string relativeTo(const std::string& folder, const std::string& name) {
  const fs::path path = name;
  const bool shipped = !path.has_parent_path() && !path.has_extension();
  if (folder.empty() || path.is_absolute()) return name;
  std::error_code ignored;
  const fs::path beside = fs::path(folder) / path;
  return shipped && !fs::exists(beside, ignored) ? name : beside.lexically_normal().string();
}

constexpr JsonLimits kLineOfList{4, 1'000};  // an object with lists

constexpr std::array<std::string_view, 9> kModelEndings = {".off",  ".obj", ".ply", ".stl", ".glb",
                                                           ".gltf", ".vrm", ".fbx", ".dae"};

bool isModel(const fs::path& file) {
  return std::ranges::find(kModelEndings, lowerCase(file.extension().string())) != kModelEndings.end();
}

/// Reads a list line by line. @param read  returns what is wrong with a line
template <typename Read>
Result<void> eachLine(const std::string& list, const std::string& text, const Read& read) {
  std::istringstream lines(text);
  std::size_t number = 1;
  for (std::string line; std::getline(lines, line); ++number) {
    if (line.ends_with('\r')) line.pop_back();
    if (const Result<void> done = read(line); !done) {
      return badFormat("{}: line {}: {}", list, number, done.error().message);
    }
  }
  return {};
}

/// The cells of a line of CSV: "a ""b"", c" in quotes is one cell. @return nothing if a quote stays open
std::optional<std::vector<std::string>> cellsOf(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back() += line[++i];
    } else if (line[i] == '"') {
      quoted = !quoted;
    } else if (line[i] == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += line[i];
    }
  }
  if (quoted) return std::nullopt;
  return cells;
}

/// Appends the meshes and characters of a folder, the files of a pattern, or the input itself.
Result<void> addInputs(const std::string& input, const BakeSettings& settings, std::vector<BakeItem>& items) {
  std::error_code error, ignored;
  std::vector<std::string> found;
  if (fs::is_directory(input, error)) {
    const auto isResult = [&](const fs::path& file) {  // or a link to one
      return fs::exists(file / kBakeDescription, ignored) || file.filename().string().starts_with(kBakeWork) ||
             fs::read_symlink(file, ignored).generic_string().starts_with("items/");
    };
    for (fs::recursive_directory_iterator entry(input, error), end; entry != end; entry.increment(error)) {
      if (entry->is_directory(ignored)) {
        if (isResult(entry->path())) entry.disable_recursion_pending();
      } else if (isModel(entry->path()) && entry->is_regular_file(ignored) && !isResult(entry->path())) {
        found.push_back(entry->path().string());
      }
    }
    if (error) return unreadable("{}: cannot be read: {}", input, error.message());
    if (found.empty()) return notFound("{}: found no file that ends in {}", input, fmt::join(kModelEndings, ", "));
  } else if (input.find_first_of("*?[") != std::string::npos && !fs::exists(input, error)) {
    glob_t matches = {};
    if (::glob(input.c_str(), 0, nullptr, &matches) == 0)
      found.assign(matches.gl_pathv, matches.gl_pathv + matches.gl_pathc);
    ::globfree(&matches);
    if (found.empty()) return notFound("{}: no file fits this pattern", input);
  } else {
    found.push_back(input);
  }
  std::ranges::sort(found);
  for (std::string& file : found) items.push_back({std::move(file), settings});
  return {};
}

Result<void> addPaths(const std::string& list, const std::string& text, const BakeSettings& defaults,
                      std::vector<BakeItem>& items) {
  const std::string folder = fs::path(list).parent_path().string();
  return eachLine(list, text, [&](const std::string& line) -> Result<void> {
    if (line.empty() || line.starts_with('#')) return {};
    if (line.find('\0') != std::string::npos) {
      return badFormat("found a zero byte, expected the path of a mesh or character");
    }
    return addInputs(relativeTo(folder, line), defaults, items);
  });
}

/// Appends the item of one line: its input and its own settings, by name.
Result<void> addRow(const std::vector<std::pair<std::string, std::string>>& row, const std::string& folder,
                    const BakeSettings& defaults, std::vector<BakeItem>& items) {
  std::string input;
  BakeSettings settings = defaults;
  for (const auto& [name, value] : row) {
    if (value.empty()) continue;
    if (name == "input") {
      input = relativeTo(folder, value);
    } else {
      LORICA_TRY(settings[name], bakeSetting(name, value, folder));
    }
  }
  if (input.empty()) return badFormat("found no input, expected the path of a mesh or character");
  return addInputs(input, settings, items);
}

Result<void> addCsv(const std::string& list, const std::string& text, const BakeSettings& defaults,
                    std::vector<BakeItem>& items) {
  std::vector<std::string> names;
  return eachLine(list, text, [&](const std::string& line) -> Result<void> {
    if (line.empty()) return {};
    const std::optional<std::vector<std::string>> cells = cellsOf(line);
    if (!cells) return badFormat("found a quote that is not closed on this line, expected another \"");
    if (names.empty()) {
      names = *cells;
      if (std::ranges::find(names, "input") != names.end()) return {};
      return badFormat("found the columns {}, expected `input` among them", line);
    }
    if (cells->size() != names.size()) return badFormat("found {} cells, expected {}", cells->size(), names.size());
    std::vector<std::pair<std::string, std::string>> row;
    for (std::size_t c = 0; c < names.size(); ++c) row.emplace_back(names[c], (*cells)[c]);
    return addRow(row, fs::path(list).parent_path().string(), defaults, items);
  });
}

/// A value of JSON as in CSV: lists separated by semicolons.
std::string plainText(const nlohmann::json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_array()) return value.is_null() ? std::string() : value.dump();
  std::vector<std::string> words;
  for (const nlohmann::json& one : value) words.push_back(plainText(one));
  return fmt::format("{}", fmt::join(words, ";"));
}

Result<void> addJsonLines(const std::string& list, const std::string& text, const BakeSettings& defaults,
                          std::vector<BakeItem>& items) {
  return eachLine(list, text, [&](const std::string& line) -> Result<void> {
    if (line.find_first_not_of(" \t") == std::string::npos) return {};
    const Result<nlohmann::json> json = parseJson(line, list, kLineOfList);
    if (!json || !json->is_object()) return badFormat("found no JSON object, expected {\"input\": \"FILE\", ...}");
    std::vector<std::pair<std::string, std::string>> row;
    for (const auto& [name, value] : json->items()) row.emplace_back(name, plainText(value));
    return addRow(row, fs::path(list).parent_path().string(), defaults, items);
  });
}

}  // namespace

Result<std::vector<std::string>> bakeSetting(const std::string& name, const std::string& value,
                                             const std::string& folder) {
  const auto* known = std::ranges::find(kKnown, name, &Known::name);
  if (known == kKnown.end()) {
    return invalidArgument("found the setting `{}`, expected input or one of {}{}", name, settingNames(),
                           didYouMean(name, listedWords(settingNames())));
  }
  std::vector<std::string> values = known->several ? split(value, ';') : std::vector{value};
  for (std::string& one : values) {
    const std::vector<std::string> words =
        known->fits == nullptr ? listedWords(known->expected) : std::vector<std::string>();
    if (!(known->fits != nullptr ? known->fits(one) : std::ranges::find(words, one) != words.end())) {
      return invalidArgument("{}: found `{}`, expected {}{}", name, one, known->expected, didYouMean(one, words));
    }
    if (name == "exact") one = "yes";
    if (known->files) one = relativeTo(folder, one);
  }
  return values;
}

std::string textOf(const BakeSettings& settings) {
  std::string text;
  for (const auto& [name, values] : settings) {
    text += fmt::format("{}{}={}", text.empty() ? "" : " ", name, fmt::join(values, ";"));
  }
  return text;
}

Result<std::vector<BakeItem>> readBakeLists(std::span<const std::string> lists, const BakeSettings& defaults) {
  std::vector<BakeItem> items;
  for (const std::string& list : lists) {
    std::error_code ignored;
    const bool found = fs::exists(list, ignored);
    const bool listed = !isModel(list) && !fs::is_directory(list, ignored) && found;
    // A file that is missing costs its own item; a list or a folder is a slip of the keyboard.
    if (!found && !isModel(list) && list != "mannequin" && list.find_first_of("*?[") == std::string::npos) {
      return notFound("{}: there is no such file or folder", list);
    }
    Result<void> added;
    if (!listed) {
      added = addInputs(list, defaults, items);
    } else {
      LORICA_TRY(const std::string text, readFile(list));
      const std::string ending = lowerCase(fs::path(list).extension().string());
      added = ending == ".csv"     ? addCsv(list, text, defaults, items)
              : ending == ".jsonl" ? addJsonLines(list, text, defaults, items)
                                   : addPaths(list, text, defaults, items);
    }
    if (!added) return added.error();
  }
  if (items.empty()) return badFormat("{}: names no input", fmt::join(lists, ", "));
  return items;
}

}  // namespace lorica

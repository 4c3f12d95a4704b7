#include "bake/bake_list.h"

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
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

enum class Kind {
  kCount,
  kCountOrAuto,
  kLength,
  kShare,
  kCover,
  kFlag,
  kChoice,
  kChoices,
  kFile,
  kWord,
  kMotions,
  kWords
};

struct Known {
  std::string_view name;
  Kind kind;
  std::string_view choices = {};
};

constexpr std::array<Known, 18> kKnown = {{{"parts", Kind::kCount},
                                           {"max-error", Kind::kShare},
                                           {"max-distance", Kind::kLength},
                                           {"max-concavity", Kind::kShare},
                                           {"exact", Kind::kFlag},
                                           {"preset", Kind::kChoice, "paper, fast, quality"},
                                           {"cover", Kind::kCover},
                                           {"hull-vertices", Kind::kCount},
                                           {"keyframes", Kind::kCountOrAuto},
                                           {"motion", Kind::kMotions},
                                           {"body", Kind::kChoice, "auto, never, always"},
                                           {"body-resolution", Kind::kLength},
                                           {"walls", Kind::kChoice, "auto, solid, shell"},
                                           {"thickness", Kind::kLength},
                                           {"map", Kind::kFile},
                                           {"hide", Kind::kWords},
                                           {"engine", Kind::kWord},
                                           {"export", Kind::kChoices, "obj, stl, ply, xml, urdf, glb, vrm"}}};

template <typename Number>
bool above(const std::string& text, Number& number) {
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && stopped == end && std::isfinite(static_cast<double>(number)) && number > Number(0);
}

/// @param words  separated by ", "
bool isOneOf(const std::string& text, std::string_view words) {
  while (!words.empty()) {
    const std::size_t end = std::min(words.find(", "), words.size());
    if (words.substr(0, end) == text) return true;
    words.remove_prefix(std::min(end + 2, words.size()));
  }
  return false;
}

/// Checks a single value. @return what was expected; empty if it is right
std::string expectedFor(const Known& known, const std::string& text) {
  int count = 0;
  double number = 0.0;
  const bool share = text.ends_with('%') && above(text.substr(0, text.size() - 1), number);
  switch (known.kind) {
    case Kind::kCount:
      return above(text, count) ? "" : "a whole number above 0";
    case Kind::kCountOrAuto:
      return text == "auto" || above(text, count) ? "" : "a whole number above 0, or auto";
    case Kind::kLength:
      return above(text, number) ? "" : "a length above 0";
    case Kind::kShare:
      return share || (above(text, number) && number < 1.0) ? "" : "a fraction between 0 and 1, such as 0.05, or 5%";
    case Kind::kCover:
      return text == "exact" || above(text, number) ? "" : "exact, or a length above 0 in metres";
    case Kind::kFlag:
      return isOneOf(text, "yes, true") ? "" : "yes, or nothing";
    case Kind::kChoice:
    case Kind::kChoices:
      return isOneOf(text, known.choices) ? "" : std::string(known.choices);
    case Kind::kFile:
    case Kind::kWord:
    case Kind::kMotions:
    case Kind::kWords:
      return text.starts_with('-') ? "a name that does not begin with a dash" : "";
  }
  return "";
}

bool takesSeveral(Kind kind) {
  return kind == Kind::kMotions || kind == Kind::kWords || kind == Kind::kChoices;
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    if (end > begin) words.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

constexpr JsonLimits kLineOfList{4, 1'000};  // an object with lists

constexpr std::array<std::string_view, 9> kModelEndings = {".off",  ".obj", ".ply", ".stl", ".glb",
                                                           ".gltf", ".vrm", ".fbx", ".dae"};

std::string endingOf(const fs::path& file) {
  return lowerCase(file.extension().string());
}

bool isModel(const fs::path& file) {
  return std::ranges::find(kModelEndings, endingOf(file)) != kModelEndings.end();
}

/// Reads a list line by line. @param read  returns what is wrong with a line
template <typename Read>
Result<void> eachLine(const std::string& list, const std::string& text, const Read& read) {
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string line = text.substr(begin, end - begin);
    if (line.ends_with('\r')) line.pop_back();
    begin = end + 1;
    ++number;
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
    const auto belongsToABake = [&](const fs::path& folder) {
      return fs::is_directory(folder / "items", ignored) &&
             (fs::is_directory(folder / "claims", ignored) || fs::exists(folder / "bake.jsonl", ignored));
    };
    const auto isResult = [&](const fs::path& file) {  // a link of a bake whose folder is this one
      return fs::read_symlink(file, ignored).generic_string().starts_with("items/");
    };
    for (fs::recursive_directory_iterator entry(input, error), end; entry != end; entry.increment(error)) {
      if (entry->is_directory(ignored)) {
        if (belongsToABake(entry->path())) entry.disable_recursion_pending();  // its results are no inputs
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
      LORICA_TRY_DO(setBakeSetting(settings, name, value, folder));
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
std::string textOf(const nlohmann::json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_array()) return value.is_null() ? std::string() : value.dump();
  std::vector<std::string> words;
  for (const nlohmann::json& one : value) words.push_back(textOf(one));
  return fmt::format("{}", fmt::join(words, ";"));
}

Result<void> addJsonLines(const std::string& list, const std::string& text, const BakeSettings& defaults,
                          std::vector<BakeItem>& items) {
  return eachLine(list, text, [&](const std::string& line) -> Result<void> {
    if (line.find_first_not_of(" \t") == std::string::npos) return {};
    const Result<nlohmann::json> json = parseJson(line, list, kLineOfList);
    if (!json || !json->is_object()) return badFormat("found no JSON object, expected {\"input\": \"FILE\", ...}");
    std::vector<std::pair<std::string, std::string>> row;
    for (const auto& [name, value] : json->items()) row.emplace_back(name, textOf(value));
    return addRow(row, fs::path(list).parent_path().string(), defaults, items);
  });
}

}  // namespace

std::string relativeTo(const std::string& folder, const std::string& name) {
  const fs::path path = name;
  const bool shipped = !path.has_parent_path() && !path.has_extension();
  if (folder.empty() || path.is_absolute()) return name;
  std::error_code ignored;
  const fs::path beside = fs::path(folder) / path;
  return shipped && !fs::exists(beside, ignored) ? name : beside.lexically_normal().string();
}

Result<void> setBakeSetting(BakeSettings& settings, const std::string& name, const std::string& value,
                            const std::string& folder) {
  const auto* known = std::ranges::find(kKnown, name, &Known::name);
  if (known == kKnown.end()) {
    return invalidArgument("found the setting `{}`, expected input or one of {}", name, bakeSettingNames());
  }
  std::vector<std::string> values = takesSeveral(known->kind) ? split(value, ';') : std::vector{value};
  for (std::string& one : values) {
    if (const std::string expected = expectedFor(*known, one); !expected.empty()) {
      return invalidArgument("{}: found `{}`, expected {}", name, one, expected);
    }
    if (known->kind == Kind::kFlag) one = "yes";
    if (known->kind == Kind::kFile || known->kind == Kind::kMotions) one = relativeTo(folder, one);
  }
  settings[name] = std::move(values);
  return {};
}

std::string bakeSettingNames() {
  std::vector<std::string_view> names;
  names.reserve(kKnown.size());
  for (const Known& known : kKnown) names.push_back(known.name);
  return fmt::format("{}", fmt::join(names, ", "));
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
      const std::string ending = endingOf(list);
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

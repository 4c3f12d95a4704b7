#include "bake/bake_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "geometry/errors.h"

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

}  // namespace lorica

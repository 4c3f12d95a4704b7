#include "session/scenes/scene_element.h"

#include "geometry/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lorica {
namespace {

std::optional<double> numberIn(const SceneJson& json, double min, double max) {
  if (!json.is_number()) return std::nullopt;
  const auto value = json.get<double>();
  if (!(value >= min && value <= max)) return std::nullopt;
  return value;
}

}  // namespace

std::string shownInScene(const SceneJson& value) {
  std::string text = value.dump(-1, ' ', false, SceneJson::error_handler_t::replace);
  if (text.size() > 40) text = std::string(firstBytes(text, 37)) + "...";
  return text;
}

SceneElement::SceneElement(const SceneJson& json, std::string path, std::optional<std::string>& error)
    : json_(json), path_(std::move(path)), error_(error) {
  if (!json_.is_object()) fail("", shownInScene(json_), "an object");
}

void SceneElement::allow(std::span<const std::string_view> keys) {
  if (!json_.is_object()) return;
  for (const auto& [key, value] : json_.items()) {
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    fail(std::string(firstBytes(key, 40)), "no such key", fmt::format("one of {}", fmt::join(keys, ", ")));
  }
}

std::string SceneElement::pathOf(std::string_view key) const {
  return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

std::string SceneElement::pathOf(std::string_view key, std::size_t index) const {
  return fmt::format("{}[{}]", pathOf(key), index);
}

void SceneElement::fail(std::string_view key, std::string_view found, std::string_view expected) {
  failWith(key, fmt::format("found {}, expected {}", found, expected));
}

void SceneElement::failWith(std::string_view key, std::string_view sentence) {
  if (error_) return;
  const std::string where = key.empty() ? (path_.empty() ? "the scene" : path_) : pathOf(key);
  error_ = fmt::format("{}: {}", where, sentence);
}

void SceneElement::need(const char* key, std::string_view expected) {
  if (json_.is_object() && !json_.contains(key)) fail(key, "nothing", expected);
}

void SceneElement::number(const char* key, double min, double max, double& value) {
  if (!has(key)) return;
  if (const std::optional<double> read = numberIn(at(key), min, max)) {
    value = *read;
  } else {
    fail(key, shownInScene(at(key)), fmt::format("a number from {:g} to {:g}", min, max));
  }
}

void SceneElement::vector(const char* key, double min, double max, Vec3& value) {
  if (!has(key)) return;
  const SceneJson& json = at(key);
  bool fine = json.is_array() && json.size() == 3;
  Vec3 read;
  for (std::size_t i = 0; fine && i < 3; ++i) {
    const std::optional<double> part = numberIn(json[i], min, max);
    fine = part.has_value();
    if (fine) read[i] = *part;
  }
  if (fine) {
    value = read;
  } else {
    fail(key, shownInScene(json), fmt::format("three numbers from {:g} to {:g}", min, max));
  }
}

void SceneElement::integer(const char* key, int min, int max, int& value) {
  if (!has(key)) return;
  const SceneJson& json = at(key);
  if (json.is_number_integer() && json >= min && json <= max) {
    value = json.get<int>();
  } else {
    fail(key, shownInScene(json), fmt::format("a whole number from {} to {}", min, max));
  }
}

void SceneElement::flag(const char* key, bool& value) {
  if (!has(key)) return;
  if (at(key).is_boolean()) {
    value = at(key).get<bool>();
  } else {
    fail(key, shownInScene(at(key)), "true or false");
  }
}

void SceneElement::text(const char* key, std::string& value) {
  if (!has(key)) return;
  if (at(key).is_string()) {
    value = at(key).get<std::string>();
  } else {
    fail(key, shownInScene(at(key)), "a string");
  }
}

void SceneElement::color(const char* key, Vec3f& value) {
  if (!has(key)) return;
  const SceneJson& json = at(key);
  const std::string text = json.is_string() ? json.get<std::string>() : "";
  const bool fine =
      text.size() == 7 && text[0] == '#' && text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
  if (!fine) {
    fail(key, shownInScene(json), "a colour such as \"#d08020\"");
    return;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const double srgb = std::stoi(text.substr(1 + 2 * i, 2), nullptr, 16) / 255.0;
    const double linear = srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
    value[i] = linear;
  }
}

}  // namespace lorica

#pragma once

#include "geometry/math.h"
#include "geometry/result.h"

#include <nlohmann/json.hpp>

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace lorica {

/// JSON that keeps the order of keys. Internal, as all of this.
using SceneJson = nlohmann::ordered_json;

/// Text to JSON. Comments are allowed; keys that stand twice in an object and lists in lists in lists... are refused.
/// @param name  what the sentences call the text
[[nodiscard]] Result<SceneJson> parseSceneJson(std::string_view text, std::string_view name);

/// A value as it stands in the file, short enough for a sentence.
[[nodiscard]] std::string shownInScene(const SceneJson& value);

/// An object of a scene file. Whatever is wrong is kept in the file's one error, the first to be found; what could not
/// be read is what it was before.
class SceneElement {
 public:
  /// @param json,error  outlive the element
  /// @param path        of the object in the file, such as "props[3]"; empty for the whole
  SceneElement(const SceneJson& json, std::string path, std::optional<std::string>& error);

  /// Refuses what is not among the keys that an element has.
  void allow(std::span<const std::string_view> keys);
  void allow(std::initializer_list<std::string_view> keys) { allow(std::span(keys.begin(), keys.size())); }
  [[nodiscard]] bool has(const char* key) const { return json_.is_object() && json_.contains(key); }
  [[nodiscard]] const SceneJson& at(const char* key) const { return json_.at(key); }
  [[nodiscard]] SceneElement child(const char* key) const { return {at(key), pathOf(key), error_}; }
  [[nodiscard]] std::string pathOf(std::string_view key) const;
  [[nodiscard]] std::string pathOf(std::string_view key, std::size_t index) const;
  void fail(std::string_view key, std::string_view found, std::string_view expected);
  /// Takes a sentence as it is, with what it is about before it.
  void failWith(std::string_view key, std::string_view sentence);
  void need(const char* key, std::string_view expected);
  [[nodiscard]] bool failed() const { return error_.has_value(); }

  // Each leaves its value as it was where the file does not have the key.
  void number(const char* key, double least, double most, double& value);
  void vector(const char* key, double least, double most, Vec3& value);
  void integer(const char* key, int least, int most, int& value);
  void flag(const char* key, bool& value);
  void text(const char* key, std::string& value);
  /// "#rrggbb" in sRGB to linear RGB.
  void color(const char* key, Vec3f& value);

  /// Visits the objects of a list.
  template <typename Visit>
  void each(const char* key, Visit visit) {
    if (!has(key)) return;
    if (!at(key).is_array()) {
      fail(key, shownInScene(at(key)), "a list");
      return;
    }
    for (std::size_t i = 0; i < at(key).size() && !error_; ++i) {
      SceneElement element(at(key)[i], pathOf(key, i), error_);
      if (!error_) visit(element);
    }
  }

 private:
  const SceneJson& json_;
  std::string path_;
  std::optional<std::string>& error_;
};

}  // namespace lorica

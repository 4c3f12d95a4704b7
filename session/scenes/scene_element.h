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

/// JSON that keeps the order of keys. Internal, like this whole header.
using SceneJson = nlohmann::ordered_json;

/// A value as text, shortened for an error message.
[[nodiscard]] std::string shownInScene(const SceneJson& value);

/// An object of a scene file. Only the first error of the file is kept; values that cannot be read stay unchanged.
class SceneElement {
 public:
  /// @param json,error  outlive the element
  /// @param path        of the object in the file, such as "props[3]"; empty for the root
  SceneElement(const SceneJson& json, std::string path, std::optional<std::string>& error);

  /// Fails if the object has other keys than these.
  void allow(std::span<const std::string_view> keys);
  void allow(std::initializer_list<std::string_view> keys) { allow(std::span(keys.begin(), keys.size())); }
  [[nodiscard]] bool has(const char* key) const { return json_.is_object() && json_.contains(key); }
  [[nodiscard]] const SceneJson& at(const char* key) const { return json_.at(key); }
  [[nodiscard]] SceneElement child(const char* key) const { return {at(key), pathOf(key), error_}; }
  [[nodiscard]] std::string pathOf(std::string_view key) const;
  [[nodiscard]] std::string pathOf(std::string_view key, std::size_t index) const;
  void fail(std::string_view key, std::string_view found, std::string_view expected);
  /// Fails with a complete message, prefixed with the path of the key.
  void failWith(std::string_view key, std::string_view sentence);
  void need(const char* key, std::string_view expected);
  [[nodiscard]] bool failed() const { return error_.has_value(); }

  // Each leaves its value unchanged if the file does not have the key.
  void number(const char* key, double min, double max, double& value);
  void vector(const char* key, double min, double max, Vec3& value);
  void integer(const char* key, int min, int max, int& value);
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

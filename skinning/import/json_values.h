#pragma once

#include <nlohmann/json.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace lorica {

/// An object's member; null if there is none or `object` is not an object.
[[nodiscard]] const nlohmann::json& memberOf(const nlohmann::json& object, const char* key);

/// A member that is a finite number, else `otherwise`.
[[nodiscard]] float numberOf(const nlohmann::json& object, const char* key, float otherwise);

/// A whole number from 0 to count - 1.
[[nodiscard]] std::optional<int> indexIn(const nlohmann::json& index, std::size_t count);

/// The same of a member.
[[nodiscard]] std::optional<int> indexOf(const nlohmann::json& object, const char* key, std::size_t count);

/// A member that is a text, else an empty one.
[[nodiscard]] std::string textOf(const nlohmann::json& object, const char* key);

/// A member that is a list, else an empty one.
[[nodiscard]] const nlohmann::json& listOf(const nlohmann::json& object, const char* key);

/// Copies a member that is a list of at least as many finite numbers; else `values` stays unchanged.
void numbersOf(const nlohmann::json& object, const char* key, std::span<float> values);

/// Reads members like the functions above, and remembers which were there but broken.
class MemberReader {
 public:
  [[nodiscard]] float number(const nlohmann::json& object, const char* key, float otherwise);
  void numbers(const nlohmann::json& object, const char* key, std::span<float> values);
  /// A member that is true or false; false if there is none.
  [[nodiscard]] bool flag(const nlohmann::json& object, const char* key);
  /// A member that is one of the strings `words`: its index; 0 if there is none.
  [[nodiscard]] std::size_t word(const nlohmann::json& object, const char* key, std::span<const char* const> words);

  /// A sentence's end, such as "roughnessFactor is not a number: its default is used"; empty if nothing was broken.
  [[nodiscard]] std::string complaint() const;

 private:
  void note(const nlohmann::json& object, const char* key, const std::string& expected);

  int broken_ = 0;
  std::string first_;
};

}  // namespace lorica

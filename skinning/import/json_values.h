#pragma once

#include "skinning/import/file_scene.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// An object's member; null if there is none or `object` is not an object.
[[nodiscard]] const nlohmann::json& memberOf(const nlohmann::json& object, const char* key);

/// A member that is a finite number, else `otherwise`.
[[nodiscard]] float numberOf(const nlohmann::json& object, const char* key, float otherwise);

/// A member that is a whole number from 0 to count - 1.
[[nodiscard]] std::optional<int> indexOf(const nlohmann::json& object, const char* key, std::size_t count);

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

/// Values of a VRM file's springs and constraints, brought into their ranges, and what was wrong with them. Internal.
/// In all of these `who` names the object that they belong to.
class VrmValues {
 public:
  explicit VrmValues(const FileScene& scene) : scene_(scene) {}

  static constexpr double kLargestNumber = 1e6;  ///< of lengths and forces in a file

  /// Keeps one sentence for each kind of fault, with the number of them.
  void addFault(const std::string& kind, const std::string& sentence);
  void writeFaultsTo(std::vector<std::string>& notes) const;

  /// For messages.
  [[nodiscard]] static std::string shown(const nlohmann::json& value);
  /// The elements of a list; none if it is something else.
  [[nodiscard]] static const nlohmann::json& listOf(const nlohmann::json& object, const char* key);
  /// @return below count, or nothing
  [[nodiscard]] static std::optional<int> indexIn(const nlohmann::json& index, std::size_t count);
  [[nodiscard]] std::optional<int> nodeIn(const nlohmann::json& index, const std::string& who);
  [[nodiscard]] double number(const nlohmann::json& object, const char* key, double otherwise, double min, double max,
                              const std::string& who);
  [[nodiscard]] Vec3 vectorOf(const nlohmann::json& list, const char* key, const Vec3& otherwise,
                              const std::string& who);
  /// Vectors of VRM 0.x have Unity's axes, whose z is opposite to glTF's.
  [[nodiscard]] Vec3 unityVectorOf(const nlohmann::json& object, const char* key, const Vec3& otherwise,
                                   const std::string& who);

 private:
  struct Fault {
    std::string kind, sentence;
    std::uint64_t count = 1;
  };
  const FileScene& scene_;
  std::vector<Fault> faults_;
};

}  // namespace lorica

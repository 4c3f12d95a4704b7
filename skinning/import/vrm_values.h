#pragma once

#include "skinning/import/file_scene.h"
#include "skinning/import/json_values.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

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

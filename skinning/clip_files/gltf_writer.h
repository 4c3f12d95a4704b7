#pragma once

#include "geometry/math.h"
#include "geometry/result.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace lorica {

/// A GLB while it is written: one document and one buffer.
class GltfWriter {
 public:
  nlohmann::ordered_json document = nlohmann::ordered_json::object();
  std::string binary;  ///< the content of buffer 0

  /// Appends an element to one of the document's lists. @return its index
  int add(const char* list, nlohmann::ordered_json element);

  /// Appends bytes as a buffer view, aligned to 4 bytes. @return its index
  int addView(std::string_view bytes);

  /// @param type     "SCALAR", "VEC3", ...
  /// @param bounded  whether the accessor states its least and greatest numbers, as positions and times must
  /// @return the accessor's index
  int addNumbers(std::span<const float> numbers, const char* type, bool bounded = false);
  int addNumbers(std::span<const std::uint16_t> numbers, const char* type);
  int addNumbers(std::span<const std::uint32_t> numbers, const char* type);

  /// The whole file; or an error if it would be larger than the format's 4 GB.
  /// @param name  of the file, for the message
  [[nodiscard]] Result<std::string> glb(const std::string& name);

 private:
  template <typename Number>
  int addAccessor(std::span<const Number> numbers, const char* type, int componentType);
};

/// Numbers as a list: {x, y, z}.
[[nodiscard]] nlohmann::ordered_json listOf(std::span<const double> numbers);
[[nodiscard]] nlohmann::ordered_json listOf(const Vec3& v);
/// (x, y, z, w).
[[nodiscard]] nlohmann::ordered_json listOf(const Quat& q);

}  // namespace lorica

#pragma once

#include "geometry/tri_mesh.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace lorica::test {

/// Writes small GLB files, valid or not: `document` is written as the test sets it.
class GlbWriter {
 public:
  nlohmann::json document = {{"asset", {{"version", "2.0"}}}};
  std::string binary;

  /// A buffer view of these numbers; with a stride, elements of `components` numbers are that many bytes apart.
  template <typename T>
  int view(const std::vector<T>& numbers, std::size_t components = 1, std::size_t stride = 0) {
    while (binary.size() % 4 != 0) binary.push_back('\0');
    nlohmann::json made = {{"buffer", 0}, {"byteOffset", binary.size()}};
    const std::size_t step = stride == 0 ? components * sizeof(T) : stride;
    const std::size_t count = numbers.size() / components;
    const std::size_t begin = binary.size();
    binary.resize(begin + count * step, '\x7f');
    for (std::size_t i = 0; i < count; ++i) {
      std::memcpy(binary.data() + begin + i * step, numbers.data() + i * components, components * sizeof(T));
    }
    made["byteLength"] = count * step;
    if (stride != 0) made["byteStride"] = stride;
    return add("bufferViews", made);
  }

  /// @param type  "SCALAR", "VEC2", "VEC3", "VEC4" or "MAT4"
  template <typename T>
  int accessor(const std::vector<T>& numbers, const std::string& type, bool normalized = false,
               std::size_t stride = 0) {
    const std::size_t components = componentsOf(type);
    nlohmann::json made = {{"bufferView", view(numbers, components, stride)},
                           {"componentType", componentType<T>()},
                           {"count", numbers.size() / components},
                           {"type", type}};
    if (normalized) made["normalized"] = true;
    return add("accessors", made);
  }

  int positions(std::span<const Vec3> points);
  int triangles(std::span<const Triangle> triangles);
  /// Column by column, as in glTF.
  int matrices(std::span<const Affine3> transforms);

  /// Appends to a list of the document. @return the index
  int add(const std::string& list, nlohmann::json element);

  [[nodiscard]] std::string glb() const;
  /// A .gltf with an external buffer.
  [[nodiscard]] std::string gltf(const std::string& bufferUri) const;

  [[nodiscard]] static std::size_t componentsOf(const std::string& type);

  template <typename T>
  [[nodiscard]] static int componentType() {
    if (std::is_same_v<T, std::int8_t>) return 5120;
    if (std::is_same_v<T, std::uint8_t>) return 5121;
    if (std::is_same_v<T, std::int16_t>) return 5122;
    if (std::is_same_v<T, std::uint16_t>) return 5123;
    if (std::is_same_v<T, std::uint32_t>) return 5125;
    return 5126;
  }
};

/// The sparse part of an accessor.
[[nodiscard]] nlohmann::json sparse(std::size_t count, int rowView, int rowType, int valueView);

/// JSON and binary as the two chunks of a GLB.
[[nodiscard]] std::string glbOf(const std::string& json, const std::string& binary);

[[nodiscard]] std::string base64(const std::string& bytes);

}  // namespace lorica::test

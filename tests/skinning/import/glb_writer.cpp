#include "tests/skinning/import/glb_writer.h"

#include "geometry/counts.h"

namespace lorica::test {

namespace {

std::string littleEndian(std::uint32_t value) {
  std::string bytes;
  for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<char>(value >> (8 * i) & 0xFFu));
  return bytes;
}

std::string chunk(std::string content, std::uint32_t kind, char padding) {
  while (content.size() % 4 != 0) content.push_back(padding);
  return littleEndian(static_cast<std::uint32_t>(content.size())) + littleEndian(kind) + content;
}

}  // namespace

std::size_t GlbWriter::componentsOf(const std::string& type) {
  return type == "SCALAR" ? 1 : type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 16;
}

int GlbWriter::add(const std::string& list, nlohmann::json element) {
  document[list].push_back(std::move(element));
  return countOf(document[list]) - 1;
}

int GlbWriter::positions(std::span<const Vec3> points) {
  std::vector<float> numbers;
  for (const Vec3& p : points) {
    for (int c = 0; c < 3; ++c) numbers.push_back(static_cast<float>(p[c]));
  }
  return accessor(numbers, "VEC3");
}

int GlbWriter::triangles(std::span<const Triangle> triangles) {
  std::vector<std::uint16_t> numbers;
  for (const Triangle& t : triangles) {
    for (const VertexIndex v : t) numbers.push_back(static_cast<std::uint16_t>(v));
  }
  return accessor(numbers, "SCALAR");
}

int GlbWriter::matrices(std::span<const Affine3> transforms) {
  std::vector<float> numbers;
  for (const Affine3& t : transforms) {
    for (int i = 0; i < 16; ++i) numbers.push_back(static_cast<float>(t.matrix()(i % 4, i / 4)));
  }
  return accessor(numbers, "MAT4");
}

std::string GlbWriter::glb() const {
  nlohmann::json whole = document;
  if (!whole.contains("buffers") && !binary.empty()) {
    whole["buffers"] = nlohmann::json::array({{{"byteLength", binary.size()}}});
  }
  return glbOf(whole.dump(), binary);
}

std::string GlbWriter::gltf(const std::string& bufferUri) const {
  nlohmann::json whole = document;
  whole["buffers"] = nlohmann::json::array({{{"byteLength", binary.size()}, {"uri", bufferUri}}});
  return whole.dump();
}

nlohmann::json sparse(std::size_t count, int rowView, int rowType, int valueView) {
  return {{"count", count},
          {"indices", {{"bufferView", rowView}, {"componentType", rowType}}},
          {"values", {{"bufferView", valueView}}}};
}

std::string glbOf(const std::string& json, const std::string& binary) {
  std::string chunks = chunk(json, 0x4E4F534A, ' ');
  if (!binary.empty()) chunks += chunk(binary, 0x004E4942, '\0');
  return "glTF" + littleEndian(2) + littleEndian(static_cast<std::uint32_t>(12 + chunks.size())) + chunks;
}

std::string base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text.push_back(i + k > bytes.size() ? '=' : kDigits[bits >> (18 - 6 * k) & 63u]);
    }
  }
  return text;
}

}  // namespace lorica::test

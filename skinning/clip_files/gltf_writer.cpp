#include "skinning/clip_files/gltf_writer.h"

#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/little_endian.h"

#include <algorithm>
#include <limits>

namespace lorica {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kUnsignedShort = 5123;
constexpr int kUnsignedInt = 5125;
constexpr int kFloat = 5126;

[[nodiscard]] std::size_t componentsOf(std::string_view type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  return type == "VEC4" ? 4 : 16;
}

void padTo4(std::string& bytes, char with) {
  while (bytes.size() % 4 != 0) bytes.push_back(with);
}

}  // namespace

int GltfWriter::add(const char* list, Json element) {
  Json& all = document[list];
  all.push_back(std::move(element));
  return countOf(all) - 1;
}

int GltfWriter::addView(std::string_view bytes) {
  padTo4(binary, '\0');
  const std::size_t offset = binary.size();
  binary += bytes;
  return add("bufferViews", {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes.size()}});
}

template <typename Number>
int GltfWriter::addAccessor(std::span<const Number> numbers, const char* type, int componentType) {
  std::string bytes;
  bytes.reserve(numbers.size_bytes());
  for (const Number number : numbers) appendLittleEndian(number, bytes);
  const int view = addView(bytes);
  return add("accessors", {{"bufferView", view},
                           {"componentType", componentType},
                           {"count", numbers.size() / componentsOf(type)},
                           {"type", type}});
}

int GltfWriter::addNumbers(std::span<const float> numbers, const char* type, bool bounded) {
  const int index = addAccessor(numbers, type, kFloat);
  if (!bounded) return index;
  const std::size_t components = componentsOf(type);
  Json least = Json::array();
  Json greatest = Json::array();
  for (std::size_t c = 0; c < components; ++c) {
    float low = std::numeric_limits<float>::max();
    float high = std::numeric_limits<float>::lowest();
    for (std::size_t i = c; i < numbers.size(); i += components) {
      low = std::min(low, numbers[i]);
      high = std::max(high, numbers[i]);
    }
    least.push_back(low);
    greatest.push_back(high);
  }
  Json& accessor = document["accessors"].back();
  accessor["min"] = std::move(least);
  accessor["max"] = std::move(greatest);
  return index;
}

int GltfWriter::addNumbers(std::span<const std::uint16_t> numbers, const char* type) {
  return addAccessor(numbers, type, kUnsignedShort);
}

int GltfWriter::addNumbers(std::span<const std::uint32_t> numbers, const char* type) {
  return addAccessor(numbers, type, kUnsignedInt);
}

Result<std::string> GltfWriter::glb(const std::string& name) {
  constexpr std::uint32_t kMagic = 0x46546C67;
  constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
  constexpr std::uint32_t kBinaryChunk = 0x004E4942;
  padTo4(binary, '\0');
  document["buffers"] = Json::array();
  document["buffers"][0]["byteLength"] = binary.size();
  std::string text = document.dump(-1, ' ', false, Json::error_handler_t::replace);
  padTo4(text, ' ');
  const std::uint64_t length = 12 + 8 + text.size() + 8 + binary.size();
  if (length > std::numeric_limits<std::uint32_t>::max()) {
    return unsupported("{}: would have {} bytes, expected at most the 4,294,967,295 of a .glb", name, length);
  }
  std::string bytes;
  bytes.reserve(length);
  const auto number = [&](std::uint64_t value) { appendLittleEndian(static_cast<std::uint32_t>(value), bytes); };
  number(kMagic);
  number(2);
  number(length);
  number(text.size());
  number(kJsonChunk);
  bytes += text;
  number(binary.size());
  number(kBinaryChunk);
  bytes += binary;
  return bytes;
}

Json listOf(std::span<const double> numbers) {
  Json list = Json::array();
  for (const double number : numbers) list.push_back(number);
  return list;
}

Json listOf(const Vec3& v) {
  return listOf(std::span(v.data(), 3));
}

Json listOf(const Quat& q) {
  return listOf(std::span(q.coeffs().data(), 4));
}

}  // namespace lorica

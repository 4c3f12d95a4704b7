#include "skinning/import/gltf_document.h"

#include "geometry/errors.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"
#include "skinning/import/file_scene.h"
#include "skinning/import/json_values.h"

#include <draco/compression/decode.h>
#include <meshoptimizer.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

namespace lorica {

namespace {

using Json = nlohmann::json;
using Bytes = std::span<const std::byte>;

constexpr std::uint64_t kBytesPerByte = 64;
constexpr std::uint64_t kSmallFile = 250'000;  ///< what is smaller may decompress to as much as a file of this size
constexpr const char* kDraco = "KHR_draco_mesh_compression";

[[nodiscard]] std::optional<std::uint64_t> sizeOf(const Json& object, const char* key) {
  const Json& value = memberOf(object, key);
  if (!value.is_number_unsigned()) return std::nullopt;
  return value.get<std::uint64_t>();
}

/// The number of faces that Draco data claims, or why the data is not read: Draco reserves memory for what it claims.
/// https://google.github.io/draco/spec/ : header, and the heads of both connectivities.
[[nodiscard]] Result<std::uint64_t> dracoFaces(Bytes bytes) {
  constexpr std::size_t kHeader = 11;
  const auto byte = [&](std::size_t i) { return std::to_integer<unsigned>(bytes[i]); };
  if (bytes.size() <= kHeader || std::memcmp(bytes.data(), "DRACO", 5) != 0) return badFormat("is no Draco data");
  const unsigned version = byte(5) * 256 + byte(6);
  const bool mesh = byte(7) == 1, edgebreaker = byte(8) == 1, metadata = (byte(10) & 0x80) != 0;
  if (version < 0x202 || !mesh || metadata) {
    return unsupported("has Draco data of version {}.{}{}{}, expected a plain mesh of version 2.2", byte(5), byte(6),
                       mesh ? "" : " of points", metadata ? " with metadata" : "");
  }
  std::size_t at = kHeader + (edgebreaker ? 1 : 0);
  const auto varint = [&] {
    std::uint64_t number = 0;
    for (int shift = 0; at < bytes.size() && shift < 63; shift += 7) {
      number |= std::uint64_t{byte(at) & 0x7f} << shift;
      if ((byte(at++) & 0x80) == 0) break;
    }
    return number;
  };
  const std::uint64_t first = varint();
  const std::uint64_t second = varint();
  const std::uint64_t faces = edgebreaker ? second : first, vertices = edgebreaker ? first : second;
  if (faces > kMaxTriangles || vertices > 3 * faces) {
    return unsupported("has {} triangles of {} vertices, expected at most {} triangles", grouped(faces),
                       grouped(vertices), grouped(kMaxTriangles));
  }
  return faces;
}

template <typename Number>
[[nodiscard]] bool copyAttribute(const draco::Mesh& mesh, const draco::PointAttribute& attribute, std::string& out) {
  const std::size_t components = attribute.num_components();
  out.resize(components * sizeof(Number) * mesh.num_points());
  std::vector<Number> element(components);
  for (draco::PointIndex point(0); point < mesh.num_points(); ++point) {
    if (!attribute.ConvertValue<Number>(attribute.mapped_index(point), static_cast<std::int8_t>(components),
                                        element.data())) {
      return false;
    }
    std::memcpy(out.data() + point.value() * components * sizeof(Number), element.data(), components * sizeof(Number));
  }
  return true;
}

[[nodiscard]] bool copyAttribute(const draco::Mesh& mesh, const draco::PointAttribute& attribute, int componentType,
                                 std::string& out) {
  const auto as = [&]<typename Stored>(Stored) { return copyAttribute<Stored>(mesh, attribute, out); };
  if (componentType == TINYGLTF_COMPONENT_TYPE_BYTE) return as(std::int8_t());
  if (componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return as(std::uint8_t());
  if (componentType == TINYGLTF_COMPONENT_TYPE_SHORT) return as(std::int16_t());
  if (componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) return as(std::uint16_t());
  return componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT ? as(std::uint32_t()) : as(float());
}

class Decompressor {
 public:
  Decompressor(Json& json, GltfDocument& document)
      : json_(json),
        document_(document),
        budget_(kBytesPerByte * std::max<std::uint64_t>(document.fileBytes, kSmallFile)) {}

  [[nodiscard]] Result<void> run() {
    if (Json& views = listOf("bufferViews"); views.is_array()) {
      for (std::size_t v = 0; v < views.size(); ++v) LORICA_TRY_DO(decompressView(views[v], v));
    }
    Json& meshes = listOf("meshes");
    if (!meshes.is_array()) return {};
    for (std::size_t m = 0; m < meshes.size(); ++m) {
      const auto primitives = meshes[m].is_object() ? meshes[m].find("primitives") : meshes[m].end();
      if (!meshes[m].is_object() || primitives == meshes[m].end() || !primitives->is_array()) continue;
      for (std::size_t p = 0; p < primitives->size(); ++p) {
        Json& primitive = (*primitives)[p];
        if (memberOf(memberOf(primitive, "extensions"), kDraco).is_null()) continue;
        const std::string who = fmt::format("{}, primitive {}", titled("mesh", m, textOf(meshes[m], "name")), p);
        LORICA_TRY_DO(decompressPrimitive(primitive, who));
      }
    }
    return {};
  }

 private:
  [[nodiscard]] Json& listOf(const char* key) {
    static Json none;
    const auto found = json_.find(key);
    return found == json_.end() ? none : *found;
  }

  [[nodiscard]] Error broken(const std::string& who, const std::string& what) const {
    return badFormat("{}: {}: {}", document_.name, who, what);
  }

  [[nodiscard]] Error unreadableWithHint(const std::string& who, std::string_view what) const {
    return unsupported(
        "{}: {}: {}: export it without mesh compression, or decompress it with 'gltf-transform copy IN "
        "OUT'",
        document_.name, who, what);
  }

  [[nodiscard]] Result<void> spend(std::uint64_t bytes, const std::string& who) {
    if (bytes > budget_) {
      return broken(who, fmt::format("decompresses to {} bytes, too many for a file of {} bytes", grouped(bytes),
                                     grouped(document_.fileBytes)));
    }
    budget_ -= bytes;
    return {};
  }

  /// The bytes that an object with buffer, byteOffset and byteLength refers to.
  [[nodiscard]] Result<Bytes> bytesOf(const Json& reference, const std::string& who) const {
    const std::optional<int> buffer = indexOf(reference, "buffer", document_.buffers.size());
    const std::uint64_t offset = sizeOf(reference, "byteOffset").value_or(0);
    const std::optional<std::uint64_t> length = sizeOf(reference, "byteLength");
    if (!buffer || !length) return broken(who, "has no buffer or no byteLength");
    const Bytes all = document_.buffers[*buffer];
    if (offset > all.size() || *length > all.size() - offset) {
      return broken(who, fmt::format("{} bytes from byte {}, but buffer {} has {}", grouped(*length), grouped(offset),
                                     *buffer, grouped(all.size())));
    }
    return all.subspan(offset, *length);
  }

  /// A new buffer. @return its index
  [[nodiscard]] std::size_t keep(std::string content) {
    document_.owned.push_back(std::move(content));
    document_.buffers.push_back(std::as_bytes(std::span(document_.owned.back())));
    document_.fileBytes += document_.owned.back().size();
    return document_.buffers.size() - 1;
  }

  [[nodiscard]] Result<void> decompressView(Json& view, std::size_t index) {
    const Json& extensions = memberOf(view, "extensions");
    const Json& older = memberOf(extensions, "EXT_meshopt_compression");
    const Json& packed = older.is_null() ? memberOf(extensions, "KHR_meshopt_compression") : older;
    if (packed.is_null()) return {};
    const std::string who = fmt::format("buffer view {}", index);
    LORICA_TRY(const Bytes from, bytesOf(packed, who));
    const std::uint64_t count = sizeOf(packed, "count").value_or(0);
    const std::uint64_t stride = sizeOf(packed, "byteStride").value_or(0);
    const std::string mode = textOf(packed, "mode");
    const std::string filter = textOf(packed, "filter");
    const bool attributes = mode == "ATTRIBUTES", triangles = mode == "TRIANGLES";
    const bool strideFits = attributes ? stride >= 4 && stride <= 256 && stride % 4 == 0 : stride == 2 || stride == 4;
    if (!strideFits || count == 0 || count > UINT32_MAX || (triangles && count % 3 != 0)) {
      return broken(who, fmt::format("meshopt data of {} elements of {} bytes does not fit the mode {}", grouped(count),
                                     stride, mode.empty() ? "(none)" : mode));
    }
    LORICA_TRY_DO(spend(count * stride, who));
    std::string out(count * stride, '\0');
    const auto* bytes = reinterpret_cast<const unsigned char*>(from.data());
    int failed = -1;
    if (attributes) {
      failed = meshopt_decodeVertexBuffer(out.data(), count, stride, bytes, from.size());
    } else if (triangles) {
      failed = meshopt_decodeIndexBuffer(out.data(), count, stride, bytes, from.size());
    } else if (mode == "INDICES") {
      failed = meshopt_decodeIndexSequence(out.data(), count, stride, bytes, from.size());
    }
    if (failed != 0) return unreadableWithHint(who, "its meshopt data is broken or of a newer version");
    if (filter == "OCTAHEDRAL" && (stride == 4 || stride == 8)) {
      meshopt_decodeFilterOct(out.data(), count, stride);
    } else if (filter == "QUATERNION" && stride == 8) {
      meshopt_decodeFilterQuat(out.data(), count, stride);
    } else if (filter == "EXPONENTIAL") {
      meshopt_decodeFilterExp(out.data(), count, stride);
    } else if (!filter.empty() && filter != "NONE") {
      return unreadableWithHint(who, fmt::format("its meshopt filter {} for elements of {} bytes is unknown",
                                                 firstBytes(filter, 40), stride));
    }
    const Json ownStride = memberOf(view, "byteStride");
    view = {{"buffer", keep(std::move(out))}, {"byteOffset", 0U}, {"byteLength", count * stride}};
    if (!ownStride.is_null()) view["byteStride"] = ownStride;
    return {};
  }

  /// Gives an accessor plain content.
  void point(Json& accessor, std::string content) {
    Json& views = listOf("bufferViews");
    const std::size_t bytes = content.size();
    accessor["bufferView"] = views.size();
    accessor["byteOffset"] = 0U;
    accessor.erase("sparse");
    views.push_back({{"buffer", keep(std::move(content))}, {"byteOffset", 0U}, {"byteLength", bytes}});
  }

  [[nodiscard]] Result<void> decompressPrimitive(Json& primitive, const std::string& who) {
    const Json packed = memberOf(memberOf(primitive, "extensions"), kDraco);
    Json& views = listOf("bufferViews");
    Json& accessors = listOf("accessors");
    const std::optional<int> view = indexOf(packed, "bufferView", views.size());
    if (!view || !accessors.is_array()) return broken(who, "its Draco data is in no buffer view");
    LORICA_TRY(const Bytes from, bytesOf(views[*view], who));
    const Result<std::uint64_t> claimed = dracoFaces(from);
    if (!claimed) return unreadableWithHint(who, claimed.error().message);
    LORICA_TRY_DO(spend(*claimed * 3 * sizeof(std::uint32_t), who));
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(from.data()), from.size());
    std::unique_ptr<draco::Mesh> decoded;
    std::string problem;
    try {
      auto result = draco::Decoder().DecodeMeshFromBuffer(&buffer);
      problem = result.status().error_msg_string();
      decoded = std::move(result).value();
    } catch (const std::exception& exception) {  // as std::bad_alloc for what attributes claim
      problem = exception.what();
    }
    if (!decoded) return unreadableWithHint(who, fmt::format("its Draco data is broken: {}", problem));
    const draco::Mesh& mesh = *decoded;

    std::string indices(std::size_t{3} * sizeof(std::uint32_t) * mesh.num_faces(), '\0');
    for (draco::FaceIndex face(0); face < mesh.num_faces(); ++face) {
      for (int corner = 0; corner < 3; ++corner) {
        const std::uint32_t vertex = mesh.face(face)[corner].value();
        std::memcpy(indices.data() + (std::size_t{3} * face.value() + corner) * sizeof vertex, &vertex, sizeof vertex);
      }
    }
    std::optional<int> index = indexOf(primitive, "indices", accessors.size());
    if (!index) {
      index = static_cast<int>(accessors.size());
      accessors.push_back(Json::object());
    }
    Json& indexAccessor = accessors[*index];
    indexAccessor = {{"componentType", unsigned{TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT}},
                     {"count", std::uint64_t{3} * mesh.num_faces()},
                     {"type", "SCALAR"}};
    point(indexAccessor, std::move(indices));
    primitive["indices"] = static_cast<unsigned>(*index);
    primitive["mode"] = unsigned{TINYGLTF_MODE_TRIANGLES};

    const Json& attributes = memberOf(packed, "attributes");
    if (!attributes.is_object()) return broken(who, "its Draco data has no attributes");
    for (const auto& [name, id] : attributes.items()) {
      const std::optional<int> a = indexOf(memberOf(primitive, "attributes"), name.c_str(), accessors.size());
      const std::string what = fmt::format("{}: {}", who, firstBytes(name, 40));
      if (!a || !id.is_number_unsigned()) return broken(what, "has no accessor or no number in its Draco data");
      const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(id.get<std::uint32_t>());
      if (attribute == nullptr) return broken(what, fmt::format("is not in its Draco data, as number {}", id.dump()));
      Json& accessor = accessors[*a];
      const std::uint64_t count = sizeOf(accessor, "count").value_or(0);
      constexpr const char* kTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
      const int components = attribute->num_components();
      if (count != mesh.num_points() || components < 1 || components > 4 ||
          textOf(accessor, "type") != kTypes[components - 1]) {
        return broken(what,
                      fmt::format("accessor {} has {} elements of type {}, but its Draco data {} of {} numbers", *a,
                                  grouped(count), textOf(accessor, "type"), grouped(mesh.num_points()), components));
      }
      LORICA_TRY_DO(spend(std::uint64_t{4} * components * count, what));
      std::string content;
      if (!copyAttribute(mesh, *attribute, indexOf(accessor, "componentType", 10'000).value_or(0), content)) {
        return broken(what, "its Draco data does not fit the accessor's component type");
      }
      point(accessor, std::move(content));
    }
    return {};
  }

  Json& json_;
  GltfDocument& document_;
  std::uint64_t budget_;
};

}  // namespace

Result<void> decompressMeshes(Json& json, GltfDocument& document) {
  return Decompressor(json, document).run();
}

}  // namespace lorica

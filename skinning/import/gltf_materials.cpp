#include "skinning/import/gltf_materials.h"

#include "geometry/files.h"
#include "skinning/import/json_values.h"
#include "skinning/import/uri.h"
#include "skinning/import/vrm_materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace lorica {

namespace {

using Json = nlohmann::json;

constexpr std::size_t kSharedBytes = 2;  // pictures may have this many times the bytes of the file

[[nodiscard]] int uvSetOf(const Json& info, int otherwise) {
  return static_cast<int>(std::clamp(numberOf(info, "texCoord", static_cast<float>(otherwise)), 0.0f, 9.0f));
}

class MaterialReader {
 public:
  MaterialReader(const GltfDocument& document, FileScene& scene) : document_(document), scene_(scene) {}

  void read() {
    const Json& list = memberOf(document_.look, "materials");
    if (!list.is_array()) return;
    scene_.materials.reserve(list.size());
    for (std::size_t m = 0; m < list.size(); ++m) scene_.materials.push_back(materialOf(list[m], m));
    applyVrm0Materials(
        memberOf(memberOf(document_.extensions, "VRM"), "materialProperties"),
        [&](int texture) { return textureOf(texture); }, scene_.materials);
  }

 private:
  [[nodiscard]] Material materialOf(const Json& json, std::size_t index) {
    Material material;
    const Json& name = memberOf(json, "name");
    material.name = name.is_string() ? name.get<std::string>() : fmt::format("material {}", index);
    const Json& physical = memberOf(json, "pbrMetallicRoughness");
    numbersOf(physical, "baseColorFactor", {material.baseColor.data(), 4});
    material.base = useOf(memberOf(physical, "baseColorTexture"));
    material.metallic = numberOf(physical, "metallicFactor", 1.0f);
    material.roughness = numberOf(physical, "roughnessFactor", 1.0f);
    material.metallicRoughness = useOf(memberOf(physical, "metallicRoughnessTexture"));
    const Json& normal = memberOf(json, "normalTexture");
    material.normal = useOf(normal);
    material.normalScale = numberOf(normal, "scale", 1.0f);
    const Json& occlusion = memberOf(json, "occlusionTexture");
    material.occlusion = useOf(occlusion);
    material.occlusionStrength = numberOf(occlusion, "strength", 1.0f);
    numbersOf(json, "emissiveFactor", {material.emissive.data(), 3});
    material.emissiveTexture = useOf(memberOf(json, "emissiveTexture"));
    const Json& mode = memberOf(json, "alphaMode");
    if (mode == "MASK") material.alpha = AlphaMode::kMask;
    if (mode == "BLEND") material.alpha = AlphaMode::kBlend;
    material.alphaCutoff = numberOf(json, "alphaCutoff", 0.5f);
    material.doubleSided = memberOf(json, "doubleSided") == true;

    const Json& extensions = memberOf(json, "extensions");
    material.emissive *= numberOf(memberOf(extensions, "KHR_materials_emissive_strength"), "emissiveStrength", 1.0f);
    if (memberOf(extensions, "KHR_materials_unlit").is_object()) material.shading = Shading::kUnlit;
    if (const Json& mtoon = memberOf(extensions, "VRMC_materials_mtoon"); mtoon.is_object()) {
      applyMtoon1(
          mtoon, [&](const Json& info) { return useOf(info); }, material);
    }
    return material;
  }

  /// A textureInfo: the index of a texture, the set of coordinates and their transform.
  [[nodiscard]] TextureUse useOf(const Json& info) {
    if (!info.is_object()) return {};
    const Json& index = memberOf(info, "index");
    TextureUse use = textureOf(index.is_number_integer() ? index.get<std::int64_t>() : -1);
    use.uvSet = uvSetOf(info, 0);
    if (const Json& moved = memberOf(memberOf(info, "extensions"), "KHR_texture_transform"); moved.is_object()) {
      std::array<float, 2> offset = {0.0f, 0.0f};
      std::array<float, 2> scale = {1.0f, 1.0f};
      numbersOf(moved, "offset", offset);
      numbersOf(moved, "scale", scale);
      const float turn = numberOf(moved, "rotation", 0.0f);
      const float c = std::cos(turn);
      const float s = std::sin(turn);
      use.transform << c * scale[0], s * scale[1], offset[0], -s * scale[0], c * scale[1], offset[1];
      use.uvSet = uvSetOf(moved, use.uvSet);
    }
    if (use.uvSet != 0 && use.uvSet != 1) {
      noteOnce("textures use a third or later set of coordinates: the first one is used");
      use.uvSet = 0;
    }
    return use;
  }

  /// A texture: a picture and its sampler.
  [[nodiscard]] TextureUse textureOf(std::int64_t index) {
    const Json& textures = memberOf(document_.look, "textures");
    if (index < 0 || index >= static_cast<std::int64_t>(textures.size())) {
      noteOnce("materials refer to textures that do not exist: they stay plain");
      return {};
    }
    const Json& texture = textures[static_cast<std::size_t>(index)];
    TextureUse use;
    use.picture = pictureOf(texture);
    const Json& samplers = memberOf(document_.look, "samplers");
    if (const std::optional<int> s = indexOf(texture, "sampler", samplers.size())) {
      const Json& sampler = samplers[static_cast<std::size_t>(*s)];
      const auto wrapOf = [&](const char* key) {
        const float mode = numberOf(sampler, key, 10497.0f);  // OpenGL's constants
        return mode == 33071.0f ? TextureWrap::kClamp : mode == 33648.0f ? TextureWrap::kMirror : TextureWrap::kRepeat;
      };
      use.wrapU = wrapOf("wrapS");
      use.wrapV = wrapOf("wrapT");
      use.smooth = numberOf(sampler, "magFilter", 9729.0f) != 9728.0f;
    }
    return use;
  }

  /// The picture of a texture, as an index into scene_.pictures; -1 if it is not available.
  [[nodiscard]] int pictureOf(const Json& texture) {
    const Json& images = memberOf(document_.look, "images");
    const std::optional<int> image = indexOf(texture, "source", images.size());
    if (!image) {
      const bool compressed = memberOf(memberOf(texture, "extensions"), "KHR_texture_basisu").is_object();
      noteOnce(compressed ? "textures are compressed (KHR_texture_basisu), expected PNG or JPEG: they stay plain"
                          : "textures have no picture as PNG or JPEG: they stay plain");
      return -1;
    }
    const auto [known, isNew] = pictureOfImage_.emplace(*image, -1);
    if (!isNew) return known->second;
    StoredPicture picture;
    const Json& json = images[static_cast<std::size_t>(*image)];
    const Json& name = memberOf(json, "name");
    picture.name = titled("image", static_cast<std::size_t>(*image), name.is_string() ? name.get<std::string>() : "");
    const Json& uri = memberOf(json, "uri");
    if (uri.is_string()) {
      const auto sameFile = pictureOfUri_.find(uri.get_ref<const std::string&>());
      if (sameFile != pictureOfUri_.end()) return known->second = sameFile->second;
    }
    Result<std::vector<std::byte>> bytes = bytesOf(json);
    if (bytes) {
      picture.bytes = std::move(*bytes);
      known->second = static_cast<int>(scene_.pictures.size());
      scene_.pictures.push_back(std::move(picture));
    } else {
      scene_.notes.push_back(fmt::format("{}: {}: its materials stay plain", picture.name, bytes.error().message));
    }
    if (uri.is_string()) pictureOfUri_.emplace(uri.get<std::string>(), known->second);
    return known->second;
  }

  [[nodiscard]] Result<std::vector<std::byte>> bytesOf(const Json& image) {
    const auto copied = [](std::span<const std::byte> from) { return std::vector(from.begin(), from.end()); };
    if (const Json& uri = memberOf(image, "uri"); uri.is_string()) {
      const std::string& text = uri.get_ref<const std::string&>();
      Result<std::string> content = isDataUri(text) ? decodeDataUri(text) : readNeighbour(text);
      if (!content) return content.error();
      return copied(std::as_bytes(std::span(*content)));
    }
    const std::vector<tinygltf::BufferView>& views = document_.model.bufferViews;
    const std::optional<int> v = indexOf(image, "bufferView", views.size());
    if (!v) return Error{ErrorCode::kBadFormat, "has neither a bufferView nor a uri"};
    const tinygltf::BufferView& view = views[static_cast<std::size_t>(*v)];
    const auto buffer = static_cast<std::size_t>(view.buffer);
    if (view.buffer < 0 || buffer >= document_.buffers.size()) {
      return Error{ErrorCode::kBadFormat, fmt::format("refers to buffer {}, which does not exist", view.buffer)};
    }
    const std::span<const std::byte> bytes = document_.buffers[buffer];
    if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset) {
      return Error{ErrorCode::kBadFormat,
                   fmt::format("bytes {} to {} of a buffer of {} bytes", grouped(view.byteOffset),
                               grouped(view.byteOffset + view.byteLength), grouped(bytes.size()))};
    }
    if (view.byteLength > allowance_) {
      return Error{ErrorCode::kUnsupported, "all pictures together have more than twice the bytes of the file"};
    }
    allowance_ -= view.byteLength;
    return copied(bytes.subspan(view.byteOffset, view.byteLength));
  }

  [[nodiscard]] Result<std::string> readNeighbour(const std::string& uri) const {
    if (document_.folder.empty()) {
      return Error{ErrorCode::kBadFormat, fmt::format("is in another file, '{}', which is not available here", uri)};
    }
    const std::optional<std::filesystem::path> relative = neighbourFile(uri);
    if (!relative) {
      return Error{ErrorCode::kBadFormat, fmt::format("'{}' is outside the file's folder, expected a file in it", uri)};
    }
    return readFile(document_.folder / *relative);
  }

  void noteOnce(const std::string& note) {
    if (noted_.insert(note).second) scene_.notes.push_back(note);
  }

  const GltfDocument& document_;
  FileScene& scene_;
  std::map<int, int> pictureOfImage_;        // -1 = not available
  std::map<std::string, int> pictureOfUri_;  // the same
  std::set<std::string> noted_;
  std::size_t allowance_ = kSharedBytes * document_.fileBytes;  // for pictures in buffers
};

}  // namespace

void addGltfMaterials(const GltfDocument& document, FileScene& scene) {
  MaterialReader(document, scene).read();
}

}  // namespace lorica

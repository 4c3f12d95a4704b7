#include "skinning/import/gltf_parts.h"

#include "geometry/counts.h"
#include "skinning/import/json_values.h"
#include "skinning/import/picture_store.h"
#include "skinning/import/vrm_materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

namespace lorica {

namespace {

using Json = nlohmann::json;

constexpr std::size_t kSharedBytes = 2;  // pictures may have this many times the bytes of the file

[[nodiscard]] int uvSetOf(const Json& info, int otherwise) {
  return std::clamp(numberOf(info, "texCoord", static_cast<float>(otherwise)), -1.0f, 9.0f);
}

class MaterialReader {
 public:
  MaterialReader(const GltfDocument& document, FileScene& scene)
      : document_(document),
        scene_(scene),
        list_(listOf(document.look, "materials")),
        textures_(listOf(document.look, "textures")),
        images_(listOf(document.look, "images")),
        samplers_(listOf(document.look, "samplers")),
        pictures_(document.files, kSharedBytes * document.fileBytes, scene, notes_) {}

  void read() {
    for (const char* name : {"materials", "textures", "images", "samplers"}) {
      const Json& list = memberOf(document_.look, name);
      if (list.is_null() || list.is_array()) continue;
      scene_.notes.push_back(fmt::format("its {} are not a list: ignored", name));
    }
    if (list_.empty()) return;
    const std::vector<bool> used = usedMaterials();
    scene_.materials.resize(list_.size());
    for (std::size_t m = 0; m < list_.size(); ++m) {
      Material& material = scene_.materials[m];
      material.name = textOf(list_[m], "name");
      if (material.name.empty()) material.name = fmt::format("material {}", m);
      if (used[m]) readMaterial(m, material);
    }
    notes_.appendTo(scene_.notes);
  }

 private:
  /// The materials that primitives refer to: others are not worth reading pictures for.
  [[nodiscard]] std::vector<bool> usedMaterials() {
    std::vector<bool> used(list_.size(), false);
    for (const tinygltf::Mesh& mesh : document_.model.meshes) {
      for (const tinygltf::Primitive& primitive : mesh.primitives) {
        if (primitive.material == -1) continue;
        if (primitive.material >= 0 && primitive.material < countOf(used)) {
          used[primitive.material] = true;
        } else {
          notes_.add("meshes have materials that do not exist: they stay plain",
                     fmt::format("mesh '{}': refers to material {}, the file has {}: it stays plain", mesh.name,
                                 primitive.material, list_.size()));
        }
      }
    }
    return used;
  }

  void readMaterial(std::size_t index, Material& material) {
    who_ = titled("material", index, textOf(list_[index], "name"));
    MemberReader members;
    if (list_[index].is_object()) {
      readCore(list_[index], material, members);
    } else {
      notes_.add("materials are not objects: they stay plain", who_ + ": is not an object: it stays plain");
    }
    const Json& vrm0 = listOf(memberOf(document_.extensions, "VRM"), "materialProperties");
    if (index < vrm0.size()) {
      if (!vrm0Queues_) vrm0Queues_ = queuesOf(vrm0);
      applyVrm0Material(
          vrm0[index], *vrm0Queues_, [&](std::int64_t texture) { return textureOf(texture); }, members, material);
    }
    if (const std::string complaint = members.complaint(); !complaint.empty()) {
      notes_.add("materials have members that are not as expected: their defaults are used",
                 fmt::format("{}: {}", who_, complaint));
    }
  }

  void readCore(const Json& json, Material& material, MemberReader& members) {
    const auto share = [&](const Json& object, const char* key) {
      return std::clamp(members.number(object, key, 1.0f), 0.0f, 1.0f);
    };
    const Json& physical = memberOf(json, "pbrMetallicRoughness");
    members.numbers(physical, "baseColorFactor", {material.baseColor.data(), 4});
    material.baseColor = material.baseColor.cwiseMax(0.0f).cwiseMin(1.0f);
    material.base = useOf(memberOf(physical, "baseColorTexture"));
    material.metallic = share(physical, "metallicFactor");
    material.roughness = share(physical, "roughnessFactor");
    material.metallicRoughness = useOf(memberOf(physical, "metallicRoughnessTexture"));
    const Json& normal = memberOf(json, "normalTexture");
    material.normal = useOf(normal);
    material.normalScale = members.number(normal, "scale", 1.0f);
    const Json& occlusion = memberOf(json, "occlusionTexture");
    material.occlusion = useOf(occlusion);
    material.occlusionStrength = share(occlusion, "strength");
    members.numbers(json, "emissiveFactor", {material.emissive.data(), 3});
    material.emissiveTexture = useOf(memberOf(json, "emissiveTexture"));
    constexpr std::array<const char*, 3> kModes = {"OPAQUE", "MASK", "BLEND"};
    material.alpha =
        std::array{AlphaMode::kOpaque, AlphaMode::kMask, AlphaMode::kBlend}[members.word(json, "alphaMode", kModes)];
    material.alphaCutoff = members.number(json, "alphaCutoff", 0.5f);
    material.doubleSided = members.flag(json, "doubleSided");

    const Json& extensions = memberOf(json, "extensions");
    material.emissiveStrength =
        members.number(memberOf(extensions, "KHR_materials_emissive_strength"), "emissiveStrength", 1.0f);
    if (memberOf(extensions, "KHR_materials_unlit").is_object()) material.shading = Shading::kUnlit;
    if (const Json& mtoon = memberOf(extensions, "VRMC_materials_mtoon"); mtoon.is_object()) {
      applyMtoon1(
          mtoon, [&](const Json& info) { return useOf(info); }, members, material);
    }
  }

  /// A textureInfo: the index of a texture, the set of coordinates and their transform.
  [[nodiscard]] TextureUse useOf(const Json& info) {
    if (info.is_null()) return {};
    const Json& index = memberOf(info, "index");
    TextureUse use = textureOf(index.is_number_integer() ? index.get<std::int64_t>() : -1);
    use.uvSet = uvSetOf(info, 0);
    if (const Json& moved = memberOf(memberOf(info, "extensions"), "KHR_texture_transform"); moved.is_object()) {
      std::array<float, 2> offset = {0.0f, 0.0f};
      std::array<float, 2> scale = {1.0f, 1.0f};
      numbersOf(moved, "offset", offset);
      numbersOf(moved, "scale", scale);
      use.rotation = numberOf(moved, "rotation", 0.0f);
      const float c = std::cos(use.rotation);
      const float s = std::sin(use.rotation);
      use.transform << c * scale[0], s * scale[1], offset[0], -s * scale[0], c * scale[1], offset[1];
      use.uvSet = uvSetOf(moved, use.uvSet);
    }
    if (use.uvSet != 0 && use.uvSet != 1) {
      notes_.add("textures use a third or later set of coordinates: the first one is used",
                 who_ + ": a texture uses a third or later set of coordinates: the first one is used");
      use.uvSet = 0;
    }
    return use;
  }

  /// A texture: a picture and its sampler.
  [[nodiscard]] TextureUse textureOf(std::int64_t index) {
    if (index < 0 || index >= countOf(textures_)) {
      notes_.add(
          "uses of textures that do not exist: their materials stay plain",
          fmt::format("{}: refers to texture {}, the file has {}: it stays plain", who_, index, textures_.size()));
      return {};
    }
    const Json& texture = textures_[index];
    TextureUse use;
    use.picture = pictureOf(index, texture);
    if (const std::optional<int> s = indexOf(texture, "sampler", samplers_.size())) {
      const Json& sampler = samplers_[*s];
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
  [[nodiscard]] int pictureOf(std::size_t textureIndex, const Json& texture) {
    std::optional<int> image = indexOf(texture, "source", images_.size());
    if (!image) {
      image = indexOf(memberOf(memberOf(texture, "extensions"), "EXT_texture_webp"), "source", images_.size());
    }
    if (!image) {
      if (!refusedTextures_.insert(textureIndex).second) return -1;
      return pictures_.refuse(titled("texture", textureIndex, textOf(texture, "name")), whyWithoutPicture(texture));
    }
    const auto [known, isNew] = pictureOfImage_.emplace(*image, -1);
    if (isNew) known->second = readPicture(*image);
    return known->second;
  }

  [[nodiscard]] std::string whyWithoutPicture(const Json& texture) const {
    const Json& extensions = memberOf(texture, "extensions");
    if (extensions.is_object()) {  // KHR_texture_basisu, EXT_texture_avif, MSFT_texture_dds
      for (const auto& [name, extension] : extensions.items()) {
        if (!memberOf(extension, "source").is_null()) return name + " is not supported, expected PNG, JPEG or WebP";
      }
    }
    const Json& source = memberOf(texture, "source");
    if (source.is_null()) return "has no picture";
    return fmt::format("refers to image {}, the file has {}", source.dump(-1, ' ', true).substr(0, 40), images_.size());
  }

  [[nodiscard]] int readPicture(std::size_t image) {
    const Json& json = images_[image];
    const std::string name = titled("image", image, textOf(json, "name"));
    if (const Json& uri = memberOf(json, "uri"); uri.is_string()) {
      return pictures_.addUri(name, uri.get_ref<const std::string&>());
    }
    const std::vector<tinygltf::BufferView>& views = document_.model.bufferViews;
    const std::optional<int> v = indexOf(json, "bufferView", views.size());
    if (!v) return pictures_.refuse(name, "has neither a bufferView that exists nor a uri");
    const tinygltf::BufferView& view = views[*v];
    const std::size_t buffer = view.buffer;
    if (view.buffer < 0 || buffer >= document_.buffers.size()) {
      return pictures_.refuse(name, fmt::format("refers to buffer {}, which does not exist", view.buffer));
    }
    const std::span<const std::byte> bytes = document_.buffers[buffer];
    if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset) {
      return pictures_.refuse(
          name, fmt::format("buffer view {}: {} bytes from byte {}, but buffer {} has {}", *v, grouped(view.byteLength),
                            grouped(view.byteOffset), view.buffer, grouped(bytes.size())));
    }
    return pictures_.addBytes(name, bytes.subspan(view.byteOffset, view.byteLength));
  }

  const GltfDocument& document_;
  FileScene& scene_;
  const Json& list_;
  const Json& textures_;
  const Json& images_;
  const Json& samplers_;
  CountedNotes notes_;
  PictureStore pictures_;
  std::string who_;                    // the material that is being read
  std::map<int, int> pictureOfImage_;  // -1 = not available
  std::set<std::size_t> refusedTextures_;
  std::optional<Vrm0Queues> vrm0Queues_;  // of all materials, once one needs them
};

}  // namespace

void addGltfMaterials(const GltfDocument& document, FileScene& scene) {
  MaterialReader(document, scene).read();
}

}  // namespace lorica

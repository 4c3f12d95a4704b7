#include "skinning/clip_files/gltf_look.h"

#include <algorithm>
#include <string_view>

namespace lorica {

namespace {

using Json = nlohmann::ordered_json;

template <typename Vector>
[[nodiscard]] std::vector<float> floatsOf(const std::vector<Vector>& list) {
  std::vector<float> numbers;
  numbers.reserve(list.size() * Vector::SizeAtCompileTime);
  for (const Vector& v : list) numbers.insert(numbers.end(), v.data(), v.data() + v.size());
  return numbers;
}

template <typename Vector>
[[nodiscard]] Json asList(const Vector& v) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < v.size(); ++i) list.push_back(v[i]);
  return list;
}

[[nodiscard]] int wrapMode(TextureWrap wrap) {
  if (wrap == TextureWrap::kMirror) return 33648;
  return wrap == TextureWrap::kClamp ? 33071 : 10497;
}

[[nodiscard]] std::string_view asText(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

GltfLook::GltfLook(GltfWriter& writer, const Look& look) : writer_(writer), look_(look) {
  addVertexLists();
  addMaterials();
}

void GltfLook::addVertexLists() {
  lists_ = Json::object();
  for (const char* set : {"TEXCOORD_0", "TEXCOORD_1"}) {
    const auto& uv = look_.uv[set[9] - '0'];
    if (!uv.empty()) lists_[set] = writer_.addNumbers(floatsOf(uv), "VEC2");
  }
  if (!look_.colors.empty()) lists_["COLOR_0"] = writer_.addNumbers(floatsOf(look_.colors), "VEC4");
  if (look_.normals.empty()) return;
  std::vector<Vec3f> normals = look_.normals;
  for (Vec3f& n : normals) {
    if (n.isZero()) n = Vec3f::UnitY();  // of flat groups, which do not use it
  }
  normals_ = writer_.addNumbers(floatsOf(normals), "VEC3");
}

Json GltfLook::primitiveOf(const LookGroup& group, const Json& attributes) {
  Json primitive;
  primitive["attributes"] = attributes;
  for (const auto& [name, accessor] : lists_.items()) primitive["attributes"][name] = accessor;
  if (!group.flat && normals_ != -1) primitive["attributes"]["NORMAL"] = normals_;
  primitive["material"] = group.material;
  return primitive;
}

void GltfLook::use(const char* extension) {
  if (extensions_.insert(extension).second) writer_.add("extensionsUsed", extension);
}

int GltfLook::pictureIndex(int picture) {
  const auto [known, isNew] = imageOf_.emplace(picture, -1);
  if (!isNew) return known->second;
  const std::string_view bytes = asText(look_.pictures[picture].bytes);
  const bool png = bytes.starts_with("\x89PNG");
  if (!png && !bytes.starts_with("\xFF\xD8\xFF")) return -1;
  Json image;
  image["bufferView"] = writer_.addView(bytes);
  image["mimeType"] = png ? "image/png" : "image/jpeg";
  return known->second = writer_.add("images", std::move(image));
}

Json GltfLook::textureInfo(const TextureUse& texture) {
  const int image = texture.given() ? pictureIndex(texture.picture) : -1;
  if (image == -1) return {};
  Json sampler;
  sampler["magFilter"] = texture.smooth ? 9729 : 9728;
  sampler["wrapS"] = wrapMode(texture.wrapU);
  sampler["wrapT"] = wrapMode(texture.wrapV);
  Json made;
  made["sampler"] = writer_.add("samplers", std::move(sampler));
  made["source"] = image;
  Json info;
  info["index"] = writer_.add("textures", std::move(made));
  if (texture.uvSet != 0) info["texCoord"] = texture.uvSet;
  if (!texture.transform.isIdentity()) {
    use("KHR_texture_transform");
    Json& moved = info["extensions"]["KHR_texture_transform"];
    const Eigen::Rotation2Df back(texture.rotation);  // glTF turns clockwise
    const Eigen::Matrix2f scale = back.toRotationMatrix() * texture.transform.leftCols<2>();
    moved["offset"] = asList(Eigen::Vector2f(texture.transform.col(2)));
    moved["rotation"] = texture.rotation;
    moved["scale"] = asList(Eigen::Vector2f(scale.diagonal()));
  }
  return info;
}

Json GltfLook::materialOf(const Material& material) {
  Json made;
  made["name"] = material.name;
  const auto texture = [&](Json& of, const char* name, const TextureUse& used) {
    Json info = textureInfo(used);
    if (!info.is_null()) of[name] = std::move(info);
    return of.contains(name);
  };
  Json& physical = made["pbrMetallicRoughness"];
  physical["baseColorFactor"] = asList(Eigen::Vector4f(material.baseColor.cwiseMax(0.0F).cwiseMin(1.0F)));
  physical["metallicFactor"] = std::clamp(material.metallic, 0.0F, 1.0F);
  physical["roughnessFactor"] = std::clamp(material.roughness, 0.0F, 1.0F);
  texture(physical, "baseColorTexture", material.base);
  texture(physical, "metallicRoughnessTexture", material.metallicRoughness);
  if (texture(made, "normalTexture", material.normal)) made["normalTexture"]["scale"] = material.normalScale;
  if (texture(made, "occlusionTexture", material.occlusion)) {
    made["occlusionTexture"]["strength"] = std::clamp(material.occlusionStrength, 0.0F, 1.0F);
  }
  const Vec3f glow = material.emissiveStrength * material.emissive;
  if (!glow.isZero()) made["emissiveFactor"] = asList(Vec3f(glow.cwiseMax(0.0F).cwiseMin(1.0F)));
  texture(made, "emissiveTexture", material.emissiveTexture);
  if (material.alpha == AlphaMode::kBlend) made["alphaMode"] = "BLEND";
  if (material.alpha == AlphaMode::kMask) {
    made["alphaMode"] = "MASK";
    made["alphaCutoff"] = std::max(material.alphaCutoff, 0.0F);
  }
  if (material.doubleSided) made["doubleSided"] = true;
  if (material.shading == Shading::kUnlit) {
    use("KHR_materials_unlit");
    made["extensions"]["KHR_materials_unlit"] = Json::object();
  }
  return made;
}

void GltfLook::addMaterials() {
  for (const Material& material : look_.materials) writer_.add("materials", materialOf(material));
}

}  // namespace lorica

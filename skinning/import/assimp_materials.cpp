#include "skinning/import/assimp_parts.h"

#include "skinning/import/picture_store.h"

#include <assimp/material.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>

namespace lorica {

namespace {

/// IEC 61966-2-1, channels limited to 0 and 1.
[[nodiscard]] float linearFromSrgb(float encoded) {
  const float c = std::isfinite(encoded) ? std::clamp(encoded, 0.0f, 1.0f) : 0.0f;
  return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}

[[nodiscard]] std::optional<Vec3f> colorOf(const aiMaterial& from, const char* key, unsigned type, unsigned index) {
  aiColor3D color;
  if (from.Get(key, type, index, color) != aiReturn_SUCCESS) return std::nullopt;
  return Vec3f(linearFromSrgb(color.r), linearFromSrgb(color.g), linearFromSrgb(color.b));
}

[[nodiscard]] std::optional<float> materialNumber(const aiMaterial& from, const char* key, unsigned type,
                                                  unsigned index) {
  float number = 0.0f;
  if (from.Get(key, type, index, number) != aiReturn_SUCCESS || !std::isfinite(number)) return std::nullopt;
  return number;
}

[[nodiscard]] TextureWrap wrapOf(const aiMaterial& from, const char* key, aiTextureType type) {
  int mode = aiTextureMapMode_Wrap;
  if (from.Get(key, type, 0, mode) != aiReturn_SUCCESS) return TextureWrap::kRepeat;
  return mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal ? TextureWrap::kClamp
         : mode == aiTextureMapMode_Mirror                                ? TextureWrap::kMirror
                                                                          : TextureWrap::kRepeat;
}

/// A texture's transform for coordinates whose v points down.
[[nodiscard]] Eigen::Matrix<float, 2, 3> transformOf(const aiUVTransform& t) {
  Eigen::Matrix3f scale = Eigen::Matrix3f::Identity();
  scale(0, 0) = t.mScaling.x;
  scale(1, 1) = t.mScaling.y;
  const float c = std::cos(t.mRotation);
  const float s = std::sin(t.mRotation);
  Eigen::Matrix3f turn;
  turn << c, -s, 0.5f - 0.5f * c + 0.5f * s, s, c, 0.5f - 0.5f * s - 0.5f * c, 0.0f, 0.0f, 1.0f;
  Eigen::Matrix3f move = Eigen::Matrix3f::Identity();
  move(0, 2) = t.mTranslation.x;
  move(1, 2) = t.mTranslation.y;
  Eigen::Matrix3f flip = Eigen::Matrix3f::Identity();
  flip(1, 1) = -1.0f;
  flip(1, 2) = 1.0f;
  const Eigen::Matrix3f all = flip * move * turn * scale * flip;
  return all.allFinite() ? Eigen::Matrix<float, 2, 3>(all.topRows<2>()) : TextureUse().transform;
}

/// What a mesh without a material gets from assimp: its grey says nothing about the character.
[[nodiscard]] bool isDefault(const aiMaterial& from) {
  aiString name;
  return from.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS && textOf(name) == AI_DEFAULT_MATERIAL_NAME &&
         from.GetTextureCount(aiTextureType_DIFFUSE) == 0;
}

class AssimpMaterialReader {
 public:
  AssimpMaterialReader(const aiScene& from, const NamedFiles& files, FileScene& scene)
      : from_(from), scene_(scene), pictures_(files, std::numeric_limits<std::size_t>::max(), scene, notes_) {}

  void read() {
    std::vector<bool> used(from_.mNumMaterials, false);
    bool any = false;
    for (unsigned m = 0; m < from_.mNumMeshes; ++m) {
      const unsigned index = from_.mMeshes[m]->mMaterialIndex;
      if (index >= from_.mNumMaterials) continue;
      used[index] = true;
      any = any || !isDefault(*from_.mMaterials[index]);
    }
    if (!any) return;
    scene_.materials.resize(from_.mNumMaterials);
    for (unsigned m = 0; m < from_.mNumMaterials; ++m) {
      aiString name;
      from_.mMaterials[m]->Get(AI_MATKEY_NAME, name);
      Material& material = scene_.materials[m];
      material.name = name.length > 0 ? textOf(name) : fmt::format("material {}", m);
      if (used[m]) readMaterial(*from_.mMaterials[m], material);
    }
    notes_.appendTo(scene_.notes);
  }

 private:
  void readMaterial(const aiMaterial& from, Material& material) {
    // 1. Colours.
    material.roughness = roughnessOf(from);
    if (const auto base = colorOf(from, AI_MATKEY_BASE_COLOR)) {
      material.baseColor.head<3>() = *base;
    } else if (const auto diffuse = colorOf(from, AI_MATKEY_COLOR_DIFFUSE)) {
      material.baseColor.head<3>() = *diffuse;
    }
    material.metallic = std::clamp(materialNumber(from, AI_MATKEY_METALLIC_FACTOR).value_or(0.0f), 0.0f, 1.0f);
    material.emissive = colorOf(from, AI_MATKEY_COLOR_EMISSIVE).value_or(Vec3f(Vec3f::Zero()));
    int flag = 0;
    material.doubleSided = from.Get(AI_MATKEY_TWOSIDED, flag) == aiReturn_SUCCESS && flag != 0;

    // 2. Textures, which replace colours.
    material.base = firstOf(from, {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE});
    if (material.base.given()) material.baseColor.head<3>().setOnes();
    material.emissiveTexture = firstOf(from, {aiTextureType_EMISSION_COLOR, aiTextureType_EMISSIVE});
    if (material.emissiveTexture.given() && material.emissive.isZero()) material.emissive.setOnes();
    material.normal = firstOf(from, {aiTextureType_NORMAL_CAMERA, aiTextureType_NORMALS});
    material.normalScale = materialNumber(from, AI_MATKEY_BUMPSCALING).value_or(1.0f);
    material.occlusion = firstOf(from, {aiTextureType_AMBIENT_OCCLUSION});

    // 3. Opacity. Files that write 0 for "opaque" are common, invisible characters are not.
    const float opacity = std::clamp(materialNumber(from, AI_MATKEY_OPACITY).value_or(1.0f), 0.0f, 1.0f);
    if (opacity > 0.0f) {
      material.baseColor.w() = opacity;
    } else {
      notes_.add("materials have an opacity of 0: drawn opaque",
                 fmt::format("material '{}': its opacity is 0: drawn opaque", material.name));
    }
    const std::string opacityPath = pathOf(from, aiTextureType_OPACITY);
    const bool ownAlpha =
        !opacityPath.empty() && material.base.given() &&
        (opacityPath == pathOf(from, aiTextureType_DIFFUSE) || opacityPath == pathOf(from, aiTextureType_BASE_COLOR));
    if (!opacityPath.empty() && !ownAlpha) {
      notes_.add(
          "materials have their opacity in another picture than their colour: not read",
          fmt::format("material '{}': its opacity is in another picture than its colour: not read", material.name));
    }
    if (material.baseColor.w() < 1.0f || ownAlpha) material.alpha = AlphaMode::kBlend;

    // 4. COLLADA's constant shading has only an emission.
    int shading = 0;
    if (from.Get(AI_MATKEY_SHADING_MODEL, shading) == aiReturn_SUCCESS && shading == aiShadingMode_NoShading) {
      material.shading = Shading::kUnlit;
      material.baseColor.head<3>() = material.emissive;
      if (material.emissiveTexture.given()) material.base = material.emissiveTexture;
      material.emissive.setZero();
      material.emissiveTexture = {};
    }
  }

  [[nodiscard]] static float roughnessOf(const aiMaterial& from) {
    const std::optional<float> exponent = materialNumber(from, AI_MATKEY_SHININESS);
    if (!exponent) return std::clamp(materialNumber(from, AI_MATKEY_ROUGHNESS_FACTOR).value_or(1.0f), 0.0f, 1.0f);
    aiColor3D specular(0.0f, 0.0f, 0.0f);
    from.Get(AI_MATKEY_COLOR_SPECULAR, specular);
    const float strength = materialNumber(from, AI_MATKEY_SHININESS_STRENGTH).value_or(1.0f);
    const float s = strength * std::max({specular.r, specular.g, specular.b});
    const float shine = std::isfinite(s) ? std::clamp(s, 0.0f, 1.0f) : 0.0f;
    return 1.0f - shine * (1.0f - std::pow(2.0f / (std::max(*exponent, 0.0f) + 2.0f), 0.25f));
  }

  [[nodiscard]] static std::string pathOf(const aiMaterial& from, aiTextureType type) {
    aiString path;
    return from.Get(AI_MATKEY_TEXTURE(type, 0), path) == aiReturn_SUCCESS ? textOf(path) : std::string();
  }

  /// The first of these kinds of texture that the material has.
  [[nodiscard]] TextureUse firstOf(const aiMaterial& from, std::initializer_list<aiTextureType> types) {
    for (const aiTextureType type : types) {
      const std::string path = pathOf(from, type);
      if (path.empty()) continue;
      TextureUse use;
      use.picture = pictureOf(path);
      int set = 0;
      if (from.Get(AI_MATKEY_UVWSRC(type, 0), set) == aiReturn_SUCCESS && (set == 0 || set == 1)) {
        use.uvSet = set;
      } else if (set != 0) {
        notes_.add("textures use a third or later set of coordinates: the first one is used",
                   fmt::format("picture '{}' uses a third or later set of coordinates: the first one is used", path));
      }
      use.wrapU = wrapOf(from, _AI_MATKEY_MAPPINGMODE_U_BASE, type);
      use.wrapV = wrapOf(from, _AI_MATKEY_MAPPINGMODE_V_BASE, type);
      aiUVTransform transform;
      if (from.Get(AI_MATKEY_UVTRANSFORM(type, 0), transform) == aiReturn_SUCCESS) {
        use.transform = transformOf(transform);
      }
      return use;
    }
    return {};
  }

  /// A picture in the file or beside it, each once.
  [[nodiscard]] int pictureOf(const std::string& path) {
    const auto [known, isNew] = pictureOfPath_.emplace(path, -1);
    if (!isNew) return known->second;
    const std::string name = fmt::format("picture '{}'", path.substr(path.find_last_of("/\\") + 1));
    const aiTexture* embedded = from_.GetEmbeddedTexture(path.c_str());
    if (embedded == nullptr) return known->second = pictures_.addPath(name, path);
    if (embedded->mHeight != 0 || embedded->pcData == nullptr) {  // neither FBX nor COLLADA has such
      return known->second = pictures_.refuse(name, "is stored as bare texels, expected PNG, JPEG or WebP");
    }
    const auto* bytes = reinterpret_cast<const std::byte*>(embedded->pcData);  // mWidth is their number
    return known->second = pictures_.addBytes(name, {bytes, static_cast<std::size_t>(embedded->mWidth)});
  }

  const aiScene& from_;
  FileScene& scene_;
  CountedNotes notes_;
  PictureStore pictures_;
  std::map<std::string, int> pictureOfPath_;  // -1 = not available
};

}  // namespace

std::string textOf(const aiString& text) {
  return {text.data, std::min<std::size_t>(text.length, sizeof text.data)};
}

void addAssimpMaterials(const aiScene& from, const NamedFiles& files, FileScene& scene) {
  AssimpMaterialReader(from, files, scene).read();
}

void addAssimpLook(const aiMesh& from, const FileScene& scene, FileMesh& mesh, std::uint64_t& notFinite) {
  if (scene.materials.empty()) return;
  const bool known = from.mMaterialIndex < scene.materials.size();
  mesh.material = known ? static_cast<int>(from.mMaterialIndex) : -1;
  const LookNeeds needs = known ? needsOf(scene.materials[from.mMaterialIndex]) : LookNeeds();
  const auto finite = [&](float number) {
    if (std::isfinite(number)) return number;
    ++notFinite;
    return 0.0f;
  };
  const std::size_t count = from.mNumVertices;
  if (from.HasNormals()) {
    mesh.normals.reserve(count);
    for (const aiVector3D& n : std::span(from.mNormals, count)) {
      mesh.normals.emplace_back(finite(n.x), finite(n.y), finite(n.z));
    }
  }
  if (needs.tangents && from.HasNormals() && from.HasTangentsAndBitangents()) {
    mesh.tangents.reserve(count);
    for (std::size_t v = 0; v < count; ++v) {
      const aiVector3D& t = from.mTangents[v];
      const aiVector3D& n = from.mNormals[v];
      const float side = (n ^ t) * from.mBitangents[v];
      mesh.tangents.emplace_back(finite(t.x), finite(t.y), finite(t.z), side < 0.0f ? -1.0f : 1.0f);
    }
  }
  for (unsigned set = 0; set < 2; ++set) {
    if (!needs.uv[set] || !from.HasTextureCoords(set)) continue;
    mesh.uv[set].reserve(count);
    for (const aiVector3D& uv : std::span(from.mTextureCoords[set], count)) {
      mesh.uv[set].emplace_back(finite(uv.x), 1.0f - finite(uv.y));
    }
  }
  if (!from.HasVertexColors(0)) return;
  mesh.colors.reserve(count);
  for (const aiColor4D& c : std::span(from.mColors[0], count)) {
    mesh.colors.emplace_back(linearFromSrgb(c.r), linearFromSrgb(c.g), linearFromSrgb(c.b),
                             std::clamp(finite(c.a), 0.0f, 1.0f));
  }
}

}  // namespace lorica

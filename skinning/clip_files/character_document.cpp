#include "skinning/clip_files/character_document.h"

#include "geometry/errors.h"
#include "geometry/files.h"
#include "skinning/clip_files/gltf_embedding.h"
#include "skinning/clip_files/own_motion.h"

#include <algorithm>
#include <map>
#include <set>
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

/// Materials, textures and the looks of vertices in a document. Toon materials become plain ones.
class GltfLook {
 public:
  GltfLook(GltfWriter& writer, const Look& look) : writer_(writer), look_(look) {
    addVertexLists();
    for (const Material& material : look.materials) writer.add("materials", materialOf(material));
  }

  /// A primitive of one group, without its triangles.
  /// @param attributes  those that all groups share
  [[nodiscard]] Json primitiveOf(const LookGroup& group, const Json& attributes) {
    Json primitive;
    primitive["attributes"] = attributes;
    for (const auto& [name, accessor] : lists_.items()) primitive["attributes"][name] = accessor;
    if (!group.flat && normals_ != -1) primitive["attributes"]["NORMAL"] = normals_;
    primitive["material"] = group.material;
    return primitive;
  }

 private:
  void addVertexLists() {
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

  void use(const char* extension) {
    if (extensions_.insert(extension).second) writer_.add("extensionsUsed", extension);
  }

  [[nodiscard]] int pictureIndex(int picture) {
    const auto [known, isNew] = imageOf_.emplace(picture, -1);
    if (!isNew) return known->second;
    const std::string_view bytes = asText(look_.pictures[picture].bytes);
    const bool png = bytes.starts_with("\x89PNG");
    if (!png && !bytes.starts_with("\xFF\xD8\xFF")) return -1;
    const int view = writer_.addView(bytes);
    return known->second =
               writer_.add("images", {{"bufferView", view}, {"mimeType", png ? "image/png" : "image/jpeg"}});
  }

  /// Textures are written when a material uses them. @return a textureInfo, or null if the texture has no picture
  [[nodiscard]] Json textureInfo(const TextureUse& texture) {
    const int image = texture.given() ? pictureIndex(texture.picture) : -1;
    if (image == -1) return {};
    const int sampler = writer_.add("samplers", {{"magFilter", texture.smooth ? 9729 : 9728},
                                                 {"wrapS", wrapMode(texture.wrapU)},
                                                 {"wrapT", wrapMode(texture.wrapV)}});
    Json info;
    info["index"] = writer_.add("textures", {{"sampler", sampler}, {"source", image}});
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

  [[nodiscard]] Json materialOf(const Material& material) {
    Json made;
    made["name"] = material.name;
    const auto texture = [&](Json& owner, const char* name, const TextureUse& used) {
      Json info = textureInfo(used);
      if (!info.is_null()) owner[name] = std::move(info);
      return owner.contains(name);
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

  GltfWriter& writer_;
  const Look& look_;
  std::map<int, int> imageOf_;        ///< of each picture that was written
  Json lists_;                        ///< attributes beside positions and weights
  int normals_ = -1;                  ///< accessor
  std::set<std::string> extensions_;  ///< that the document uses
};

/// A node for each joint. @return the topmost
[[nodiscard]] Json addNodes(GltfWriter& writer, const Skeleton& skeleton) {
  Json roots = Json::array();
  writer.document["nodes"] = Json::array();
  for (JointIndex j = 0; j < skeleton.jointCount(); ++j) {
    const Joint& joint = skeleton.joint(j);
    const int index = writer.add("nodes", {{"name", joint.name},
                                           {"translation", listOf(joint.rest.translation)},
                                           {"rotation", listOf(joint.rest.rotation)},
                                           {"scale", listOf(joint.rest.scale)}});
    if (joint.parent == kNoJoint) {
      roots.push_back(index);
    } else {
      writer.document["nodes"][joint.parent]["children"].push_back(index);
    }
  }
  return roots;
}

[[nodiscard]] int addSkin(GltfWriter& writer, std::span<const Affine3> jointFromModel) {
  std::vector<float> matrices;
  Json skin;
  for (std::size_t j = 0; j < jointFromModel.size(); ++j) {
    Eigen::Matrix4f matrix = jointFromModel[j].matrix().cast<float>();
    matrix.row(3) << 0.0F, 0.0F, 0.0F, 1.0F;
    matrices.insert(matrices.end(), matrix.data(), matrix.data() + 16);
    skin["joints"].push_back(j);
  }
  skin["inverseBindMatrices"] = writer.addNumbers(matrices, "MAT4");
  return writer.add("skins", std::move(skin));
}

/// Joints and weights of all vertices, heaviest first, in sets of four.
void addWeights(GltfWriter& writer, const Character& character, JointIndex firstJoint, Json& attributes) {
  const std::size_t vertexCount = character.mesh.vertices.size();
  std::size_t most = 1;
  for (std::size_t v = 0; v < vertexCount; ++v) {
    most = std::max<std::size_t>(most, character.influenceBegin[v + 1] - character.influenceBegin[v]);
  }
  const std::size_t sets = (most + 3) / 4;
  std::vector<std::vector<std::uint16_t>> joints(sets, std::vector<std::uint16_t>(4 * vertexCount, 0));
  std::vector<std::vector<float>> weights(sets, std::vector<float>(4 * vertexCount, 0.0F));
  for (std::size_t v = 0; v < vertexCount; ++v) {
    std::vector<Influence> vertex(character.influences.begin() + character.influenceBegin[v],
                                  character.influences.begin() + character.influenceBegin[v + 1]);
    std::stable_sort(vertex.begin(), vertex.end(),
                     [](const Influence& a, const Influence& b) { return a.weight > b.weight; });
    for (std::size_t i = 0; i < vertex.size(); ++i) {
      joints[i / 4][4 * v + i % 4] = static_cast<std::uint16_t>(vertex[i].joint - firstJoint);
      weights[i / 4][4 * v + i % 4] = static_cast<float>(vertex[i].weight);
    }
    // Floats whose sum is 1 to the last digit.
    double others = 0.0;
    for (std::size_t i = 1; i < vertex.size(); ++i) others += weights[i / 4][4 * v + i % 4];
    weights[0][4 * v] = static_cast<float>(1.0 - others);
  }
  for (std::size_t s = 0; s < sets; ++s) {
    attributes["JOINTS_" + std::to_string(s)] = writer.addNumbers(std::span<const std::uint16_t>(joints[s]), "VEC4");
    attributes["WEIGHTS_" + std::to_string(s)] = writer.addNumbers(std::span<const float>(weights[s]), "VEC4");
  }
}

[[nodiscard]] int addMesh(GltfWriter& writer, const Character& character, const Look& look, JointIndex firstJoint) {
  Json attributes;
  attributes["POSITION"] = writer.addNumbers(floatsOf(character.mesh.vertices), "VEC3", true);
  addWeights(writer, character, firstJoint, attributes);
  Json mesh;
  mesh["name"] = character.name;
  const std::span<const Triangle> all = character.shown.empty() ? character.mesh.triangles : character.shown;
  const auto addPrimitive = [&](std::span<const Triangle> triangles, Json primitive) {
    if (triangles.empty()) return;
    std::vector<std::uint32_t> indices;
    for (const Triangle& t : triangles) indices.insert(indices.end(), t.begin(), t.end());
    primitive["indices"] = writer.addNumbers(std::span<const std::uint32_t>(indices), "SCALAR");
    mesh["primitives"].push_back(std::move(primitive));
  };
  if (look.given()) {
    GltfLook written(writer, look);
    for (const LookGroup& group : look.groups) {
      addPrimitive(all.subspan(group.firstTriangle, group.triangleCount), written.primitiveOf(group, attributes));
    }
  } else {
    Json plain;
    plain["attributes"] = std::move(attributes);
    addPrimitive(all, std::move(plain));
  }
  return writer.add("meshes", std::move(mesh));
}

/// Adds a whole character: a node for each joint, in their order and at rest, and a node with the skinned mesh.
/// @param skeleton   of the joints to write
/// @param jointFromModel  inverse bind matrices of these joints
/// @param firstJoint      index in the character of the first of them; no vertex may follow an earlier one
/// @param look            of the character's mesh; may be empty
void addCharacter(GltfWriter& writer, const Character& character, const Look& look, const Skeleton& skeleton,
                  std::span<const Affine3> jointFromModel, JointIndex firstJoint) {
  writer.document["asset"]["version"] = "2.0";
  writer.document["asset"]["generator"] = "Lorica";
  Json roots = addNodes(writer, skeleton);
  if (roots.size() > 1) {  // the joints of a skin must have one root
    const int above = writer.add("nodes", {{"name", "skeleton"}, {"children", std::move(roots)}});
    roots = Json::array({above});
  }
  if (!character.mesh.triangles.empty()) {
    const int skin = addSkin(writer, jointFromModel);
    const int mesh = addMesh(writer, character, look, firstJoint);
    roots.push_back(writer.add("nodes", {{"name", character.name}, {"skin", skin}, {"mesh", mesh}}));
  }
  Json scene;
  scene["nodes"] = std::move(roots);
  writer.document["scene"] = 0;
  writer.document["scenes"] = Json::array({std::move(scene)});
}

/// Joints that are no node, because the file's node has several bind matrices or is sheared, never move within their
/// parent: they hang on the nearest node above.
void hangOnNodes(CharacterDocument& document, const Character& character) {
  document.hangOn = document.nodeOfJoint;
  std::vector<Affine3> nodeFromJoint(document.hangOn.size(), Affine3::Identity());
  for (JointIndex j = 0; j < character.skeleton.jointCount(); ++j) {
    const Joint& joint = character.skeleton.joint(j);
    if (document.hangOn[j] >= 0 || joint.parent == kNoJoint) continue;
    document.hangOn[j] = document.hangOn[joint.parent];
    nodeFromJoint[j] = nodeFromJoint[joint.parent] * joint.rest.matrix();
    document.nodeFromModel[j] = nodeFromJoint[j] * character.jointFromModel[j];
  }
}

/// What Lorica has read of a character, as a document.
CharacterDocument readDocument(const Character& character, const Look& look, const Skeleton& skeleton,
                               std::span<const Affine3> jointFromModel) {
  CharacterDocument document;
  const int first = character.skeleton.jointCount() - skeleton.jointCount();
  addCharacter(document.writer, character, look, skeleton, jointFromModel, first);
  document.nodeOfJoint.assign(first, -1);
  document.nodeFromModel.assign(first, Affine3::Identity());
  for (JointIndex j = 0; j < skeleton.jointCount(); ++j) document.nodeOfJoint.push_back(j);
  document.nodeFromModel.insert(document.nodeFromModel.end(), jointFromModel.begin(), jointFromModel.end());
  document.hangOn = document.nodeOfJoint;
  return document;
}

Result<CharacterDocument> ownDocument(const ClipCharacter& from) {
  LORICA_TRY(const std::string content, readFile(from.path));
  const NamedFiles files{from.path.has_parent_path() ? from.path.parent_path() : ".", from.paths};
  CharacterDocument document;
  LORICA_TRY(GltfWriter writer,
             embedGltf(std::as_bytes(std::span(content)), from.path.string(), files, document.notes));
  document.writer = std::move(writer);
  document.nodeOfJoint = from.file->nodeOfJoint;
  document.nodeFromModel = from.file->character.jointFromModel;
  hangOnNodes(document, from.file->character);
  return document;
}

}  // namespace

bool isOfGltf(const CharacterFile& file) {
  return file.format.starts_with("glTF") || file.format.starts_with("VRM");
}

Result<CharacterDocument> characterDocument(const ClipCharacter& from) {
  if (isOfGltf(*from.file)) return ownDocument(from);
  const Character& character = from.file->character;
  if (!character.shapes.empty()) {
    return unsupported("{}: a mesh in several poses has no bones that a clip could move", from.path.string());
  }
  const Pose rest = restPose(character.skeleton);
  const OwnMotion own = inMetres(*from.file, {"", character.skeleton, {0.0}, rest});
  // Joints of the output do not shrink what hangs on them.
  const double metresPerUnit = character.skeleton.joint(0).rest.scale.x();
  std::vector<Affine3> jointFromModel;
  for (std::size_t j = 1; j < character.jointFromModel.size(); ++j) {
    jointFromModel.emplace_back(Eigen::Scaling(metresPerUnit) * character.jointFromModel[j]);
  }
  return readDocument(character, from.file->look, own.motion.skeleton, jointFromModel);
}

CharacterDocument characterDocument(const Character& character) {
  return readDocument(character, {}, character.skeleton, character.jointFromModel);
}

}  // namespace lorica

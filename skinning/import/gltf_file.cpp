#include "skinning/import/scene_readers.h"

#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"
#include "skinning/import/gltf_accessor.h"
#include "skinning/import/gltf_document.h"
#include "skinning/import/gltf_parts.h"
#include "skinning/import/json_values.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

namespace lorica {
namespace {

[[nodiscard]] Vec3 valueAt(const std::vector<double>& numbers, std::size_t i, const Vec3*) {
  return {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
}

[[nodiscard]] Quat valueAt(const std::vector<double>& numbers, std::size_t i, const Quat*) {
  return Quat(numbers[4 * i + 3], numbers[4 * i], numbers[4 * i + 1], numbers[4 * i + 2]);
}

class ClipReader {
 public:
  ClipReader(const GltfDocument& document, GltfAccessors& accessors, std::size_t animation)
      : document_(document),
        accessors_(accessors),
        animation_(document.model.animations[animation]),
        who_(titled("animation", animation, animation_.name)) {
    clip.name = animation_.name.empty() ? fmt::format("clip {}", animation) : animation_.name;
  }

  [[nodiscard]] Result<void> addChannel(std::size_t index) {
    const tinygltf::AnimationChannel& channel = animation_.channels[index];
    const std::string user = fmt::format("{}, channel {}", who_, index);
    if (channel.target_path == "weights") return {};  // see addGltfMorphs()
    const bool moves =
        channel.target_path == "translation" || channel.target_path == "rotation" || channel.target_path == "scale";
    if (channel.target_node == -1 || !moves) {
      ++unknownChannels;
      return {};
    }
    LORICA_TRY_DO(checkIndex(document_, channel.target_node, document_.model.nodes.size(), user, "node"));
    const auto [position, isNew] = trackOfNode_.emplace(channel.target_node, clip.tracks.size());
    if (isNew) clip.tracks.push_back({channel.target_node, std::nullopt, std::nullopt, std::nullopt});
    FileTrack& track = clip.tracks[position->second];
    if (channel.target_path == "translation") return readTrack(channel, 3, user, track.translation);
    if (channel.target_path == "scale") return readTrack(channel, 3, user, track.scale);
    return readTrack(channel, 4, user, track.rotation);
  }

  FileClip clip;
  int unknownChannels = 0;   ///< with a path or node that glTF 2.0 does not define
  int doubledChannels = 0;   ///< with a node and path that another channel already animates
  std::size_t lateKeys = 0;  ///< not later than the previous key

 private:
  template <typename Value>
  [[nodiscard]] Result<void> readTrack(const tinygltf::AnimationChannel& channel, int components,
                                       const std::string& user, std::optional<KeyTrack<Value>>& out) {
    if (out) {
      ++doubledChannels;
      return {};
    }
    LORICA_TRY(const GltfKeys keys, accessors_.keys(animation_, channel.sampler, components, user));
    const auto& [interpolation, times, values] = keys;
    KeyTrack<Value> track;
    track.interpolation = interpolation;
    const std::size_t perKey = keys.listsPerKey();
    const std::size_t valueCount = values.size() / components;
    if (valueCount != perKey * times.size()) {
      return badFormat("{}: {}: {} for {}, expected {}", document_.name, user,
                       counted(std::int64_t(valueCount), "value"), counted(std::ssize(times), "key"),
                       grouped(perKey * times.size()));
    }
    track.times.reserve(times.size());
    track.values.reserve(valueCount);
    for (std::size_t key = 0; key < times.size(); ++key) {
      if (!track.times.empty() && times[key] <= track.times.back()) {
        ++lateKeys;
        continue;
      }
      track.times.push_back(times[key]);
      for (std::size_t v = perKey * key; v < perKey * (key + 1); ++v) {
        track.values.push_back(valueAt(values, v, static_cast<const Value*>(nullptr)));
      }
    }
    out = std::move(track);
    return {};
  }

  const GltfDocument& document_;
  GltfAccessors& accessors_;
  const tinygltf::Animation& animation_;
  std::string who_;
  std::map<int, std::size_t> trackOfNode_;
};

/// Adds the file's animations of nodes, one clip each. Those of morph weights are added by addGltfMorphs().
[[nodiscard]] Result<void> addGltfClips(const GltfDocument& document, GltfAccessors& accessors, FileScene& scene) {
  int unknownChannels = 0;
  int doubledChannels = 0;
  std::size_t lateKeys = 0;
  for (std::size_t a = 0; a < document.model.animations.size(); ++a) {
    ClipReader reader(document, accessors, a);
    for (std::size_t c = 0; c < document.model.animations[a].channels.size(); ++c) {
      LORICA_TRY_DO(reader.addChannel(c));
    }
    unknownChannels += reader.unknownChannels;
    doubledChannels += reader.doubledChannels;
    lateKeys += reader.lateKeys;
    scene.clips.push_back(std::move(reader.clip));
  }
  scene.note(unknownChannels, "animation channel animates something other than nodes: skipped",
             "animation channels animate something other than nodes: skipped");
  scene.note(doubledChannels, "animation channel animates what another already animates: skipped",
             "animation channels animate what another already animates: skipped");
  scene.note(lateKeys, "animation key is not later than the previous key: skipped",
             "animation keys are not later than the previous key: skipped");
  return {};
}

using Json = nlohmann::json;

/// VRM 1.0 renamed the bones of the thumb, and only those.
[[nodiscard]] std::string nameIn1(const std::string& nameIn0) {
  static const std::array<std::array<const char*, 2>, 4> kThumbs = {{{"leftThumbProximal", "leftThumbMetacarpal"},
                                                                     {"leftThumbIntermediate", "leftThumbProximal"},
                                                                     {"rightThumbProximal", "rightThumbMetacarpal"},
                                                                     {"rightThumbIntermediate", "rightThumbProximal"}}};
  for (const auto& [in0, in1] : kThumbs) {
    if (nameIn0 == in0) return in1;
  }
  return nameIn0;
}

class BoneList {
 public:
  explicit BoneList(FileScene& scene) : scene_(scene), taken_(scene.nodes.size(), 0) {}

  void add(const std::string& name, const Json& node) {
    const std::optional<HumanBone> bone = humanBoneNamed(name);
    if (!bone) return;                                                     // eyes and jaw
    if (node.is_number_integer() && node.get<std::int64_t>() < 0) return;  // Unity's word for none
    const bool known =
        node.is_number_integer() && node.get<std::int64_t>() >= 0 && node.get<std::int64_t>() < countOf(scene_.nodes);
    if (!known) {
      scene_.notes.push_back(
          fmt::format("VRM: bone {} refers to node {}, which does not exist: skipped", name, node.dump()));
      return;
    }
    const auto index = node.get<std::size_t>();
    bool& has = has_[ordinalOf(*bone)];
    if (has || taken_[index] != 0) {
      scene_.notes.push_back(
          fmt::format("VRM: bone {} or its node {} is listed twice: the first is used", name, index));
      return;
    }
    has = true;
    taken_[index] = 1;
    scene_.bones.emplace_back(*bone, static_cast<int>(index));
  }

 private:
  FileScene& scene_;
  std::array<bool, kHumanBoneCount> has_{};
  std::vector<char> taken_;
};

/// Reads what VRM 0.x ("VRM"), 1.0 ("VRMC_vrm") or a VRM animation ("VRMC_vrm_animation") adds to a glTF file: the
/// format name, the humanoid bones, and the facing direction -Z of 0.x. Bones that refer to no node are skipped, with a
/// note unless it is a negative one. https://github.com/vrm-c/vrm-specification: 0.0/README.md and
/// VRMC_vrm-1.0/humanoid.md
/// @param extensions  those of the whole file, an object
/// @param scene       its nodes are read; format, bones, axes and notes are written
void readVrm(const Json& extensions, FileScene& scene) {
  BoneList bones(scene);
  for (const auto& [extension, format] :
       {std::pair("VRMC_vrm", "VRM 1.0"), std::pair("VRMC_vrm_animation", "VRM animation 1.0")}) {
    const Json& vrm = memberOf(extensions, extension);
    if (!vrm.is_object()) continue;
    scene.format = format;
    const Json& list = memberOf(memberOf(vrm, "humanoid"), "humanBones");
    if (!list.is_object()) return;
    for (const auto& [name, bone] : list.items()) bones.add(name, memberOf(bone, "node"));
    return;
  }
  if (const Json& vrm = memberOf(extensions, "VRM"); vrm.is_object()) {
    scene.format = "VRM 0.x";
    scene.modelFromFileAxes = Quat(0.0, 0.0, 1.0, 0.0);  // 180 degrees about Y
    scene.notes.emplace_back("VRM 0.x faces -Z: rotated to face +Z");
    for (const Json& bone : listOf(memberOf(vrm, "humanoid"), "humanBones")) {
      const Json& name = memberOf(bone, "bone");
      if (name.is_string()) bones.add(nameIn1(name.get<std::string>()), memberOf(bone, "node"));
    }
  }
}

constexpr std::uint64_t kLookNumbersPerByte = 4;

/// Converts one file to a FileScene.
class GltfSceneReader {
 public:
  explicit GltfSceneReader(const GltfDocument& document)
      : document_(document), accessors_(document), lookAccessors_(document, kLookNumbersPerByte) {}

  [[nodiscard]] Result<FileScene> read() {
    addGltfMaterials(document_, scene_);
    for (const auto step : {&GltfSceneReader::readNodes, &GltfSceneReader::linkNodes, &GltfSceneReader::readSkins,
                            &GltfSceneReader::readMeshes}) {
      LORICA_TRY_DO((this->*step)());
    }
    LORICA_TRY_DO(addGltfClips(document_, accessors_, scene_));
    scene_.format = "glTF 2.0";
    readVrm(document_.extensions, scene_);
    addGltfMorphs(document_, accessors_, scene_);
    readExpressions(document_.extensions, scene_);
    readVrmSprings(document_, scene_);
    for (const std::string& extension : document_.model.extensionsUsed) {
      if (extension == "EXT_mesh_gpu_instancing") {
        scene_.notes.emplace_back("EXT_mesh_gpu_instancing: only one copy of each instanced mesh is read");
      }
    }
    return std::move(scene_);
  }

 private:
  /// Copies the numbers of a node's property, if it has them.
  [[nodiscard]] Result<void> readProperty(const std::vector<double>& from, std::size_t node, const char* property,
                                          std::span<double> to) const {
    if (from.empty()) return {};
    if (from.size() != to.size()) {
      return badFormat("{}: node {}: {} has {} numbers, expected {}", document_.name, node, property, from.size(),
                       to.size());
    }
    std::copy(from.begin(), from.end(), to.begin());
    return {};
  }

  [[nodiscard]] Result<void> readNodes() {
    int unturned = 0;
    scene_.nodes.reserve(document_.model.nodes.size());
    for (std::size_t i = 0; i < document_.model.nodes.size(); ++i) {
      const tinygltf::Node& from = document_.model.nodes[i];
      FileNode node;
      node.name = from.name.empty() ? fmt::format("node {}", i) : from.name;
      Mat4 matrix = Mat4::Identity();
      Eigen::Vector4d rotation(0.0, 0.0, 0.0, 1.0);
      const auto numbersOf = [](auto& m) { return std::span(m.data(), m.size()); };
      Vec3& translation = node.local.translation;
      LORICA_TRY_DO(readProperty(from.matrix, i, "matrix", numbersOf(matrix)));
      LORICA_TRY_DO(readProperty(from.translation, i, "translation", numbersOf(translation)));
      LORICA_TRY_DO(readProperty(from.rotation, i, "rotation", numbersOf(rotation)));
      LORICA_TRY_DO(readProperty(from.scale, i, "scale", numbersOf(node.local.scale)));
      const double norm = rotation.norm();
      if (!matrix.allFinite() || !node.local.translation.allFinite() || !node.local.scale.allFinite() ||
          !std::isfinite(norm)) {
        return badFormat("{}: node {} '{}': contains a non-finite number", document_.name, i, node.name);
      }
      if (std::abs(norm - 1.0) > 1e-3) ++unturned;
      if (norm > 1e-12) node.local.rotation = Quat(Eigen::Vector4d(rotation / norm));
      if (!from.matrix.empty()) setMatrix(node, Affine3(Eigen::Matrix<double, 3, 4>(matrix.topRows<3>())));
      scene_.nodes.push_back(std::move(node));
    }
    scene_.note(unturned, "node has a rotation that is not of unit length: normalised",
                "nodes have rotations that are not of unit length: normalised");
    return {};
  }

  [[nodiscard]] Result<void> linkNodes() {
    const std::size_t count = scene_.nodes.size();
    for (std::size_t i = 0; i < count; ++i) {
      for (const int child : document_.model.nodes[i].children) {
        LORICA_TRY_DO(checkIndex(document_, child, count, fmt::format("node {}", i), "child node"));
        FileNode& node = scene_.nodes[child];
        if (node.parent != -1) {
          return badFormat("{}: node {} '{}': is a child of node {} and of node {}, expected one parent",
                           document_.name, child, node.name, node.parent, i);
        }
        node.parent = i;
      }
    }
    // Each node has at most one parent, so a node below no root is part of a cycle.
    std::vector<int> below;
    inScene_.assign(count, 0);
    for (std::size_t i = 0; i < count; ++i) {
      if (scene_.nodes[i].parent == -1) below.push_back(i);
    }
    const std::vector<int> roots = below;
    markBelow(below);
    for (std::size_t i = 0; i < count; ++i) {
      if (inScene_[i] == 0)
        return badFormat("{}: node {} '{}': is its own ancestor", document_.name, i, scene_.nodes[i].name);
    }

    // The nodes that the default scene draws.
    const int sceneCount = countOf(document_.model.scenes);
    if (sceneCount == 0) return {};
    const int drawn = document_.model.defaultScene == -1 ? 0 : document_.model.defaultScene;
    LORICA_TRY_DO(checkIndex(document_, drawn, document_.model.scenes.size(), "the file", "scene"));
    const std::vector<int>& listed = document_.model.scenes[drawn].nodes;
    for (const int node : listed) {
      LORICA_TRY_DO(checkIndex(document_, node, count, fmt::format("scene {}", drawn), "node"));
    }
    inScene_.assign(count, 0);
    markBelow(listed);
    return {};
  }

  void markBelow(std::vector<int> stack) {
    while (!stack.empty()) {
      const std::size_t node = stack.back();
      stack.pop_back();
      if (inScene_[node] != 0) continue;
      inScene_[node] = 1;
      const std::vector<int>& children = document_.model.nodes[node].children;
      stack.insert(stack.end(), children.begin(), children.end());
    }
  }

  [[nodiscard]] Result<void> readSkins() {
    scene_.skins.reserve(document_.model.skins.size());
    for (std::size_t s = 0; s < document_.model.skins.size(); ++s) {
      const tinygltf::Skin& from = document_.model.skins[s];
      const std::string who = titled("skin", s, from.name);
      if (from.joints.empty()) return badFormat("{}: {}: has no joints, expected at least one", document_.name, who);
      for (const int joint : from.joints) {
        LORICA_TRY_DO(checkIndex(document_, joint, scene_.nodes.size(), who, "joint node"));
      }
      FileSkin skin{from.name, from.joints, {}};
      skin.jointFromMesh.assign(from.joints.size(), Affine3::Identity());
      if (from.inverseBindMatrices != -1) {
        LORICA_TRY(const std::vector<double> numbers,
                   accessors_.numbers(from.inverseBindMatrices, 16, who + ": inverse bind matrices"));
        if (numbers.size() < 16 * from.joints.size()) {
          return badFormat("{}: {}: {} inverse bind matrices for {} joints", document_.name, who, numbers.size() / 16,
                           from.joints.size());
        }
        for (std::size_t j = 0; j < from.joints.size(); ++j) {
          Mat4 matrix = Eigen::Map<const Mat4>(numbers.data() + 16 * j);
          if (!matrix.row(3).isApprox(Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0), 1e-3)) ++projective_;
          skin.jointFromMesh[j].matrix().topRows<3>() = matrix.topRows<3>();
        }
      }
      scene_.skins.push_back(std::move(skin));
    }
    if (projective_ > 0) {
      scene_.notes.push_back(
          fmt::format("{} inverse bind matrices do not have the last row 0 0 0 1: it is assumed", projective_));
    }
    return {};
  }

  /// Refuses files in which many nodes share meshes of many primitives: their product takes the time.
  [[nodiscard]] Result<void> checkDraws() const {
    std::uint64_t draws = 0;
    for (std::size_t i = 0; i < document_.model.nodes.size(); ++i) {
      const int mesh = document_.model.nodes[i].mesh;
      if (inScene_[i] == 0 || mesh < 0 || mesh >= countOf(document_.model.meshes)) continue;
      draws += document_.model.meshes[mesh].primitives.size();
    }
    if (draws <= kMaxDraws) return {};
    return unsupported("{}: its nodes draw {} primitives, expected at most {}", document_.name, grouped(draws),
                       grouped(kMaxDraws));
  }

  [[nodiscard]] Result<void> readMeshes() {
    const GltfMeshSources sources{document_, accessors_, lookAccessors_};
    GltfMeshCounts statistics;
    CountedNotes notes;
    LORICA_TRY_DO(checkDraws());
    int undrawn = 0;
    for (std::size_t i = 0; i < document_.model.nodes.size(); ++i) {
      const tinygltf::Node& node = document_.model.nodes[i];
      const std::string who = fmt::format("node {}", i);
      if (node.skin != -1) {
        LORICA_TRY_DO(checkIndex(document_, node.skin, scene_.skins.size(), who, "skin"));
      }
      if (node.mesh == -1) continue;
      if (inScene_[i] == 0) {
        ++undrawn;
        continue;
      }
      LORICA_TRY_DO(addGltfMesh(sources, node.mesh, i, scene_, statistics, notes));
    }
    scene_.meshCount = countOf(document_.model.meshes);
    for (const tinygltf::Mesh& mesh : document_.model.meshes) {
      scene_.primitiveCount += countOf(mesh.primitives);
      std::size_t targets = 0;
      for (const tinygltf::Primitive& primitive : mesh.primitives) {
        targets = std::max(targets, primitive.targets.size());
      }
      scene_.morphTargetCount += targets;
    }
    scene_.note(undrawn, "node with a mesh is not in the drawn scene: skipped",
                "nodes with a mesh are not in the drawn scene: skipped");
    scene_.note(statistics.pointsAndLines, "primitive is points or lines: skipped",
                "primitives are points or lines: skipped");
    scene_.note(statistics.withoutPositions, "primitive has no positions: skipped",
                "primitives have no positions: skipped");
    scene_.note(statistics.rigidOnSkin, "primitive of a node with a skin has no joints: attached to its node",
                "primitives of nodes with a skin have no joints: attached to their nodes");
    scene_.note(statistics.degenerate, "triangle uses a vertex twice: skipped",
                "triangles use a vertex twice: skipped");
    scene_.note(statistics.leftOver, "index does not form a complete triangle: skipped",
                "indices do not form a complete triangle: skipped");
    scene_.note(statistics.notFinite,
                "number of normals, tangents, texture coordinates or colours is not finite: replaced by 0",
                "numbers of normals, tangents, texture coordinates or colours are not finite: replaced by 0");
    notes.appendTo(scene_.notes);
    spendLook();
    return {};
  }

  /// Lists of the look are as long as all vertices, if any mesh has them: drops them if they are too many.
  void spendLook() {
    std::uint64_t vertices = 0;
    std::uint64_t numbers = 0;
    const auto count = [&](const auto& list, std::uint64_t components) {
      const auto has = [&](const FileMesh& mesh) { return !std::invoke(list, mesh).empty(); };
      if (std::ranges::any_of(scene_.meshes, has)) numbers += components;
    };
    for (const FileMesh& mesh : scene_.meshes) vertices += mesh.positions.size();
    count(&FileMesh::normals, 3);
    count(&FileMesh::tangents, 4);
    count([](const FileMesh& mesh) { return std::span(mesh.uv[0]); }, 2);
    count([](const FileMesh& mesh) { return std::span(mesh.uv[1]); }, 2);
    count(&FileMesh::colors, 4);
    if (lookAccessors_.spend(vertices * numbers)) return;
    for (FileMesh& mesh : scene_.meshes) {
      mesh.normals = {};
      mesh.tangents = {};
      mesh.uv[0] = {};
      mesh.uv[1] = {};
      mesh.colors = {};
    }
    scene_.notes.push_back(
        fmt::format("normals, texture coordinates and colours of {} vertices are too many for a "
                    "file of {} bytes: not used",
                    grouped(vertices), grouped(document_.fileBytes)));
  }

  const GltfDocument& document_;
  GltfAccessors accessors_;
  GltfAccessors lookAccessors_;
  FileScene scene_;
  std::vector<char> inScene_;
  int projective_ = 0;
};

}  // namespace

Result<FileScene> readGltfScene(std::span<const std::byte> bytes, const std::string& name, const NamedFiles& files) {
  LORICA_TRY(const GltfDocument document, parseGltf(bytes, name, files));
  return GltfSceneReader(document).read();
}

}  // namespace lorica

#include "skinning/import/scene_check.h"

#include "geometry/errors.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

namespace lorica {

namespace {

template <typename Index>
[[nodiscard]] bool within(Index index, std::size_t count) {
  return index >= 0 && std::cmp_less(index, count);
}

[[nodiscard]] bool isTurn(const Quat& q) {
  return std::abs(q.norm() - 1.0) < 1e-6;
}

/// Whether no node is its own ancestor.
[[nodiscard]] bool isForest(const FileScene& scene) {
  std::vector<char> reachesRoot(scene.nodes.size(), 0);
  std::vector<int> path;
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    path.clear();
    for (int up = n; up != -1 && reachesRoot[up] == 0; up = scene.nodes[up].parent) {
      path.push_back(up);
      if (path.size() > scene.nodes.size()) return false;
    }
    for (const int node : path) reachesRoot[node] = 1;
  }
  return true;
}

[[nodiscard]] bool areSound(const FileScene& scene, const FileNode& node) {
  return (node.parent == -1 || within(node.parent, scene.nodes.size())) && node.local.translation.allFinite() &&
         node.local.scale.allFinite() && isTurn(node.local.rotation) && (!node.inner || isTurn(*node.inner));
}

[[nodiscard]] bool isSound(const FileScene& scene, const FileSkin& skin) {
  return !skin.nodes.empty() && skin.nodes.size() == skin.jointFromMesh.size() &&
         std::all_of(skin.nodes.begin(), skin.nodes.end(), [&](int n) { return within(n, scene.nodes.size()); }) &&
         std::all_of(skin.jointFromMesh.begin(), skin.jointFromMesh.end(),
                     [](const Affine3& m) { return m.matrix().allFinite(); });
}

[[nodiscard]] bool areSoundWeights(const FileMesh& mesh) {
  if (mesh.skin == -1) return mesh.weightBegin.empty() && mesh.weights.empty();
  return mesh.weightBegin.size() == mesh.positions.size() + 1 && mesh.weightBegin.front() == 0 &&
         mesh.weightBegin.back() == mesh.weights.size() &&
         std::is_sorted(mesh.weightBegin.begin(), mesh.weightBegin.end());
}

[[nodiscard]] bool isSound(const FileScene& scene, const FileMesh& mesh, const FileMorph& morph) {
  const auto unordered = [](const MorphOffset& a, const MorphOffset& b) { return a.vertex >= b.vertex; };
  return within(morph.target, scene.morphTargets.size()) &&
         std::adjacent_find(morph.offsets.begin(), morph.offsets.end(), unordered) == morph.offsets.end() &&
         std::all_of(morph.offsets.begin(), morph.offsets.end(), [&](const MorphOffset& o) {
           return within(o.vertex, mesh.positions.size()) && o.position.allFinite() && o.normal.allFinite();
         });
}

/// One element for each vertex, all finite, or none.
template <typename Element>
[[nodiscard]] bool fits(const std::vector<Element>& list, const FileMesh& mesh) {
  return list.empty() ||
         (list.size() == mesh.positions.size() &&
          std::all_of(list.begin(), list.end(), [](const Element& element) { return element.allFinite(); }));
}

[[nodiscard]] bool isSound(const FileScene& scene, const FileMesh& mesh) {
  const auto inRange = [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](VertexIndex v) { return within(v, mesh.positions.size()); });
  };
  return within(mesh.node, scene.nodes.size()) && (mesh.skin == -1 || within(mesh.skin, scene.skins.size())) &&
         (mesh.material == -1 || within(mesh.material, scene.materials.size())) && !mesh.positions.empty() &&
         fits(mesh.positions, mesh) && std::all_of(mesh.triangles.begin(), mesh.triangles.end(), inRange) &&
         areSoundWeights(mesh) &&
         std::all_of(mesh.morphs.begin(), mesh.morphs.end(),
                     [&](const FileMorph& m) { return isSound(scene, mesh, m); }) &&
         fits(mesh.normals, mesh) && fits(mesh.tangents, mesh) && fits(mesh.uv[0], mesh) && fits(mesh.uv[1], mesh) &&
         fits(mesh.colors, mesh);
}

[[nodiscard]] bool isFinite(const Vec3& v) {
  return v.allFinite();
}
[[nodiscard]] bool isFinite(const Quat& q) {
  return q.coeffs().allFinite();
}

[[nodiscard]] bool areSoundTimes(const std::vector<double>& times) {
  const auto late = [](double a, double b) { return !(a < b); };
  return !times.empty() && std::all_of(times.begin(), times.end(), [](double t) { return std::isfinite(t); }) &&
         std::adjacent_find(times.begin(), times.end(), late) == times.end();
}

template <typename Value>
[[nodiscard]] bool isSound(const std::optional<KeyTrack<Value>>& track) {
  if (!track) return true;
  return track->interpolation == KeyInterpolation::kLinear && areSoundTimes(track->times) &&
         track->values.size() == track->times.size() &&
         std::all_of(track->values.begin(), track->values.end(), [](const Value& value) { return isFinite(value); });
}

/// One target's weights.
[[nodiscard]] bool isSound(const FileScene& scene, const MorphWeightTrack& track) {
  return within(track.firstTarget, scene.morphTargets.size()) && track.targetCount == 1 &&
         track.interpolation == KeyInterpolation::kLinear && areSoundTimes(track.times) &&
         track.values.size() == track.times.size() &&
         std::all_of(track.values.begin(), track.values.end(), [](float value) { return std::isfinite(value); });
}

[[nodiscard]] bool isSound(const FileScene& scene, const FileClip& clip) {
  const auto sound = [&](const FileTrack& track) {
    return within(track.node, scene.nodes.size()) && isSound(track.translation) && isSound(track.rotation) &&
           isSound(track.scale);
  };
  return std::all_of(clip.tracks.begin(), clip.tracks.end(), sound) &&
         std::all_of(clip.weights.begin(), clip.weights.end(),
                     [&](const MorphWeightTrack& track) { return isSound(scene, track); });
}

[[nodiscard]] bool isSound(const FileScene& scene, const Material& material) {
  const auto textures = material.textures();
  const bool used = std::all_of(textures.begin(), textures.end(), [&](const TextureUse* use) {
    return (use->picture == -1 || within(use->picture, scene.pictures.size())) && within(use->uvSet, 2) &&
           use->transform.allFinite() && std::isfinite(use->rotation);
  });
  const auto isShare = [](float number) { return number >= 0.0F && number <= 1.0F; };
  return used && material.baseColor.allFinite() && material.emissive.allFinite() && isShare(material.metallic) &&
         isShare(material.roughness) && std::isfinite(material.normalScale);
}

}  // namespace

Result<void> checkScene(const FileScene& scene, const std::string& name) {
  const auto unsound = [&](const auto& list, std::string_view what, const auto& check) -> Result<void> {
    const auto found = std::find_if(list.begin(), list.end(), [&](const auto& one) { return !check(one); });
    if (found == list.end()) return {};
    return badFormat("{}: {} {} refers to what is not there, or is not finite", name, what, found - list.begin());
  };
  const auto sound = [&](const auto& one) { return isSound(scene, one); };
  const auto soundTarget = [&](const FileMorphTarget& target) {
    return within(target.node, scene.nodes.size()) && std::isfinite(target.defaultWeight);
  };
  LORICA_TRY_DO(unsound(scene.nodes, "node", [&](const auto& n) { return areSound(scene, n); }));
  if (!isForest(scene)) return badFormat(name + ": a node is its own ancestor");
  LORICA_TRY_DO(unsound(scene.skins, "skin", sound));
  LORICA_TRY_DO(unsound(scene.morphTargets, "morph target", soundTarget));
  LORICA_TRY_DO(unsound(scene.meshes, "mesh", sound));
  LORICA_TRY_DO(unsound(scene.clips, "clip", sound));
  LORICA_TRY_DO(unsound(scene.materials, "material", sound));
  const bool unit = !scene.metresPerUnit || (std::isfinite(*scene.metresPerUnit) && *scene.metresPerUnit > 0.0);
  if (!unit || !isTurn(scene.modelFromFileAxes)) {
    return badFormat(name + ": its unit or axes are not finite");
  }
  return {};
}

}  // namespace lorica

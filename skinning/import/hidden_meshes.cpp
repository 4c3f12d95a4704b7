#include "skinning/import/character_parts.h"

#include "geometry/errors.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <string_view>
#include <utility>

namespace lorica {

namespace {

constexpr std::size_t kMaxNames = 1000;
constexpr std::size_t kMaxNamesInMessages = 40;

[[nodiscard]] bool sameName(const std::string& a, const std::string& b) {
  return lowerCase(a) == lowerCase(b);
}

[[nodiscard]] const std::string& nodeOf(const FileScene& scene, const FileMesh& mesh) {
  return scene.nodes[mesh.node].name;
}

/// Colliders of `lorica export` are no part of a character, if anything else is in the file.
void takeColliders(FileScene& scene) {
  const auto isCollider = [&](const FileMesh& mesh) {
    return mesh.material >= 0 && scene.materials[mesh.material].name == kColliderMaterial;
  };
  if (!std::ranges::all_of(scene.meshes, isCollider)) std::erase_if(scene.meshes, isCollider);
}

/// "1H_Axe (Cube.001), Hat (Cube.002) and 3 more".
[[nodiscard]] std::string listed(std::vector<MeshName> names) {
  const std::size_t more = names.size() - std::min(names.size(), kMaxNamesInMessages);
  names.resize(names.size() - more);
  std::string text;
  for (const MeshName& name : names) text += (text.empty() ? "" : ", ") + name.text();
  return more == 0 ? text : fmt::format("{} and {} more", text, more);
}

}  // namespace

std::vector<MeshName> meshNamesOf(const FileScene& scene) {
  std::vector<MeshName> names;
  std::set<std::pair<std::string_view, std::string_view>> known;
  for (const FileMesh& mesh : scene.meshes) {
    const std::string& node = nodeOf(scene, mesh);
    if (names.size() < kMaxNames && known.emplace(node, mesh.name).second) names.push_back({node, mesh.name});
  }
  return names;
}

Result<std::vector<FileMesh>> takeHiddenMeshes(FileScene& scene, std::span<const std::string> hidden,
                                               const std::string& fileName) {
  takeColliders(scene);
  std::vector<FileMesh> taken;
  if (hidden.empty()) return taken;
  const std::vector<MeshName> names = meshNamesOf(scene);
  const auto isMeant = [&](const FileMesh& mesh, const std::string& name) {
    return sameName(nodeOf(scene, mesh), name) || (!mesh.name.empty() && sameName(mesh.name, name));
  };
  for (const std::string& name : hidden) {
    if (std::any_of(scene.meshes.begin(), scene.meshes.end(), [&](const FileMesh& m) { return isMeant(m, name); })) {
      continue;
    }
    return invalidArgument("{}: no mesh named `{}` to hide, {}", fileName, name,
                           names.empty() ? "the file has none" : "expected one of " + listed(names));
  }
  const auto firstHidden = std::stable_partition(scene.meshes.begin(), scene.meshes.end(), [&](const FileMesh& mesh) {
    return std::none_of(hidden.begin(), hidden.end(), [&](const std::string& name) { return isMeant(mesh, name); });
  });
  if (firstHidden == scene.meshes.begin()) {
    return invalidArgument("{}: every mesh is hidden ({}), expected at least one to be left", fileName, listed(names));
  }
  taken.assign(std::make_move_iterator(firstHidden), std::make_move_iterator(scene.meshes.end()));
  scene.meshes.erase(firstHidden, scene.meshes.end());
  return taken;
}

}  // namespace lorica

#include "skinning/import/assimp_morphs.h"

#include "skinning/import/gltf_morphs.h"

#include <assimp/mesh.h>

#include <fmt/format.h>

#include <algorithm>

namespace lorica {

namespace {

[[nodiscard]] Vec3f difference(const aiVector3D& a, const aiVector3D& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

/// What a target adds to a mesh; none if its vertices are not the mesh's or not finite.
[[nodiscard]] std::optional<std::vector<MorphOffset>> offsetsOf(const aiMesh& mesh, const aiAnimMesh& target) {
  if (target.mVertices == nullptr || target.mNumVertices != mesh.mNumVertices) return std::nullopt;
  const bool turns = target.mNormals != nullptr && mesh.mNormals != nullptr;
  std::vector<MorphOffset> offsets;
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
    MorphOffset offset{static_cast<VertexIndex>(v), difference(target.mVertices[v], mesh.mVertices[v]), Vec3f::Zero()};
    if (turns) offset.normal = difference(target.mNormals[v], mesh.mNormals[v]);
    if (!offset.position.allFinite()) return std::nullopt;
    if (!offset.normal.allFinite()) offset.normal.setZero();
    if (!offset.position.isZero(0.0F) || !offset.normal.isZero(0.0F)) offsets.push_back(offset);
  }
  return offsets;
}

}  // namespace

void AssimpMorphs::add(const aiMesh& from, FileMesh& mesh) {
  for (unsigned t = 0; t < from.mNumAnimMeshes; ++t) {
    const aiAnimMesh& target = *from.mAnimMeshes[t];
    std::string name(target.mName.data, std::min<std::size_t>(target.mName.length, sizeof target.mName.data));
    if (name.empty()) name = fmt::format("{} {}", mesh.name.empty() ? "target" : mesh.name, t);
    const auto known = known_.find({mesh.node, name});
    if (known == known_.end() && scene_.morphTargets.size() >= static_cast<std::size_t>(kMaxMorphTargets)) {
      ++beyondLimit_;
      continue;
    }
    std::optional<std::vector<MorphOffset>> offsets = offsetsOf(from, target);
    if (!offsets) {
      ++broken_;
      continue;
    }
    const int index = known != known_.end() ? known->second : static_cast<int>(scene_.morphTargets.size());
    if (known == known_.end()) {
      known_.emplace(std::pair(mesh.node, name), index);
      scene_.morphTargets.push_back({name, mesh.node, -1, static_cast<int>(t), 0.0F});
    }
    if (!offsets->empty()) mesh.morphs.push_back({index, std::move(*offsets)});
  }
}

void AssimpMorphs::finish() {
  if (broken_ > 0) {
    scene_.notes.push_back(
        fmt::format("{} morph targets have numbers that are not finite, or not the vertices of their mesh: skipped",
                    grouped(broken_)));
  }
  if (beyondLimit_ > 0) {
    scene_.notes.push_back(fmt::format("{} morph targets are beyond the first {}: skipped", grouped(beyondLimit_),
                                       grouped(kMaxMorphTargets)));
  }
}

}  // namespace lorica

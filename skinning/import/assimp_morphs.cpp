#include "skinning/import/assimp_parts.h"

#include "geometry/counts.h"
#include "geometry/work_budgets.h"

#include <assimp/anim.h>
#include <assimp/mesh.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lorica {

namespace {

constexpr int kAmbiguous = -1;

/// The keys of one target; keys that are not finite or not later than the previous one are counted.
class WeightKeys {
 public:
  void add(double time, double weight, std::uint64_t& lost) {
    if (!std::isfinite(time) || !std::isfinite(weight) || (!track_.times.empty() && time <= track_.times.back())) {
      ++lost;
      return;
    }
    track_.times.push_back(time);
    track_.values.push_back(weight);
  }
  void appendTo(std::vector<MorphWeightTrack>& tracks, int target) {
    if (track_.times.empty()) return;
    track_.firstTarget = target;
    track_.targetCount = 1;
    tracks.push_back(std::move(track_));
  }

 private:
  MorphWeightTrack track_;
};

/// Where a clip's times begin. assimp 5.2 subtracts 2^63 from the times of a clip that has no start and moves no node.
[[nodiscard]] double startOf(const aiAnimation& from, double secondsPerTick) {
  constexpr double kImpossible = -1e7;  // [s]
  double first = 0.0;
  for (unsigned c = 0; c < from.mNumMorphMeshChannels; ++c) {
    const aiMeshMorphAnim& channel = *from.mMorphMeshChannels[c];
    if (channel.mNumKeys > 0) first = std::min(first, channel.mKeys[0].mTime * secondsPerTick);
  }
  return first < kImpossible ? first : 0.0;
}

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
    std::string name = textOf(target.mName);
    if (name.empty()) name = fmt::format("{} {}", mesh.name.empty() ? "target" : mesh.name, t);
    const auto known = known_.find({mesh.node, name});
    if (known == known_.end() && scene_.morphTargets.size() >= kMaxMorphTargets) {
      ++beyondLimit_;
      continue;
    }
    std::optional<std::vector<MorphOffset>> offsets = offsetsOf(from, target);
    if (!offsets) {
      ++broken_;
      continue;
    }
    const int index = known != known_.end() ? known->second : countOf(scene_.morphTargets);
    if (known == known_.end()) {
      known_.emplace(std::pair(mesh.node, name), index);
      scene_.morphTargets.push_back({name, mesh.node, -1, static_cast<int>(t), 0.0F});
    }
    const auto [place, first] = byIndex_.emplace(std::pair(mesh.node, t), index);
    if (!first && place->second != index) place->second = kAmbiguous;
    if (!offsets->empty()) mesh.morphs.push_back({index, std::move(*offsets)});
  }
}

void AssimpMorphs::addWeights(const aiAnimation& from, double secondsPerTick,
                              const std::map<std::string, int>& nodeOfName, FileClip& clip) {
  const double start = startOf(from, secondsPerTick);
  for (unsigned c = 0; c < from.mNumMorphMeshChannels; ++c) {
    const aiMeshMorphAnim& channel = *from.mMorphMeshChannels[c];
    // The name of a node, an asterisk, and the number of one of its meshes.
    const std::string name = channel.mName.C_Str();
    const auto node = nodeOfName.find(name.substr(0, name.rfind('*')));
    std::map<int, WeightKeys> keysOfTarget;
    for (unsigned k = 0; k < channel.mNumKeys; ++k) {
      const aiMeshMorphKey& key = channel.mKeys[k];
      for (unsigned v = 0; v < key.mNumValuesAndWeights; ++v) {
        const auto target = node == nodeOfName.end() ? byIndex_.end() : byIndex_.find({node->second, key.mValues[v]});
        if (target == byIndex_.end() || target->second == kAmbiguous) {
          ++lostWeights_;
        } else {
          keysOfTarget[target->second].add(key.mTime * secondsPerTick - start, key.mWeights[v], lostWeights_);
        }
      }
    }
    for (auto& [target, keys] : keysOfTarget) keys.appendTo(clip.weights, target);
  }
}

void AssimpMorphs::finish() {
  scene_.note(broken_, "morph target has numbers that are not finite, or not the vertices of its mesh: skipped",
              "morph targets have numbers that are not finite, or not the vertices of their mesh: skipped");
  scene_.note(lostWeights_,
              "key of weights refers to no morph target, is not finite or not later than the previous key: skipped",
              "keys of weights refer to no morph target, are not finite or not later than the previous key: skipped");
  const std::string beyond = fmt::format("beyond the first {}: skipped", grouped(kMaxMorphTargets));
  scene_.note(beyondLimit_, "morph target is " + beyond, "morph targets are " + beyond);
}

}  // namespace lorica

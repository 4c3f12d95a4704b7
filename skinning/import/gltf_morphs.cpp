#include "skinning/import/gltf_parts.h"

#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace lorica {

namespace {

/// Things that were skipped: how many, and why the first of them was.
struct Skipped {
  std::uint64_t count = 0;
  std::string first;

  void add(const std::string& why) {
    if (count++ == 0) first = why;
  }
};

class MorphReader {
 public:
  MorphReader(const GltfDocument& document, GltfAccessors& accessors, FileScene& scene)
      : document_(document), accessors_(accessors), scene_(scene) {}

  void read() {
    listTargets();
    for (std::size_t begin = 0; begin < scene_.meshes.size();) {
      std::size_t end = begin + 1;
      while (end < scene_.meshes.size() && scene_.meshes[end].node == scene_.meshes[begin].node) ++end;
      readOffsets(std::span(scene_.meshes).subspan(begin, end - begin));
      begin = end;
    }
    for (std::size_t a = 0; a < document_.model.animations.size(); ++a) readClip(a);

    if (beyondLimit_ > 0) {
      scene_.notes.push_back(fmt::format("{} morph targets, expected at most {}: the others are skipped",
                                         grouped(beyondLimit_ + kMaxMorphTargets), grouped(kMaxMorphTargets)));
    }
    note(badTargets_, "part of a morph target", "parts of morph targets");
    note(badChannels_, "animation channel of morph weights", "animation channels of morph weights");
    scene_.note(lateKeys_, "key of morph weights is not later than the previous key: skipped",
                "keys of morph weights are not later than the previous key: skipped");
  }

 private:
  /// The targets of a node's mesh: first .. first + listed of the scene's, of `declared` in the file.
  struct NodeTargets {
    int first = 0;
    int listed = 0;
    int declared = 0;
  };

  void note(const Skipped& skipped, const char* one, const char* many) {
    if (skipped.count == 0) return;
    scene_.notes.push_back(
        fmt::format("{} could not be read: skipped (the first: {})", counted(skipped.count, one, many), skipped.first));
  }

  /// An error's sentence without the file's name, which the notes do not have.
  [[nodiscard]] std::string plain(const Error& error) const {
    const std::string prefix = document_.name + ": ";
    return error.message.starts_with(prefix) ? error.message.substr(prefix.size()) : error.message;
  }

  // 1. The targets of every node with a mesh, by their names.
  void listTargets() {
    for (const FileMesh& mesh : scene_.meshes) {
      if (targetsOfNode_.contains(mesh.node)) continue;
      const std::size_t m = document_.model.nodes[mesh.node].mesh;
      const tinygltf::Mesh& from = document_.model.meshes[m];
      std::size_t declared = 0;
      for (const tinygltf::Primitive& primitive : from.primitives) {
        declared = std::max(declared, primitive.targets.size());
      }
      const std::size_t room = kMaxMorphTargets - scene_.morphTargets.size();
      const std::size_t listed = std::min(declared, room);
      beyondLimit_ += declared - listed;
      targetsOfNode_[mesh.node] = {countOf(scene_.morphTargets), static_cast<int>(listed), static_cast<int>(declared)};
      const std::vector<double>& nodeWeights = document_.model.nodes[mesh.node].weights;
      const std::vector<double>& weights = nodeWeights.empty() ? from.weights : nodeWeights;
      const std::vector<std::string>* names = m < document_.targetNames.size() ? &document_.targetNames[m] : nullptr;
      for (std::size_t t = 0; t < listed; ++t) {
        FileMorphTarget target;
        if (names != nullptr && t < names->size()) target.name = (*names)[t];
        if (target.name.empty()) target.name = fmt::format("{} {}", from.name.empty() ? "target" : from.name, t);
        target.node = mesh.node;
        target.mesh = m;
        target.index = t;
        const float weight = t < weights.size() ? weights[t] : 0.0;
        target.defaultWeight = std::isfinite(weight) ? weight : 0.0F;
        scene_.morphTargets.push_back(std::move(target));
      }
    }
  }

  // 2. What they move. Primitives often share one list of vertices, so each list of offsets is read once.
  void readOffsets(std::span<FileMesh> meshes) {
    const NodeTargets& targets = targetsOfNode_[meshes.front().node];
    const tinygltf::Mesh& from = document_.model.meshes[document_.model.nodes[meshes.front().node].mesh];
    for (int t = 0; t < targets.listed; ++t) {
      for (FileMesh& mesh : meshes) {
        const tinygltf::Primitive& primitive = from.primitives[mesh.primitive];
        if (static_cast<std::size_t>(t) >= primitive.targets.size()) continue;
        const std::string who = fmt::format("mesh {}, primitive {}, morph target {}",
                                            document_.model.nodes[mesh.node].mesh, mesh.primitive, t);
        const std::size_t vertexCount = document_.model.accessors[primitive.attributes.at("POSITION")].count;
        const std::map<std::string, int>& attributes = primitive.targets[t];
        const bool positions = readList(attributes, "POSITION", who, vertexCount, positions_);
        const bool normals = readList(attributes, "NORMAL", who, vertexCount, normals_);
        if (positions || normals) addOffsets(targets.first + t, positions, normals, who, mesh);
      }
    }
  }

  struct List {
    int accessor = -1;
    std::vector<double> numbers;
  };

  [[nodiscard]] bool readList(const std::map<std::string, int>& attributes, const char* attribute,
                              const std::string& who, std::size_t vertexCount, List& list) {
    const auto accessor = attributes.find(attribute);
    if (accessor == attributes.end()) return false;
    if (list.accessor != accessor->second || list.accessor == -1) {
      list = {};
      Result<std::vector<double>> numbers =
          accessors_.numbers(accessor->second, 3, fmt::format("{}: {}", who, attribute));
      if (!numbers) {
        badTargets_.add(plain(numbers.error()));
        return false;
      }
      list = {accessor->second, std::move(*numbers)};
    }
    if (list.numbers.size() == 3 * vertexCount) return true;
    badTargets_.add(fmt::format("{}: {} has {} elements, expected {}, one for each position", who, attribute,
                                grouped(list.numbers.size() / 3), grouped(vertexCount)));
    return false;
  }

  void addOffsets(int target, bool positions, bool normals, const std::string& who, FileMesh& mesh) {
    const auto at = [](const List& list, std::size_t v) {
      return Vec3f(list.numbers[3 * v], list.numbers[3 * v + 1], list.numbers[3 * v + 2]);
    };
    const auto offsetOf = [&](std::size_t v) {
      const std::size_t source = mesh.sourceVertices[v];
      MorphOffset offset{static_cast<VertexIndex>(v), Vec3f::Zero(), Vec3f::Zero()};
      if (positions) offset.position = at(positions_, source);
      if (normals) offset.normal = at(normals_, source);
      return offset;
    };
    const auto moves = [](const MorphOffset& offset) {
      return !offset.position.isZero(0.0F) || !offset.normal.isZero(0.0F);
    };
    std::size_t count = 0;
    for (std::size_t v = 0; v < mesh.sourceVertices.size(); ++v) count += moves(offsetOf(v)) ? 1 : 0;
    if (count == 0) return;
    if (!accessors_.spend(3 * count)) {
      badTargets_.add(fmt::format("{}: moves {} vertices, too many for a file of {} bytes with what others move", who,
                                  grouped(count), grouped(document_.fileBytes)));
      return;
    }
    FileMorph morph{target, {}};
    morph.offsets.reserve(count);
    for (std::size_t v = 0; v < mesh.sourceVertices.size(); ++v) {
      if (const MorphOffset offset = offsetOf(v); moves(offset)) morph.offsets.push_back(offset);
    }
    mesh.morphs.push_back(std::move(morph));
  }

  // 3. The weights of an animation.
  void readClip(std::size_t index) {
    const tinygltf::Animation& animation = document_.model.animations[index];
    std::map<int, bool> animated;
    for (std::size_t c = 0; c < animation.channels.size(); ++c) {
      const tinygltf::AnimationChannel& channel = animation.channels[c];
      if (channel.target_path != "weights") continue;
      const std::string who = fmt::format("{}, channel {}", titled("animation", index, animation.name), c);
      const auto targets = targetsOfNode_.find(channel.target_node);
      if (targets == targetsOfNode_.end() || targets->second.declared == 0) {
        badChannels_.add(fmt::format("{}: node {} shows no morph targets", who, channel.target_node));
        continue;
      }
      if (animated[channel.target_node]) {
        badChannels_.add(fmt::format("{}: another channel already animates node {}", who, channel.target_node));
        continue;
      }
      Result<MorphWeightTrack> track = readTrack(animation, channel, targets->second, who);
      if (!track) {
        badChannels_.add(plain(track.error()));
        continue;
      }
      animated[channel.target_node] = true;
      if (track->targetCount > 0) scene_.clips[index].weights.push_back(std::move(*track));
    }
  }

  [[nodiscard]] Result<MorphWeightTrack> readTrack(const tinygltf::Animation& animation,
                                                   const tinygltf::AnimationChannel& channel,
                                                   const NodeTargets& targets, const std::string& who) {
    LORICA_TRY(const GltfKeys keys, accessors_.keys(animation, channel.sampler, 1, who));
    const auto& [interpolation, times, values] = keys;
    MorphWeightTrack track;
    track.firstTarget = targets.first;
    track.targetCount = targets.listed;
    track.interpolation = interpolation;
    const std::size_t lists = keys.listsPerKey();
    const std::size_t declared = targets.declared;
    const std::size_t listed = targets.listed;
    if (values.size() != lists * declared * times.size()) {
      return badFormat("{}: {} for {} of {}, expected {}", who, counted(std::ssize(values), "value"),
                       counted(std::ssize(times), "key"), counted(std::int64_t(declared), "morph target"),
                       grouped(lists * declared * times.size()));
    }
    track.times.reserve(times.size());
    track.values.reserve(lists * listed * times.size());
    for (std::size_t key = 0; key < times.size(); ++key) {
      if (!track.times.empty() && times[key] <= track.times.back()) {
        ++lateKeys_;
        continue;
      }
      track.times.push_back(times[key]);
      for (std::size_t list = 0; list < lists; ++list) {
        const double* from = values.data() + (key * lists + list) * declared;
        for (std::size_t t = 0; t < listed; ++t) track.values.push_back(from[t]);
      }
    }
    return track;
  }

  const GltfDocument& document_;
  GltfAccessors& accessors_;
  FileScene& scene_;
  std::map<int, NodeTargets> targetsOfNode_;
  std::uint64_t beyondLimit_ = 0;
  Skipped badTargets_;
  Skipped badChannels_;
  std::uint64_t lateKeys_ = 0;
  List positions_;  // read last
  List normals_;
};

}  // namespace

void addGltfMorphs(const GltfDocument& document, GltfAccessors& accessors, FileScene& scene) {
  MorphReader(document, accessors, scene).read();
}

}  // namespace lorica

#include "skinning/import/gltf_clips.h"

#include "geometry/errors.h"

#include <fmt/format.h>

#include <map>

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
    LORICA_TRY_DO(checkIndex(document_, channel.sampler, animation_.samplers.size(), user, "sampler"));
    const tinygltf::AnimationSampler& sampler = animation_.samplers[channel.sampler];
    KeyTrack<Value> track;
    if (sampler.interpolation == "STEP") {
      track.interpolation = KeyInterpolation::kStep;
    } else if (sampler.interpolation == "CUBICSPLINE") {
      track.interpolation = KeyInterpolation::kCubicSpline;
    } else if (sampler.interpolation != "LINEAR") {
      return badFormat("{}: {}: interpolation '{}', expected STEP, LINEAR or CUBICSPLINE", document_.name, user,
                       sampler.interpolation);
    }
    LORICA_TRY(const std::vector<double> times, accessors_.numbers(sampler.input, 1, user + ": times"));
    LORICA_TRY(const std::vector<double> values, accessors_.numbers(sampler.output, components, user + ": values"));
    const std::size_t perKey = track.interpolation == KeyInterpolation::kCubicSpline ? 3 : 1;
    const std::size_t valueCount = values.size() / components;
    if (valueCount != perKey * times.size()) {
      return badFormat("{}: {}: {} values for {} keys, expected {}", document_.name, user, grouped(valueCount),
                       grouped(times.size()), grouped(perKey * times.size()));
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

}  // namespace

Result<void> addGltfClips(const GltfDocument& document, GltfAccessors& accessors, FileScene& scene) {
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
  const auto note = [&](std::uint64_t count, const char* what) {
    if (count > 0) scene.notes.push_back(fmt::format("{} {}", grouped(count), what));
  };
  note(unknownChannels, "animation channels animate something other than nodes: skipped");
  note(doubledChannels, "animation channels animate what another already animates: skipped");
  note(lateKeys, "animation keys are not later than the previous key: skipped");
  return {};
}

}  // namespace lorica

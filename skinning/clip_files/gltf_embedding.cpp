#include "skinning/clip_files/gltf_embedding.h"

#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/json.h"
#include "skinning/import/file_scene.h"
#include "skinning/import/gltf_document.h"
#include "skinning/import/uri.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

namespace lorica {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMaxFallback = std::uint64_t{1} << 28;  ///< bytes

/// Changes the number of a buffer into bytes of the one buffer.
class BufferMerger {
 public:
  BufferMerger(GltfWriter& writer, const GltfDocument& file) : writer_(writer), file_(file) {}

  [[nodiscard]] Result<void> merge() {
    const Json buffers = writer_.document.value("buffers", Json::array());
    for (std::size_t b = 0; b < buffers.size(); ++b) {  // what the reader has decompressed comes after these
      const std::span<const std::byte> bytes = file_.buffers[b];
      const auto length = buffers[b]["byteLength"].get<std::uint64_t>();
      // For programs without meshopt, whose views must lie in a buffer although it has no content.
      const bool fallback = bytes.empty() && buffers[b].contains("extensions") && length <= kMaxFallback;
      if (bytes.size() < length && !fallback) return unsupported("{}: buffer {} has no content", file_.name, b);
      while (writer_.binary.size() % 4 != 0) writer_.binary.push_back('\0');
      begin_.push_back(writer_.binary.size());
      writer_.binary.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      if (fallback) writer_.binary.append(length, '\0');
    }
    if (begin_.size() <= 1) return {};
    const auto views = writer_.document.find("bufferViews");
    if (views == writer_.document.end()) return {};
    for (Json& view : *views) {
      move(view);
      const auto extensions = view.find("extensions");  // compressed copies of the view
      if (extensions == view.end() || !extensions->is_object()) continue;
      for (Json& extension : *extensions) move(extension);
    }
    return {};
  }

 private:
  void move(Json& reference) {
    const auto buffer = reference.is_object() ? reference.find("buffer") : reference.end();
    if (buffer == reference.end() || !buffer->is_number_unsigned()) return;
    const auto b = buffer->get<std::size_t>();
    if (b >= begin_.size()) return;
    *buffer = 0;
    const auto offset = reference.find("byteOffset");
    const std::size_t within = offset == reference.end() ? 0 : offset->get<std::size_t>();
    reference["byteOffset"] = begin_[b] + within;
  }

  GltfWriter& writer_;
  const GltfDocument& file_;
  std::vector<std::size_t> begin_;
};

/// The kind of a picture by its first bytes; empty if unknown.
[[nodiscard]] std::string mimeTypeOf(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG")) return "image/png";
  if (bytes.starts_with("\xFF\xD8\xFF")) return "image/jpeg";
  if (bytes.starts_with("RIFF") && bytes.substr(0, 12).ends_with("WEBP")) return "image/webp";
  if (bytes.starts_with("\xABKTX 20")) return "image/ktx2";
  return {};
}

/// Takes the pictures of other files into the buffer.
void embedPictures(GltfWriter& writer, const NamedFiles& files, std::vector<std::string>& notes) {
  const auto images = writer.document.find("images");
  if (images == writer.document.end() || !images->is_array()) return;
  for (Json& image : *images) {
    const auto uri = image.is_object() ? image.find("uri") : image.end();
    if (uri == image.end() || !uri->is_string()) continue;
    const std::string text = uri->get<std::string>();
    if (isDataUri(text)) continue;
    const Result<std::filesystem::path> file = files.find(percentDecoded(text));
    const Result<std::string> content = file ? readFile(*file, NamedBy::kFile) : file.error();
    const std::string kind = content ? mimeTypeOf(*content) : std::string();
    if (kind.empty()) {
      notes.push_back(
          fmt::format("the picture '{}' was not found or is of an unknown kind: the output refers to it", text));
      continue;
    }
    image.erase("uri");
    image["mimeType"] = kind;
    image["bufferView"] = writer.addView(*content);
  }
}

/// The same motion of a skeleton that rests as the file's nodes do, which may be in another pose than the character:
/// that has its skin's bind pose. None if all agree.
[[nodiscard]] std::optional<SkeletalMotion> restingAsSaved(const SkeletalMotion& motion, const Json& fileNodes,
                                                           std::span<const int> nodes) {
  bool differs = false;
  std::vector<Joint> joints(motion.skeleton.joints().begin(), motion.skeleton.joints().end());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (nodes[j] == -1) continue;
    const Json& node = fileNodes[nodes[j]];
    FileNode saved;
    const auto read = [&](const char* key, auto& numbers) {
      const auto list = node.find(key);
      if (list == node.end() || std::ssize(*list) != numbers.size()) return false;
      for (Eigen::Index i = 0; i < numbers.size(); ++i) numbers.data()[i] = (*list)[i].template get<double>();
      return true;
    };
    Mat4 matrix;
    if (read("matrix", matrix)) {
      setMatrix(saved, Affine3(Eigen::Matrix<double, 3, 4>(matrix.topRows<3>())));
    } else {
      read("translation", saved.local.translation);
      read("scale", saved.local.scale);
      read("rotation", saved.local.rotation.coeffs());
      const double norm = saved.local.rotation.norm();
      saved.local.rotation = norm > 1e-12 ? saved.local.rotation.normalized() : Quat::Identity();
    }
    JointTransform& rest = joints[j].rest;
    if (saved.inner || saved.local.matrix().isApprox(rest.matrix(), 1e-9)) continue;
    rest = saved.local;
    differs = true;
  }
  if (!differs) return std::nullopt;
  Result<Skeleton> skeleton = Skeleton::create(std::move(joints));
  LORICA_CHECK(skeleton.ok(), "reading the file has checked its nodes");
  return SkeletalMotion{motion.name, std::move(*skeleton), motion.times, motion.poses};
}

/// Less is the noise of double precision, not motion. Of lengths: relative to the skeleton's largest translation.
constexpr double kStill = 1e-9;

[[nodiscard]] Result<void> checkFinite(const SkeletalMotion& motion) {
  for (int f = 0; f < motion.frameCount(); ++f) {
    const std::span<const JointTransform> pose = motion.pose(f);
    for (std::size_t j = 0; j < pose.size(); ++j) {
      const JointTransform& t = pose[j];
      const bool finite = t.translation.cast<float>().allFinite() && t.rotation.coeffs().allFinite() &&
                          t.scale.cast<float>().allFinite();
      if (finite && std::isfinite(motion.times[f])) continue;
      return invalidArgument("frame {}: the pose of joint '{}' is not finite", f + 1, motion.skeleton.joint(j).name);
    }
  }
  return {};
}

/// One property of one joint over all keys.
struct Channel {
  const char* path;
  const char* type;
  std::vector<float> values;
};

class AnimationWriter {
 public:
  AnimationWriter(GltfWriter& writer, const SkeletalMotion& motion) : writer_(writer), motion_(motion) {
    // Times that are the same as floats are one key.
    for (int f = 0; f < motion.frameCount(); ++f) {
      const float time = motion.times[f] - motion.times.front();
      if (!times_.empty() && !(time > times_.back())) continue;
      times_.push_back(time);
      frames_.push_back(f);
    }
    for (const Joint& joint : motion.skeleton.joints()) {
      still_ = std::max(still_, kStill * joint.rest.translation.norm());
    }
  }

  /// What of a joint moves.
  [[nodiscard]] std::vector<Channel> channelsOf(JointIndex joint) const {
    std::vector<Channel> channels;
    if (moves(joint, [&](const JointTransform& a, const JointTransform& b) {
          return (a.translation - b.translation).norm() > still_;
        })) {
      channels.push_back({"translation", "VEC3", vectors(joint, &JointTransform::translation)});
    }
    if (moves(joint, [](const JointTransform& a, const JointTransform& b) {
          const Eigen::Vector4d same = (a.rotation.dot(b.rotation) < 0.0 ? -1.0 : 1.0) * b.rotation.coeffs();
          return (a.rotation.coeffs() - same).norm() > kStill;
        })) {
      channels.push_back({"rotation", "VEC4", rotations(joint)});
    }
    if (moves(joint,
              [](const JointTransform& a, const JointTransform& b) { return (a.scale - b.scale).norm() > kStill; })) {
      channels.push_back({"scale", "VEC3", vectors(joint, &JointTransform::scale)});
    }
    return channels;
  }

  /// Rotations that stay at rest: an animation must have a channel.
  [[nodiscard]] Channel restOf(JointIndex joint) const { return {"rotation", "VEC4", rotations(joint)}; }

  void add(int node, const Channel& channel) {
    if (timesAccessor_ == -1) timesAccessor_ = writer_.addNumbers(times_, "SCALAR", true);
    const int output = writer_.addNumbers(channel.values, channel.type);
    channels_.push_back({{"sampler", samplers_.size()}, {"target", {{"node", node}, {"path", channel.path}}}});
    samplers_.push_back({{"input", timesAccessor_}, {"output", output}, {"interpolation", "LINEAR"}});
  }

  [[nodiscard]] bool empty() const { return channels_.empty(); }

  /// First in the list, because many programs play the first animation.
  void finish() {
    Json animation = {{"name", motion_.name}, {"channels", std::move(channels_)}, {"samplers", std::move(samplers_)}};
    Json& all = writer_.document["animations"];
    if (!all.is_array()) all = Json::array();
    all.insert(all.begin(), std::move(animation));
  }

 private:
  template <typename Differ>
  [[nodiscard]] bool moves(JointIndex joint, const Differ& differ) const {
    const JointTransform& rest = motion_.skeleton.joint(joint).rest;
    return std::any_of(frames_.begin(), frames_.end(), [&](int f) { return differ(motion_.pose(f)[joint], rest); });
  }

  [[nodiscard]] std::vector<float> vectors(JointIndex joint, Vec3 JointTransform::*property) const {
    std::vector<float> values;
    for (const int f : frames_) {
      const Vec3f v = (motion_.pose(f)[joint].*property).cast<float>();
      values.insert(values.end(), v.data(), v.data() + 3);
    }
    return values;
  }

  /// Each on the side of the one before, for programs that do not take the shorter arc themselves.
  [[nodiscard]] std::vector<float> rotations(JointIndex joint) const {
    std::vector<float> values;
    Quat before = motion_.skeleton.joint(joint).rest.rotation;
    for (const int f : frames_) {
      Quat q = motion_.pose(f)[joint].rotation.normalized();
      if (q.dot(before) < 0.0) q.coeffs() = -q.coeffs();
      before = q;
      const Eigen::Vector4f xyzw = q.coeffs().cast<float>();
      values.insert(values.end(), xyzw.data(), xyzw.data() + 4);
    }
    return values;
  }

  GltfWriter& writer_;
  const SkeletalMotion& motion_;
  std::vector<float> times_;
  std::vector<int> frames_;  ///< of the keys
  double still_ = 0.0;       ///< of translations
  int timesAccessor_ = -1;
  Json channels_ = Json::array();
  Json samplers_ = Json::array();
};

}  // namespace

Result<GltfWriter> embedGltf(std::span<const std::byte> bytes, const std::string& name, const NamedFiles& files,
                             std::vector<std::string>& notes) {
  LORICA_TRY(const GltfDocument file, parseGltf(bytes, name, files));
  LORICA_TRY(const GltfParts parts, splitGltf(bytes, name));
  GltfWriter writer;
  LORICA_TRY(writer.document, parseJson<Json>(parts.json, name));
  LORICA_TRY_DO(BufferMerger(writer, file).merge());
  embedPictures(writer, files, notes);
  return writer;
}

Result<void> addAnimation(GltfWriter& writer, const SkeletalMotion& motion, std::span<const int> nodes) {
  LORICA_TRY_DO(checkFinite(motion));
  AnimationWriter animation(writer, motion);
  JointIndex anyNode = kNoJoint;
  for (JointIndex j = 0; j < motion.skeleton.jointCount(); ++j) {
    if (nodes[j] != -1 && anyNode == kNoJoint) anyNode = j;
    const std::vector<Channel> channels = animation.channelsOf(j);
    if (nodes[j] == -1 && !channels.empty()) {
      return unsupported("joint '{}' moves, but its node is sheared, which an animation of glTF cannot hold",
                         motion.skeleton.joint(j).name);
    }
    for (const Channel& channel : channels) animation.add(nodes[j], channel);
  }
  if (animation.empty()) animation.add(nodes[anyNode], animation.restOf(anyNode));
  animation.finish();
  return {};
}

Result<void> addAnimationToFile(GltfWriter& writer, const SkeletalMotion& performed, std::span<const int> nodeOfJoint) {
  std::vector<int> nodes(nodeOfJoint.begin(), nodeOfJoint.end());
  for (JointIndex j = 0; j < performed.skeleton.jointCount(); ++j) {
    const JointIndex parent = performed.skeleton.joint(j).parent;
    // The second half of a sheared node, whose matrix is not a transform of this joint alone.
    if (parent != kNoJoint && nodeOfJoint[parent] == -1) nodes[j] = -1;
  }
  const std::optional<SkeletalMotion> saved = restingAsSaved(performed, writer.document["nodes"], nodes);
  const SkeletalMotion& motion = saved ? *saved : performed;
  LORICA_TRY_DO(addAnimation(writer, motion, nodes));
  for (const Json& channel : writer.document["animations"][0]["channels"]) {
    const int index = channel["target"]["node"].get<int>();
    Json& node = writer.document["nodes"][index];
    if (node.erase("matrix") == 0) continue;
    const auto joint = std::find(nodes.begin(), nodes.end(), index) - nodes.begin();
    const JointTransform& rest = motion.skeleton.joint(joint).rest;
    node["translation"] = listOf(rest.translation);
    node["rotation"] = listOf(rest.rotation);
    node["scale"] = listOf(rest.scale);
  }
  return {};
}

}  // namespace lorica

#include "skinning/clip_files/gltf_animation.h"

#include "geometry/errors.h"

#include <algorithm>
#include <cmath>

namespace lorica {

namespace {

using Json = nlohmann::ordered_json;

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
    Json sampler;
    sampler["input"] = timesAccessor_;
    sampler["output"] = writer_.addNumbers(channel.values, channel.type);
    sampler["interpolation"] = "LINEAR";
    Json made;
    made["sampler"] = samplers_.size();
    made["target"]["node"] = node;
    made["target"]["path"] = channel.path;
    samplers_.push_back(std::move(sampler));
    channels_.push_back(std::move(made));
  }

  [[nodiscard]] bool empty() const { return channels_.empty(); }

  /// First in the list, because many programs play the first animation.
  void finish() {
    Json animation;
    animation["name"] = motion_.name;
    animation["channels"] = std::move(channels_);
    animation["samplers"] = std::move(samplers_);
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

}  // namespace lorica

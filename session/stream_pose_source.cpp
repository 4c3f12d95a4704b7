#include "session/stream_pose_source.h"

#include "capture/retarget/stream_retarget.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

namespace lorica {
namespace {

class ProxyPoseSource final : public PoseSource {
 public:
  ProxyPoseSource(ProxySkeleton proxy, std::unique_ptr<PoseSource> source)
      : proxy_(std::move(proxy)), source_(std::move(source)), pose_(restPose(proxy_.skeleton())) {}

  Result<std::optional<double>> next(std::span<JointTransform> pose) override {
    Result<std::optional<double>> time = source_->next(pose_);
    if (time && time->has_value()) proxy_.mapBack(pose_, pose);
    const std::span<const double> trust = source_->trust();
    trust_.resize(trust.empty() ? 0 : pose.size());
    for (std::size_t j = 0; j < trust_.size(); ++j) {
      trust_[j] = trust[proxy_.proxyOf(j)];
    }
    return time;
  }

  [[nodiscard]] std::optional<double> smoothingDelay() const override { return source_->smoothingDelay(); }
  [[nodiscard]] std::span<const double> trust() const override { return trust_; }
  [[nodiscard]] std::span<const NamedWeight> expressions() const override { return source_->expressions(); }
  [[nodiscard]] double waited() const override { return source_->waited(); }
  [[nodiscard]] bool present() const override { return source_->present(); }
  [[nodiscard]] bool refusedLegs() const override { return source_->refusedLegs(); }

 private:
  ProxySkeleton proxy_;
  std::unique_ptr<PoseSource> source_;
  Pose pose_;                  ///< of the proxy skeleton
  std::vector<double> trust_;  ///< of the character's joints
};

/// A session goes on at least this often [s].
constexpr double kLongestWait = 1.0 / 30.0;
constexpr double kSilentSeconds = 0.5;
constexpr double kRecoverSeconds = 0.3;

class StreamPoseSource final : public PoseSource {
 public:
  StreamPoseSource(const Skeleton& skeleton, StreamRetargeter retargeter, std::unique_ptr<BoneStream> stream,
                   const StreamSettings& settings)
      : skeleton_(skeleton),
        retargeter_(std::move(retargeter)),
        stream_(std::move(stream)),
        settings_(settings),
        trust_(skeleton.jointCount(), 0.0) {}

  Result<std::optional<double>> next(std::span<JointTransform> pose) override {
    const auto begin = std::chrono::steady_clock::now();
    const bool isNew = stream_->wait(settings_.waits ? kLongestWait : 0.0, frame_);
    waited_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (!isNew && stream_->ended()) return std::optional<double>();
    const double now = stream_->now();
    if (isNew) {
      received_ = true;
      if (settings_.sender) settings_.sender->apply(frame_.pose);
      if (settings_.mirror) frame_.pose = mirrored(frame_.pose);
      expressions_ = settings_.mirror ? mirroredExpressions_.of(frame_.expressions) : frame_.expressions;
    }
    const double time = std::max(isNew ? frame_.time : now, time_);
    const bool known = received_ && frame_.tracking && now - frame_.time < kSilentSeconds;
    retargeter_.apply(frame_.pose, time, known, pose);
    updateTrust(known, time - time_);
    time_ = time;
    return std::optional<double>(time);
  }

  [[nodiscard]] std::span<const double> trust() const override { return trust_; }
  [[nodiscard]] std::span<const NamedWeight> expressions() const override { return expressions_; }
  [[nodiscard]] double waited() const override { return waited_; }

 private:
  /// Joints have their parents' trust, and none from the first bone of a limb on that is not sent.
  void updateTrust(bool known, double step) {
    const std::span<const Joint> joints = skeleton_.joints();
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const JointIndex parent = joints[j].parent;
      const bool above = parent == kNoJoint ? known : trust_[parent] > 0.0;
      const bool sure = above && !isGuessed(joints[j].bone);
      trust_[j] = sure ? std::min(1.0, trust_[j] + std::max(step, kLeastTrust) / kRecoverSeconds) : 0.0;
    }
  }

  [[nodiscard]] bool isGuessed(const std::optional<HumanBone>& bone) const {
    if (!bone || frame_.pose.rotation[static_cast<std::size_t>(*bone)]) return false;
    return std::any_of(limbs().begin(), limbs().end(),
                       [&](const LimbBones& limb) { return *bone == limb.upper || *bone == limb.lower; });
  }

  static constexpr double kLeastTrust = 1e-6;

  Skeleton skeleton_;
  StreamRetargeter retargeter_;
  std::unique_ptr<BoneStream> stream_;
  StreamSettings settings_;
  BoneFrame frame_;
  MirroredExpressions mirroredExpressions_;
  std::span<const NamedWeight> expressions_;  ///< of the last frame
  bool received_ = false;
  double time_ = 0.0;
  double waited_ = 0.0;
  std::vector<double> trust_;  ///< one per joint
};

}  // namespace

std::string mirroredExpression(std::string_view name) {
  using Sides = std::pair<std::string_view, std::string_view>;
  constexpr std::array<Sides, 5> kSides = {
      {{"Left", "Right"}, {"left", "right"}, {"LEFT", "RIGHT"}, {"_L", "_R"}, {"_l", "_r"}}};
  const auto swapped = [&](std::string_view side, std::string_view other) {
    return std::string(name.substr(0, name.size() - side.size())).append(other);
  };
  for (const auto& [left, right] : kSides) {
    if (name.ends_with(left)) return swapped(left, right);
    if (name.ends_with(right)) return swapped(right, left);
  }
  return std::string(name);
}

std::span<const NamedWeight> MirroredExpressions::of(std::span<const NamedWeight> sent) {
  const bool same = std::equal(sent.begin(), sent.end(), names_.begin(), names_.end(),
                               [](const NamedWeight& one, const std::string& name) { return one.name == name; });
  if (!same) {
    names_.clear();
    mirrored_.clear();
    for (const NamedWeight& one : sent) {
      names_.push_back(one.name);
      mirrored_.push_back({mirroredExpression(one.name), 0.0f});
    }
  }
  for (std::size_t i = 0; i < sent.size(); ++i) mirrored_[i].weight = sent[i].weight;
  return mirrored_;
}

std::unique_ptr<PoseSource> makeProxyPoseSource(ProxySkeleton proxy, std::unique_ptr<PoseSource> source) {
  return std::make_unique<ProxyPoseSource>(std::move(proxy), std::move(source));
}

Result<std::unique_ptr<PoseSource>> makeStreamPoseSource(const Character& character, std::unique_ptr<BoneStream> stream,
                                                         const StreamSettings& settings) {
  LORICA_CHECK(stream != nullptr, "a stream pose source needs a stream");
  LORICA_TRY(ProxySkeleton proxy, ProxySkeleton::create(character));
  LORICA_TRY(StreamRetargeter retargeter, StreamRetargeter::create(proxy.skeleton()));
  auto source =
      std::make_unique<StreamPoseSource>(proxy.skeleton(), std::move(retargeter), std::move(stream), settings);
  if (proxy.isOwn()) return std::unique_ptr<PoseSource>(std::move(source));
  return makeProxyPoseSource(std::move(proxy), std::move(source));
}

}  // namespace lorica

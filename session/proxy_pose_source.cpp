#include "session/proxy_pose_source.h"

#include <utility>
#include <vector>

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

}  // namespace

std::unique_ptr<PoseSource> makeProxyPoseSource(ProxySkeleton proxy, std::unique_ptr<PoseSource> source) {
  return std::make_unique<ProxyPoseSource>(std::move(proxy), std::move(source));
}

}  // namespace lorica

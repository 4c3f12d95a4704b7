#include "session/pose_faults.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "geometry/errors.h"

namespace lorica {
namespace {

class FaultyPoses final : public PoseSource {
 public:
  FaultyPoses(std::unique_ptr<PoseSource> source, const FaultSettings& settings)
      : source_(std::move(source)), frames_(settings) {}

  Result<std::optional<double>> next(std::span<JointTransform> pose) override {
    if (inner_.pose.empty()) inner_.pose.assign(pose.begin(), pose.end());
    Result<std::optional<double>> time = take();
    if (!time || !time->has_value()) return time;
    taken_ = inner_;
    overtake(**time);
    if (!frames_.frozen() || !started_) shown_ = taken_;
    started_ = true;
    std::copy(shown_.pose.begin(), shown_.pose.end(), pose.begin());
    return time;
  }

  [[nodiscard]] std::span<const double> trust() const override { return shown_.trust; }
  [[nodiscard]] std::span<const NamedWeight> expressions() const override { return shown_.expressions; }
  [[nodiscard]] double waited() const override { return source_->waited(); }
  [[nodiscard]] bool present() const override { return source_->present(); }

 private:
  /// What a source gave at once.
  struct Frame {
    Pose pose;
    std::vector<double> trust;
    std::vector<NamedWeight> expressions;
  };

  Result<std::optional<double>> take() {
    if (!ahead_) {
      Result<std::optional<double>> time = source_->next(inner_.pose);
      inner_.trust.assign(source_->trust().begin(), source_->trust().end());
      inner_.expressions.assign(source_->expressions().begin(), source_->expressions().end());
      return time;
    }
    Result<std::optional<double>> time = std::move(*ahead_);
    ahead_.reset();
    return time;
  }

  void overtake(double& time) {
    const double lateness = frames_.lateness();
    if (lateness == 0.0) return;
    double last = time;
    time += lateness;
    for (int i = 0; i < kMaxOvertaken; ++i) {
      ahead_ = take();
      if (!*ahead_ || !(*ahead_)->has_value()) return;
      const double next = ***ahead_;
      if (next > time) return;
      ahead_.reset();
      if (next <= last) return;  // the same frame again: a stream has no newer one in this step
      last = next;
    }
  }

  std::unique_ptr<PoseSource> source_;
  FrameFaults frames_;
  std::optional<Result<std::optional<double>>> ahead_;  ///< the time of inner_ if it was not shown yet
  Frame inner_;                                         ///< the last one of the source
  Frame taken_;                                         ///< the one of this time
  Frame shown_;                                         ///< the last one that was not frozen
  bool started_ = false;
};

}  // namespace

Result<std::unique_ptr<PoseSource>> makePoseFaults(std::unique_ptr<PoseSource> source, const FaultSettings& settings) {
  LORICA_CHECK(source != nullptr, "pose faults need a source");
  if (settings.ofJoints()) {
    return invalidArgument(
        "dropout, jitter and swap apply to tracked joints, not to motions of bones; expected late or freeze");
  }
  if (!settings.any()) return source;
  return std::unique_ptr<PoseSource>(std::make_unique<FaultyPoses>(std::move(source), settings));
}

}  // namespace lorica

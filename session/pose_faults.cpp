#include "session/pose_faults.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace lorica {
namespace {

class FaultyPoses final : public PoseSource {
 public:
  FaultyPoses(std::unique_ptr<PoseSource> source, const FaultSettings& settings)
      : source_(std::move(source)), frames_(settings) {}

  Result<std::optional<double>> next(std::span<JointTransform> pose) override {
    if (inner_.empty()) {
      inner_.assign(pose.begin(), pose.end());
      shown_ = inner_;
      taken_ = inner_;
    }
    Result<std::optional<double>> time = take();
    if (!time || !time->has_value()) return time;
    taken_ = inner_;
    overtake(**time);
    if (!frames_.frozen() || !started_) shown_ = taken_;
    started_ = true;
    std::copy(shown_.begin(), shown_.end(), pose.begin());
    return time;
  }

  [[nodiscard]] double waited() const override { return source_->waited(); }

 private:
  Result<std::optional<double>> take() {
    if (!ahead_) return source_->next(inner_);
    Result<std::optional<double>> time = std::move(*ahead_);
    ahead_.reset();
    return time;
  }

  void overtake(double& time) {
    const double lateness = frames_.lateness();
    if (lateness == 0.0) return;
    time += lateness;
    for (int i = 0; i < kMaxOvertaken; ++i) {
      ahead_ = take();
      if (!*ahead_ || !(*ahead_)->has_value() || ***ahead_ > time) return;
      ahead_.reset();
    }
  }

  std::unique_ptr<PoseSource> source_;
  FrameFaults frames_;
  std::optional<Result<std::optional<double>>> ahead_;  ///< the time of inner_ if it was not shown yet
  Pose inner_;                                          ///< last pose of the source
  Pose taken_;                                          ///< pose of this frame
  Pose shown_;                                          ///< last pose that was not frozen
  bool started_ = false;
};

}  // namespace

Result<std::unique_ptr<PoseSource>> makePoseFaults(std::unique_ptr<PoseSource> source, const FaultSettings& settings) {
  LORICA_CHECK(source != nullptr, "pose faults need a source");
  if (settings.ofJoints()) {
    return Error{ErrorCode::kInvalidArgument,
                 "dropout, jitter and swap apply to tracked joints, not to motions of bones; expected late or freeze"};
  }
  if (!settings.any()) return source;
  return std::unique_ptr<PoseSource>(std::make_unique<FaultyPoses>(std::move(source), settings));
}

}  // namespace lorica

#include "session/treated_source.h"

#include "geometry/errors.h"
#include "geometry/work_budgets.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace lorica {
namespace {

class LoggedJoints final : public SkeletonSource {
 public:
  LoggedJoints(std::unique_ptr<SkeletonSource> source, std::shared_ptr<SourceLog> log)
      : source_(std::move(source)), log_(std::move(log)) {}

  Result<std::optional<SkeletonFrame>> next() override {
    Result<std::optional<SkeletonFrame>> frame = source_->next();
    if (frame && frame->has_value()) log_->joints.push_back(**frame);
    return frame;
  }

 private:
  std::unique_ptr<SkeletonSource> source_;
  std::shared_ptr<SourceLog> log_;
};

class LoggedPoses final : public PoseSource {
 public:
  LoggedPoses(std::unique_ptr<PoseSource> source, std::shared_ptr<SourceLog> log)
      : source_(std::move(source)), log_(std::move(log)) {}

  Result<std::optional<double>> next(std::span<JointTransform> pose) override {
    Result<std::optional<double>> time = source_->next(pose);
    if (time && time->has_value()) {
      log_->poseTimes.push_back(**time);
      log_->poses.insert(log_->poses.end(), pose.begin(), pose.end());
      log_->trust.insert(log_->trust.end(), source_->trust().begin(), source_->trust().end());
      putExpressions(source_->expressions(), log_->expressions);
    }
    return time;
  }
  [[nodiscard]] std::optional<double> smoothingDelay() const override { return source_->smoothingDelay(); }
  [[nodiscard]] std::span<const double> trust() const override { return source_->trust(); }
  [[nodiscard]] std::span<const NamedWeight> expressions() const override { return source_->expressions(); }
  [[nodiscard]] double waited() const override { return source_->waited(); }
  [[nodiscard]] bool present() const override { return source_->present(); }

 private:
  std::unique_ptr<PoseSource> source_;
  std::shared_ptr<SourceLog> log_;
};

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

void putExpressions(std::span<const NamedWeight> expressions, ByteWriter& bytes) {
  const auto fits = [](const NamedWeight& one) { return one.name.size() <= kMaxExpressionName; };
  const auto fitting = static_cast<std::size_t>(std::count_if(expressions.begin(), expressions.end(), fits));
  std::size_t left = std::min(fitting, kMaxPoseExpressions);
  bytes.put(static_cast<std::uint16_t>(left));
  for (const NamedWeight& one : expressions) {
    if (left == 0) return;
    if (!fits(one)) continue;
    bytes.put(static_cast<std::uint8_t>(one.name.size()));
    bytes.put(std::string_view(one.name));
    bytes.put(one.weight);
    --left;
  }
}

std::unique_ptr<SkeletonSource> makeLoggedSource(std::unique_ptr<SkeletonSource> source,
                                                 std::shared_ptr<SourceLog> log) {
  LORICA_CHECK(source != nullptr && log != nullptr, "logging needs a source and a log");
  return std::make_unique<LoggedJoints>(std::move(source), std::move(log));
}

std::unique_ptr<PoseSource> makeLoggedSource(std::unique_ptr<PoseSource> source, std::shared_ptr<SourceLog> log) {
  LORICA_CHECK(source != nullptr && log != nullptr, "logging needs a source and a log");
  return std::make_unique<LoggedPoses>(std::move(source), std::move(log));
}

Result<std::unique_ptr<PoseSource>> makePoseFaults(std::unique_ptr<PoseSource> source, const FaultSettings& settings) {
  LORICA_CHECK(source != nullptr, "pose faults need a source");
  if (settings.ofJoints()) {
    return invalidArgument(
        "dropout, jitter and swap apply to tracked joints, not to motions of bones; expected late or freeze");
  }
  if (!settings.any()) return source;
  return std::unique_ptr<PoseSource>(std::make_unique<FaultyPoses>(std::move(source), settings));
}

Result<std::unique_ptr<PoseSource>> makeTreatedSource(const Character& character,
                                                      std::unique_ptr<SkeletonSource> joints,
                                                      const SourceTreatment& treatment) {
  LORICA_TRY_DO(checkFaults(treatment.faults));
  if (treatment.log) joints = makeLoggedSource(std::move(joints), treatment.log);
  if (treatment.faults.any()) joints = makeFaultInjector(std::move(joints), treatment.faults);
  return makeJointPoseSource(character, std::move(joints), treatment.joints);
}

Result<std::unique_ptr<PoseSource>> makeTreatedSource(std::unique_ptr<PoseSource> poses,
                                                      const SourceTreatment& treatment) {
  LORICA_TRY_DO(checkFaults(treatment.faults));
  if (treatment.log) poses = makeLoggedSource(std::move(poses), treatment.log);
  return makePoseFaults(std::move(poses), treatment.faults);
}

}  // namespace lorica

#include "session/treated_source.h"

#include "geometry/work_budgets.h"
#include "session/pose_faults.h"

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

#include "session/recording/session_replay.h"

#include "capture/files/joint_csv.h"
#include "geometry/errors.h"
#include "session/session_springs.h"
#include "session/treated_source.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace lorica {
namespace {

/// Recorded poses with the trust that they had.
class RecordedPoses final : public PoseSource {
 public:
  /// @param trust        one for each joint of each pose; empty = all trusted
  /// @param expressions  of each pose; empty = none
  RecordedPoses(SkeletalMotion motion, std::vector<double> trust, std::vector<std::vector<NamedWeight>> expressions)
      : joints_(motion.skeleton.jointCount()),
        poses_(makeMotionPoseSource(std::move(motion))),
        trust_(std::move(trust)),
        expressions_(std::move(expressions)) {}

  Result<std::optional<double>> next(std::span<JointTransform> pose) override {
    Result<std::optional<double>> time = poses_->next(pose);
    if (time && time->has_value()) ++read_;
    return time;
  }
  [[nodiscard]] std::span<const double> trust() const override {
    if (trust_.empty() || read_ == 0) return {};
    return std::span(trust_).subspan((read_ - 1) * joints_, joints_);
  }
  [[nodiscard]] std::span<const NamedWeight> expressions() const override {
    if (expressions_.empty() || read_ == 0) return {};
    return expressions_[read_ - 1];
  }

 private:
  std::size_t joints_;
  std::unique_ptr<PoseSource> poses_;
  std::vector<double> trust_;
  std::vector<std::vector<NamedWeight>> expressions_;
  std::size_t read_ = 0;
};

}  // namespace

Result<std::unique_ptr<PoseSource>> SessionReplay::source(const SessionFile& recorded, const Character& character,
                                                          std::size_t avatar) {
  const AvatarRecord& header = recorded.header.avatar(avatar);
  const RecordedMotion& motion = recorded.motions[avatar];
  const SourceTreatment treatment{nullptr, header.faults, header.joints};
  if (header.poseJoints == 0) return makeTreatedSource(character, makeRecordedSource(motion.joints), treatment);
  if (header.poseJoints != character.skeleton.jointCount()) {
    return invalidArgument("poses of {} joints were recorded, {} has {}", header.poseJoints, character.name,
                           character.skeleton.jointCount());
  }
  SkeletalMotion poses{header.source, character.skeleton, motion.poseTimes, motion.poses};
  return makeTreatedSource(std::make_unique<RecordedPoses>(std::move(poses), motion.poseTrust, motion.poseExpressions),
                           treatment);
}

void SessionReplay::beforeStep(Session& session) {
  if (over()) return;
  for (std::size_t i = 0; i < recorded_->steps[step_].actions; ++i) session.act(recorded_->actions[action_++]);
}

Result<void> SessionReplay::afterStep(const Session& session, std::span<const WorldAction> /*done*/) {
  if (over()) return {};
  const SessionStep& step = recorded_->steps[step_];
  if (!difference_ && (session.time() != step.time || session.hashes() != step.hashes)) {
    std::vector<std::string> what;
    if (session.time() != step.time) what.emplace_back("time");
    if (session.hashes().hulls != step.hashes.hulls) what.emplace_back("hulls");
    if (session.hashes().props != step.hashes.props) what.emplace_back("props");
    if (session.hashes().particles != step.hashes.particles) what.emplace_back("particles");
    difference_ = Difference{static_cast<int>(step_), step.time, fmt::format("{}", fmt::join(what, " and "))};
  }
  ++step_;
  return {};
}

namespace {

/// @param differs  makes the error
template <typename Differs>
Result<void> checkAvatar(const AvatarRecord& header, const SessionAvatar& avatar, const Differs& differs) {
  if (hashOf(avatar.character()) != header.characterHash) {
    return differs(
        fmt::format("recorded with a character {} that differs from the one found, expected the same mesh, "
                    "skeleton and weights: specify it with --character",
                    header.character));
  }
  if (hashOf(avatar.body().decomposition()) != header.decompositionHash) {
    return differs(
        fmt::format("recorded with another decomposition of {}{}: specify the one that was used with --decomposition",
                    header.character,
                    header.decomposition.empty() ? ", the default one at that time" : ", " + header.decomposition));
  }
  const SessionSprings* springs = avatar.springs();
  if ((springs != nullptr ? std::optional(springs->mode()) : std::nullopt) != header.springs ||
      (springs != nullptr ? springs->hash() : 0) != header.springsHash) {
    return differs(fmt::format("recorded with other springs than those of {}: specify the character with --character",
                               header.character));
  }
  if (hashOf(avatar.training()) != header.trainingHash) {
    return differs("recorded with a decomposition that was trained on other poses: specify it with --decomposition");
  }
  return {};
}

}  // namespace

Result<void> checkReplay(const SessionHeader& header, const std::string& name, const Session& session) {
  const auto differs = [&](const std::string& what) { return invalidArgument("{}: {}", name, what); };
  LORICA_CHECK(session.avatars().size() == header.avatars.size(), "as many avatars as were recorded");
  for (std::size_t a = 0; a < header.avatars.size(); ++a) {
    LORICA_TRY_DO(checkAvatar(header.avatar(a), session.avatars()[a], differs));
  }
  if (hashOf(session.world()) != header.worldHash) {
    return differs(fmt::format(
        "the scene{} differs from the recording: its meshes or the interpretation of scene files have changed",
        header.scene.empty() ? "" : " " + header.scene));
  }
  return {};
}

}  // namespace lorica

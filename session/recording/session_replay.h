#pragma once

#include "session/recording/session_file.h"
#include "session/session.h"

#include <memory>
#include <optional>
#include <string>

namespace lorica {

/// Replays a recorded session: applies the recorded actions in the same steps and compares the results of each step.
class SessionReplay final : public StepWatcher {
 public:
  explicit SessionReplay(std::shared_ptr<const SessionFile> recorded) : recorded_(std::move(recorded)) {}

  /// Source of the recorded joints or poses, with the same processing as in the recording.
  /// @param character  of the recorded avatar
  /// @return the source, or an error if they do not fit the character
  [[nodiscard]] static Result<std::unique_ptr<PoseSource>> source(const SessionFile& recorded,
                                                                  const Character& character, std::size_t avatar = 0);

  /// The first step whose results differ from the recording.
  struct Difference {
    int step = 0;       ///< from 0
    double time = 0.0;  ///< as recorded [s]
    std::string what;   ///< "hulls", "hulls and props"
  };
  [[nodiscard]] const std::optional<Difference>& difference() const { return difference_; }
  [[nodiscard]] int steps() const { return step_; }
  [[nodiscard]] bool over() const { return step_ >= recorded_->steps.size(); }

  void beforeStep(Session& session) override;
  [[nodiscard]] Result<void> afterStep(const Session& session, std::span<const WorldAction> done) override;
  /// Stops the comparison.
  void sessionChanged() override { step_ = recorded_->steps.size(); }

 private:
  std::shared_ptr<const SessionFile> recorded_;
  std::size_t step_ = 0, action_ = 0;
  std::optional<Difference> difference_;
};

/// Checks that characters, decompositions, training ranges and scene are those of the recorded session.
/// @param name  of the session, for the error message
/// @return success, or an error with the difference
[[nodiscard]] Result<void> checkReplay(const SessionHeader& header, const std::string& name, const Session& session);

}  // namespace lorica

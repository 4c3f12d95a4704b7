#pragma once

#include "session/session_file.h"
#include "session/step_watcher.h"

#include <memory>
#include <optional>
#include <string>

namespace lorica {

/// Runs a recorded session again: does to the world what was done, at the same steps, and compares what comes of each.
class SessionReplay final : public StepWatcher {
 public:
  explicit SessionReplay(std::shared_ptr<const SessionFile> recorded) : recorded_(std::move(recorded)) {}

  /// The joints or poses that were recorded, treated as they were then.
  /// @param character  the one that was recorded
  /// @return the source; or that the character cannot be moved by them
  [[nodiscard]] static Result<std::unique_ptr<PoseSource>> source(const SessionFile& recorded,
                                                                  const Character& character);

  /// The first step that came out otherwise.
  struct Difference {
    int step = 0;       ///< from 0
    double time = 0.0;  ///< that was recorded [s]
    std::string what;   ///< "hulls", "hulls and props"
  };
  [[nodiscard]] const std::optional<Difference>& difference() const { return difference_; }
  [[nodiscard]] int steps() const { return static_cast<int>(step_); }
  [[nodiscard]] bool over() const { return step_ >= recorded_->steps.size(); }

  void beforeStep(Session& session) override;
  [[nodiscard]] Result<void> afterStep(const Session& session, std::span<const WorldAction> done) override;
  /// What follows is compared no more.
  void sessionChanged() override { step_ = recorded_->steps.size(); }

 private:
  std::shared_ptr<const SessionFile> recorded_;
  std::size_t step_ = 0, action_ = 0;
  std::optional<Difference> difference_;
};

/// Whether character and decomposition are those of the recorded session.
/// @param name  of the session, for the sentence
/// @return what differs
[[nodiscard]] Result<void> checkReplay(const SessionHeader& header, const std::string& name, const Session& session);

}  // namespace lorica

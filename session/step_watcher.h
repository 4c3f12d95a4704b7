#pragma once

#include "geometry/result.h"
#include "session/world_action.h"

#include <span>

namespace lorica {

class Session;

/// Observes the steps of a session, to record or to replay it. See Session::watch().
class StepWatcher {
 public:
  virtual ~StepWatcher() = default;

  /// Called before a step; may call Session::act().
  virtual void beforeStep(Session& session) = 0;
  /// Called after a step. @param done  the actions that were applied in it, in order
  /// @return an error is returned by Session::step()
  [[nodiscard]] virtual Result<void> afterStep(const Session& session, std::span<const WorldAction> done) = 0;
  /// Called when the session restarts or continues with another body or world: the watched run has ended.
  virtual void sessionChanged() = 0;
};

}  // namespace lorica

#pragma once

#include "geometry/result.h"
#include "session/world_action.h"

#include <span>

namespace lorica {

class Session;

/// Stands beside a session, step by step: who records one, or runs a recorded one again. See Session::watch().
class StepWatcher {
 public:
  virtual ~StepWatcher() = default;

  /// Before a step; may act().
  virtual void beforeStep(Session& session) = 0;
  /// After a step. @param done  what was done to the world in it, in order
  /// @return an error ends the session's step with it
  [[nodiscard]] virtual Result<void> afterStep(const Session& session, std::span<const WorldAction> done) = 0;
  /// The session begins anew, or goes on with another body or world: what is watched is over.
  virtual void sessionChanged() = 0;
};

}  // namespace lorica

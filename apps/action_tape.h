#pragma once

#include "session/session.h"

#include <cstddef>
#include <vector>

namespace lorica {

/// What was done by hand in a recording, frame by frame, so that a run from the start does it again.
class ActionTape {
 public:
  /// Does something by hand now. What was done in frames still to come, before a rewind(), is forgotten then.
  void act(Session& session, const WorldAction& action);
  /// Before each step: does again what was done in this frame.
  void redo(Session& session);
  /// The session begins anew.
  void rewind() { next_ = 0; }
  void clear() { done_.clear(), next_ = 0; }

  /// Whether there is something that redo() has not done yet.
  [[nodiscard]] bool goesOn() const { return next_ < done_.size(); }

 private:
  struct Done {
    int frame = 0;  // before which it was done
    WorldAction action;
  };
  std::vector<Done> done_;
  std::size_t next_ = 0;  // what comes before has been done in this run
};

}  // namespace lorica

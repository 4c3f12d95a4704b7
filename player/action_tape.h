#pragma once

#include "session/session.h"

#include <cstddef>
#include <vector>

namespace lorica {

/// Records the user's actions per frame, so that a run from the start repeats them.
class ActionTape {
 public:
  /// Performs an action now and records it. Recorded actions of later frames, left from before a rewind(), are dropped.
  void act(Session& session, const WorldAction& action);
  /// Repeats the actions recorded for the current frame. Call before each step.
  void redo(Session& session);
  /// Forgets the last thrown ball, or the last drag; also all later ones, left from before a rewind(). The session has
  /// to restart and come back to see it.
  void undo();
  [[nodiscard]] bool canUndo() const { return next_ > 0; }
  /// The session restarts.
  void rewind() { next_ = 0; }
  void clear() { done_.clear(), next_ = 0; }

  /// Whether redo() still has actions to repeat.
  [[nodiscard]] bool goesOn() const { return next_ < done_.size(); }

 private:
  struct Done {
    int frame = 0;  // the action precedes this frame
    WorldAction action;
  };
  std::vector<Done> done_;
  std::size_t next_ = 0;  // earlier entries have been performed in this run
};

}  // namespace lorica

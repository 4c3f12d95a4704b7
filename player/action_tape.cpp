#include "player/action_tape.h"

namespace lorica {

void ActionTape::act(Session& session, const WorldAction& action) {
  if (goesOn()) {
    done_.resize(next_);
    // The recorded release has been dropped, too.
    if (session.world().held() && action.kind != WorldAction::Kind::kRelease) act(session, WorldAction::release());
  }
  session.act(action);
  done_.push_back({session.frameCount(), action});
  next_ = done_.size();
}

void ActionTape::redo(Session& session) {
  for (; goesOn() && done_[next_].frame <= session.frameCount(); ++next_) session.act(done_[next_].action);
}

void ActionTape::undo() {
  using Kind = WorldAction::Kind;
  done_.resize(next_);
  const bool drag = !done_.empty() && done_.back().action.kind != Kind::kThrowBall;
  while (!done_.empty()) {
    const Kind kind = done_.back().action.kind;
    if (drag && kind == Kind::kThrowBall) break;
    done_.pop_back();
    if (kind == Kind::kThrowBall || kind == Kind::kGrab) break;
  }
  next_ = done_.size();
}

}  // namespace lorica

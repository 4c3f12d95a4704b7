#include "player/action_tape.h"

#include <algorithm>

namespace lorica {

void ActionTape::act(Session& session, const WorldAction& action) {
  if (goesOn()) {
    done_.resize(next_);
    // The recorded releases have been dropped, too.
    for (int hand = 0; hand < World::kMaxHands; ++hand) {
      const bool releases = action.kind == WorldAction::Kind::kRelease && action.hand == hand;
      if (session.world().held(hand) && !releases) act(session, WorldAction::release(Vec3::Zero(), hand));
    }
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
  if (done_.empty()) return;
  const WorldAction last = done_.back().action;
  if (last.kind == Kind::kThrowBall) {
    done_.pop_back();
  } else {
    // The drag of one hand, among what others do meanwhile.
    const auto ofHand = [&](const Done& done) {
      return done.action.kind != Kind::kThrowBall && done.action.hand == last.hand;
    };
    auto begin = done_.end();
    while (begin != done_.begin()) {
      --begin;
      if (ofHand(*begin) && begin->action.kind == Kind::kGrab) break;
    }
    done_.erase(std::remove_if(begin, done_.end(), ofHand), done_.end());
  }
  next_ = done_.size();
}

}  // namespace lorica

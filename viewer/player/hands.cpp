#include "viewer/player/hands.h"

#include "geometry/counts.h"

#include <algorithm>

namespace lorica {
namespace {

constexpr double kBallRadius = 0.11;    // of a football [m]
constexpr double kBallSpeed = 11.0;     // towards the target [m/s]
constexpr double kBallAhead = 0.4;      // distance from the eye, where it would fill the picture [m]
constexpr double kGravity = 9.81;       // [m/s^2]
constexpr double kLowestHand = 0.02;    // minimum height of a held prop, so that it stays above the floor [m]
constexpr double kFarthestHand = 50.0;  // maximum distance from the origin, as the mouse may point at the horizon [m]

/// Throws from the camera towards a target, and upward enough to pass through it.
WorldAction ballFrom(const Camera& camera, const Vec3& target, double gravity) {
  const Vec3 view = target - camera.eye;
  const double distance = std::max(view.norm(), 1e-6);
  Vec3 position = camera.eye + std::min(kBallAhead, 0.5 * distance) / distance * view;
  position.y() = std::max(position.y(), kBallRadius);
  const double seconds = (target - position).norm() / kBallSpeed;
  Vec3 velocity = kBallSpeed / distance * view;
  velocity.y() += 0.5 * gravity * kGravity * seconds;
  if (velocity.norm() > kFastestBall) velocity *= kFastestBall / velocity.norm();
  return WorldAction::throwBall(position, velocity, kBallRadius);
}

}  // namespace

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

void ActionTape::forgetLast() {
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

void Hands::act(Session& session, const WorldAction& action) {
  if (without_) {
    if (canBeDone(action, session.world())) apply(action, session.world());
  } else if (again_) {
    tape_.act(session, action);
  } else {
    session.act(action);
  }
}

void Hands::take(const Change& change, const Screen& screen, const std::optional<Vec3>& target, Session& session) {
  if (change.id == ControlId::kThrow) {
    Camera camera = screen.camera();
    if (change.at) camera.eye = change.ray.origin;
    return act(session, ballFrom(camera, change.at ? *change.at : target.value_or(camera.target), gravity_));
  }
  std::optional<double>& depth = depths_[static_cast<std::size_t>(change.hand)];
  if (change.id == ControlId::kRelease) {
    if (!depth) return;
    act(session, WorldAction::release(change.velocity, change.hand));
    depth.reset();
    return;
  }
  const std::optional<PropPick> pick = session.world().pick(change.ray);
  if (!pick || session.world().props()[pick->prop].mass <= 0.0) return;
  act(session, WorldAction::grab(pick->prop, pick->position, change.hand));
  const HandAim aim = screen.aim(change.hand);
  depth = (pick->position - aim.ray.origin).dot(aim.forward);
}

unsigned Hands::holds() const {
  unsigned bits = 0;
  for (int hand = 0; hand < countOf(depths_); ++hand) bits |= depths_[hand] ? 1u << hand : 0u;
  return bits;
}

void Hands::beforeStep(const Screen& screen, Session& session) {
  if (!without_) tape_.redo(session);
  for (int hand = 0; hand < countOf(depths_); ++hand) {
    if (!depths_[hand]) continue;
    // In the plane that faces the hand's forward direction and contains the grabbed point.
    const HandAim aim = screen.aim(hand);
    const Vec3 direction = aim.ray.direction.normalized();
    Vec3 position = aim.ray.origin + *depths_[hand] / std::max(direction.dot(aim.forward), 0.1) * direction;
    position.y() = std::max(position.y(), kLowestHand);
    if (position.norm() > kFarthestHand) position *= kFarthestHand / position.norm();
    act(session, WorldAction::moveGrab(position, hand));
  }
}

void Hands::rewind(Session& session) {
  for (int hand = 0; hand < countOf(depths_); ++hand) {
    if (depths_[hand]) act(session, WorldAction::release(Vec3::Zero(), hand));
  }
  depths_ = {};
  without_ = false;
  tape_.rewind();
}

void Hands::forget() {
  depths_ = {};
  tape_.clear();
}

}  // namespace lorica

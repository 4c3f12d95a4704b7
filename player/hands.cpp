#include "player/hands.h"

#include <algorithm>
#include <cmath>

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

Vec3 forwardOf(const Camera& camera) {
  return (camera.target - camera.eye).normalized();
}

}  // namespace

void Hands::act(Session& session, const WorldAction& action) {
  if (without_) {
    if (canBeDone(action, session.world())) apply(action, session.world());
  } else if (again_) {
    tape_.act(session, action);
  } else {
    session.act(action);
  }
}

void Hands::take(const WindowRequests& requests, const Screen& screen, const std::optional<Vec3>& target,
                 Session& session) {
  if (requests.pressed) {
    const std::optional<PropPick> pick = session.world().pick(*requests.pressed);
    if (pick && session.world().props()[pick->prop].mass > 0.0) {
      act(session, WorldAction::grab(pick->prop, pick->position));
      const Camera camera = screen.camera();
      depth_ = (pick->position - camera.eye).dot(forwardOf(camera));
      holds_ = true;
    }
  }
  if (requests.released && holds_) {
    act(session, WorldAction::release(requests.throwsWith));
    holds_ = false;
  }
  if (requests.throwBall) {
    const Camera camera = screen.camera();
    act(session, ballFrom(camera, target.value_or(camera.target), gravity_));
  }
}

void Hands::beforeStep(const Screen& screen, Session& session) {
  if (!without_) tape_.redo(session);
  if (!holds_) return;
  // In the plane that faces the camera and contains the grabbed point.
  const Ray ray = screen.pointer();
  const double along = ray.direction.normalized().dot(forwardOf(screen.camera()));
  Vec3 position = ray.origin + depth_ / std::max(along, 0.1) * ray.direction.normalized();
  position.y() = std::max(position.y(), kLowestHand);
  if (position.norm() > kFarthestHand) position *= kFarthestHand / position.norm();
  act(session, WorldAction::moveGrab(position));
}

void Hands::rewind(Session& session) {
  if (holds_) act(session, WorldAction::release());
  holds_ = without_ = false;
  tape_.rewind();
}

void Hands::forget() {
  holds_ = false;
  tape_.clear();
}

}  // namespace lorica

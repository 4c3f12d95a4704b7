#include "session/world_action.h"

#include <numbers>

#include "geometry/counts.h"

namespace lorica {
namespace {

constexpr double kSmallestBall = 0.01;  ///< [m]
constexpr double kBallDensity = 250.0;  ///< [kg/m^3]: a ball of 10 cm radius has about 1 kg
constexpr double kBallBounce = 0.5;
const Vec3f kBallColor(0.78f, 0.12f, 0.10f);

bool isPosition(const Vec3& position) {
  return position.allFinite() && position.cwiseAbs().maxCoeff() <= kFarthestPosition;
}

Prop ballOf(const WorldAction& action) {
  Prop ball;
  ball.shape = PropShape::kSphere;
  ball.halfExtents = Vec3::Constant(action.radius);
  ball.mass = kBallDensity * 4.0 / 3.0 * std::numbers::pi * action.radius * action.radius * action.radius;
  ball.restitution = kBallBounce;
  ball.color = kBallColor;
  ball.worldFromProp = Eigen::Translation3d(action.position);
  ball.velocity = action.velocity;
  return ball;
}

bool isVelocity(const Vec3& v) {
  return v.allFinite() && v.norm() <= kFastestBall;
}

}  // namespace

WorldAction WorldAction::throwBall(const Vec3& position, const Vec3& velocity, double radius) {
  return {Kind::kThrowBall, 0, position, velocity, radius, 0};
}

WorldAction WorldAction::grab(int prop, const Vec3& position, int hand) {
  return {Kind::kGrab, prop, position, Vec3::Zero(), 0.0, hand};
}

WorldAction WorldAction::moveGrab(const Vec3& position, int hand) {
  return {Kind::kMoveGrab, 0, position, Vec3::Zero(), 0.0, hand};
}

WorldAction WorldAction::release(const Vec3& velocity, int hand) {
  return {Kind::kRelease, 0, Vec3::Zero(), velocity, 0.0, hand};
}

bool canBeDone(const WorldAction& action, const World& world) {
  if (action.hand < 0 || action.hand >= World::kMaxHands) return false;
  switch (action.kind) {
    case WorldAction::Kind::kThrowBall:
      return isPosition(action.position) && isVelocity(action.velocity) && action.radius >= kSmallestBall &&
             action.radius <= kLargestBall;
    case WorldAction::Kind::kGrab:
      return isPosition(action.position) && action.prop >= 0 && action.prop < countOf(world.props());
    case WorldAction::Kind::kMoveGrab:
      return isPosition(action.position);
    case WorldAction::Kind::kRelease:
      return isVelocity(action.velocity);
  }
  return false;
}

void apply(const WorldAction& action, World& world) {
  switch (action.kind) {
    case WorldAction::Kind::kThrowBall:
      world.throwProp(ballOf(action));
      return;
    case WorldAction::Kind::kGrab:
      (void)world.grab(action.prop, action.position, action.hand);  // does nothing if the prop cannot be held
      return;
    case WorldAction::Kind::kMoveGrab:
      world.moveGrab(action.position, action.hand);
      return;
    case WorldAction::Kind::kRelease:
      world.release(action.velocity, action.hand);
      return;
  }
}

}  // namespace lorica

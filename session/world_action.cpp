#include "session/world_action.h"

#include <numbers>

namespace lorica {
namespace {

constexpr double kSmallestBall = 0.01;  ///< [m]
constexpr double kBallDensity = 250.0;  ///< [kg/m^3]: a ball of 10 cm weighs a kilogram
constexpr double kBallBounce = 0.5;
const Vec3f kBallColor(0.78f, 0.12f, 0.10f);

bool isPlace(const Vec3& place) {
  return place.allFinite() && place.cwiseAbs().maxCoeff() <= kFarthestPlace;
}

Prop ballOf(const WorldAction& action) {
  Prop ball;
  ball.shape = PropShape::kSphere;
  ball.halfExtents = Vec3::Constant(action.radius);
  ball.mass = kBallDensity * 4.0 / 3.0 * std::numbers::pi * action.radius * action.radius * action.radius;
  ball.restitution = kBallBounce;
  ball.color = kBallColor;
  ball.worldFromProp = Eigen::Translation3d(action.place);
  ball.velocity = action.velocity;
  return ball;
}

}  // namespace

WorldAction WorldAction::throwBall(const Vec3& place, const Vec3& velocity, double radius) {
  return {Kind::kThrowBall, 0, place, velocity, radius};
}

WorldAction WorldAction::grab(int prop, const Vec3& place) {
  return {Kind::kGrab, prop, place, Vec3::Zero(), 0.0};
}

WorldAction WorldAction::moveGrab(const Vec3& place) {
  return {Kind::kMoveGrab, 0, place, Vec3::Zero(), 0.0};
}

WorldAction WorldAction::release() {
  return {};
}

bool canBeDone(const WorldAction& action, const World& world) {
  switch (action.kind) {
    case WorldAction::Kind::kThrowBall:
      return isPlace(action.place) && action.velocity.allFinite() && action.velocity.norm() <= kFastestBall &&
             action.radius >= kSmallestBall && action.radius <= kLargestBall;
    case WorldAction::Kind::kGrab:
      return isPlace(action.place) && action.prop >= 0 && action.prop < static_cast<int>(world.props().size());
    case WorldAction::Kind::kMoveGrab:
      return isPlace(action.place);
    case WorldAction::Kind::kRelease:
      return true;
  }
  return false;
}

void apply(const WorldAction& action, World& world) {
  switch (action.kind) {
    case WorldAction::Kind::kThrowBall:
      world.throwProp(ballOf(action));
      return;
    case WorldAction::Kind::kGrab:
      (void)world.grab(action.prop, action.place);  // what cannot be held is not
      return;
    case WorldAction::Kind::kMoveGrab:
      world.moveGrab(action.place);
      return;
    case WorldAction::Kind::kRelease:
      world.release();
      return;
  }
}

}  // namespace lorica

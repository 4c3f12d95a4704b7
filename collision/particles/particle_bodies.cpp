#include "collision/particles/particle_bodies.h"

#include "collision/particles/particle_grid.h"
#include "collision/particles/particle_obstacle.h"
#include "geometry/threads.h"
#include "geometry/work_budgets.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

// A body that particles push is no faster.
constexpr double kFastestBody = 30.0, kFastestSpin = 60.0;  // [m/s, rad/s]
// Half the usual substep of World, which gravity is already ahead of a body's path by [s].
constexpr double kWorldSubstep = 1.0 / 240.0;
constexpr double kMoving = 0.15;  // a faster body wakes the sand around it [m/s]

float signOf(float v) {
  return v < 0.0f ? -1.0f : 1.0f;
}

float fromBall(const Vec3f& point, float radius, Vec3f& normal) {
  const float length = std::sqrt(point.x() * point.x() + point.y() * point.y() + point.z() * point.z());
  normal = length > 1e-9f ? Vec3f(point / length) : Vec3f::UnitY();
  return length - radius;
}

float fromBox(const Vec3f& point, const Vec3f& half, float reach, Vec3f& normal) {
  const Vec3f over = point.cwiseAbs() - half;
  const float most = std::max({over.x(), over.y(), over.z()});
  normal.setZero();
  if (most >= reach) return most;
  if (most <= 0.0f) {
    const Eigen::Index axis = over.x() == most ? 0 : over.y() == most ? 1 : 2;
    normal[axis] = signOf(point[axis]);
    return most;
  }
  // Beside one face only, which is the most frequent case.
  const float sides = std::max(over.x(), 0.0f) + std::max(over.y(), 0.0f) + std::max(over.z(), 0.0f);
  for (Eigen::Index k = 0; k < 3; ++k) normal[k] = signOf(point[k]) * std::max(over[k], 0.0f);
  if (sides == most) {
    normal /= most;
    return most;
  }
  const float distance = std::sqrt(normal.x() * normal.x() + normal.y() * normal.y() + normal.z() * normal.z());
  normal /= distance;
  return distance;
}

float fromCylinder(const Vec3f& point, float radius, float half, Vec3f& normal) {
  const float around = std::sqrt(point.x() * point.x() + point.z() * point.z());
  const Vec3f away = around > 1e-9f ? Vec3f(point.x() / around, 0.0f, point.z() / around) : Vec3f::UnitX();
  Vec3f flat;
  const float distance = fromBox({around, point.y(), 0.0f}, {radius, half, 1.0f}, 1e9f, flat);
  normal = flat.x() * away + Vec3f(0.0f, flat.y(), 0.0f);
  return distance;
}

float fromHulls(std::span<const ParticleBody::Hull> hulls, const Vec3f& point, Vec3f& normal) {
  float nearest = 1e9f;
  for (const ParticleBody::Hull& hull : hulls) {
    float highest = -1e9f;
    const Eigen::Vector4f* face = nullptr;
    for (const Eigen::Vector4f& plane : hull) {
      const float height = plane.x() * point.x() + plane.y() * point.y() + plane.z() * point.z() - plane.w();
      if (height <= highest) continue;
      highest = height;
      face = &plane;
    }
    if (face == nullptr || highest >= nearest) continue;
    nearest = highest;
    normal = face->head<3>();
  }
  return nearest;
}

/// Half the sides of a box around it, own frame; not of kHulls.
Vec3f boundsOf(const ParticleBody& body) {
  const Vec3f half = body.halfExtents.cast<float>();
  switch (body.shape) {
    case ParticleBody::Shape::kSphere:
      return Vec3f::Constant(half.x());
    case ParticleBody::Shape::kCapsule:
    case ParticleBody::Shape::kCylinder:
      return {half.x(), half.y(), half.x()};
    case ParticleBody::Shape::kBox:
    case ParticleBody::Shape::kHulls:
      break;
  }
  return half;
}

Quat turnedBy(const Vec3& turn, const Quat& rotation) {
  // Without trigonometry, so that every machine gives the same result.
  Quat by(1.0, 0.5 * turn.x(), 0.5 * turn.y(), 0.5 * turn.z());
  return (by * rotation).normalized();
}

Vec3 clamped(const Vec3& v, double longest) {
  const double length = v.norm();
  return length > longest ? Vec3(longest / length * v) : v;
}

}  // namespace

float distanceFrom(const ParticleBody& body, const Vec3f& point, float reach, Vec3f& normal) {
  const Vec3f half = body.halfExtents.cast<float>();
  switch (body.shape) {
    case ParticleBody::Shape::kBox:
      return fromBox(point, half, reach, normal);
    case ParticleBody::Shape::kSphere:
      return fromBall(point, half.x(), normal);
    case ParticleBody::Shape::kCapsule: {
      const float straight = half.y() - half.x();
      return fromBall({point.x(), point.y() - std::clamp(point.y(), -straight, straight), point.z()}, half.x(), normal);
    }
    case ParticleBody::Shape::kCylinder:
      return fromCylinder(point, half.x(), half.y(), normal);
    case ParticleBody::Shape::kHulls:
      break;
  }
  return fromHulls(body.hulls, point, normal);
}

bool isWithin(const ParticleBody& body, const Vec3f& point, float away) {
  const Vec3 own = body.from.worldFromBody.inverse() * point.cast<double>();
  Vec3f normal;
  return own.norm() < body.radius + away && distanceFrom(body, own.cast<float>(), away, normal) < away;
}

Vec3f extentOf(const ParticleBody& body, const Eigen::Matrix3f& bodyFromWorld) {
  if (body.shape == ParticleBody::Shape::kHulls) return Vec3f::Constant(static_cast<float>(body.radius));
  return bodyFromWorld.transpose().cwiseAbs() * boundsOf(body);
}

void ParticleBodies::begin(std::span<ParticleBody> bodies, double seconds, int substeps) {
  bodies_ = bodies;
  substeps_ = substeps;
  seconds_ = seconds / substeps;
  ownShare_ = 0.5 + 0.5 * std::min(1.0, kWorldSubstep / seconds_);
  states_.resize(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    State& state = states_[b];
    state.shift = state.addedVelocity = state.addedSpin = state.pendingVelocity = state.pendingSpin = Vec3::Zero();
    state.turn = Quat::Identity();
    bodies[b].pushed = false;
    place(state, bodies[b], 0.0);
  }
  contacts_.clear();
}

void ParticleBodies::place(State& state, const ParticleBody& body, double fraction) const {
  const Isometry3 path = between(body.from.worldFromBody, body.to.worldFromBody, fraction);
  state.position = path.translation() + state.shift;
  state.rotation = state.turn * Quat(path.linear());
  state.velocity = body.from.velocity + fraction * (body.to.velocity - body.from.velocity) + state.addedVelocity;
  state.spin =
      body.from.angularVelocity + fraction * (body.to.angularVelocity - body.from.angularVelocity) + state.addedSpin;
  const Mat3 turn = state.rotation.toRotationMatrix();
  state.inverseInertia = turn * body.inverseInertia.asDiagonal() * turn.transpose();
  state.bodyFromWorld = turn.transpose().cast<float>();
}

void ParticleBodies::advance(int substep) {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    State& state = states_[b];
    state.shift += seconds_ * state.addedVelocity;
    if (!state.addedSpin.isZero()) state.turn = turnedBy(seconds_ * state.addedSpin, state.turn);
    place(state, bodies_[b], static_cast<double>(substep + 1) / substeps_);
  }
}

void ParticleBodies::follow() {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    State& state = states_[b];
    if (state.pendingVelocity.isZero() && state.pendingSpin.isZero()) continue;
    const Vec3 way = ownShare_ * seconds_ * state.pendingVelocity, turn = ownShare_ * seconds_ * state.pendingSpin;
    state.shift += way;
    state.position += way;
    state.turn = turnedBy(turn, state.turn);
    state.rotation = turnedBy(turn, state.rotation);
    const Mat3 rotation = state.rotation.toRotationMatrix();
    state.inverseInertia = rotation * bodies_[b].inverseInertia.asDiagonal() * rotation.transpose();
    state.bodyFromWorld = rotation.transpose().cast<float>();
    state.pendingVelocity = state.pendingSpin = Vec3::Zero();
    bodies_[b].pushed = true;
  }
}

void ParticleBodies::finish() {
  follow();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const State& state = states_[b];
    ParticleBody& body = bodies_[b];
    if (!body.pushed) continue;
    if (!state.position.allFinite() || !state.velocity.allFinite() || !state.spin.allFinite()) {
      body.pushed = false;
      continue;
    }
    body.to.worldFromBody.translation() = state.position;
    body.to.worldFromBody.linear() = state.rotation.normalized().toRotationMatrix();
    body.to.velocity = clamped(state.velocity, kFastestBody);
    body.to.angularVelocity = clamped(state.spin, kFastestSpin);
  }
}

void ParticleBodies::gather(const ParticleGrid& grid, std::span<const ParticleRow> positions, float reach,
                            float moved) {
  candidates_.clear();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const ParticleBody& body = bodies_[b];
    const Vec3f center = states_[b].position.cast<float>();
    const Vec3f extent = extentOf(body, states_[b].bodyFromWorld);
    const Vec3f near = extent.array() + reach, far = near.array() + moved;
    grid.visitRuns({center.x() - far.x(), center.y() - far.y(), center.z() - far.z()},
                   {center.x() + far.x(), center.y() + far.y(), center.z() + far.z()},
                   [&](std::uint32_t first, std::uint32_t last) {
                     for (std::uint32_t i = first; i < last && candidates_.size() < kMaxParticlePairs; ++i) {
                       const ParticleRow& p = positions[i];
                       if (std::abs(p.x - center.x()) > near.x() || std::abs(p.y - center.y()) > near.y() ||
                           std::abs(p.z - center.z()) > near.z()) {
                         continue;
                       }
                       candidates_.push_back({i, static_cast<std::uint32_t>(b), 0.0f, Vec3f::Zero()});
                     }
                   });
  }
}

std::span<const ParticleBodies::Contact> ParticleBodies::find(std::span<const ParticleRow> positions, float reach) {
  parallelRanges(candidates_.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      Contact& contact = candidates_[c];
      const State& state = states_[contact.body];
      const ParticleRow& p = positions[contact.particle];
      const Vec3f own = state.bodyFromWorld * (Vec3(p.x, p.y, p.z) - state.position).cast<float>();
      contact.distance = distanceFrom(bodies_[contact.body], own, reach, contact.normal);
      if (contact.distance < reach) contact.normal = state.bodyFromWorld.transpose() * contact.normal;
    }
  });
  contacts_.clear();
  for (State& state : states_) state.contacts = 0;
  for (const Contact& contact : candidates_) {
    if (!(contact.distance < reach)) continue;
    contacts_.push_back(contact);
    ++states_[contact.body].contacts;
  }
  return contacts_;
}

void ParticleBodies::markAround(const ParticleGrid& grid, float margin, std::vector<std::uint8_t>& flags) const {
  for (const ParticleBody& body : bodies_) {
    const Vec3f from = body.from.worldFromBody.translation().cast<float>();
    const Vec3f to = body.to.worldFromBody.translation().cast<float>();
    if (body.inverseMass == 0.0
            ? from == to
            : body.from.velocity.norm() + body.radius * body.from.angularVelocity.norm() < kMoving) {
      continue;
    }
    const Vec3f far = Vec3f::Constant(static_cast<float>(body.radius) + margin);
    const Vec3f min = from.cwiseMin(to) - far, max = from.cwiseMax(to) + far;
    grid.visitRuns({min.x(), min.y(), min.z()}, {max.x(), max.y(), max.z()},
                   [&](std::uint32_t first, std::uint32_t last) {
                     std::fill(flags.begin() + first, flags.begin() + last, std::uint8_t{1});
                   });
  }
}

double ParticleBodies::yielding(const Contact& contact, const ParticleRow& at) const {
  const State& state = states_[contact.body];
  const Vec3 arm = Vec3(at.x, at.y, at.z) - state.position;
  const Vec3 turning = arm.cross(contact.normal.cast<double>());
  return bodies_[contact.body].inverseMass + turning.dot(state.inverseInertia * turning);
}

void ParticleBodies::give(State& state, const ParticleBody& body, const Vec3& arm, const Vec3& impulse) {
  const Vec3 velocity = body.inverseMass * impulse, spin = state.inverseInertia * arm.cross(impulse);
  state.velocity += velocity;
  state.spin += spin;
  state.addedVelocity += velocity;
  state.addedSpin += spin;
  state.pendingVelocity += velocity;
  state.pendingSpin += spin;
}

void ParticleBodies::push(const Contact& contact, const ParticleRow& at, const Vec3& impulse) {
  State& state = states_[contact.body];
  give(state, bodies_[contact.body], Vec3(at.x, at.y, at.z) - state.position, impulse);
}

Vec3f ParticleBodies::collide(const Contact& contact, const ParticleRow& at, const Vec3f& velocity, double inverseMass,
                              double friction, double leaving) {
  State& state = states_[contact.body];
  const ParticleBody& body = bodies_[contact.body];
  const Vec3 arm = Vec3(at.x, at.y, at.z) - state.position, normal = contact.normal.cast<double>();
  const Vec3 slip = velocity.cast<double>() - state.velocity - state.spin.cross(arm);
  const double along = slip.dot(normal);
  const auto yieldingAlong = [&](const Vec3& way) {
    const Vec3 turning = arm.cross(way);
    return inverseMass + body.inverseMass + turning.dot(state.inverseInertia * turning);
  };
  const double yields = yieldingAlong(normal);
  if (along >= leaving || !(yields > 0.0)) return Vec3f::Zero();
  const double stop = (leaving - along) / yields;
  Vec3 impulse = stop * normal;
  const Vec3 sliding = slip - along * normal;
  const double speed = sliding.norm();
  if (friction > 0.0 && speed > 1e-6) {
    const Vec3 way = sliding / speed;
    impulse -= std::min(friction * stop, speed / yieldingAlong(way)) * way;
  }
  give(state, body, arm, -impulse);
  return (inverseMass * impulse).cast<float>();
}

Vec3f ParticleBodies::drag(const Contact& contact, const ParticleRow& at, const Vec3f& velocity, double mass,
                           double share) {
  State& state = states_[contact.body];
  const Vec3 arm = Vec3(at.x, at.y, at.z) - state.position, normal = contact.normal.cast<double>();
  const Vec3 slip = velocity.cast<double>() - state.velocity - state.spin.cross(arm);
  const Vec3 sliding = slip - slip.dot(normal) * normal;
  const double speed = sliding.norm();
  if (!(speed > 1e-6)) return Vec3f::Zero();
  const Vec3 turning = arm.cross(sliding / speed);
  const double yields = mass * (bodies_[contact.body].inverseMass + turning.dot(state.inverseInertia * turning)) + 1.0;
  const Vec3 impulse = -share * mass / yields * sliding;
  give(state, bodies_[contact.body], arm, -impulse);
  return (impulse / mass).cast<float>();
}

}  // namespace lorica

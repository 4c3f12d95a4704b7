#include "collision/world/live_obstacles.h"

#include "collision/live/lifted_point.h"
#include "collision/live/part_bones.h"
#include "skinning/linear_blend.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lorica {

namespace {

constexpr int kRounds = 8;               // a tail between several bodies is pushed by each in turn
constexpr double kMinGive = 1e-4;        // [m]
constexpr double kTolerance = 1e-7;      // [m]
constexpr double kMovedBySprings = 0.5;  // share of a point's weights
constexpr double kTouchedBySprings = 1e-3;

/// The rigid part of a transform whose axes are turned and scaled.
[[nodiscard]] Isometry3 rigid(const Affine3& transform) {
  Isometry3 result = Isometry3::Identity();
  Mat3 axes = transform.linear();
  axes.col(0).normalize();
  axes.col(1) = (axes.col(1) - axes.col(1).dot(axes.col(0)) * axes.col(0)).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  if (axes.allFinite()) result.linear() = axes;
  result.translation() = transform.translation();
  return result;
}

[[nodiscard]] Isometry3 between(const Isometry3& begin, const Isometry3& end, double share) {
  Isometry3 result = Isometry3::Identity();
  result.linear() = Quat(begin.linear()).slerp(share, Quat(end.linear())).toRotationMatrix();
  result.translation() = begin.translation() + share * (end.translation() - begin.translation());
  return result;
}

/// Moves a tail to the nearest point on the sphere around its head that lies on a plane, or as far out as it reaches.
[[nodiscard]] Vec3 onPlane(const Vec3& head, double length, const SpringPush& push, const Vec3& tail) {
  if (push.height >= length) return head + length * push.normal;
  Vec3 aside = tail - head;
  aside -= aside.dot(push.normal) * push.normal;
  if (!(aside.squaredNorm() > 1e-24)) aside = push.normal.unitOrthogonal();
  const double across = std::sqrt(std::max(0.0, length * length - push.height * push.height));
  return head + push.height * push.normal + across * aside.normalized();
}

/// The nearest of the two points of the sphere that lie on two planes. Where the planes do not meet within its reach,
/// the point that is about as far below the one as below the other.
[[nodiscard]] Vec3 onPlanes(const Vec3& head, double length, const SpringPush& a, const SpringPush& b,
                            const Vec3& tail) {
  const double cosine = a.normal.dot(b.normal);
  const double sineSq = 1.0 - cosine * cosine;
  if (!(sineSq > 1e-9)) return tail;
  const Vec3 foot = ((a.height - cosine * b.height) * a.normal + (b.height - cosine * a.height) * b.normal) / sineSq;
  const double restSq = length * length - foot.squaredNorm();
  if (restSq >= 0.0) {
    Vec3 aside = a.normal.cross(b.normal).normalized() * std::sqrt(restSq);
    if (aside.dot(tail - head) < 0.0) aside = -aside;
    return head + foot + aside;
  }
  // Lowers both planes, each in proportion to what it may give, until they meet at one point of the sphere.
  const Vec3 down = ((a.give - cosine * b.give) * a.normal + (b.give - cosine * a.give) * b.normal) / sineSq;
  const double quadratic = down.squaredNorm();
  const double linear = foot.dot(down);
  const double root = linear * linear - quadratic * (foot.squaredNorm() - length * length);
  if (!(quadratic > 0.0) || root < 0.0) return tail;
  return head + foot - (linear - std::sqrt(root)) / quadratic * down;
}

/// Nearest surface of a prop, in the prop's frame.
struct Nearest {
  double distance = kInfinity;  ///< negative inside
  Vec3 normal = Vec3::UnitY();
};

/// A box in as many dimensions as the vectors have: the outside distance is exact, the inside one to the nearest side.
[[nodiscard]] Nearest nearestOfBox(const Vec3& point, const Vec3& half) {
  const Vec3 beyond = point.cwiseAbs() - half;
  const Vec3 outside = beyond.cwiseMax(0.0);
  if (outside.squaredNorm() > 0.0) {
    const double distance = outside.norm();
    Vec3 normal = outside / distance;
    for (int i = 0; i < 3; ++i) normal[i] = std::copysign(normal[i], point[i]);
    return {distance, normal};
  }
  int side = 0;
  const double distance = beyond.maxCoeff(&side);
  return {distance, std::copysign(1.0, point[side]) * Vec3::Unit(side)};
}

[[nodiscard]] Nearest nearestOfMesh(const Vec3& point, const PropMeshShape& mesh) {
  Nearest nearest;
  for (const ConvexHull& hull : mesh.hulls) {
    Nearest own{-kInfinity, Vec3::UnitY()};
    for (const Triangle& t : hull.triangles) {
      const Vec3 normal = areaNormal(hull.vertices, t).stableNormalized();
      const double distance = normal.dot(point - hull.vertices[t[0]]);
      if (distance > own.distance) own = {distance, normal};
    }
    if (own.distance < nearest.distance) nearest = own;
  }
  return nearest;
}

[[nodiscard]] Nearest nearestOf(const Vec3& point, const Prop& prop) {
  const Vec3& half = prop.halfExtents;
  switch (prop.shape) {
    case PropShape::kBox:
      return nearestOfBox(point, half);
    case PropShape::kSphere:
    case PropShape::kCapsule: {
      const double straight = prop.shape == PropShape::kCapsule ? std::max(0.0, half.y() - half.x()) : 0.0;
      const Vec3 from = point - std::clamp(point.y(), -straight, straight) * Vec3::UnitY();
      const double length = from.norm();
      return {length - half.x(), length > 0.0 ? Vec3(from / length) : Vec3(Vec3::UnitX())};
    }
    case PropShape::kCylinder: {
      const double across = std::hypot(point.x(), point.z());
      const Vec3 outward = across > 0.0 ? Vec3(point.x() / across, 0.0, point.z() / across) : Vec3(Vec3::UnitX());
      const Nearest section = nearestOfBox(Vec3(across, point.y(), 0.0), Vec3(half.x(), half.y(), kInfinity));
      return {section.distance, section.normal.x() * outward + section.normal.y() * Vec3::UnitY()};
    }
    case PropShape::kMesh:
      return nearestOfMesh(point, *prop.mesh);
  }
  return {};
}

/// The nearest free one of some points all over the sphere around a tail's head; the tail itself if none is better.
[[nodiscard]] Vec3 nearestFree(const LiveObstacles& obstacles, std::size_t spring, const Vec3& head, const Vec3& tail) {
  constexpr int kRings = 11;
  constexpr int kAround = 12;
  const Vec3 along = tail - head;
  const double length = along.norm();
  if (!(length > 0.0)) return tail;
  const Vec3 aside = along.unitOrthogonal();
  const Vec3 other = along.cross(aside) / length;
  Vec3 best = tail;
  double leastBelow = obstacles.below(spring, head, tail);
  for (int ring = 1; ring <= kRings && leastBelow > 0.0; ++ring) {
    const double angle = std::numbers::pi * ring / (kRings + 1);
    for (int i = 0; i < kAround; ++i) {
      const double turn = 2.0 * std::numbers::pi * i / kAround;
      const Vec3 across = std::cos(turn) * aside + std::sin(turn) * other;
      const Vec3 point = head + std::cos(angle) * along + std::sin(angle) * length * across;
      const double depth = obstacles.below(spring, head, point);
      if (depth >= leastBelow) continue;
      leastBelow = depth;
      best = point;
    }
  }
  return best;
}

}  // namespace

void LiveObstacles::takeFaces(const ConvexHull& hull, Solid& solid) {
  solid.planes.clear();
  for (const Triangle& t : hull.triangles) {
    const Vec3 normal = areaNormal(hull.vertices, t).stableNormalized();
    if (normal.squaredNorm() > 0.5) solid.planes.push_back({normal, normal.dot(hull.vertices[t[0]])});
  }
  solid.center = boundsOf(hull.vertices).center();
  double radiusSq = 0.0;
  for (const Vec3& v : hull.vertices) radiusSq = std::max(radiusSq, (v - solid.center).squaredNorm());
  solid.radius = std::sqrt(radiusSq);
}

/// The largest distance above a plane: of a point inside minus its depth.
double LiveObstacles::depthless(const Solid& solid, const Vec3& point) {
  double distance = -kInfinity;
  for (const Plane& plane : solid.planes) distance = std::max(distance, plane.normal.dot(point) - plane.offset);
  return distance;
}

LiveObstacles::LiveObstacles(const LiveBody& body, const Character& character, const SpringSimulation& springs) {
  const Decomposition& decomposition = body.decomposition();
  std::vector<char> swings(character.skeleton.joints().size(), 0);
  for (const SpringJoint& joint : springs.joints()) swings[joint.joint] = 1;
  for (std::size_t j = 0; j < swings.size(); ++j) {  // a joint below one that swings is moved by it
    const JointIndex parent = character.skeleton.joint(j).parent;
    if (parent != kNoJoint && swings[parent] != 0) swings[j] = 1;
  }

  const std::vector<LiftedPoint> lifted = liftPoints(character, decomposition);
  solids_.resize(decomposition.parts.size());
  std::vector<double> moves(swings.size());
  for (std::size_t p = 0; p < solids_.size(); ++p) {
    Solid& solid = solids_[p];
    std::fill(moves.begin(), moves.end(), 0.0);
    std::vector<Vec3> firm;
    for (const PointIndex i : body.plan()->candidates(p)) {
      double swung = 0.0;
      for (const LiftedTerm& term : lifted[i]) {
        swung += swings[term.joint] != 0 ? term.weight : 0.0;
        if (swings[term.joint] == 0) moves[term.joint] += term.weight;
      }
      solid.live = solid.live && swung < kTouchedBySprings;
      if (swung < kMovedBySprings) firm.push_back(bindPositionOf(lifted[i]));
    }
    solid.joint = std::max_element(moves.begin(), moves.end()) - moves.begin();
    if (solid.live) {
      solid.planes.reserve(2 * body.candidateCount(p));
    } else {
      takeFaces(convexHull(firm), solid);
    }
  }
  placeAtRest(body, character, springs);
}

/// Decides which tails ignore which parts.
void LiveObstacles::placeAtRest(const LiveBody& body, const Character& character, const SpringSimulation& springs) {
  std::vector<Affine3> worldFromJoint(character.skeleton.joints().size());
  computeWorldFromJoint(character.skeleton, restPose(character.skeleton), worldFromJoint);
  std::vector<Affine3> worldFromModel(worldFromJoint.size());
  computeWorldFromModel(character, worldFromJoint, worldFromModel);
  LiveBody atRest(body.plan());
  atRest.update(worldFromModel);
  prepare(atRest.parts(), worldFromModel, worldFromModel, {}, 0.0);
  moveTo(1.0);

  const std::span<const SpringJoint> joints = springs.joints();
  radii_.reserve(joints.size() * solids_.size());
  for (const SpringJoint& joint : joints) {
    hitRadii_.push_back(joint.hitRadius);
    const Vec3 tail = worldFromJoint[joint.joint] * joint.tail;
    for (const Solid& solid : solids_) {
      const double distance = depthless(solid, solid.worldFromSolid.inverse() * tail);
      radii_.push_back(distance >= -joint.hitRadius ? std::min(distance, joint.hitRadius) : -kInfinity);
    }
  }
}

void LiveObstacles::prepare(std::span<const LivePart> parts, std::span<const Affine3> last,
                            std::span<const Affine3> now, std::span<const Prop> props, double seconds) {
  LORICA_CHECK(parts.size() == solids_.size(), "the parts belong to another body");
  for (std::size_t p = 0; p < solids_.size(); ++p) {
    Solid& solid = solids_[p];
    if (solid.live) {
      takeFaces(parts[p].shape, solid);
      solid.begin = parts[p].worldFromPart;
      solid.end = rigid(now[solid.joint] * last[solid.joint].inverse() * Affine3(parts[p].worldFromPart.matrix()));
    } else {
      solid.begin = rigid(last[solid.joint]);
      solid.end = rigid(now[solid.joint]);
    }
  }
  props_ = props;
  seconds_ = seconds;
}

void LiveObstacles::moveTo(double share) {
  share_ = share;
  for (Solid& solid : solids_) {
    solid.worldFromSolid = share >= 1.0 ? solid.end : between(solid.begin, solid.end, share);
  }
}

std::optional<double> LiveObstacles::distance(std::size_t spring, PartIndex part, const Vec3& point) const {
  const Solid& solid = solids_[part];
  if (radii_[spring * solids_.size() + part] == -kInfinity || solid.planes.empty()) {
    return std::nullopt;
  }
  return depthless(solid, solid.worldFromSolid.inverse() * point);
}

void LiveObstacles::pushOut(std::size_t spring, const Vec3& head, double length, Vec3& tail) {
  const std::span<const double> radii = std::span(radii_).subspan(spring * solids_.size(), solids_.size());
  std::optional<SpringPush> last;
  std::size_t lastBody = 0;
  const auto push = [&](std::size_t body, const std::optional<SpringPush>& by) {
    if (!by) return false;
    Vec3 moved = onPlane(head, length, *by, tail);
    // Between two bodies, each would push the tail back into the other.
    if (last && lastBody != body && last->normal.dot(moved - head) < last->height - kTolerance) {
      moved = onPlanes(head, length, *last, *by, tail);
    }
    tail = moved;
    last = by;
    lastBody = body;
    return true;
  };
  for (int round = 0; round < kRounds; ++round) {
    bool moved = false;
    for (std::size_t s = 0; s < solids_.size(); ++s) {
      if (radii[s] != -kInfinity)
        moved = push(s, pushOf(solids_[s], radii[s], hitRadii_[spring], head, length, tail)) || moved;
    }
    for (std::size_t p = 0; p < props_.size(); ++p) {
      moved = push(solids_.size() + p, pushOf(props_[p], hitRadii_[spring], head, tail)) || moved;
    }
    if (!moved) return;
  }
  // Squeezed between bodies, with its own centre in one of them: it goes where there is room.
  if (below(spring, head, tail) > hitRadii_[spring]) tail = nearestFree(*this, spring, head, tail);
}

double LiveObstacles::below(std::size_t spring, const Vec3& head, const Vec3& tail) const {
  const std::span<const double> radii = std::span(radii_).subspan(spring * solids_.size(), solids_.size());
  double deepest = -kInfinity;
  for (std::size_t s = 0; s < solids_.size(); ++s) {
    if (radii[s] == -kInfinity || solids_[s].planes.empty()) continue;
    const Vec3 local = solids_[s].worldFromSolid.inverse() * tail;
    deepest = std::max(deepest, radii[s] - depthless(solids_[s], local));
  }
  for (const Prop& prop : props_) {
    const std::optional<SpringPush> push = pushOf(prop, hitRadii_[spring], head, tail);
    if (push) deepest = std::max(deepest, push->height - push->normal.dot(tail - head));
  }
  return deepest;
}

std::optional<SpringPush> LiveObstacles::pushOf(const Solid& solid, double radius, double hitRadius, const Vec3& head,
                                                double length, const Vec3& tail) {
  const Vec3 local = solid.worldFromSolid.inverse() * tail;
  const double reach = solid.radius + std::max(radius, 0.0);
  if (solid.planes.empty() || (local - solid.center).squaredNorm() > reach * reach) return std::nullopt;
  if (depthless(solid, local) >= radius - kTolerance) return std::nullopt;
  // The nearest face above which the tail can get; if there is none, the nearest face.
  const Vec3 localHead = solid.worldFromSolid.inverse() * head;
  const Plane* best = nullptr;
  bool bestReached = false;
  double bestDistance = -kInfinity;
  for (const Plane& plane : solid.planes) {
    const double distance = plane.normal.dot(local) - plane.offset;
    const bool reached = plane.offset + radius - plane.normal.dot(localHead) <= length;
    if (best != nullptr && (bestReached != reached ? bestReached : distance <= bestDistance)) continue;
    best = &plane;
    bestReached = reached;
    bestDistance = distance;
  }
  return SpringPush{solid.worldFromSolid.linear() * best->normal, best->offset + radius - best->normal.dot(localHead),
                    radius + hitRadius + kMinGive};
}

std::optional<SpringPush> LiveObstacles::pushOf(const Prop& prop, double radius, const Vec3& head,
                                                const Vec3& tail) const {
  if (prop.mass == 0.0) return std::nullopt;
  const Vec3 moved = share_ * seconds_ * prop.velocity;  // since the last frame
  const Vec3 offset = tail - moved - prop.worldFromProp.translation();
  if (offset.norm() > boundingRadius(prop) + radius) return std::nullopt;
  const Mat3 worldFromProp = prop.worldFromProp.linear();
  const Nearest nearest = nearestOf(worldFromProp.transpose() * offset, prop);
  if (nearest.distance >= radius - kTolerance) return std::nullopt;
  const Vec3 normal = worldFromProp * nearest.normal;
  return SpringPush{normal, normal.dot(tail - head) + radius - nearest.distance, 2.0 * radius + kMinGive};
}

}  // namespace lorica

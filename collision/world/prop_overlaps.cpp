#include "collision/world/prop_overlaps.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace lorica {
namespace {

using Box = Eigen::AlignedBox3d;

Vec3 halfSides(const Prop& prop) {
  const Vec3& half = prop.halfExtents;
  const bool turned = prop.shape == PropShape::kCapsule || prop.shape == PropShape::kCylinder;
  return turned ? Vec3(half.x(), half.y(), half.x()) : half;
}

Box boxAround(const Prop& prop) {
  const Vec3 center = prop.worldFromProp.translation();
  const Vec3 half = prop.shape == PropShape::kSphere ? Vec3(Vec3::Constant(prop.halfExtents.x()))
                                                     : Vec3(prop.worldFromProp.linear().cwiseAbs() * halfSides(prop));
  return {center - half, center + half};
}

std::vector<Box> boxesAround(std::span<const Prop> props) {
  std::vector<Box> boxes;
  boxes.reserve(props.size());
  for (const Prop& prop : props) boxes.push_back(boxAround(prop));
  return boxes;
}

bool contains(const ConvexHull& hull, const Vec3& p) {
  return std::all_of(hull.triangles.begin(), hull.triangles.end(), [&](const Triangle& t) {
    return areaNormal(hull.vertices, t).dot(p - hull.vertices[t[0]]) < 0.0;
  });
}

bool contains(const Prop& prop, const Vec3& position) {
  const Vec3 p = prop.worldFromProp.inverse() * position;
  const Vec3& half = prop.halfExtents;
  switch (prop.shape) {
    case PropShape::kBox:
      return (p.cwiseAbs() - half).maxCoeff() < 0.0;
    case PropShape::kSphere:
      return p.norm() < half.x();
    case PropShape::kCapsule: {
      const double straight = half.y() - half.x();
      return (p - Vec3(0.0, std::clamp(p.y(), -straight, straight), 0.0)).norm() < half.x();
    }
    case PropShape::kCylinder:
      return std::abs(p.y()) < half.y() && std::hypot(p.x(), p.z()) < half.x();
    case PropShape::kMesh:
      return std::any_of(prop.mesh->hulls.begin(), prop.mesh->hulls.end(),
                         [&](const ConvexHull& hull) { return contains(hull, p); });
  }
  return false;
}

/// Whether the centre of mass of a prop is in another prop. That of a mesh may be outside of it, such as in the hole of
/// a ring, and then tells nothing.
bool isInside(const Prop& inner, const Prop& outer) {
  if (!inner.mesh) return contains(outer, inner.worldFromProp.translation());
  const Vec3 centre = inner.worldFromProp * inner.mesh->solid.center;
  return contains(inner, centre) && contains(outer, centre);
}

/// Visits each pair, except pairs of static bodies, whose bounding boxes overlap. @param visit  return false to stop
template <typename Visit>
void forNearPairs(std::span<const Prop> props, Visit visit) {
  const std::vector<Box> boxes = boxesAround(props);
  for (std::size_t b = 1; b < props.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      if (props[a].mass == 0.0 && props[b].mass == 0.0) continue;
      const Vec3 gap = (boxes[a].min() - boxes[b].max()).cwiseMax(boxes[b].min() - boxes[a].max());
      if (gap.maxCoeff() < 0.0 && !visit(a, b)) return;
    }
  }
}

}  // namespace

std::optional<PropOverlap> findPropInside(std::span<const Prop> props) {
  std::optional<PropOverlap> found;
  forNearPairs(props, [&](std::size_t a, std::size_t b) {
    if (isInside(props[b], props[a])) {
      found = PropOverlap{b, a};
    } else if (isInside(props[a], props[b])) {
      found = PropOverlap{a, b};
    }
    return !found;
  });
  return found;
}

std::optional<std::size_t> findStaticAround(std::span<const Prop> props, const Vec3& point) {
  for (std::size_t i = 0; i < props.size(); ++i) {
    if (props[i].mass == 0.0 && contains(props[i], point)) return i;
  }
  return std::nullopt;
}

std::size_t countNearPairs(std::span<const Prop> props) {
  std::size_t count = 0;
  forNearPairs(props, [&](std::size_t /*a*/, std::size_t /*b*/) { return ++count > 0; });
  return count;
}

namespace {

constexpr double kStep = 0.05;         // [m]
constexpr int kMaxSteps = 400;         // 20 m
constexpr double kClear = 0.01;        // [m]
constexpr double kTouching = 0.005;    // props within this distance form one stack [m]
constexpr double kStandsBelow = 0.02;  // above the floor [m]

Box grown(const Box& box, double by) {
  return {box.min() - Vec3::Constant(by), box.max() + Vec3::Constant(by)};
}

/// How far a prop extends from its centre along a direction.
double reach(const Prop& prop, const Vec3& direction) {
  if (prop.shape == PropShape::kSphere) return prop.halfExtents.x();
  return (prop.worldFromProp.linear().transpose() * direction).cwiseAbs().dot(halfSides(prop));
}

/// A part's hull in the world and its bounding box.
struct Obstacle {
  ConvexHull hull;
  Box box;
};

/// Whether a plane parallel to a face of either one separates them. Other separating planes are not tested, so a pair
/// that is clear may be reported as not clear.
bool areClear(const Obstacle& part, const Prop& prop, const Vec3& moved) {
  const Vec3 center = prop.worldFromProp.translation() + moved;
  for (const Triangle& t : part.hull.triangles) {
    const Vec3 normal = areaNormal(part.hull.vertices, t).normalized();
    if (normal.dot(center - part.hull.vertices[t[0]]) - reach(prop, normal) > kClear) return true;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 direction = prop.worldFromProp.linear().col(axis);
    double low = 1e300, high = -1e300;
    for (const Vec3& v : part.hull.vertices) {
      const double along = direction.dot(v - center);
      low = std::min(low, along);
      high = std::max(high, along);
    }
    const double half = reach(prop, direction);
    if (low > half + kClear || high < -half - kClear) return true;
  }
  return false;
}

/// Groups props into stacks. @return for each prop, the index of the first prop of its stack
std::vector<std::size_t> stacksOf(std::span<const Prop> props, std::span<const Box> boxes) {
  std::vector<std::size_t> first(props.size());
  std::iota(first.begin(), first.end(), std::size_t{0});
  for (std::size_t i = 0; i < props.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (props[i].mass == 0.0 || props[k].mass == 0.0 || first[i] == first[k]) continue;
      if (!grown(boxes[i], kTouching).intersects(boxes[k])) continue;
      const std::size_t joined = std::min(first[i], first[k]), other = std::max(first[i], first[k]);
      std::replace(first.begin(), first.end(), other, joined);
    }
  }
  return first;
}

}  // namespace

std::vector<Vec3> resolveOverlaps(std::span<const LivePart> parts, std::span<const Prop> props) {
  std::vector<Vec3> moves(props.size(), Vec3::Zero());
  std::vector<Obstacle> obstacles;
  obstacles.reserve(parts.size());
  Box avatar;
  for (const LivePart& part : parts) {
    if (part.shape.degenerate()) continue;
    Obstacle obstacle{worldHull(part), Box()};
    for (const Vec3& v : obstacle.hull.vertices) obstacle.box.extend(v);
    avatar.extend(obstacle.box);
    obstacles.push_back(std::move(obstacle));
  }
  const std::vector<Box> boxes = boxesAround(props);
  const std::vector<std::size_t> stacks = stacksOf(props, boxes);

  const auto isInAPart = [&](std::size_t i, const Vec3& moved) {
    const Box box = grown(boxes[i].translated(moved), kClear);
    return std::any_of(obstacles.begin(), obstacles.end(), [&](const Obstacle& part) {
      return part.box.intersects(box) && !areClear(part, props[i], moved);
    });
  };
  for (std::size_t stack = 0; stack < props.size(); ++stack) {
    if (stacks[stack] != stack || props[stack].mass == 0.0) continue;
    std::vector<std::size_t> members;
    Box around;
    for (std::size_t i = stack; i < props.size(); ++i) {
      if (stacks[i] != stack) continue;
      members.push_back(i);
      around.extend(boxes[i]);
    }
    const auto isInTheWay = [&](const Vec3& moved) {
      return std::any_of(members.begin(), members.end(), [&](std::size_t i) { return isInAPart(i, moved); });
    };
    const auto meetsOthers = [&](const Vec3& moved) {
      for (std::size_t k = 0; k < props.size(); ++k) {
        if (stacks[k] == stack) continue;
        const Box other = grown(boxes[k].translated(moves[k]), kClear);
        for (const std::size_t i : members) {
          if (boxes[i].translated(moved).intersects(other)) return true;
        }
      }
      return false;
    };
    if (!isInTheWay(Vec3::Zero())) continue;

    Vec3 away = Vec3::UnitY();
    if (around.min().y() < kStandsBelow) {
      away = around.center() - avatar.center();
      away.y() = 0.0;
      away = away.norm() > kClear ? Vec3(away.normalized()) : Vec3::UnitZ();
    }
    for (int step = 1; step <= kMaxSteps; ++step) {
      const Vec3 moved = step * kStep * away;
      if (isInTheWay(moved) || meetsOthers(moved)) continue;
      for (const std::size_t i : members) moves[i] = moved;
      break;
    }
  }
  return moves;
}

}  // namespace lorica

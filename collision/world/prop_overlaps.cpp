#include "collision/world/prop_overlaps.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lorica {
namespace {

bool contains(const ConvexHull& hull, const Vec3& p) {
  return std::all_of(hull.triangles.begin(), hull.triangles.end(), [&](const Triangle& t) {
    const Vec3& a = hull.vertices[t[0]];
    return (hull.vertices[t[1]] - a).cross(hull.vertices[t[2]] - a).dot(p - a) < 0.0;
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

Aabb boundsOf(const Prop& prop) {
  Vec3 half = prop.halfExtents;
  if (prop.shape == PropShape::kCapsule || prop.shape == PropShape::kCylinder) half.z() = half.x();
  const Vec3 reach = prop.shape == PropShape::kSphere ? Vec3(Vec3::Constant(half.x()))
                                                      : Vec3(prop.worldFromProp.linear().cwiseAbs() * half);
  const Vec3 centre = prop.worldFromProp.translation();
  return {centre - reach, centre + reach};
}

/// Visits each pair, except pairs of static bodies, whose bounding boxes overlap. @param visit  return false to stop
template <typename Visit>
void forNearPairs(std::span<const Prop> props, Visit visit) {
  std::vector<Aabb> boxes;
  boxes.reserve(props.size());
  for (const Prop& prop : props) boxes.push_back(boundsOf(prop));
  for (std::size_t b = 1; b < props.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      if (props[a].mass == 0.0 && props[b].mass == 0.0) continue;
      const Vec3 gap = (boxes[a].min - boxes[b].max).cwiseMax(boxes[b].min - boxes[a].max);
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

}  // namespace lorica

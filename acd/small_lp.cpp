#include "acd/small_lp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace lorica {

namespace {

using Vec2 = Eigen::Vector2d;

constexpr double kTolerance = 1e-11;
constexpr double kParallelPlanes = 1e-12;

/// The half-plane normal . y >= offset; the normal is not a unit vector.
struct HalfPlane {
  Vec2 normal;
  double offset;
};

/// Minimizes on the line base + t * direction, within all half-planes.
std::optional<Vec2> minimizeOnLine(const Vec2& objective, std::span<const HalfPlane> halfPlanes, const Vec2& base,
                                   const Vec2& direction, double reach) {
  double low = -reach;
  double high = reach;
  for (const HalfPlane& h : halfPlanes) {
    const double slope = h.normal.dot(direction);
    const double missing = h.offset - h.normal.dot(base);
    if (std::abs(slope) <= kParallelPlanes) {
      if (missing > kTolerance) return std::nullopt;
    } else if (slope > 0.0) {
      low = std::max(low, missing / slope);
    } else {
      high = std::min(high, missing / slope);
    }
  }
  if (low > high + kTolerance) return std::nullopt;
  const double slope = objective.dot(direction);
  const double t = slope > 0.0 ? low : slope < 0.0 ? high : std::clamp(0.0, std::min(low, high), high);
  return base + t * direction;
}

std::optional<Vec2> minimizeOnPlane(const Vec2& objective, std::span<const HalfPlane> halfPlanes, double reach) {
  Vec2 best(objective.x() > 0.0 ? -reach : reach, objective.y() > 0.0 ? -reach : reach);
  for (std::size_t i = 0; i < halfPlanes.size(); ++i) {
    const HalfPlane& h = halfPlanes[i];
    if (h.normal.dot(best) >= h.offset - kTolerance) continue;
    const double lengthSq = h.normal.squaredNorm();
    if (lengthSq <= kParallelPlanes * kParallelPlanes) return std::nullopt;  // parallel to the plane, and violated
    const Vec2 direction = Vec2(-h.normal.y(), h.normal.x()) / std::sqrt(lengthSq);
    const std::optional<Vec2> onLine =
        minimizeOnLine(objective, halfPlanes.first(i), h.normal * (h.offset / lengthSq), direction, 4.0 * reach);
    if (!onLine) return std::nullopt;
    best = *onLine;
  }
  return best;
}

}  // namespace

std::optional<Vec3> minimizeLinear(const Vec3& objective, std::span<const HalfSpace> halfSpaces, double reach) {
  std::array<HalfSpace, 6> box;
  Vec3 best;
  for (int axis = 0; axis < 3; ++axis) {
    box[2 * axis] = {Vec3::Unit(axis), -reach};
    box[2 * axis + 1] = {-Vec3::Unit(axis), -reach};
    best[axis] = objective[axis] > 0.0 ? -reach : reach;
  }
  std::vector<HalfPlane> inPlane;
  for (std::size_t i = 0; i < halfSpaces.size(); ++i) {
    const HalfSpace& h = halfSpaces[i];
    if (h.normal.dot(best) >= h.offset - kTolerance) continue;
    // The half-space excludes the best point so far: the new one is on its plane.
    const Vec3 base = h.normal * h.offset;
    const Vec3 u = h.normal.unitOrthogonal();
    const Vec3 v = h.normal.cross(u);
    inPlane.clear();
    const auto restrict = [&](const HalfSpace& other) {
      inPlane.push_back({Vec2(other.normal.dot(u), other.normal.dot(v)), other.offset - other.normal.dot(base)});
    };
    for (const HalfSpace& side : box) restrict(side);
    for (const HalfSpace& other : halfSpaces.first(i)) restrict(other);
    const std::optional<Vec2> y = minimizeOnPlane(Vec2(objective.dot(u), objective.dot(v)), inPlane, 4.0 * reach);
    if (!y) return std::nullopt;
    best = base + y->x() * u + y->y() * v;
  }
  return best;
}

}  // namespace lorica

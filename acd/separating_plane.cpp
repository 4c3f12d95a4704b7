#include "acd/separating_plane.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace lorica {
namespace {

constexpr int kSteps = 200;      // a walk takes about ten
constexpr double kTouch = 1e-9;  // hulls closer than this fraction of their size touch

/// The vertex farthest along a direction.
Vec3 farthest(std::span<const Vec3> points, const Vec3& direction) {
  return *std::max_element(points.begin(), points.end(),
                           [&](const Vec3& a, const Vec3& b) { return direction.dot(a) < direction.dot(b); });
}

/// The point nearest to the origin in the affine hull of one to three points; none if it lies outside their convex
/// hull.
std::optional<Vec3> nearestIn(std::span<const Vec3> points) {
  const Vec3& a = points[0];
  if (points.size() == 1) return a;
  const Vec3 u = points[1] - a;
  if (points.size() == 2) {
    const double t = -a.dot(u) / u.squaredNorm();
    if (!(t >= 0.0 && t <= 1.0)) return std::nullopt;
    return Vec3(a + t * u);
  }
  const Vec3 v = points[2] - a;
  const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v);
  const double au = -a.dot(u), av = -a.dot(v);
  const double determinant = uu * vv - uv * uv;
  const double s = (au * vv - av * uv) / determinant;
  const double t = (av * uu - au * uv) / determinant;
  if (!(s >= 0.0 && t >= 0.0 && s + t <= 1.0)) return std::nullopt;
  return Vec3(a + s * u + t * v);
}

/// Keeps those of up to four points whose convex hull has the point nearest to the origin. @return that point
Vec3 reduceToNearest(std::vector<Vec3>& points) {
  Vec3 nearest = Vec3::Zero();
  double least = std::numeric_limits<double>::infinity();
  std::vector<Vec3> kept, some;
  for (unsigned subset = 1; subset < (1U << points.size()); ++subset) {
    some.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
      if ((subset >> i & 1U) != 0) some.push_back(points[i]);
    }
    if (some.size() > 3) continue;
    const std::optional<Vec3> found = nearestIn(some);
    if (!found || !(found->squaredNorm() < least)) continue;
    least = found->squaredNorm();
    nearest = *found;
    kept = some;
  }
  points = kept;
  return nearest;
}

}  // namespace

std::optional<Plane> separatingPlane(std::span<const Vec3> above, std::span<const Vec3> below) {
  const double size = boundsOf(above).diagonal() + boundsOf(below).diagonal();
  std::vector<Vec3> differences = {above.front() - below.front()};  // vertices of the difference of the hulls
  double before = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kSteps; ++step) {
    const Vec3 between = reduceToNearest(differences);
    const double length = between.norm();
    if (length <= kTouch * size || length >= before) return std::nullopt;
    before = length;
    const Vec3 normal = between / length;
    const Vec3 nearAbove = farthest(above, -normal);
    const Vec3 nearBelow = farthest(below, normal);
    const double low = normal.dot(nearAbove);
    const double high = normal.dot(nearBelow);
    if (low - high > 0.5 * length) return Plane{normal, 0.5 * (low + high)};
    differences.emplace_back(nearAbove - nearBelow);
  }
  return std::nullopt;
}

}  // namespace lorica

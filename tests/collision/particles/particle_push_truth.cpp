#include "tests/collision/particles/particle_push_truth.h"

#include "tests/collision/parts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lorica::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

ParticleTruth::ParticleTruth(std::span<const LivePart> parts) {
  for (const LivePart& part : parts) {
    std::vector<Plane>& planes = planes_.emplace_back();
    const ConvexHull hull = worldHull(part);
    for (const Triangle& t : hull.triangles) {
      const Vec3& a = hull.vertices[t[0]];
      const Vec3& b = hull.vertices[t[1]];
      const Vec3& c = hull.vertices[t[2]];
      const Vec3 cross = (b - a).cross(c - a);
      if (!(cross.norm() > 1e-12)) continue;
      planes.push_back({cross.normalized(), cross.normalized().dot(a)});
    }
  }
  std::mt19937_64 random(1);
  for (int i = 0; i < 300; ++i) directions_.emplace_back(uniformRotation(random) * Vec3::UnitX());
}

double ParticleTruth::height(std::size_t part, const Vec3& p) const {
  double max = -kInfinity;
  for (const Plane& plane : planes_[part]) max = std::max(max, plane.normal.dot(p) - plane.offset);
  return planes_[part].empty() ? kInfinity : max;
}

double ParticleTruth::lowest(const Vec3& p) const {
  double min = kInfinity;
  for (std::size_t part = 0; part < planes_.size(); ++part) min = std::min(min, height(part, p));
  return min;
}

bool ParticleTruth::hasFace(std::size_t part, const Vec3& p, const Vec3& normal, double distance) const {
  return std::any_of(planes_[part].begin(), planes_[part].end(), [&](const Plane& plane) {
    return std::abs(plane.normal.dot(p) - plane.offset) < distance && plane.normal.dot(normal) > 1.0 - 1e-6;
  });
}

double ParticleTruth::wayOut(const Vec3& p) const {
  double shortest = lowest(p) < 0.0 ? kInfinity : 0.0;
  for (const Vec3& direction : directions_) {
    // The interval of the ray inside each hull. The way out extends as long as an interval covers its end.
    std::vector<std::pair<double, double>> covered;
    for (const std::vector<Plane>& planes : planes_) {
      double from = 0.0;
      double to = planes.empty() ? -1.0 : kInfinity;
      for (const Plane& plane : planes) {
        const double rise = plane.normal.dot(direction);
        const double depth = plane.offset - plane.normal.dot(p);
        if (rise > 0.0) to = std::min(to, depth / rise);
        if (rise < 0.0) from = std::max(from, depth / rise);
      }
      if (from < to) covered.emplace_back(from, to);
    }
    std::sort(covered.begin(), covered.end());
    double way = 0.0;
    for (const auto& [from, to] : covered) {
      if (from <= way) way = std::max(way, to);
    }
    shortest = std::min(shortest, way);
  }
  return shortest;
}

}  // namespace lorica::test

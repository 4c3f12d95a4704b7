#include "export/capsule.h"

#include <cmath>
#include <numbers>

namespace lorica {

namespace {

/// A circle that holds the points' projections along an axis: Ritter's way, from two far points outward.
struct Circle {
  Vec3 center;
  double radius = 0.0;
};

Circle circleAround(std::span<const Vec3> points, const Vec3& axis) {
  const auto flat = [&](const Vec3& p) -> Vec3 { return p - p.dot(axis) * axis; };
  const auto farthestFrom = [&](const Vec3& from) {
    Vec3 farthest = from;
    for (const Vec3& p : points) {
      if ((flat(p) - from).squaredNorm() > (farthest - from).squaredNorm()) farthest = flat(p);
    }
    return farthest;
  };
  const Vec3 first = farthestFrom(flat(points.front()));
  const Vec3 second = farthestFrom(first);
  Circle circle{0.5 * (first + second), 0.5 * (first - second).norm()};
  for (const Vec3& p : points) {
    const Vec3 away = flat(p) - circle.center;
    const double distance = away.norm();
    if (distance <= circle.radius) continue;
    const double grown = 0.5 * (circle.radius + distance);
    circle.center += (distance - grown) / distance * away;
    circle.radius = grown;
  }
  for (const Vec3& p : points) circle.radius = std::max(circle.radius, (flat(p) - circle.center).norm());
  return circle;
}

Capsule capsuleAlong(std::span<const Vec3> points, const Vec3& axis) {
  const Circle circle = circleAround(points, axis);
  // A ball around the axis at t holds a point if |t - along| <= reach: so the segment must begin before the first and
  // end behind the last of these intervals' inner ends.
  double begin = kInfinity;
  double end = -kInfinity;
  for (const Vec3& p : points) {
    const double along = p.dot(axis);
    const double across = (p - along * axis - circle.center).norm();
    const double reach = std::sqrt(std::max(0.0, circle.radius * circle.radius - across * across));
    begin = std::min(begin, along + reach);
    end = std::max(end, along - reach);
  }
  if (begin > end) begin = end = 0.5 * (begin + end);
  return {circle.center + begin * axis, circle.center + end * axis, circle.radius};
}

}  // namespace

double Capsule::volume() const {
  return std::numbers::pi * radius * radius * ((to - from).norm() + 4.0 / 3.0 * radius);
}

double Capsule::outside(const Vec3& p) const {
  const Vec3 along = to - from;
  const double lengthSq = along.squaredNorm();
  const double t = lengthSq > 0.0 ? std::clamp((p - from).dot(along) / lengthSq, 0.0, 1.0) : 0.0;
  return (p - from - t * along).norm() - radius;
}

Capsule capsuleAround(std::span<const Vec3> points) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) mean += p / points.size();
  Mat3 covariance = Mat3::Zero();
  for (const Vec3& p : points) covariance += (p - mean) * (p - mean).transpose();
  const SymmetricAxes axes = symmetricAxes(covariance);
  Capsule best = capsuleAlong(points, axes.vectors.col(2));
  for (const int i : {1, 0}) {
    const Capsule other = capsuleAlong(points, axes.vectors.col(i));
    if (other.volume() < best.volume()) best = other;
  }
  return best;
}

Capsule withVolume(const Capsule& capsule, double volume) {
  const double all = capsule.volume();
  if (all <= 0.0) return capsule;
  const double scale = std::cbrt(volume / all);
  const Vec3 middle = 0.5 * (capsule.from + capsule.to);
  return {middle + scale * (capsule.from - middle), middle + scale * (capsule.to - middle), scale * capsule.radius};
}

}  // namespace lorica

#include "collision/world/part_overlap.h"

#include "collision/world/bullet_math.h"

#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

namespace lorica {
namespace {

// Rotations of the frame in which a pair is tested.
constexpr int kViewCount = 8;
const btQuaternion kViews[kViewCount] = {{0, 0, 0, 1},
                                         {0.5f, 0.5f, 0.5f, 0.5f},
                                         {0.6f, 0, 0, 0.8f},
                                         {0, -0.28f, 0, 0.96f},
                                         {0.48f, 0, 0.36f, 0.8f},
                                         {-0.5f, 0.7f, -0.1f, 0.5f},
                                         {0.1f, -0.3f, 0.9f, 0.3f},
                                         {-0.7f, -0.1f, 0.1f, 0.7f}};

/// Greatest product of a point with a direction; -infinity without points. Keeps four of them, because each maximum
/// waits for the one before it.
double highest(std::span<const Vec3> points, const Vec3& direction) {
  std::array<double, 4> high;
  high.fill(-std::numeric_limits<double>::infinity());
  std::size_t i = 0;
  for (; i + high.size() <= points.size(); i += high.size()) {
    for (std::size_t k = 0; k < high.size(); ++k) high[k] = std::max(high[k], points[i + k].dot(direction));
  }
  for (; i < points.size(); ++i) high[0] = std::max(high[0], points[i].dot(direction));
  return std::max(std::max(high[0], high[1]), std::max(high[2], high[3]));
}

/// Overlap of the two along a direction: how far the second must move along it to leave the first behind [m].
double overlapAlong(const LivePart& first, const LivePart& second, const Vec3& direction) {
  const Vec3 inFirst = first.worldFromPart.linear().transpose() * direction;
  const Vec3 inSecond = second.worldFromPart.linear().transpose() * direction;
  const double high = highest(first.shape.vertices, inFirst);
  const double low = -highest(second.shape.vertices, -inSecond);
  return high + first.worldFromPart.translation().dot(direction) - low -
         second.worldFromPart.translation().dot(direction);
}

/// Two parts and the same in single precision.
struct Pair {
  const LivePart& first;
  const PartShape& firstShape;
  const LivePart& second;
  const PartShape& secondShape;
};

double quickHighest(const PartShape& shape, const Vec3& direction) {
  return fromBullet(shape.localGetSupportingVertexWithoutMargin(toBullet(direction))).dot(direction);
}

/// overlapAlong() to a millionth of the parts' sizes, in a fraction of the time.
double quickOverlapAlong(const Pair& pair, const Vec3& direction) {
  const Isometry3& first = pair.first.worldFromPart;
  const Isometry3& second = pair.second.worldFromPart;
  return quickHighest(pair.firstShape, first.linear().transpose() * direction) +
         quickHighest(pair.secondShape, -(second.linear().transpose() * direction)) +
         (first.translation() - second.translation()).dot(direction);
}

/// Searches the face normals of a hull for a direction of smaller depth. Never fails, but ignores edges.
/// @param sign  +1 for the first part's faces, -1 for the second's
void tryFaces(const Pair& pair, const LivePart& part, double sign, PartOverlap& overlap) {
  for (const Triangle& t : part.shape.triangles) {
    const Vec3 normal = areaNormal(part.shape.vertices, t);
    const double length = normal.norm();
    if (!(length > 0.0)) continue;
    const Vec3 direction = part.worldFromPart.linear() * (sign / length * normal);
    const double depth = quickOverlapAlong(pair, direction);
    if (depth >= overlap.depth) continue;
    overlap.depth = depth;
    overlap.direction = direction;
  }
}

/// Refines the direction by local search with decreasing steps: the minimum may be at a pair of edges, between faces.
void settle(const Pair& pair, PartOverlap& overlap) {
  constexpr int kAround = 16;
  std::array<std::pair<double, double>, kAround> circle;
  for (int i = 0; i < kAround; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kAround;
    circle[i] = {std::cos(angle), std::sin(angle)};
  }
  for (double step = 0.4; step > 1e-6;) {
    const Vec3 u = overlap.direction.unitOrthogonal(), v = overlap.direction.cross(u);
    PartOverlap best = overlap;
    for (const auto& [x, y] : circle) {
      const Vec3 direction = (overlap.direction + step * (x * u + y * v)).normalized();
      const double depth = quickOverlapAlong(pair, direction);
      if (depth < best.depth) {
        best.depth = depth;
        best.direction = direction;
      }
    }
    if (best.depth < overlap.depth) {
      overlap = best;
    } else {
      step *= 0.6;
    }
  }
  overlap.depth = overlapAlong(pair.first, pair.second, overlap.direction);
}

/// Whether no direction nearby has a smaller depth. EPA may stop at an edge of two aligned boxes, from either part.
bool isLeast(const LivePart& first, const LivePart& second, const PartOverlap& overlap) {
  constexpr double kNearby = 0.02;     // [rad]
  constexpr double kTolerance = 1e-4;  // [m]
  const Vec3 u = overlap.direction.unitOrthogonal(), v = overlap.direction.cross(u);
  for (const auto& [x, y] : {std::pair(1.0, 0.0), std::pair(0.0, 1.0), std::pair(-1.0, 0.0), std::pair(0.0, -1.0),
                             std::pair(0.7, 0.7), std::pair(-0.7, 0.7), std::pair(-0.7, -0.7), std::pair(0.7, -0.7)}) {
    const Vec3 direction = (overlap.direction + kNearby * (x * u + y * v)).normalized();
    if (overlapAlong(first, second, direction) < overlap.depth - kTolerance) return false;
  }
  return true;
}

/// The overlap with the second part grown by a radius; none if they are still apart.
std::optional<PartOverlap> rounded(PartOverlap overlap, double radius) {
  overlap.depth += radius;
  overlap.position -= 0.5 * radius * overlap.direction;
  if (overlap.depth > 0.0 && std::isfinite(overlap.depth)) return overlap;
  return std::nullopt;
}

}  // namespace

std::optional<PartOverlap> overlapOf(const LivePart& first, const PartShape& firstShape, const LivePart& second,
                                     const PartShape& secondShape, double radius) {
  const Isometry3 firstFromSecond = first.worldFromPart.inverse() * second.worldFromPart;
  const Isometry3 secondFromFirst = firstFromSecond.inverse();
  const btTransform there = toBullet(Quat(firstFromSecond.linear()), firstFromSecond.translation());
  const btTransform back = toBullet(Quat(secondFromFirst.linear()), secondFromFirst.translation());

  const Pair pair{first, firstShape, second, secondShape};
  PartOverlap overlap;
  overlap.depth = std::numeric_limits<double>::infinity();
  // For about one pair in ten thousand, Bullet reports an overlapping pair as separate, or its expanding polytope
  // algorithm (EPA) stops far from the minimum depth or fails. So its results are checked in double precision: parts
  // are separate only if a separating plane exists. Each depth is computed twice, from either part, and in rotated
  // frames until two results exist.
  int depths = 0;
  double deepest = 0.0;
  for (int look = 0; look < 2 * kViewCount && depths < 2; ++look) {
    const bool swapped = look % 2 == 1;
    const LivePart& mine = swapped ? second : first;
    const PartShape& myShape = swapped ? secondShape : firstShape;
    const PartShape& otherShape = swapped ? firstShape : secondShape;
    // In the part's own frame, single precision is accurate to about 0.001 mm.
    const btTransform view(kViews[look / 2]);
    const btTransform other = view * (swapped ? back : there);
    const Mat3 worldFromView = mine.worldFromPart.linear() * fromBullet(view).linear().transpose();
    const double sign = swapped ? 1.0 : -1.0;
    btGjkEpaSolver2::sResults results;
    const auto direction = [&] { return Vec3(worldFromView * (sign * fromBullet(results.normal).normalized())); };
    const auto middle = [&] {
      const Vec3 inView = 0.5 * (fromBullet(results.witnesses[0]) + fromBullet(results.witnesses[1]));
      return Vec3(worldFromView * inView + mine.worldFromPart.translation());
    };
    if (depths == 0 && btGjkEpaSolver2::Distance(&myShape, view, &otherShape, other, other.getOrigin(), results)) {
      PartOverlap gap{middle(), direction(), overlapAlong(first, second, direction())};
      if (gap.depth <= 0.0) {
        // About one search in a thousand ends too early: then the points that it found are farther apart than the
        // parts are along their direction.
        if (radius > 0.0 && results.distance + gap.depth > 1e-4) settle(pair, gap);
        return rounded(gap, radius);
      }
    }
    if (!btGjkEpaSolver2::Penetration(&myShape, view, &otherShape, other, other.getOrigin(), results, false)) continue;
    ++depths;
    const double depth = overlapAlong(first, second, direction());
    deepest = std::max(deepest, depth);
    if (depth >= overlap.depth) continue;
    overlap.depth = depth;
    overlap.direction = direction();
    overlap.position = middle();
  }
  if (depths < 2 || deepest > 1.02 * overlap.depth + 1e-4 || !isLeast(first, second, overlap)) {
    tryFaces(pair, first, 1.0, overlap);
    tryFaces(pair, second, -1.0, overlap);
    settle(pair, overlap);
  }
  return rounded(overlap, radius);
}

}  // namespace lorica

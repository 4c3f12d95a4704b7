#include "collision/world/self_contact.h"

#include "acd/transfer.h"
#include "collision/world/bullet_math.h"
#include "collision/world/part_shape.h"
#include "geometry/result.h"

#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace lorica {
namespace {

constexpr btScalar kRestGap = 0.005f;  // hulls closer than this in the rest pose are neighbours [m]

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

/// A part's shape in Bullet.
struct Solid {
  PartShape shape{0.0f};
  Aabb bounds;  ///< world [m]
};

bool apart(const Aabb& a, const Aabb& b) {
  return (a.min.array() > b.max.array()).any() || (b.min.array() > a.max.array()).any();
}

/// Whether two parts have points in common. @param a,b  with points in ascending order
bool sharePoints(const Part& a, const Part& b) {
  auto i = a.points.begin();
  auto j = b.points.begin();
  while (i != a.points.end() && j != b.points.end()) {
    if (*i == *j) return true;
    if (*i < *j) {
      ++i;
    } else {
      ++j;
    }
  }
  return false;
}

/// Overlap of the two along a direction: how far the second must move along it to leave the first behind [m].
double overlapAlong(const LivePart& first, const LivePart& second, const Vec3& direction) {
  const Vec3 inFirst = first.worldFromPart.linear().transpose() * direction;
  const Vec3 inSecond = second.worldFromPart.linear().transpose() * direction;
  double high = -std::numeric_limits<double>::infinity();
  double low = std::numeric_limits<double>::infinity();
  for (const Vec3& v : first.shape.vertices) high = std::max(high, v.dot(inFirst));
  for (const Vec3& v : second.shape.vertices) low = std::min(low, v.dot(inSecond));
  return high + first.worldFromPart.translation().dot(direction) - low -
         second.worldFromPart.translation().dot(direction);
}

/// Searches the face normals of a hull for a direction of smaller depth. Never fails, but ignores edges.
/// @param sign  +1 for the first part's faces, -1 for the second's
void tryFaces(const LivePart& first, const LivePart& second, const LivePart& of, double sign, SelfContact& contact) {
  const std::vector<Vec3>& v = of.shape.vertices;
  for (const Triangle& t : of.shape.triangles) {
    const Vec3& corner = v[t[0]];
    const Vec3 normal = (v[t[1]] - corner).cross(v[t[2]] - corner);
    const double length = normal.norm();
    if (!(length > 0.0)) continue;
    const Vec3 direction = of.worldFromPart.linear() * (sign / length * normal);
    const double depth = overlapAlong(first, second, direction);
    if (depth >= contact.depth) continue;
    contact.depth = depth;
    contact.direction = direction;
  }
}

/// Refines the direction by local search with decreasing steps: the minimum may be at a pair of edges, between faces.
void settle(const LivePart& first, const LivePart& second, SelfContact& contact) {
  constexpr int kAround = 16;
  for (double step = 0.4; step > 1e-6;) {
    const Vec3 u = contact.direction.unitOrthogonal(), v = contact.direction.cross(u);
    SelfContact best = contact;
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kAround;
      const Vec3 direction = (contact.direction + step * (std::cos(angle) * u + std::sin(angle) * v)).normalized();
      const double depth = overlapAlong(first, second, direction);
      if (depth < best.depth) {
        best.depth = depth;
        best.direction = direction;
      }
    }
    if (best.depth < contact.depth) {
      contact = best;
    } else {
      step *= 0.6;
    }
  }
}

}  // namespace

struct SelfContactQuery::Impl {
  std::vector<Solid> solids;
  std::vector<std::uint8_t> neighbours;  ///< matrix of parts, 1 = neighbours
  std::vector<SelfContact> contacts;
  std::vector<std::pair<double, PartIndex>> order;  ///< parts by the lower bound of x

  [[nodiscard]] std::uint8_t& neighbour(std::size_t a, std::size_t b) { return neighbours[a * solids.size() + b]; }
  void test(std::span<const LivePart> parts, PartIndex a, PartIndex b);
};

SelfContactQuery::SelfContactQuery(const LiveBody& body, std::span<const Vec3> rest) : impl_(std::make_unique<Impl>()) {
  const Decomposition& decomposition = body.decomposition();
  LORICA_CHECK(rest.size() == static_cast<std::size_t>(decomposition.vertexCount),
               "the rest pose must have the vertices of the body's mesh");
  const std::size_t count = decomposition.parts.size();
  impl_->solids.resize(count);
  impl_->neighbours.assign(count * count, 1);
  impl_->contacts.reserve(count * (count - 1) / 2);
  impl_->order.reserve(count);

  std::vector<Vec3> points(static_cast<std::size_t>(decomposition.pointCount()));
  transfer(decomposition, rest, points);
  const std::vector<ConvexHull> hulls = partHulls(decomposition, points);
  for (std::size_t i = 0; i < count; ++i) {
    impl_->solids[i].shape.setPoints(hulls[i].vertices);
    impl_->solids[i].bounds = boundsOf(hulls[i].vertices);
  }
  const btTransform origin = btTransform::getIdentity();
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = a + 1; b < count; ++b) {
      if (sharePoints(decomposition.parts[a], decomposition.parts[b])) continue;
      const Vec3 between = impl_->solids[b].bounds.center() - impl_->solids[a].bounds.center();
      btGjkEpaSolver2::sResults results;
      const bool measured = btGjkEpaSolver2::Distance(&impl_->solids[a].shape, origin, &impl_->solids[b].shape, origin,
                                                      toBullet(between), results);
      const bool close = !measured || results.distance < kRestGap;
      impl_->neighbour(a, b) = impl_->neighbour(b, a) = close ? 1 : 0;
    }
  }
  for (std::size_t i = 0; i < count; ++i)
    impl_->solids[i].shape.reserve(body.candidateCount(static_cast<PartIndex>(i)));
}

SelfContactQuery::~SelfContactQuery() = default;
SelfContactQuery::SelfContactQuery(SelfContactQuery&&) noexcept = default;
SelfContactQuery& SelfContactQuery::operator=(SelfContactQuery&&) noexcept = default;

bool SelfContactQuery::areNeighbours(PartIndex a, PartIndex b) const {
  return impl_->neighbour(static_cast<std::size_t>(a), static_cast<std::size_t>(b)) != 0;
}

std::span<const SelfContact> SelfContactQuery::find(std::span<const LivePart> parts) {
  LORICA_CHECK(parts.size() == impl_->solids.size(), "the parts must be those of the query's body");
  std::vector<Solid>& solids = impl_->solids;
  impl_->contacts.clear();
  impl_->order.clear();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].shape.degenerate()) continue;
    solids[i].shape.setPoints(parts[i].shape.vertices);
    Aabb& bounds = solids[i].bounds;
    bounds = Aabb();
    for (const Vec3& v : parts[i].shape.vertices) bounds.extend(parts[i].worldFromPart * v);
    impl_->order.emplace_back(bounds.min.x(), static_cast<PartIndex>(i));
  }
  std::sort(impl_->order.begin(), impl_->order.end());
  for (auto i = impl_->order.begin(); i != impl_->order.end(); ++i) {
    const auto a = static_cast<std::size_t>(i->second);
    for (auto j = i + 1; j != impl_->order.end() && j->first <= solids[a].bounds.max.x(); ++j) {
      const auto b = static_cast<std::size_t>(j->second);
      if (impl_->neighbour(a, b) != 0 || apart(solids[a].bounds, solids[b].bounds)) continue;
      impl_->test(parts, std::min(i->second, j->second), std::max(i->second, j->second));
    }
  }
  std::sort(impl_->contacts.begin(), impl_->contacts.end(), [](const SelfContact& a, const SelfContact& b) {
    return std::pair(a.first, a.second) < std::pair(b.first, b.second);
  });
  return impl_->contacts;
}

void SelfContactQuery::Impl::test(std::span<const LivePart> parts, PartIndex a, PartIndex b) {
  const LivePart& first = parts[a];
  const LivePart& second = parts[b];
  const PartShape& firstShape = solids[a].shape;
  const PartShape& secondShape = solids[b].shape;
  const Isometry3 firstFromSecond = first.worldFromPart.inverse() * second.worldFromPart;
  const Isometry3 secondFromFirst = firstFromSecond.inverse();
  const btTransform there = toBullet(Quat(firstFromSecond.linear()), firstFromSecond.translation());
  const btTransform back = toBullet(Quat(secondFromFirst.linear()), secondFromFirst.translation());

  SelfContact contact;
  contact.first = a;
  contact.second = b;
  contact.depth = std::numeric_limits<double>::infinity();
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
    if (depths == 0 && btGjkEpaSolver2::Distance(&myShape, view, &otherShape, other, other.getOrigin(), results) &&
        overlapAlong(first, second, direction()) <= 0.0) {
      return;
    }
    if (!btGjkEpaSolver2::Penetration(&myShape, view, &otherShape, other, other.getOrigin(), results, false)) continue;
    ++depths;
    const double depth = overlapAlong(first, second, direction());
    deepest = std::max(deepest, depth);
    if (depth >= contact.depth) continue;
    contact.depth = depth;
    contact.direction = direction();
    const Vec3 middle = 0.5 * (fromBullet(results.witnesses[0]) + fromBullet(results.witnesses[1]));
    contact.position = worldFromView * middle + mine.worldFromPart.translation();
  }
  if (depths < 2 || deepest > 1.02 * contact.depth + 1e-4) {
    tryFaces(first, second, first, 1.0, contact);
    tryFaces(first, second, second, -1.0, contact);
    settle(first, second, contact);
  }
  if (contact.depth > 0.0 && std::isfinite(contact.depth)) contacts.push_back(contact);
}

}  // namespace lorica

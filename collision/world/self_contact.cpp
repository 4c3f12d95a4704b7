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

// Turned frames to look at a pair in.
constexpr int kViewCount = 8;
const btQuaternion kViews[kViewCount] = {{0, 0, 0, 1},
                                         {0.5f, 0.5f, 0.5f, 0.5f},
                                         {0.6f, 0, 0, 0.8f},
                                         {0, -0.28f, 0, 0.96f},
                                         {0.48f, 0, 0.36f, 0.8f},
                                         {-0.5f, 0.7f, -0.1f, 0.5f},
                                         {0.1f, -0.3f, 0.9f, 0.3f},
                                         {-0.7f, -0.1f, 0.1f, 0.7f}};

/// A part as Bullet sees it.
struct Solid {
  PartShape shape{0.0f};
  Aabb bounds;  ///< world [m]
};

bool apart(const Aabb& a, const Aabb& b) {
  return (a.min.array() > b.max.array()).any() || (b.min.array() > a.max.array()).any();
}

/// Whether points of both parts are the same. @param a,b  with points in ascending order
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

/// How far the first must be left behind along a direction until nothing of it is beyond the second [m].
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

/// Looks along the normals of a hull's faces for one that is less deep. Never fails, and knows no edges.
/// @param sign  +1 for the first part's faces, -1 for the second's
void tryFaces(const LivePart& first, const LivePart& second, const LivePart& of, double sign, SelfContact& contact) {
  const std::vector<Vec3>& v = of.shape.vertices;
  for (const Triangle& t : of.shape.triangles) {
    const Vec3& corner = v[static_cast<std::size_t>(t[0])];
    const Vec3 normal = (v[static_cast<std::size_t>(t[1])] - corner).cross(v[static_cast<std::size_t>(t[2])] - corner);
    const double length = normal.norm();
    if (!(length > 0.0)) continue;
    const Vec3 direction = of.worldFromPart.linear() * (sign / length * normal);
    const double depth = overlapAlong(first, second, direction);
    if (depth >= contact.depth) continue;
    contact.depth = depth;
    contact.direction = direction;
  }
}

/// Turns the direction to where the overlap is less, in ever smaller steps: between faces it is an edge's matter.
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
  std::vector<std::uint8_t> neighbours;  ///< of each part, each part
  std::vector<SelfContact> contacts;
  std::vector<std::pair<double, PartIndex>> order;  ///< parts by where their bounds begin along x

  [[nodiscard]] std::uint8_t& neighbour(std::size_t a, std::size_t b) { return neighbours[a * solids.size() + b]; }
  void test(std::span<const LivePart> parts, PartIndex a, PartIndex b);
};

SelfContactQuery::SelfContactQuery(const LiveBody& body, std::span<const Vec3> rest) : impl_(std::make_unique<Impl>()) {
  const Decomposition& decomposition = body.decomposition();
  CHECK(rest.size() == static_cast<std::size_t>(decomposition.vertexCount), "the rest pose is one of the body's mesh");
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
  CHECK(parts.size() == impl_->solids.size(), "the parts are those of the query's body");
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
  const LivePart& first = parts[static_cast<std::size_t>(a)];
  const LivePart& second = parts[static_cast<std::size_t>(b)];
  const PartShape& firstShape = solids[static_cast<std::size_t>(a)].shape;
  const PartShape& secondShape = solids[static_cast<std::size_t>(b)].shape;
  const Isometry3 firstFromSecond = first.worldFromPart.inverse() * second.worldFromPart;
  const Isometry3 secondFromFirst = firstFromSecond.inverse();
  const btTransform there = toBullet(Quat(firstFromSecond.linear()), firstFromSecond.translation());
  const btTransform back = toBullet(Quat(secondFromFirst.linear()), secondFromFirst.translation());

  SelfContact contact;
  contact.first = a;
  contact.second = b;
  contact.depth = std::numeric_limits<double>::infinity();
  // Now and then, in one pair of ten thousand, Bullet takes for apart what overlaps, or its expanding polytope ends far
  // from the least depth, or nowhere. So what it says is checked in double precision: apart are two parts with a plane
  // between them. And it says it twice, from either part, and from other sides until it did.
  int depths = 0;
  double deepest = 0.0;
  for (int look = 0; look < 2 * kViewCount && depths < 2; ++look) {
    const bool swapped = look % 2 == 1;
    const LivePart& mine = swapped ? second : first;
    const PartShape& myShape = swapped ? secondShape : firstShape;
    const PartShape& otherShape = swapped ? firstShape : secondShape;
    // In a part's own place single precision is good for a thousandth of a millimetre.
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
    contact.place = worldFromView * middle + mine.worldFromPart.translation();
  }
  if (depths < 2 || deepest > 1.02 * contact.depth + 1e-4) {
    tryFaces(first, second, first, 1.0, contact);
    tryFaces(first, second, second, -1.0, contact);
    settle(first, second, contact);
  }
  if (contact.depth > 0.0 && std::isfinite(contact.depth)) contacts.push_back(contact);
}

}  // namespace lorica

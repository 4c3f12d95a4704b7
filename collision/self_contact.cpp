#include "collision/self_contact.h"

#include "acd/transfer.h"
#include "collision/bullet_math.h"
#include "collision/part_shape.h"
#include "geometry/result.h"

#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>

#include <algorithm>
#include <cstdint>
#include <limits>

namespace lorica {
namespace {

constexpr btScalar kRestGap = 0.005f;  // hulls closer than this in the rest pose are neighbours [m]

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
  // In the first part's frame, where single precision is good for a thousandth of a millimetre.
  const Isometry3 firstFromSecond = first.worldFromPart.inverse() * second.worldFromPart;
  const btTransform place = toBullet(Quat(firstFromSecond.linear()), firstFromSecond.translation());
  btGjkEpaSolver2::sResults results;
  if (!btGjkEpaSolver2::Penetration(&firstShape, btTransform::getIdentity(), &secondShape, place, place.getOrigin(),
                                    results, false)) {
    return;
  }
  SelfContact contact;
  contact.first = a;
  contact.second = b;
  contact.place =
      first.worldFromPart * Vec3(0.5 * (fromBullet(results.witnesses[0]) + fromBullet(results.witnesses[1])));
  contact.direction = first.worldFromPart.linear() * -fromBullet(results.normal).normalized();
  contact.depth = overlapAlong(first, second, contact.direction);
  if (contact.depth > 0.0) contacts.push_back(contact);
}

}  // namespace lorica

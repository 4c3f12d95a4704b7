#include "collision/world/self_contact.h"

#include "acd/transfer.h"
#include "collision/live/extent_kernel.h"
#include "collision/world/bullet_math.h"
#include "collision/world/part_overlap.h"
#include "collision/world/part_shape.h"
#include "geometry/counts.h"
#include "geometry/result.h"

#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>

#include <algorithm>
#include <cstdint>
#include <optional>

namespace lorica {
namespace {

constexpr btScalar kRestGap = 0.005f;  // hulls closer than this in the rest pose are neighbours [m]

/// A part's shape in Bullet.
struct SelfSolid {
  PartShape shape{0.0f};
  Aabb bounds;  ///< world [m]
};

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

}  // namespace

struct SelfContactQuery::Impl {
  std::vector<SelfSolid> solids;
  std::vector<std::uint8_t> neighbours;  ///< matrix of parts, 1 = neighbours
  std::vector<SelfContact> contacts;
  std::vector<std::pair<double, PartIndex>> order;  ///< parts by the lower bound of x

  [[nodiscard]] std::uint8_t& neighbour(std::size_t a, std::size_t b) { return neighbours[a * solids.size() + b]; }
  void test(std::span<const LivePart> parts, PartIndex a, PartIndex b);
};

SelfContactQuery::SelfContactQuery(const LiveBody& body, std::span<const Vec3> rest) : impl_(std::make_unique<Impl>()) {
  const Decomposition& decomposition = body.decomposition();
  LORICA_CHECK(countOf(rest) == decomposition.vertexCount, "the rest pose must have the vertices of the body's mesh");
  const std::size_t count = decomposition.parts.size();
  impl_->solids.resize(count);
  impl_->neighbours.assign(count * count, 1);
  impl_->contacts.reserve(count * (count - 1) / 2);
  impl_->order.reserve(count);

  std::vector<Vec3> points(decomposition.pointCount());
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
  for (std::size_t i = 0; i < count; ++i) impl_->solids[i].shape.reserve(body.candidateCount(i));
}

SelfContactQuery::~SelfContactQuery() = default;
SelfContactQuery::SelfContactQuery(SelfContactQuery&&) noexcept = default;
SelfContactQuery& SelfContactQuery::operator=(SelfContactQuery&&) noexcept = default;

bool SelfContactQuery::areNeighbours(PartIndex a, PartIndex b) const {
  return impl_->neighbour(a, b) != 0;
}

std::span<const SelfContact> SelfContactQuery::find(std::span<const LivePart> parts) {
  LORICA_CHECK(parts.size() == impl_->solids.size(), "the parts must be those of the query's body");
  std::vector<SelfSolid>& solids = impl_->solids;
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
    const std::size_t a = i->second;
    for (auto j = i + 1; j != impl_->order.end() && j->first <= solids[a].bounds.max.x(); ++j) {
      const std::size_t b = j->second;
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
  const std::optional<PartOverlap> overlap = overlapOf(parts[a], solids[a].shape, parts[b], solids[b].shape);
  if (overlap) contacts.push_back({a, b, overlap->position, overlap->direction, overlap->depth});
}

}  // namespace lorica

#include "collision/particles/particle_push_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace lorica {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Max number of hulls around a particle that are considered in the search for a near way out.
constexpr std::size_t kMaxHulls = 8;
/// Ways out of one hull that are tried, each in a different direction.
constexpr std::size_t kMaxWays = 8;
/// Max number of planes met on the way into a crease; and which of the older ones are tried with the newest.
constexpr std::size_t kMaxSides = 4;
constexpr std::array<std::array<std::size_t, 3>, 7> kSubsets = {
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 2, 0}, {2, 0, 1}, {2, 0, 2}, {2, 1, 2}}};

/// A plane of a hull.
struct Side {
  std::uint32_t hull = 0;
  std::uint32_t plane = 0;
};

/// One particle's search.
class Search {
 public:
  Search(const PushHulls& hulls, const PushGrid& grid, const Vec3f& start)
      : hulls_(hulls), grid_(grid), start_(start) {}

  PushExit run(const PushDepth& inside);

 private:
  [[nodiscard]] std::optional<Vec3f> ontoAll(std::span<const Side> sides) const;
  [[nodiscard]] bool onSurfaces(const Vec3f& p, std::span<const Side> sides) const;
  std::optional<Side> tryPosition(std::span<const Side> sides);
  void tryCreases();
  void tryAlong(const Vec3f& direction);

  const PushHulls& hulls_;
  const PushGrid& grid_;
  Vec3f start_;
  std::array<Side, kMaxSides> sides_;
  std::size_t sideCount_ = 0;
  PushExit best_{};
  float length_ = kInfinity;  ///< from the start to the best
};

/// The point nearest to the start that is a margin above all of up to three planes; none if they are too parallel.
std::optional<Vec3f> Search::ontoAll(std::span<const Side> sides) const {
  std::array<Vec3, 3> normals;
  Vec3 lift;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    normals[i] = hulls_.normal(sides[i].plane).cast<double>();
    lift[i] = hulls_.margin() - hulls_.height(sides[i].plane, start_);
  }
  const Vec3 from = start_.cast<double>();
  if (sides.size() == 1) return (from + lift[0] * normals[0]).cast<float>();
  if (sides.size() == 2) {
    const double cosine = normals[0].dot(normals[1]);
    const double sineSq = 1.0 - cosine * cosine;
    if (sineSq < 1e-3) return {};
    const Vec3 moved =
        ((lift[0] - cosine * lift[1]) / sineSq) * normals[0] + ((lift[1] - cosine * lift[0]) / sineSq) * normals[1];
    return (from + moved).cast<float>();
  }
  const double determinant = normals[0].dot(normals[1].cross(normals[2]));
  if (std::abs(determinant) < 1e-2) return {};
  const Vec3 moved = (lift[0] * normals[1].cross(normals[2]) + lift[1] * normals[2].cross(normals[0]) +
                      lift[2] * normals[0].cross(normals[1])) /
                     determinant;
  return (from + moved).cast<float>();
}

/// Whether a point on these planes is on the faces of their hulls.
bool Search::onSurfaces(const Vec3f& p, std::span<const Side> sides) const {
  return std::all_of(sides.begin(), sides.end(),
                     [&](const Side& side) { return !isAbove(hulls_, side.hull, p, 8.0F * hulls_.margin()); });
}

/// Tries the point of some planes that is nearest to the start, and keeps it if it is the nearest so far.
/// @param sides  the newest first
/// @return the side of another hull in which it lies
std::optional<Side> Search::tryPosition(std::span<const Side> sides) {
  const std::optional<Vec3f> position = ontoAll(sides);
  if (!position) return {};
  const float distance = (*position - start_).norm();
  if (distance >= length_) return {};
  const PushDepth met = deepestAt(hulls_, grid_, *position);
  if (met.height < 0.0F) return Side{met.hull, met.plane};
  if (!onSurfaces(*position, sides)) return {};
  length_ = distance;
  best_ = {*position, sides[0].hull, sides[0].plane};
  return {};
}

/// Tries to leave one hull, then the hulls that this leads into, and tries the creases between some of them.
void Search::tryCreases() {
  while (length_ == kInfinity) {
    std::optional<Side> next;
    for (const std::array<std::size_t, 3>& others : kSubsets) {
      std::array<Side, 3> used = {sides_[sideCount_ - 1]};
      bool known = true;
      for (std::size_t i = 1; i <= others[0]; ++i) {
        known = known && others[i] + 1 < sideCount_;
        used[i] = sides_[others[i]];
      }
      if (!known) continue;
      const std::optional<Side> met = tryPosition(std::span(used).first(1 + others[0]));
      if (!next) next = met;
    }
    if (!next || sideCount_ == kMaxSides) return;
    for (std::size_t i = 0; i < sideCount_; ++i) {
      if (sides_[i].plane == next->plane) return;  // back and forth
    }
    sides_[sideCount_++] = *next;
  }
}

/// Follows a ray until it is outside of all hulls. It leaves each convex hull once, so this ends.
void Search::tryAlong(const Vec3f& direction) {
  float length = 0.0F;
  Side side;
  const std::size_t rounds = hulls_.hulls().size() + 1;
  for (std::size_t round = 0; round < rounds && length < length_; ++round) {
    const Vec3f here = start_ + length * direction;
    const PushDepth met = deepestAt(hulls_, grid_, here);
    if (!(met.height < 0.0F)) {
      length_ = length;
      best_ = {here, side.hull, side.plane};
      return;
    }
    const PushLeave leave = leaveHull(hulls_, met.hull, here, direction);
    length += leave.length;
    side = {met.hull, leave.plane};
  }
}

/// Directions to try if everything else leads far.
const std::array<Vec3f, 14>& anyDirections() {
  static const std::array<Vec3f, 14> directions = [] {
    const float third = std::sqrt(1.0F / 3.0F);
    std::array<Vec3f, 14> made;
    for (std::size_t i = 0; i < 8; ++i) {
      made[i] = third * Vec3f((i & 1U) != 0 ? 1.0F : -1.0F, (i & 2U) != 0 ? 1.0F : -1.0F, (i & 4U) != 0 ? 1.0F : -1.0F);
    }
    for (std::size_t i = 0; i < 6; ++i) {
      made[8 + i] = (i % 2 == 0 ? 1.0F : -1.0F) * Vec3f::Unit(i / 2);
    }
    return made;
  }();
  return directions;
}

PushExit Search::run(const PushDepth& inside) {
  // The shortest way out is never shorter than the way out of the hull in which the particle is deepest.
  const float min = hulls_.margin() - inside.height;
  best_ = {start_, inside.hull, inside.plane};

  // The nearest way out of any other hull that contains the start.
  std::array<PushDepth, kMaxHulls> depths;
  const std::size_t held = depthsAt(hulls_, grid_, start_, depths);
  for (std::size_t i = 0; i < held; ++i) {
    const Side side{depths[i].hull, depths[i].plane};
    if (side.plane != inside.plane) (void)tryPosition(std::span(&side, 1));
  }
  sides_[sideCount_++] = {inside.hull, inside.plane};
  tryCreases();
  if (length_ <= 2.0F * min) return best_;

  std::array<PushDepth, kMaxWays> ways;
  for (std::size_t i = 0; i < held; ++i) {
    const std::size_t count = waysOut(hulls_, depths[i].hull, start_, length_, ways);
    for (std::size_t k = 1; k < count; ++k) {
      const Side side{ways[k].hull, ways[k].plane};
      (void)tryPosition(std::span(&side, 1));
    }
  }
  if (length_ < kInfinity) return best_;

  for (std::size_t i = 0; i < held; ++i) tryAlong(hulls_.normal(depths[i].plane));
  for (std::size_t i = 1; i < sideCount_; ++i) tryAlong(hulls_.normal(sides_[i].plane));
  if (length_ < kInfinity) return best_;
  for (const Vec3f& direction : anyDirections()) tryAlong(direction);
  return best_;
}

}  // namespace

PushExit findExit(const PushHulls& hulls, const PushGrid& grid, const Vec3f& start, const PushDepth& inside) {
  return Search(hulls, grid, start).run(inside);
}

}  // namespace lorica

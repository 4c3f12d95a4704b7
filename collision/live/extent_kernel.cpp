#include "collision/live/extent_kernel.h"

// Highway compiles the code between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/live/extent_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <hwy/cache_control.h>

#include <algorithm>
#include <cstdint>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace lorica::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Doubles = hn::CappedTag<double, 8>;
using Lanes = hn::Vec<Doubles>;
using Floats = hn::CappedTag<float, kSupportBlock>;  // any smaller power of two divides a block too
using Ints = hn::RebindToSigned<Floats>;

// Whole vectors of points only; products and sums are not fused, so that every instruction set rounds alike.

/// Bounds of as many points as lanes divide, about the motion's origin.
std::size_t extendBounds(std::span<const Vec3> points, const Mat3& rotation, Aabb& bounds) {
  const Doubles d;
  const std::size_t lanes = hn::Lanes(d);
  if (points.size() < lanes) return 0;
  const auto along = [&](int axis, Lanes x, Lanes y, Lanes z) {
    return hn::Add(hn::Add(hn::Mul(hn::Set(d, rotation(axis, 0)), x), hn::Mul(hn::Set(d, rotation(axis, 1)), y)),
                   hn::Mul(hn::Set(d, rotation(axis, 2)), z));
  };
  auto lowX = hn::Set(d, kInfinity), lowY = lowX, lowZ = lowX;
  auto highX = hn::Set(d, -kInfinity), highY = highX, highZ = highX;
  std::size_t done = 0;
  for (; done + lanes <= points.size(); done += lanes) {
    Lanes x, y, z;
    hn::LoadInterleaved3(d, points[done].data(), x, y, z);
    const auto alongX = along(0, x, y, z), alongY = along(1, x, y, z), alongZ = along(2, x, y, z);
    lowX = hn::Min(lowX, alongX);
    lowY = hn::Min(lowY, alongY);
    lowZ = hn::Min(lowZ, alongZ);
    highX = hn::Max(highX, alongX);
    highY = hn::Max(highY, alongY);
    highZ = hn::Max(highZ, alongZ);
  }
  bounds.min = {hn::GetLane(hn::MinOfLanes(d, lowX)), hn::GetLane(hn::MinOfLanes(d, lowY)),
                hn::GetLane(hn::MinOfLanes(d, lowZ))};
  bounds.max = {hn::GetLane(hn::MaxOfLanes(d, highX)), hn::GetLane(hn::MaxOfLanes(d, highY)),
                hn::GetLane(hn::MaxOfLanes(d, highZ))};
  return done;
}

/// The same with the greatest squared distance.
std::size_t extendDistance(std::span<const Vec3> points, double& distanceSq) {
  const Doubles d;
  const std::size_t lanes = hn::Lanes(d);
  auto farthest = hn::Zero(d);
  std::size_t done = 0;
  for (; done + lanes <= points.size(); done += lanes) {
    Lanes x, y, z;
    hn::LoadInterleaved3(d, points[done].data(), x, y, z);
    farthest = hn::Max(farthest, hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)));
  }
  distanceSq = hn::GetLane(hn::MaxOfLanes(d, farthest));
  return done;
}

int findSupport(const float* x, const float* y, const float* z, int count, float dx, float dy, float dz) {
  const Floats f;
  const Ints n;
  const int lanes = hn::Lanes(f);
  const auto directionX = hn::Set(f, dx);
  const auto directionY = hn::Set(f, dy);
  const auto directionZ = hn::Set(f, dz);
  auto here = hn::Iota(n, 0);
  auto best = hn::Set(f, -std::numeric_limits<float>::infinity());
  auto where = here;
  for (int i = 0; i < count; i += lanes) {
    // Not fused, so that every instruction set rounds alike.
    const auto value =
        hn::Add(hn::Add(hn::Mul(directionX, hn::LoadU(f, x + i)), hn::Mul(directionY, hn::LoadU(f, y + i))),
                hn::Mul(directionZ, hn::LoadU(f, z + i)));
    const auto better = hn::Gt(value, best);
    best = hn::IfThenElse(better, value, best);
    where = hn::IfThenElse(hn::RebindMask(n, better), here, where);
    here = hn::Add(here, hn::Set(n, lanes));
  }
  const auto farthest = hn::Eq(best, hn::MaxOfLanes(f, best));
  const auto none = hn::Set(n, std::numeric_limits<std::int32_t>::max());
  const int first = hn::GetLane(hn::MinOfLanes(n, hn::IfThenElse(hn::RebindMask(n, farthest), where, none)));
  return first < count ? first : 0;  // a NaN direction makes every comparison false
}

}  // namespace lorica::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace lorica {
namespace {
HWY_EXPORT(extendBounds);
HWY_EXPORT(extendDistance);
HWY_EXPORT(findSupport);
}  // namespace

Aabb boundsOf(std::span<const Vec3> points, const Isometry3& motion) {
  const Mat3 rotation = motion.linear();
  Aabb bounds;
  const std::size_t done = HWY_DYNAMIC_DISPATCH(extendBounds)(points, rotation, bounds);
  for (const Vec3& p : points.subspan(done)) {
    Vec3 turned;
    for (int axis = 0; axis < 3; ++axis) {
      turned[axis] = rotation(axis, 0) * p.x() + rotation(axis, 1) * p.y() + rotation(axis, 2) * p.z();
    }
    bounds.extend(turned);
  }
  bounds.min += motion.translation();
  bounds.max += motion.translation();
  return bounds;
}

double farthestSq(std::span<const Vec3> points) {
  double distanceSq = 0.0;
  const std::size_t done = HWY_DYNAMIC_DISPATCH(extendDistance)(points, distanceSq);
  for (const Vec3& p : points.subspan(done)) {
    distanceSq = std::max(distanceSq, p.squaredNorm());
  }
  return distanceSq;
}

int supportIndex(const float* x, const float* y, const float* z, int count, float directionX, float directionY,
                 float directionZ) {
  return HWY_DYNAMIC_DISPATCH(findSupport)(x, y, z, count, directionX, directionY, directionZ);
}

void fetch(std::span<const std::byte> bytes) {
  constexpr std::size_t kLine = 64, kMost = 3072;  // [bytes]
  for (std::size_t i = 0; i < std::min(bytes.size(), kMost); i += kLine) hwy::Prefetch(&bytes[i]);
}

}  // namespace lorica
#endif

#include "collision/live/clip_kernel.h"

// Highway compiles the code between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/live/clip_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace lorica::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Doubles = hn::CappedTag<double, kClipPadding>;
using Lanes = hn::Vec<Doubles>;

// Products and sums are not fused, so that every instruction set rounds alike.

Lanes dot(Lanes x, Lanes y, Lanes z, Lanes u, Lanes v, Lanes w) {
  return hn::Add(hn::Add(hn::Mul(x, u), hn::Mul(y, v)), hn::Mul(z, w));
}

void clipRay(std::span<const double> planes, const Vec3& origin, const Vec3& direction, double reach, Entry& entry) {
  const Doubles d;
  const std::size_t lanes = hn::Lanes(d), count = planes.size() / 4;
  const double* const x = planes.data();
  const Lanes ox = hn::Set(d, origin.x()), oy = hn::Set(d, origin.y()), oz = hn::Set(d, origin.z());
  const Lanes dx = hn::Set(d, direction.x()), dy = hn::Set(d, direction.y()), dz = hn::Set(d, direction.z());
  const Lanes zero = hn::Zero(d), nowhere = hn::Set(d, -1.0);
  Lanes in = zero, out = hn::Set(d, reach), plane = nowhere;
  Lanes index = hn::Iota(d, 0.0);
  const Lanes step = hn::Set(d, static_cast<double>(lanes));
  for (std::size_t i = 0; i < count; i += lanes) {
    const Lanes nx = hn::LoadU(d, x + i), ny = hn::LoadU(d, x + count + i), nz = hn::LoadU(d, x + 2 * count + i);
    // How far the origin is inside, and how fast the ray goes outwards.
    const Lanes inside = hn::Sub(hn::LoadU(d, x + 3 * count + i), dot(nx, ny, nz, ox, oy, oz));
    const Lanes speed = dot(nx, ny, nz, dx, dy, dz);
    const Lanes at = hn::Div(inside, speed);
    const auto later = hn::And(hn::Lt(speed, zero), hn::Gt(at, in));
    in = hn::IfThenElse(later, at, in);
    plane = hn::IfThenElse(later, index, plane);
    out = hn::IfThenElse(hn::And(hn::Gt(speed, zero), hn::Lt(at, out)), at, out);
    // Along a plane and outside of it: nothing is inside.
    out = hn::IfThenElse(hn::And(hn::Eq(speed, zero), hn::Lt(inside, zero)), nowhere, out);
    if (!hn::AllFalse(d, hn::Gt(in, out))) return;
    index = hn::Add(index, step);
  }
  const double first = hn::GetLane(hn::MaxOfLanes(d, in));
  if (!(first <= hn::GetLane(hn::MinOfLanes(d, out)))) return;
  entry.at = first;
  // The first plane of those through which it comes in last.
  const Lanes none = hn::Set(d, static_cast<double>(count));
  const auto last = hn::And(hn::Eq(in, hn::Set(d, first)), hn::Ge(plane, zero));
  const double which = hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(last, plane, none)));
  if (which < static_cast<double>(count)) entry.plane = static_cast<std::int32_t>(which);
}

unsigned ballsNear(const Balls& balls, std::size_t first, const Vec3& origin, const Vec3& direction, double reach,
                   double thickness) {
  const Doubles d;
  const std::size_t lanes = hn::Lanes(d);
  const Lanes dx = hn::Set(d, direction.x()), dy = hn::Set(d, direction.y()), dz = hn::Set(d, direction.z());
  const Lanes zero = hn::Zero(d), end = hn::Set(d, reach);
  unsigned near = 0;
  for (std::size_t i = 0; i < kClipPadding; i += lanes) {
    const Lanes x = hn::Sub(hn::LoadU(d, &balls.x[first + i]), hn::Set(d, origin.x()));
    const Lanes y = hn::Sub(hn::LoadU(d, &balls.y[first + i]), hn::Set(d, origin.y()));
    const Lanes z = hn::Sub(hn::LoadU(d, &balls.z[first + i]), hn::Set(d, origin.z()));
    const Lanes radius = hn::Add(hn::LoadU(d, &balls.radius[first + i]), hn::Set(d, thickness));
    const Lanes along = dot(x, y, z, dx, dy, dz);
    // The ray's point nearest to the middle, which is not before the origin.
    const Lanes at = hn::Min(hn::Max(along, zero), end);
    const Lanes u = hn::Sub(x, hn::Mul(at, dx)), v = hn::Sub(y, hn::Mul(at, dy)), w = hn::Sub(z, hn::Mul(at, dz));
    const auto hit = hn::Le(dot(u, v, w, u, v, w), hn::Mul(radius, radius));
    std::array<std::uint8_t, 8> bits{};
    hn::StoreMaskBits(d, hit, bits.data());
    near |= static_cast<unsigned>(bits[0]) << i;
  }
  return near;
}

}  // namespace lorica::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace lorica {
namespace {
HWY_EXPORT(clipRay);
HWY_EXPORT(ballsNear);
}  // namespace

Entry entryOf(std::span<const double> planes, const Vec3& origin, const Vec3& direction, double reach) {
  Entry entry;
  HWY_DYNAMIC_DISPATCH(clipRay)(planes, origin, direction, reach, entry);
  return entry;
}

unsigned ballsOnRay(const Balls& balls, std::size_t first, const Vec3& origin, const Vec3& direction, double reach,
                    double thickness) {
  return HWY_DYNAMIC_DISPATCH(ballsNear)(balls, first, origin, direction, reach, thickness);
}

}  // namespace lorica
#endif

#include "collision/live/clip_kernel.h"

// Highway compiles the code between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/live/clip_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <array>

HWY_BEFORE_NAMESPACE();
namespace lorica::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Doubles = hn::CappedTag<double, kClipPadding>;
using Lanes = hn::Vec<Doubles>;

constexpr double kRounding = 1e-15;  ///< of a product and a quotient

// Products and sums are not fused, so that every instruction set rounds alike.

HWY_INLINE Lanes dot(Lanes x, Lanes y, Lanes z, Lanes u, Lanes v, Lanes w) {
  return hn::Add(hn::Add(hn::Mul(x, u), hn::Mul(y, v)), hn::Mul(z, w));
}

void clipRay(std::span<const double> planes, const Vec3& origin, const Vec3& direction, double from, double to,
             Entry& entry) {
  const Doubles d;
  const std::size_t lanes = hn::Lanes(d), count = planes.size() / 4;
  const double* const x = planes.data();
  const Lanes ox = hn::Set(d, origin.x()), oy = hn::Set(d, origin.y()), oz = hn::Set(d, origin.z());
  const Lanes dx = hn::Set(d, direction.x()), dy = hn::Set(d, direction.y()), dz = hn::Set(d, direction.z());
  const Lanes zero = hn::Zero(d), infinite = hn::Set(d, kInfinity), rounding = hn::Set(d, kRounding);
  Lanes in = hn::Set(d, from), out = hn::Set(d, to);
  std::int32_t plane = -1;
  for (std::size_t i = 0; i < count; i += lanes) {
    const Lanes nx = hn::LoadU(d, x + i), ny = hn::LoadU(d, x + count + i), nz = hn::LoadU(d, x + 2 * count + i);
    // How far the origin is inside, and how fast the ray goes outwards.
    const Lanes inside = hn::Sub(hn::LoadU(d, x + 3 * count + i), dot(nx, ny, nz, ox, oy, oz));
    const Lanes speed = dot(nx, ny, nz, dx, dy, dz);
    // Most planes leave the ray as it is, which needs no division.
    const auto outwards = hn::Gt(speed, zero);
    const Lanes limit = hn::Mul(hn::IfThenElse(outwards, out, in), speed);
    if (hn::AllFalse(d, hn::Lt(inside, hn::Add(limit, hn::Mul(hn::Abs(limit), rounding))))) continue;
    // Along a plane and outside of it: nothing is inside.
    if (!hn::AllFalse(d, hn::And(hn::Eq(speed, zero), hn::Lt(inside, zero)))) return;
    const Lanes at = hn::Div(inside, speed);
    const Lanes later = hn::MaxOfLanes(d, hn::IfThenElse(hn::Lt(speed, zero), at, zero));
    out = hn::Min(out, hn::MinOfLanes(d, hn::IfThenElse(outwards, at, infinite)));
    if (hn::GetLane(later) > hn::GetLane(in)) {
      // The first plane of those through which it comes in last.
      in = later;
      plane = static_cast<std::int32_t>(i + hn::FindKnownFirstTrue(d, hn::And(hn::Lt(speed, zero), hn::Eq(at, in))));
    }
    if (hn::GetLane(in) > hn::GetLane(out)) return;
  }
  if (!(hn::GetLane(in) <= hn::GetLane(out))) return;
  entry = {hn::GetLane(in), plane};
}

std::uint64_t ballsNear(const Balls& balls, std::size_t first, std::size_t count, const Vec3& origin,
                        const Vec3& direction, double reach, double thickness) {
  const Doubles d;
  const std::size_t lanes = hn::Lanes(d);
  const Lanes ox = hn::Set(d, origin.x()), oy = hn::Set(d, origin.y()), oz = hn::Set(d, origin.z());
  const Lanes dx = hn::Set(d, direction.x()), dy = hn::Set(d, direction.y()), dz = hn::Set(d, direction.z());
  const Lanes zero = hn::Zero(d), end = hn::Set(d, reach), more = hn::Set(d, thickness);
  std::uint64_t near = 0;
  for (std::size_t i = 0; i < count; i += lanes) {
    const Lanes x = hn::Sub(hn::LoadU(d, &balls.x[first + i]), ox);
    const Lanes y = hn::Sub(hn::LoadU(d, &balls.y[first + i]), oy);
    const Lanes z = hn::Sub(hn::LoadU(d, &balls.z[first + i]), oz);
    const Lanes radius = hn::Add(hn::LoadU(d, &balls.radius[first + i]), more);
    const Lanes along = dot(x, y, z, dx, dy, dz);
    // The ray's point nearest to the middle, which is not before the origin.
    const Lanes at = hn::Min(hn::Max(along, zero), end);
    const Lanes u = hn::Sub(x, hn::Mul(at, dx)), v = hn::Sub(y, hn::Mul(at, dy)), w = hn::Sub(z, hn::Mul(at, dz));
    const auto hit = hn::Le(dot(u, v, w, u, v, w), hn::Mul(radius, radius));
    std::array<std::uint8_t, 8> bits{};
    hn::StoreMaskBits(d, hit, bits.data());
    near |= std::uint64_t{bits[0]} << i;
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

Entry entryOf(std::span<const double> planes, const Vec3& origin, const Vec3& direction, double from, double to) {
  Entry entry;
  HWY_DYNAMIC_DISPATCH(clipRay)(planes, origin, direction, from, to, entry);
  return entry;
}

std::uint64_t ballsOnRay(const Balls& balls, std::size_t first, std::size_t count, const Vec3& origin,
                         const Vec3& direction, double reach, double thickness) {
  return HWY_DYNAMIC_DISPATCH(ballsNear)(balls, first, count, origin, direction, reach, thickness);
}

}  // namespace lorica
#endif

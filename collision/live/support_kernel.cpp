#include "collision/live/support_kernel.h"

// Highway compiles the code between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/live/support_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <cstdint>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace lorica::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, kSupportBlock>;  // any smaller power of two divides a block too
using Ints = hn::RebindToSigned<Floats>;

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
HWY_EXPORT(findSupport);
}  // namespace

int supportIndex(const float* x, const float* y, const float* z, int count, float directionX, float directionY,
                 float directionZ) {
  return HWY_DYNAMIC_DISPATCH(findSupport)(x, y, z, count, directionX, directionY, directionZ);
}

}  // namespace lorica
#endif

// Reading particles by number into vectors. For files that Highway compiles once for each instruction set.

#if defined(LORICA_PARTICLE_ROWS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LORICA_PARTICLE_ROWS_INL_H
#undef LORICA_PARTICLE_ROWS_INL_H
#else
#define LORICA_PARTICLE_ROWS_INL_H
#endif

#include "collision/particles/neighbour_lists.h"

#include <hwy/cache_control.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lorica::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, kParticleBlock>;  // any smaller power of two divides a block too
using Float = hn::Vec<Floats>;
using Ints = hn::RebindToSigned<Floats>;

/// Four numbers of as many particles as there are lanes.
struct Rows {
  Float x, y, z, w;
};

/// The numbers of a vector of particles, from the first on.
HWY_INLINE hn::Vec<hn::RebindToUnsigned<Floats>> numbersFrom(std::size_t first) {
  const hn::RebindToUnsigned<Floats> u;
  return hn::Add(hn::Load(u, kLaneNumbers.data()), hn::Set(u, static_cast<std::uint32_t>(first)));
}

// Not fused, so that every instruction set rounds alike.
HWY_INLINE Float dotOf(Float ax, Float ay, Float az, Float bx, Float by, Float bz) {
  return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
}

/// 1 / sqrt(x) to a few units in the last place, by Newton's method from an initial guess by the exponent. Takes a
/// third of the time of a root and a division, and gives the same bits on every machine. For 0 it is a large number.
HWY_INLINE Float inverseRoot(Float x) {
  const Floats f;
  const hn::RebindToUnsigned<Floats> u;
  const auto half = hn::Mul(hn::Set(f, 0.5f), x);
  auto y = hn::BitCast(f, hn::Sub(hn::Set(u, 0x5f375a86u), hn::ShiftRight<1>(hn::BitCast(u, x))));
  for (int step = 0; step < 3; ++step) {
    y = hn::Mul(y, hn::Sub(hn::Set(f, 1.5f), hn::Mul(hn::Mul(half, y), y)));
  }
  return y;
}

HWY_INLINE void storeRows(const Rows& rows, ParticleRow* to) {
  hn::StoreInterleaved4(rows.x, rows.y, rows.z, rows.w, Floats(), &to->x);
}

HWY_INLINE Rows loadRows(const ParticleRow* from) {
  const Floats f;
  Rows rows{hn::Zero(f), hn::Zero(f), hn::Zero(f), hn::Zero(f)};
  hn::LoadInterleaved4(f, &from->x, rows.x, rows.y, rows.z, rows.w);
  return rows;
}

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE Rows gatherRows(const ParticleRow* rows, const std::uint32_t* ids) {
  const Floats f;
  const ParticleRow& row = rows[*ids];
  return {hn::Set(f, row.x), hn::Set(f, row.y), hn::Set(f, row.z), hn::Set(f, row.w)};
}

#else

// Block k of the result is the row ids[4 * k].
template <class D>
HWY_INLINE hn::Vec<D> blocksOfRows(D d, const ParticleRow* rows, const std::uint32_t* ids) {
  if constexpr (hn::MaxLanes(d) == 4) {
    return hn::Load(d, &rows[*ids].x);
  } else {
    const hn::Half<D> half;
    const auto lower = blocksOfRows(half, rows, ids);
    return hn::Combine(d, blocksOfRows(half, rows, ids + hn::MaxLanes(half)), lower);
  }
}

/// Lane i is the row ids[i]. Faster than gather instructions.
HWY_INLINE Rows gatherRows(const ParticleRow* rows, const std::uint32_t* ids) {
  const Floats f;
  hwy::Prefetch(ids + 24 * kParticleBlock);
  const hn::RepartitionToWide<Floats> pairs;
  const auto p0 = blocksOfRows(f, rows, ids);
  const auto p1 = blocksOfRows(f, rows, ids + 1);
  const auto p2 = blocksOfRows(f, rows, ids + 2);
  const auto p3 = blocksOfRows(f, rows, ids + 3);
  const auto xy01 = hn::BitCast(pairs, hn::InterleaveLower(f, p0, p1));
  const auto xy23 = hn::BitCast(pairs, hn::InterleaveLower(f, p2, p3));
  const auto zw01 = hn::BitCast(pairs, hn::InterleaveUpper(f, p0, p1));
  const auto zw23 = hn::BitCast(pairs, hn::InterleaveUpper(f, p2, p3));
  return {
      hn::BitCast(f, hn::InterleaveLower(pairs, xy01, xy23)), hn::BitCast(f, hn::InterleaveUpper(pairs, xy01, xy23)),
      hn::BitCast(f, hn::InterleaveLower(pairs, zw01, zw23)), hn::BitCast(f, hn::InterleaveUpper(pairs, zw01, zw23))};
}

#endif

}  // namespace lorica::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

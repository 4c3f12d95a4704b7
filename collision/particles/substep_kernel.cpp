#include "collision/particles/substep_kernel.h"

#include <array>

// Highway compiles the code between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction set. Not for
// vectors whose size is known only at run time: such vectors cannot be members of a struct.
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/particles/substep_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <hwy/cache_control.h>

HWY_BEFORE_NAMESPACE();
namespace lorica::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, kParticleBlock>;  // any smaller power of two divides a block too
using Float = hn::Vec<Floats>;
using Numbers = hn::RebindToUnsigned<Floats>;

/// Four numbers of as many particles as there are lanes.
struct Rows {
  Float x, y, z, w;
};

/// The numbers of a vector of particles, from the first on.
HWY_INLINE hn::Vec<Numbers> numbersFrom(std::size_t first) {
  const Numbers u;
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
  const Numbers u;
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

// 1. Water.

/// A vector of particles and one neighbour of each.
struct Pairs {
  Float dx, dy, dz, distanceSq;  // from the neighbour
  hn::Mask<Floats> near;
};

HWY_INLINE Pairs pairsOf(const Rows& own, const Rows& other, const std::uint32_t* slot, std::size_t i, float reach) {
  const Floats f;
  const Numbers u;
  Pairs pairs{hn::Sub(own.x, other.x), hn::Sub(own.y, other.y), hn::Sub(own.z, other.z), hn::Zero(f), hn::FirstN(f, 0)};
  pairs.distanceSq = dotOf(pairs.dx, pairs.dy, pairs.dz, pairs.dx, pairs.dy, pairs.dz);
  pairs.near = hn::And(hn::Lt(pairs.distanceSq, hn::Set(f, reach * reach)),
                       hn::RebindMask(f, hn::Ne(hn::LoadU(u, slot), numbersFrom(i))));
  return pairs;
}

HWY_INLINE Float densityOf(const FluidKernels& k, const Pairs& pairs) {
  const Floats f;
  const auto left = hn::Sub(hn::Set(f, k.reach * k.reach), pairs.distanceSq);
  return hn::IfThenElseZero(pairs.near, hn::Mul(hn::Set(f, k.density), hn::Mul(left, hn::Mul(left, left))));
}

/// Contribution of the floor and the walls as if the fluid continued behind them: density, and its slopes away from
/// them.
struct Walls {
  Float density, x, y, z;
};

/// Integrals of the kernels over the half space behind a wall; q is the fraction of the reach behind it. For (1 -
/// r^2)^3 it is pi/4 q^5 (16/5 - 16/3 q + 24/7 q^2 - q^3 + q^4/9); for the component of (1 - r)^2 along the normal it
/// is pi q^4 (1/6 - 2/15 q).
HWY_INLINE void addWall(const FluidKernels& k, Float distance, Float away, Float& density, Float& slope) {
  const Floats f;
  const auto q = hn::Max(hn::Zero(f), hn::Sub(hn::Set(f, 1.0f), hn::Mul(distance, hn::Set(f, 1.0f / k.reach))));
  if (hn::AllTrue(f, hn::Eq(q, hn::Zero(f)))) return;
  const auto q2 = hn::Mul(q, q), q4 = hn::Mul(q2, q2);
  auto sum = hn::Sub(hn::Mul(q, hn::Set(f, 1.0f / 9.0f)), hn::Set(f, 1.0f));
  sum = hn::Add(hn::Mul(q, sum), hn::Set(f, 24.0f / 7.0f));
  sum = hn::Sub(hn::Mul(q, sum), hn::Set(f, 16.0f / 3.0f));
  sum = hn::Add(hn::Mul(q, sum), hn::Set(f, 16.0f / 5.0f));
  density = hn::Add(density, hn::Mul(hn::Set(f, k.wallDensity), hn::Mul(hn::Mul(q4, q), sum)));
  const auto own = hn::Sub(hn::Set(f, 1.0f / 6.0f), hn::Mul(q, hn::Set(f, 2.0f / 15.0f)));
  slope = hn::Add(slope, hn::Mul(away, hn::Mul(hn::Set(f, k.wallSlope), hn::Mul(q4, own))));
}

HWY_INLINE Walls wallsOf(const FluidKernels& k, const Rows& own, const BodyTerms& bodies, std::size_t i) {
  const Floats f;
  const auto zero = hn::Zero(f), one = hn::Set(f, 1.0f), minus = hn::Set(f, -1.0f);
  Walls walls{zero, zero, zero, zero};
  if (bodies.walls != nullptr) {
    const Rows body = loadRows(bodies.walls + i);
    walls = {body.w, body.x, body.y, body.z};
  }
  addWall(k, hn::Sub(own.x, hn::Set(f, k.min.x)), one, walls.density, walls.x);
  addWall(k, hn::Sub(hn::Set(f, k.max.x), own.x), minus, walls.density, walls.x);
  addWall(k, hn::Sub(own.y, hn::Set(f, k.min.y)), one, walls.density, walls.y);
  addWall(k, hn::Sub(own.z, hn::Set(f, k.min.z)), one, walls.density, walls.z);
  addWall(k, hn::Sub(hn::Set(f, k.max.z), own.z), minus, walls.density, walls.z);
  return walls;
}

// Calls work(i, slots of these particles, how many) for each vector of particles.
template <class Work>
HWY_INLINE void forVectors(const NeighbourLists& lists, std::size_t firstBlock, std::size_t lastBlock,
                           const Work& work) {
  const std::size_t lanes = hn::Lanes(Floats());
  for (std::size_t block = firstBlock; block < lastBlock; ++block) {
    for (std::size_t lane = 0; lane < kParticleBlock; lane += lanes) {
      work(block * kParticleBlock + lane, lists.slots(block) + lane, lists.slotCount(block));
    }
  }
}

void pressures(const FluidKernels& k, const ParticleRow* positions, const NeighbourLists& lists,
               const BodyTerms& bodies, std::size_t firstBlock, std::size_t lastBlock, float* pressure, float pressed,
               ParticleRow* next) {
  forVectors(lists, firstBlock, lastBlock, [&](std::size_t i, const std::uint32_t* slot, int slots) HWY_ATTR {
    const Floats f;
    const auto zero = hn::Zero(f), reach = hn::Set(f, k.reach);
    Rows own = loadRows(positions + i);
    const Walls walls = wallsOf(k, own, bodies, i);
    auto density = hn::Add(hn::Set(f, k.ownDensity), walls.density);
    auto sumX = walls.x, sumY = walls.y, sumZ = walls.z, squares = zero;
    for (int s = 0; s < slots; ++s, slot += kParticleBlock) {
      const Pairs pairs = pairsOf(own, gatherRows(positions, slot), slot, i, k.reach);
      density = hn::Add(density, densityOf(k, pairs));
      const auto inverse = inverseRoot(pairs.distanceSq);
      const auto left = hn::Sub(reach, hn::Mul(pairs.distanceSq, inverse));
      const auto slope = hn::IfThenElseZero(pairs.near, hn::Mul(hn::Set(f, k.slope), hn::Mul(left, left)));
      squares = hn::Add(squares, hn::Mul(slope, slope));
      const auto along = hn::Mul(slope, inverse);
      sumX = hn::Add(sumX, hn::Mul(along, pairs.dx));
      sumY = hn::Add(sumY, hn::Mul(along, pairs.dy));
      sumZ = hn::Add(sumZ, hn::Mul(along, pairs.dz));
    }
    squares = hn::Add(squares, dotOf(sumX, sumY, sumZ, sumX, sumY, sumZ));
    if (bodies.yielding != nullptr) squares = hn::Add(squares, hn::LoadU(f, bodies.yielding + i));
    const auto excess = hn::Mul(hn::Set(f, k.relaxation), hn::Sub(density, hn::Set(f, 1.0f)));
    const auto before = hn::LoadU(f, pressure + i);
    const auto after =  // a free surface does not pull
        hn::Max(zero, hn::Add(before, hn::Div(excess, hn::Add(squares, hn::Set(f, k.softening)))));
    hn::StoreU(after, f, pressure + i);
    own.w = hn::Sub(after, hn::Mul(hn::Set(f, pressed), before));
    storeRows(own, next + i);
  });
}

void moves(const FluidKernels& k, const ParticleRow* pressed, const NeighbourLists& lists, const BodyTerms& bodies,
           const ParticleRow& min, const ParticleRow& max, float longest, std::size_t firstBlock, std::size_t lastBlock,
           ParticleRow* next) {
  forVectors(lists, firstBlock, lastBlock, [&](std::size_t i, const std::uint32_t* slot, int slots) HWY_ATTR {
    const Floats f;
    const Numbers u;
    const auto reach = hn::Set(f, k.reach), tiny = hn::Set(f, 1e-6f), one = hn::Set(f, 1.0f);
    Rows own = loadRows(pressed + i);
    const Walls walls = wallsOf(k, own, bodies, i);
    auto sumX = hn::Mul(own.w, walls.x), sumY = hn::Mul(own.w, walls.y), sumZ = hn::Mul(own.w, walls.z);
    for (int s = 0; s < slots; ++s, slot += kParticleBlock) {
      const Rows other = gatherRows(pressed, slot);
      const Pairs pairs = pairsOf(own, other, slot, i, k.reach);
      const auto inverse = inverseRoot(pairs.distanceSq);
      const auto distance = hn::Mul(pairs.distanceSq, inverse);
      const auto left = hn::Sub(reach, distance);
      const auto slope = hn::IfThenElseZero(pairs.near, hn::Mul(hn::Set(f, k.slope), hn::Mul(left, left)));
      const auto way = hn::Mul(hn::Add(own.w, other.w), slope);
      const auto along = hn::Mul(way, inverse);
      sumX = hn::Add(sumX, hn::Mul(along, pairs.dx));
      sumZ = hn::Add(sumZ, hn::Mul(along, pairs.dz));
      // Two particles in the same position are separated upwards and downwards, by their numbers.
      const auto first = hn::RebindMask(f, hn::Lt(hn::LoadU(u, slot), numbersFrom(i)));
      const auto upOrDown = hn::IfThenElse(first, way, hn::Neg(way));
      sumY = hn::Add(sumY, hn::IfThenElse(hn::Gt(distance, tiny), hn::Mul(along, pairs.dy), upOrDown));
    }
    const auto length = hn::Sqrt(dotOf(sumX, sumY, sumZ, sumX, sumY, sumZ));
    const auto rate = hn::Min(one, hn::Div(hn::Set(f, longest), hn::Max(length, tiny)));
    own.x = hn::Min(hn::Max(hn::Add(own.x, hn::Mul(rate, sumX)), hn::Set(f, min.x)), hn::Set(f, max.x));
    own.y = hn::Min(hn::Max(hn::Add(own.y, hn::Mul(rate, sumY)), hn::Set(f, min.y)), hn::Set(f, max.y));
    own.z = hn::Min(hn::Max(hn::Add(own.z, hn::Mul(rate, sumZ)), hn::Set(f, min.z)), hn::Set(f, max.z));
    own.w = hn::Mul(rate, own.w);
    storeRows(own, next + i);
  });
}

void blends(const FluidKernels& k, const ParticleRow* positions, const ParticleRow* motions,
            const NeighbourLists& lists, float viscosity, std::size_t firstBlock, std::size_t lastBlock,
            ParticleRow* next) {
  forVectors(lists, firstBlock, lastBlock, [&](std::size_t i, const std::uint32_t* slot, int slots) HWY_ATTR {
    const Floats f;
    const Rows own = loadRows(positions + i);
    Rows motion = loadRows(motions + i);
    auto sumX = hn::Zero(f), sumY = sumX, sumZ = sumX;
    for (int s = 0; s < slots; ++s, slot += kParticleBlock) {
      const Pairs pairs = pairsOf(own, gatherRows(positions, slot), slot, i, k.reach);
      const Rows other = gatherRows(motions, slot);
      const auto weight = densityOf(k, pairs);
      sumX = hn::Add(sumX, hn::Mul(weight, hn::Sub(other.x, motion.x)));
      sumY = hn::Add(sumY, hn::Mul(weight, hn::Sub(other.y, motion.y)));
      sumZ = hn::Add(sumZ, hn::Mul(weight, hn::Sub(other.z, motion.z)));
    }
    const auto share = hn::Set(f, viscosity);
    motion.x = hn::Add(motion.x, hn::Mul(share, sumX));
    motion.y = hn::Add(motion.y, hn::Mul(share, sumY));
    motion.z = hn::Add(motion.z, hn::Mul(share, sumZ));
    storeRows(motion, next + i);
  });
}

// 2. Sand.

// Additional share of a correction for the upper of two grains, besides one half.
constexpr float kUpper = 0.5f;

// A vector of grains, from the block's slots on.
HWY_INLINE void stepVector(const GrainPass& p, const std::uint32_t* slot, int slotCount, std::size_t i) {
  const Floats f;
  const Numbers u;
  const auto zero = hn::Zero(f), one = hn::Set(f, 1.0f), tiny = hn::Set(f, 1e-14f);
  const auto diameter = hn::Set(f, p.diameter), diameterSq = hn::Set(f, p.diameter * p.diameter);
  const auto friction = hn::Set(f, p.friction), deepFrom = hn::Set(f, p.deepFrom);
  const auto fallX = hn::Set(f, p.fall.x), fallY = hn::Set(f, p.fall.y), fallZ = hn::Set(f, p.fall.z);
  const auto self = numbersFrom(i);

  const Rows position = loadRows(p.positions + i);
  const Rows motion = loadRows(p.motions + i);
  const auto rests = hn::Gt(position.w, zero);
  const auto wayX = hn::Add(motion.x, hn::IfThenZeroElse(rests, fallX));
  const auto wayY = hn::Add(motion.y, hn::IfThenZeroElse(rests, fallY));
  const auto wayZ = hn::Add(motion.z, hn::IfThenZeroElse(rests, fallZ));
  const auto x = hn::Add(position.x, wayX), y = hn::Add(position.y, wayY), z = hn::Add(position.z, wayZ);
  auto brakeX = zero, brakeY = zero, brakeZ = zero;
  auto touches = zero;
  for (int s = 0; s < slotCount; ++s, slot += kParticleBlock) {
    const auto number = hn::LoadU(u, slot);
    const Rows other = gatherRows(p.ends, slot);
    const auto dx = hn::Sub(x, other.x), dy = hn::Sub(y, other.y), dz = hn::Sub(z, other.z);
    const auto distanceSq = dotOf(dx, dy, dz, dx, dy, dz);
    const auto touching = hn::And(hn::Lt(distanceSq, diameterSq), hn::RebindMask(f, hn::Ne(number, self)));
    if (hn::AllFalse(f, touching)) continue;
    const auto asleep = hn::Lt(other.w, zero);
    const auto otherRests = hn::Gt(other.w, zero);
    const Rows otherMotion = gatherRows(p.motions, slot);
    const auto otherWayX = hn::IfThenZeroElse(asleep, hn::Add(otherMotion.x, hn::IfThenZeroElse(otherRests, fallX)));
    const auto otherWayY = hn::IfThenZeroElse(asleep, hn::Add(otherMotion.y, hn::IfThenZeroElse(otherRests, fallY)));
    const auto otherWayZ = hn::IfThenZeroElse(asleep, hn::Add(otherMotion.z, hn::IfThenZeroElse(otherRests, fallZ)));
    const auto distance = hn::Sqrt(distanceSq);
    const auto overlap = hn::Sub(diameter, distance);
    // Two grains in the same position are separated upwards and downwards, by their numbers.
    const auto apart = hn::Gt(distanceSq, tiny);
    const auto scale = hn::Div(one, hn::IfThenElse(apart, distance, one));
    const auto upOrDown = hn::IfThenElse(hn::RebindMask(f, hn::Lt(number, self)), one, hn::Neg(one));
    const auto nx = hn::Mul(dx, scale), nz = hn::Mul(dz, scale);
    const auto ny = hn::IfThenElse(apart, hn::Mul(dy, scale), upOrDown);
    const auto slipX = hn::Sub(wayX, otherWayX), slipY = hn::Sub(wayY, otherWayY), slipZ = hn::Sub(wayZ, otherWayZ);
    const auto along = dotOf(slipX, slipY, slipZ, nx, ny, nz);
    // A gap closes to zero at most. An earlier overlap opens slowly, so that grains are not thrown apart.
    const auto before = hn::Max(zero, hn::Add(overlap, along));
    const auto deep = hn::Max(zero, hn::Sub(before, deepFrom));
    const auto opening = hn::Min(before, hn::Add(hn::Set(f, p.opening), hn::Mul(hn::Set(f, p.deepShare), deep)));
    const auto closing = hn::Max(zero, hn::Add(hn::Sub(overlap, before), opening));
    const auto tx = hn::Sub(slipX, hn::Mul(along, nx));
    const auto ty = hn::Sub(slipY, hn::Mul(along, ny));
    const auto tz = hn::Sub(slipZ, hn::Mul(along, nz));
    const auto slipSq = dotOf(tx, ty, tz, tx, ty, tz), grip = hn::Mul(friction, overlap);
    auto held = one;
    const auto slides = hn::And(touching, hn::Gt(slipSq, hn::Mul(grip, grip)));
    if (!hn::AllFalse(f, slides)) held = hn::IfThenElse(slides, hn::Div(grip, hn::Sqrt(hn::Max(slipSq, tiny))), one);
    // A sleeping neighbour does not yield. Otherwise the upper grain yields more, so that a pile supports itself within
    // few substeps.
    const auto share = hn::IfThenElse(asleep, one, hn::Add(hn::Set(f, 0.5f), hn::Mul(hn::Set(f, kUpper), ny)));
    const auto weight = hn::IfThenElseZero(touching, share);
    brakeX = hn::Add(brakeX, hn::Mul(weight, hn::Sub(hn::Mul(closing, nx), hn::Mul(held, tx))));
    brakeY = hn::Add(brakeY, hn::Mul(weight, hn::Sub(hn::Mul(closing, ny), hn::Mul(held, ty))));
    brakeZ = hn::Add(brakeZ, hn::Mul(weight, hn::Sub(hn::Mul(closing, nz), hn::Mul(held, tz))));
    touches = hn::Add(touches, hn::IfThenElseZero(touching, one));
  }
  const auto rate = hn::Min(one, hn::Div(hn::Set(f, p.relaxation), hn::Max(touches, one)));
  auto toX = hn::Add(wayX, hn::Mul(rate, brakeX));
  auto toY = hn::Add(wayY, hn::Mul(rate, brakeY));
  auto toZ = hn::Add(wayZ, hn::Mul(rate, brakeZ));
  // The floor stops grains that reach it, and holds them as far as its friction allows.
  const auto below = hn::Max(zero, hn::Sub(hn::Set(f, p.min.y), hn::Add(position.y, toY)));
  toY = hn::Add(toY, below);
  const auto slide = hn::Sqrt(hn::Max(hn::Add(hn::Mul(toX, toX), hn::Mul(toZ, toZ)), tiny));
  const auto held = hn::Min(one, hn::Div(hn::Mul(friction, below), slide));
  toX = hn::Sub(toX, hn::Mul(held, toX));
  toZ = hn::Sub(toZ, hn::Mul(held, toZ));
  // Static friction holds slow grains; the speed is limited to what the lists can follow.
  const auto way = hn::Sqrt(hn::Max(dotOf(toX, toY, toZ, toX, toY, toZ), tiny));
  const auto isQuiet = hn::Lt(way, hn::Set(f, p.quiet));
  const auto go = hn::IfThenZeroElse(isQuiet, hn::Min(one, hn::Div(hn::Set(f, p.fastest), way)));
  toX = hn::Mul(go, toX);
  toY = hn::Mul(go, toY);
  toZ = hn::Mul(go, toZ);
  const auto quietCount = hn::IfThenElseZero(isQuiet, hn::Min(hn::Add(motion.w, one), hn::Set(f, p.maxQuiet)));
  const auto endX = hn::Add(position.x, toX);
  const auto endY = hn::Add(position.y, toY);
  const auto endZ = hn::Add(position.z, toZ);
  const auto inX = hn::Min(hn::Max(endX, hn::Set(f, p.min.x)), hn::Set(f, p.max.x));
  const auto inY = hn::Min(hn::Max(endY, hn::Set(f, p.min.y)), hn::Set(f, p.max.y));
  const auto inZ = hn::Min(hn::Max(endZ, hn::Set(f, p.min.z)), hn::Set(f, p.max.z));
  toX = hn::IfThenElseZero(hn::Eq(inX, endX), toX);  // a wall stops it
  toZ = hn::IfThenElseZero(hn::Eq(inZ, endZ), toZ);

  std::array<float, kParticleBlock> sleeping;
  for (std::size_t k = 0; k < hn::Lanes(f); ++k) sleeping[k] = p.asleep[i + k];
  const auto stays = hn::Ne(hn::LoadU(f, sleeping.data()), zero);
  storeRows({hn::IfThenElse(stays, position.x, inX), hn::IfThenElse(stays, position.y, inY),
             hn::IfThenElse(stays, position.z, inZ), position.w},
            p.nextPositions + i);
  const auto nextX = hn::Add(inX, hn::Add(toX, hn::IfThenZeroElse(rests, fallX)));
  const auto nextY = hn::Add(inY, hn::Add(toY, hn::IfThenZeroElse(rests, fallY)));
  const auto nextZ = hn::Add(inZ, hn::Add(toZ, hn::IfThenZeroElse(rests, fallZ)));
  storeRows({hn::IfThenElse(stays, position.x, nextX), hn::IfThenElse(stays, position.y, nextY),
             hn::IfThenElse(stays, position.z, nextZ), hn::IfThenElse(stays, hn::Set(f, -1.0f), position.w)},
            p.nextEnds + i);
  storeRows({hn::IfThenZeroElse(stays, toX), hn::IfThenZeroElse(stays, toY), hn::IfThenZeroElse(stays, toZ),
             hn::IfThenElse(stays, motion.w, quietCount)},
            p.nextMotions + i);
}

void stepBlocks(const GrainPass& pass, const NeighbourLists& lists, std::size_t firstBlock, std::size_t lastBlock) {
  const std::size_t lanes = hn::Lanes(Floats());
  for (std::size_t block = firstBlock; block < lastBlock; ++block) {
    const std::uint8_t* asleep = pass.asleep + block * kParticleBlock;
    for (std::size_t lane = 0; lane < kParticleBlock; lane += lanes) {
      std::size_t sleepers = 0;
      for (std::size_t k = 0; k < lanes; ++k) sleepers += asleep[lane + k];
      if (sleepers == lanes) continue;
      stepVector(pass, lists.slots(block) + lane, lists.slotCount(block), block * kParticleBlock + lane);
    }
  }
}

}  // namespace lorica::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace lorica {
namespace {
HWY_EXPORT(pressures);
HWY_EXPORT(moves);
HWY_EXPORT(blends);
HWY_EXPORT(stepBlocks);
}  // namespace

void findPressures(const FluidKernels& kernels, const ParticleRow* positions, const NeighbourLists& lists,
                   const BodyTerms& bodies, std::size_t firstBlock, std::size_t lastBlock, float* pressures,
                   float pressed, ParticleRow* next) {
  HWY_DYNAMIC_DISPATCH(pressures)(kernels, positions, lists, bodies, firstBlock, lastBlock, pressures, pressed, next);
}

void movePressed(const FluidKernels& kernels, const ParticleRow* pressed, const NeighbourLists& lists,
                 const BodyTerms& bodies, const ParticleRow& min, const ParticleRow& max, float longest,
                 std::size_t firstBlock, std::size_t lastBlock, ParticleRow* next) {
  HWY_DYNAMIC_DISPATCH(moves)(kernels, pressed, lists, bodies, min, max, longest, firstBlock, lastBlock, next);
}

void blendMotions(const FluidKernels& kernels, const ParticleRow* positions, const ParticleRow* motions,
                  const NeighbourLists& lists, float viscosity, std::size_t firstBlock, std::size_t lastBlock,
                  ParticleRow* next) {
  HWY_DYNAMIC_DISPATCH(blends)(kernels, positions, motions, lists, viscosity, firstBlock, lastBlock, next);
}

void stepGrains(const GrainPass& pass, const NeighbourLists& lists, std::size_t firstBlock, std::size_t lastBlock) {
  HWY_DYNAMIC_DISPATCH(stepBlocks)(pass, lists, firstBlock, lastBlock);
}

}  // namespace lorica
#endif

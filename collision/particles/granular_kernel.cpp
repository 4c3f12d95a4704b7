#include "collision/particles/granular_kernel.h"

#include <array>

// Highway compiles the code between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction set. Not for
// vectors whose size is known only at run time: such vectors cannot be members of a struct.
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/particles/granular_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "collision/particles/particle_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lorica::HWY_NAMESPACE {

// Additional share of a correction for the upper of two grains, besides one half.
constexpr float kUpper = 0.5f;

// A vector of grains, from the block's slots on.
HWY_INLINE void stepVector(const GrainPass& p, const std::uint32_t* slot, int slotCount, std::size_t i) {
  const Floats f;
  const hn::RebindToUnsigned<Floats> u;
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
HWY_EXPORT(stepBlocks);
}  // namespace

void stepGrains(const GrainPass& pass, const NeighbourLists& lists, std::size_t firstBlock, std::size_t lastBlock) {
  HWY_DYNAMIC_DISPATCH(stepBlocks)(pass, lists, firstBlock, lastBlock);
}

}  // namespace lorica
#endif

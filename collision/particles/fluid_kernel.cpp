#include "collision/particles/fluid_kernel.h"

// Highway compiles the code between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction set. Not for
// vectors whose size is known only at run time: such vectors cannot be members of a struct.
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/particles/fluid_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "collision/particles/particle_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lorica::HWY_NAMESPACE {

using Numbers = hn::RebindToUnsigned<Floats>;

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

}  // namespace lorica::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace lorica {
namespace {
HWY_EXPORT(pressures);
HWY_EXPORT(moves);
HWY_EXPORT(blends);
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

}  // namespace lorica
#endif

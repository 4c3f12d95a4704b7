#include "collision/particle_push_kernel.h"

#include "collision/particle_push_exit.h"

// Highway compiles what lies between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/particle_push_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <limits>

HWY_BEFORE_NAMESPACE();
namespace lorica::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;
using Ints = hn::RebindToSigned<Floats>;
using PlaneFloats = hn::CappedTag<float, PushGrid::kWidth>;

// Nothing is fused, so that every instruction set rounds alike.
HWY_INLINE hn::Vec<PlaneFloats> heights(const PushGrid::Block& block, std::size_t i, hn::Vec<PlaneFloats> x,
                                        hn::Vec<PlaneFloats> y, hn::Vec<PlaneFloats> z) {
  const PlaneFloats f;
  return hn::Sub(
      hn::Add(hn::Add(hn::Mul(hn::Load(f, block.x.data() + i), x), hn::Mul(hn::Load(f, block.y.data() + i), y)),
              hn::Mul(hn::Load(f, block.z.data() + i), z)),
      hn::Load(f, block.offset.data() + i));
}

/// Which of a list's planes is the first so high.
HWY_INLINE std::uint32_t planeAt(const PushGrid& grid, const PushGrid::List& list, float height, hn::Vec<PlaneFloats> x,
                                 hn::Vec<PlaneFloats> y, hn::Vec<PlaneFloats> z) {
  const PlaneFloats f;
  const auto wanted = hn::Set(f, height);
  for (std::uint32_t b = list.firstBlock; b < list.firstBlock + list.blockCount; ++b) {
    for (std::size_t i = 0; i < PushGrid::kWidth; i += hn::Lanes(f)) {
      const auto lane = hn::FindFirstTrue(f, hn::Eq(heights(grid.blocks[b], i, x, y, z), wanted));
      if (lane >= 0) return grid.planes[b][i + static_cast<std::size_t>(lane)];
    }
  }
  return 0;
}

/// @param cell  that of p
HWY_INLINE PushDepth deepestInCell(const PushGrid& grid, std::size_t cell, const Vec3f& p) {
  const PlaneFloats f;
  const auto x = hn::Set(f, p.x());
  const auto y = hn::Set(f, p.y());
  const auto z = hn::Set(f, p.z());
  PushDepth deepest;
  const std::uint32_t first = grid.firstList[cell];
  if (first == 0) return deepest;
  const PushGrid::List* found = nullptr;
  for (const PushGrid::List* list = &grid.lists[first];; ++list) {
    auto highest = hn::Set(f, -std::numeric_limits<float>::infinity());
    for (std::uint32_t b = list->firstBlock; b < list->firstBlock + list->blockCount; ++b) {
      for (std::size_t i = 0; i < PushGrid::kWidth; i += hn::Lanes(f)) {
        highest = hn::Max(highest, heights(grid.blocks[b], i, x, y, z));
      }
    }
    const float height = hn::GetLane(hn::MaxOfLanes(f, highest));
    if (height < deepest.height) {
      deepest.height = height;
      found = list;
    }
    if (list->last) break;
  }
  if (found != nullptr) {
    deepest.hull = found->hull;
    deepest.plane = planeAt(grid, *found, deepest.height, x, y, z);
  }
  return deepest;
}

PushDepth deepest(const PushHulls& hulls, const PushGrid& grid, const Vec3f& p) {
  const bool near = (p.array() >= 0.0F).all() && (p.array() <= hulls.boxMax().array()).all();
  return near ? deepestInCell(grid, grid.cellOf(p), p) : PushDepth{};
}

/// Lists the particles in cells that a hull reaches into.
HWY_INLINE std::size_t screen(const PushHulls& hulls, const PushGrid& grid, const float* xyz, std::size_t count,
                              std::uint32_t* listed) {
  const Floats f;
  const Ints n;
  const std::size_t lanes = hn::Lanes(f);
  const auto originX = hn::Set(f, hulls.origin().x());
  const auto originY = hn::Set(f, hulls.origin().y());
  const auto originZ = hn::Set(f, hulls.origin().z());
  const auto topX = hn::Set(f, hulls.boxMax().x());
  const auto topY = hn::Set(f, hulls.boxMax().y());
  const auto topZ = hn::Set(f, hulls.boxMax().z());
  const auto zero = hn::Zero(f);
  const auto inverse = hn::Set(f, grid.inverseSize);
  const auto countX = hn::Set(n, grid.count[0]);
  const auto countY = hn::Set(n, grid.count[1]);
  const auto* occupied = reinterpret_cast<const std::int32_t*>(grid.occupied.data());
  std::size_t found = 0;
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    auto x = zero;
    auto y = zero;
    auto z = zero;
    hn::LoadInterleaved3(f, xyz + 3 * i, x, y, z);
    x = hn::Sub(x, originX);
    y = hn::Sub(y, originY);
    z = hn::Sub(z, originZ);
    const auto above = hn::And(hn::And(hn::Ge(x, zero), hn::Ge(y, zero)), hn::Ge(z, zero));
    const auto below = hn::And(hn::And(hn::Le(x, topX), hn::Le(y, topY)), hn::Le(z, topZ));
    const auto near = hn::And(above, below);
    if (hn::AllFalse(f, near)) continue;
    const auto cellX = hn::ConvertTo(n, hn::Mul(hn::IfThenElseZero(near, x), inverse));
    const auto cellY = hn::ConvertTo(n, hn::Mul(hn::IfThenElseZero(near, y), inverse));
    const auto cellZ = hn::ConvertTo(n, hn::Mul(hn::IfThenElseZero(near, z), inverse));
    const auto cell = hn::Add(hn::Mul(hn::Add(hn::Mul(cellZ, countY), cellY), countX), cellX);
    const auto word = hn::GatherIndex(n, occupied, hn::ShiftRight<5>(cell));
    const auto bit = hn::Shl(hn::Set(n, 1), hn::And(cell, hn::Set(n, 31)));
    const auto hit = hn::And(hn::TestBit(word, bit), hn::RebindMask(n, near));
    if (hn::AllFalse(n, hit)) continue;
    const auto index = hn::Iota(n, static_cast<std::int32_t>(i));
    found += hn::CompressStore(index, hit, n, reinterpret_cast<std::int32_t*>(listed) + found);
  }
  for (; i < count; ++i) {
    const Vec3f p = Vec3f(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]) - hulls.origin();
    const bool near = (p.array() >= 0.0F).all() && (p.array() <= hulls.boxMax().array()).all();
    if (near && grid.firstList[grid.cellOf(p)] != 0) listed[found++] = static_cast<std::uint32_t>(i);
  }
  return found;
}

std::size_t pushAll(const PushHulls& hulls, const PushGrid& grid, float* xyz, std::size_t count, std::uint32_t first,
                    std::uint32_t* scratch, ParticleTouch* touches) {
  const std::size_t listed = screen(hulls, grid, xyz, count, scratch);
  std::size_t touched = 0;
  for (std::size_t k = 0; k < listed; ++k) {
    float* at = xyz + 3 * static_cast<std::size_t>(scratch[k]);
    const Vec3f start = Vec3f(at[0], at[1], at[2]) - hulls.origin();
    const PushDepth inside = deepestInCell(grid, grid.cellOf(start), start);
    if (!(inside.height < 0.0F)) continue;
    // Nearly always the nearest way out of the one hull leads out of all.
    PushExit exit{start + (hulls.margin() - inside.height) * hulls.normal(inside.plane), inside.hull, inside.plane};
    if (deepest(hulls, grid, exit.place).height < 0.0F) exit = findExit(hulls, grid, start, inside);
    const PushHulls::Hull& hull = hulls.hulls()[exit.hull];
    const Vec3f place = exit.place + hulls.origin();
    at[0] = place.x();
    at[1] = place.y();
    at[2] = place.z();
    touches[touched++] = {first + scratch[k], hull.part, (exit.place - start).norm(), hulls.normal(exit.plane),
                          hulls.surfaceVelocity(hull, exit.place)};
  }
  return touched;
}

}  // namespace lorica::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace lorica {
namespace {
HWY_EXPORT(deepest);
HWY_EXPORT(pushAll);
}  // namespace

PushDepth deepestAt(const PushHulls& hulls, const PushGrid& grid, const Vec3f& p) {
  return HWY_DYNAMIC_DISPATCH(deepest)(hulls, grid, p);
}

std::size_t pushParticles(const PushHulls& hulls, const PushGrid& grid, float* xyz, std::size_t count,
                          std::uint32_t first, std::uint32_t* scratch, ParticleTouch* touches) {
  return HWY_DYNAMIC_DISPATCH(pushAll)(hulls, grid, xyz, count, first, scratch, touches);
}

}  // namespace lorica
#endif

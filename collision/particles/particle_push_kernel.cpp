#include "collision/particles/particle_push_kernel.h"

// Highway compiles the code between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/particles/particle_push_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

HWY_BEFORE_NAMESPACE();
namespace lorica::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;
using Ints = hn::RebindToSigned<Floats>;
using Indices = hn::RebindToUnsigned<Floats>;
using PlaneFloats = hn::CappedTag<float, PushGrid::kWidth>;

// Not fused, so that every instruction set rounds alike.
HWY_INLINE hn::Vec<PlaneFloats> heights(const PushGrid::Block& block, std::size_t i, hn::Vec<PlaneFloats> x,
                                        hn::Vec<PlaneFloats> y, hn::Vec<PlaneFloats> z) {
  const PlaneFloats f;
  return hn::Sub(
      hn::Add(hn::Add(hn::Mul(hn::Load(f, block.x.data() + i), x), hn::Mul(hn::Load(f, block.y.data() + i), y)),
              hn::Mul(hn::Load(f, block.z.data() + i), z)),
      hn::Load(f, block.offset.data() + i));
}

/// A point, and its cell's lists.
struct Position {
  hn::Vec<PlaneFloats> x, y, z;
  const PushGrid::List* list;  ///< null if there is none
};

HWY_INLINE Position positionOf(const PushGrid& grid, const Vec3f& p) {
  const PlaneFloats f;
  const std::uint32_t first = grid.firstList[grid.cellOf(p)];
  return {hn::Set(f, p.x()), hn::Set(f, p.y()), hn::Set(f, p.z()), first != 0 ? &grid.lists[first] : nullptr};
}

/// The height of a point above the highest plane of a list that may lead out; 0 if it is not inside the hull.
HWY_INLINE float heightIn(const PushGrid& grid, const PushGrid::List& list, const Position& position) {
  const PlaneFloats f;
  auto highest = hn::Set(f, -std::numeric_limits<float>::infinity());
  std::uint32_t b = list.firstBlock;
  for (; b < list.firstBlock + list.exitCount; ++b) {
    for (std::size_t i = 0; i < PushGrid::kWidth; i += hn::Lanes(f)) {
      highest = hn::Max(highest, heights(grid.blocks[b], i, position.x, position.y, position.z));
    }
  }
  const auto zero = hn::Zero(f);
  if (!hn::AllTrue(f, hn::Lt(highest, zero))) return 0.0F;
  for (; b < list.firstBlock + list.blockCount; ++b) {
    for (std::size_t i = 0; i < PushGrid::kWidth; i += hn::Lanes(f)) {
      if (!hn::AllFalse(f, hn::Ge(heights(grid.blocks[b], i, position.x, position.y, position.z), zero))) return 0.0F;
    }
  }
  return hn::GetLane(hn::MaxOfLanes(f, highest));
}

/// The first of a list's planes with this height.
HWY_INLINE PushDepth depthOf(const PushGrid& grid, const PushGrid::List& list, float height, const Position& position) {
  const PlaneFloats f;
  const auto wanted = hn::Set(f, height);
  for (std::uint32_t b = list.firstBlock; b < list.firstBlock + list.exitCount; ++b) {
    for (std::size_t i = 0; i < PushGrid::kWidth; i += hn::Lanes(f)) {
      const auto lane =
          hn::FindFirstTrue(f, hn::Eq(heights(grid.blocks[b], i, position.x, position.y, position.z), wanted));
      if (lane >= 0) return {height, list.hull, grid.planes[b][i + lane]};
    }
  }
  return {};
}

HWY_INLINE bool isNear(const PushHulls& hulls, const Vec3f& p) {
  return (p.array() >= 0.0F).all() && (p.array() <= hulls.boxMax().array()).all();
}

/// @param p  in the box of all hulls
HWY_INLINE PushDepth deepestInCell(const PushGrid& grid, const Vec3f& p) {
  const Position position = positionOf(grid, p);
  if (position.list == nullptr) return {};
  const PushGrid::List* found = nullptr;
  float lowest = 0.0F;
  for (const PushGrid::List* list = position.list;; ++list) {
    const float height = heightIn(grid, *list, position);
    if (height < lowest) {
      lowest = height;
      found = list;
    }
    if (list->last) break;
  }
  return found != nullptr ? depthOf(grid, *found, lowest, position) : PushDepth{};
}

HWY_INLINE bool isInside(const PushGrid& grid, const PushGrid::List& list, const Position& position) {
  const PlaneFloats f;
  for (std::uint32_t b = list.firstBlock; b < list.firstBlock + list.blockCount; ++b) {
    for (std::size_t i = 0; i < PushGrid::kWidth; i += hn::Lanes(f)) {
      const auto height = heights(grid.blocks[b], i, position.x, position.y, position.z);
      if (!hn::AllTrue(f, hn::Lt(height, hn::Zero(f)))) return false;
    }
  }
  return true;
}

bool insideAny(const PushHulls& hulls, const PushGrid& grid, const Vec3f& p) {
  if (!isNear(hulls, p)) return false;
  const Position position = positionOf(grid, p);
  if (position.list == nullptr) return false;
  for (const PushGrid::List* list = position.list;; ++list) {
    if (isInside(grid, *list, position)) return true;
    if (list->last) return false;
  }
}

bool aboveOne(const PushHulls& hulls, std::uint32_t which, const Vec3f& p, float by) {
  const Floats f;
  const PushHulls::Hull& hull = hulls.hulls()[which];
  const auto x = hn::Set(f, p.x()), y = hn::Set(f, p.y()), z = hn::Set(f, p.z()), limit = hn::Set(f, by);
  for (std::size_t i = hull.firstPlane; i < hull.firstPlane + hull.planeCount; i += hn::Lanes(f)) {
    const auto height =
        hn::Sub(hn::Add(hn::Add(hn::Mul(hn::LoadU(f, hulls.x() + i), x), hn::Mul(hn::LoadU(f, hulls.y() + i), y)),
                        hn::Mul(hn::LoadU(f, hulls.z() + i), z)),
                hn::LoadU(f, hulls.offset() + i));
    if (!hn::AllFalse(f, hn::Gt(height, limit))) return true;
  }
  return false;
}

PushDepth deepest(const PushHulls& hulls, const PushGrid& grid, const Vec3f& p) {
  return isNear(hulls, p) ? deepestInCell(grid, p) : PushDepth{};
}

std::size_t allDepths(const PushHulls& hulls, const PushGrid& grid, const Vec3f& p, std::span<PushDepth> depths) {
  if (!isNear(hulls, p)) return 0;
  const Position position = positionOf(grid, p);
  if (position.list == nullptr) return 0;
  std::size_t count = 0;
  for (const PushGrid::List* list = position.list; count < depths.size(); ++list) {
    const float height = heightIn(grid, *list, position);
    if (height < 0.0F) depths[count++] = depthOf(grid, *list, height, position);
    if (list->last) break;
  }
  return count;
}

std::size_t waysOutOf(const PushHulls& hulls, std::uint32_t which, const Vec3f& p, float longest,
                      std::span<PushDepth> faces) {
  constexpr std::size_t kMaxPlanes = 2048;
  constexpr float kSimilar = 0.9F;  // cosine
  const Floats f;
  const PushHulls::Hull& hull = hulls.hulls()[which];
  if (hull.exitCount > kMaxPlanes) return 0;
  const std::size_t first = hull.firstPlane;
  alignas(64) std::array<float, kMaxPlanes> height;  // NOLINT: written before it is read
  const auto dot = [&](std::size_t i, const Vec3f& v) HWY_ATTR {
    return hn::Add(hn::Add(hn::Mul(hn::LoadU(f, hulls.x() + first + i), hn::Set(f, v.x())),
                           hn::Mul(hn::LoadU(f, hulls.y() + first + i), hn::Set(f, v.y()))),
                   hn::Mul(hn::LoadU(f, hulls.z() + first + i), hn::Set(f, v.z())));
  };
  const auto none = hn::Set(f, -std::numeric_limits<float>::infinity());
  auto highest = none;
  for (std::size_t i = 0; i < hull.exitCount; i += hn::Lanes(f)) {
    const auto h = hn::Sub(dot(i, p), hn::LoadU(f, hulls.offset() + first + i));
    hn::StoreU(h, f, height.data() + i);
    highest = hn::Max(highest, h);
  }
  std::size_t count = 0;
  while (count < faces.size()) {
    const float wanted = hn::GetLane(hn::MaxOfLanes(f, highest));
    if (!(wanted > -std::numeric_limits<float>::infinity()) || -wanted > longest) break;
    std::size_t at = 0;
    for (; at < hull.exitCount; at += hn::Lanes(f)) {
      const auto lane = hn::FindFirstTrue(f, hn::Eq(hn::LoadU(f, height.data() + at), hn::Set(f, wanted)));
      if (lane < 0) continue;
      at += lane;
      break;
    }
    const std::uint32_t plane = first + at;
    faces[count++] = {wanted, which, plane};
    const Vec3f normal = hulls.normal(plane);
    highest = none;
    for (std::size_t i = 0; i < hull.exitCount; i += hn::Lanes(f)) {
      const auto similar = hn::Gt(dot(i, normal), hn::Set(f, kSimilar));
      const auto h = hn::IfThenElse(similar, none, hn::LoadU(f, height.data() + i));
      hn::StoreU(h, f, height.data() + i);
      highest = hn::Max(highest, h);
    }
    height[at] = -std::numeric_limits<float>::infinity();
  }
  return count;
}

PushLeave leaveOne(const PushHulls& hulls, std::uint32_t which, const Vec3f& p, const Vec3f& direction) {
  const Floats f;
  const PushHulls::Hull& hull = hulls.hulls()[which];
  const float infinity = std::numeric_limits<float>::infinity();
  const auto lengths = [&](std::size_t i) HWY_ATTR {
    const auto x = hn::LoadU(f, hulls.x() + i);
    const auto y = hn::LoadU(f, hulls.y() + i);
    const auto z = hn::LoadU(f, hulls.z() + i);
    const auto dot = [&](const Vec3f& v) HWY_ATTR {
      return hn::Add(hn::Add(hn::Mul(x, hn::Set(f, v.x())), hn::Mul(y, hn::Set(f, v.y()))),
                     hn::Mul(z, hn::Set(f, v.z())));
    };
    const auto height = hn::Sub(dot(p), hn::LoadU(f, hulls.offset() + i));
    const auto rise = dot(direction);
    const auto leaves = hn::Ge(rise, hn::Set(f, 1e-3F));
    return hn::IfThenElse(leaves, hn::Div(hn::Sub(hn::Set(f, hulls.margin()), height), rise), hn::Set(f, infinity));
  };
  const std::size_t end = hull.firstPlane + hull.planeCount;
  auto nearest = hn::Set(f, infinity);
  for (std::size_t i = hull.firstPlane; i < end; i += hn::Lanes(f)) nearest = hn::Min(nearest, lengths(i));
  const float length = hn::GetLane(hn::MinOfLanes(f, nearest));
  if (!(length < infinity)) return {infinity, 0};
  for (std::size_t i = hull.firstPlane; i < end; i += hn::Lanes(f)) {
    const auto lane = hn::FindFirstTrue(f, hn::Eq(lengths(i), hn::Set(f, length)));
    if (lane >= 0) return {length, static_cast<std::uint32_t>(i + lane)};
  }
  return {infinity, 0};
}

/// Lists the particles in cells that a hull reaches into, and these cells.
HWY_INLINE std::size_t screen(const PushHulls& hulls, const PushGrid& grid, const float* xyz, std::size_t count,
                              std::uint32_t* listed, std::uint32_t* cells) {
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
  const auto lane = hn::Iota(n, 0);
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
    const auto index = hn::Add(lane, hn::Set(n, static_cast<std::int32_t>(i)));
    hn::StoreU(hn::Compress(index, hit), n, reinterpret_cast<std::int32_t*>(listed) + found);
    hn::StoreU(hn::Compress(cell, hit), n, reinterpret_cast<std::int32_t*>(cells) + found);
    found += hn::CountTrue(n, hit);
  }
  for (; i < count; ++i) {
    const Vec3f p = Vec3f(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]) - hulls.origin();
    if (!isNear(hulls, p) || grid.firstList[grid.cellOf(p)] == 0) continue;
    cells[found] = grid.cellOf(p);
    listed[found++] = i;
  }
  return found;
}

/// deepestAt() of particles in one cell, as many as there are lanes.
HWY_INLINE void deepestOf(const PushGrid& grid, const PushGrid::List* list, const PushScratch::Row* rows,
                          std::size_t count, PushDepth* depths) {
  const Floats f;
  const Indices n;
  const auto zero = hn::Zero(f);
  auto x = zero, y = zero, z = zero, which = zero;
  hn::LoadInterleaved4(f, &rows->x, x, y, z, which);
  auto lowest = zero;
  auto lowestPlane = hn::Zero(n), lowestHull = hn::Zero(n);
  const auto heightAbove = [&](const PushGrid::Block& block, std::size_t i) HWY_ATTR {
    return hn::Sub(hn::Add(hn::Add(hn::Mul(hn::Set(f, block.x[i]), x), hn::Mul(hn::Set(f, block.y[i]), y)),
                           hn::Mul(hn::Set(f, block.z[i]), z)),
                   hn::Set(f, block.offset[i]));
  };
  for (;; ++list) {
    auto highest = hn::Set(f, -std::numeric_limits<float>::infinity());
    auto plane = hn::Zero(n);
    std::uint32_t b = list->firstBlock;
    for (; b < list->firstBlock + list->exitCount; ++b) {
      for (std::size_t i = 0; i < PushGrid::kWidth; ++i) {
        const auto height = heightAbove(grid.blocks[b], i);
        const auto higher = hn::Gt(height, highest);
        highest = hn::IfThenElse(higher, height, highest);
        plane = hn::IfThenElse(hn::RebindMask(n, higher),
                               hn::Set(n, static_cast<std::uint32_t>(b * PushGrid::kWidth + i)), plane);
      }
    }
    auto lower = hn::Lt(highest, lowest);
    for (; b < list->firstBlock + list->blockCount && !hn::AllFalse(f, lower); ++b) {
      for (std::size_t i = 0; i < PushGrid::kWidth; ++i) {
        lower = hn::And(lower, hn::Lt(heightAbove(grid.blocks[b], i), zero));
      }
    }
    lowest = hn::IfThenElse(lower, highest, lowest);
    lowestPlane = hn::IfThenElse(hn::RebindMask(n, lower), plane, lowestPlane);
    lowestHull = hn::IfThenElse(hn::RebindMask(n, lower), hn::Set(n, list->hull), lowestHull);
    if (list->last) break;
  }
  alignas(64) std::array<float, 16> height;               // NOLINT: written before it is read
  alignas(64) std::array<std::uint32_t, 16> plane, hull;  // NOLINT
  hn::Store(lowest, f, height.data());
  hn::Store(lowestPlane, n, plane.data());
  hn::Store(lowestHull, n, hull.data());
  for (std::size_t k = 0; k < count; ++k) {
    depths[rows[k].listed] = {height[k], hull[k],
                              grid.planes[plane[k] / PushGrid::kWidth][plane[k] % PushGrid::kWidth]};
  }
}

// The particles are looked at cell by cell: whatever their order, the planes of a cell are then at hand for all of
// them.
std::size_t pushAll(const PushHulls& hulls, const PushGrid& grid, float* xyz, std::size_t count, std::uint32_t first,
                    PushScratch& scratch, ParticleTouch* touches) {
  std::uint32_t *listed = scratch.listed.data(), *cell = scratch.cell.data(), *starts = scratch.starts.data();
  PushScratch::Row* rows = scratch.rows.data();
  const std::size_t near = screen(hulls, grid, xyz, count, listed, cell);
  if (near == 0) return 0;
  std::fill_n(starts, grid.lists.size() + 1, 0u);
  for (std::size_t k = 0; k < near; ++k) {
    cell[k] = grid.firstList[cell[k]];
    ++starts[cell[k]];
  }
  std::uint32_t sum = 0;
  for (std::size_t list = 0; list <= grid.lists.size(); ++list) sum += std::exchange(starts[list], sum);
  for (std::size_t k = 0; k < near; ++k) {
    const float* at = xyz + 3 * static_cast<std::size_t>(listed[k]);
    const Vec3f p = Vec3f(at[0], at[1], at[2]) - hulls.origin();
    rows[starts[cell[k]]++] = {p.x(), p.y(), p.z(), static_cast<std::uint32_t>(k)};
  }
  for (std::size_t list = 0, begin = 0; begin < near; begin = starts[list++]) {
    for (std::size_t r = begin; r < starts[list]; r += hn::Lanes(Floats())) {
      deepestOf(grid, &grid.lists[list], rows + r, std::min(hn::Lanes(Floats()), starts[list] - r),
                scratch.depths.data());
    }
  }
  std::uint32_t touched = 0;
  for (std::size_t k = 0; k < near; ++k) {
    cell[k] = touched;
    touched += scratch.depths[k].height < 0.0F ? 1 : 0;
  }
  for (std::size_t r = 0; r < near; ++r) {
    const PushScratch::Row& row = rows[r];
    const PushDepth& inside = scratch.depths[row.listed];
    if (!(inside.height < 0.0F)) continue;
    const Vec3f start(row.x, row.y, row.z);
    // The nearest way out of the one hull nearly always leads out of all.
    PushExit exit{start + (hulls.margin() - inside.height) * hulls.normal(inside.plane), inside.hull, inside.plane};
    if (insideAny(hulls, grid, exit.position)) exit = findExit(hulls, grid, start, inside);
    const PushHulls::Hull& hull = hulls.hulls()[exit.hull];
    const Vec3f position = exit.position + hulls.origin();
    const std::uint32_t particle = listed[row.listed];
    std::copy_n(position.data(), 3, xyz + 3 * static_cast<std::size_t>(particle));
    touches[cell[row.listed]] = {first + particle, hull.part, (exit.position - start).norm(), hulls.normal(exit.plane),
                                 hulls.surfaceVelocity(hull, exit.position)};
  }
  return touched;
}

}  // namespace lorica::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace lorica {
namespace {
HWY_EXPORT(deepest);
HWY_EXPORT(allDepths);
HWY_EXPORT(waysOutOf);
HWY_EXPORT(leaveOne);
HWY_EXPORT(insideAny);
HWY_EXPORT(aboveOne);
HWY_EXPORT(pushAll);
}  // namespace

PushDepth deepestAt(const PushHulls& hulls, const PushGrid& grid, const Vec3f& p) {
  return HWY_DYNAMIC_DISPATCH(deepest)(hulls, grid, p);
}

std::size_t depthsAt(const PushHulls& hulls, const PushGrid& grid, const Vec3f& p, std::span<PushDepth> depths) {
  return HWY_DYNAMIC_DISPATCH(allDepths)(hulls, grid, p, depths);
}

std::size_t waysOut(const PushHulls& hulls, std::uint32_t hull, const Vec3f& p, float longest,
                    std::span<PushDepth> faces) {
  return HWY_DYNAMIC_DISPATCH(waysOutOf)(hulls, hull, p, longest, faces);
}

PushLeave leaveHull(const PushHulls& hulls, std::uint32_t hull, const Vec3f& p, const Vec3f& direction) {
  return HWY_DYNAMIC_DISPATCH(leaveOne)(hulls, hull, p, direction);
}

bool isInsideAny(const PushHulls& hulls, const PushGrid& grid, const Vec3f& p) {
  return HWY_DYNAMIC_DISPATCH(insideAny)(hulls, grid, p);
}

bool isAbove(const PushHulls& hulls, std::uint32_t hull, const Vec3f& p, float by) {
  return HWY_DYNAMIC_DISPATCH(aboveOne)(hulls, hull, p, by);
}

void PushScratch::reserveRows(std::size_t particles, std::size_t lists) {
  const std::size_t room = particles + 16;  // whole vectors are read and written
  if (starts.size() < lists + 1) starts.resize(lists + 1);
  if (rows.size() >= room) return;
  for (std::vector<std::uint32_t>* v : {&listed, &cell}) v->resize(room);
  rows.resize(room);
  depths.resize(room);
}

std::size_t pushParticles(const PushHulls& hulls, const PushGrid& grid, float* xyz, std::size_t count,
                          std::uint32_t first, PushScratch& scratch, ParticleTouch* touches) {
  return HWY_DYNAMIC_DISPATCH(pushAll)(hulls, grid, xyz, count, first, scratch, touches);
}

}  // namespace lorica
#endif

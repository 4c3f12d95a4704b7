#include "collision/particles/particle_push_grid.h"

// Highway compiles the code between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/particles/particle_push_grid.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace lorica::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, PushHulls::kBlock>;
using Indices = hn::RebindToUnsigned<Floats>;

/// Some planes, in whole blocks.
struct Planes {
  const float* x;
  const float* y;
  const float* z;
  const float* offset;
  const std::uint32_t* index;  ///< null: they are numbered from `first`
  std::uint32_t first;
  std::size_t exitCount;
  std::size_t count;
};

/// The highest plane above a point.
struct Highest {
  float height;
  float x, y, z;  ///< normal
};

/// Chooses the planes that can be the highest above some point of a cube, among those that may lead out and among all.
///
/// A plane p is excluded if another one, q, is higher in the whole cube: if the difference of their heights at the
/// center is more than the difference of their normals can compensate. Here q is the highest above the center.
/// @return whether the hull reaches into the cube; only then is all of `out` written
HWY_INLINE bool choose(const Planes& in, const Vec3f& center, float half, float slack, PushGrid::Chosen& out) {
  const Floats f;
  const Indices n;
  const auto centerX = hn::Set(f, center.x());
  const auto centerY = hn::Set(f, center.y());
  const auto centerZ = hn::Set(f, center.z());
  const auto reach = hn::Set(f, half);
  const float nowhere = -std::numeric_limits<float>::infinity();

  // Whether the whole cube is above one plane.
  auto lowest = hn::Set(f, nowhere);
  auto highest = hn::Set(f, nowhere);
  const auto look = [&](std::size_t begin, std::size_t end) HWY_ATTR {
    for (std::size_t i = begin; i < end; i += hn::Lanes(f)) {
      const auto x = hn::LoadU(f, in.x + i);
      const auto y = hn::LoadU(f, in.y + i);
      const auto z = hn::LoadU(f, in.z + i);
      const auto height = hn::Sub(hn::Add(hn::Add(hn::Mul(x, centerX), hn::Mul(y, centerY)), hn::Mul(z, centerZ)),
                                  hn::LoadU(f, in.offset + i));
      const auto around = hn::Mul(reach, hn::Add(hn::Add(hn::Abs(x), hn::Abs(y)), hn::Abs(z)));
      hn::StoreU(height, f, out.height.data() + i);
      lowest = hn::Max(lowest, hn::Sub(height, around));
      highest = hn::Max(highest, height);
    }
    return hn::GetLane(hn::MaxOfLanes(f, lowest)) <= slack;
  };
  const auto planeOf = [&](std::size_t end) HWY_ATTR {
    const float height = hn::GetLane(hn::MaxOfLanes(f, highest));
    std::size_t i = 0;
    for (; i < end; i += hn::Lanes(f)) {
      const auto lane = hn::FindFirstTrue(f, hn::Eq(hn::LoadU(f, out.height.data() + i), hn::Set(f, height)));
      if (lane < 0) continue;
      i += lane;
      break;
    }
    return Highest{height, in.x[i], in.y[i], in.z[i]};
  };
  if (!look(0, in.exitCount)) return false;
  const Highest exit = planeOf(in.exitCount);
  if (!look(in.exitCount, in.count)) return false;
  const Highest any = in.exitCount < in.count ? planeOf(in.count) : exit;

  std::size_t count = 0;
  const auto take = [&](std::size_t begin, std::size_t end, const Highest& best) HWY_ATTR {
    const auto bestX = hn::Set(f, best.x);
    const auto bestY = hn::Set(f, best.y);
    const auto bestZ = hn::Set(f, best.z);
    const auto atLeast = hn::Set(f, best.height - slack);
    const auto lane = hn::Iota(n, 0);
    for (std::size_t i = begin; i < end; i += hn::Lanes(f)) {
      const auto x = hn::LoadU(f, in.x + i);
      const auto y = hn::LoadU(f, in.y + i);
      const auto z = hn::LoadU(f, in.z + i);
      const auto apart = hn::Add(hn::Add(hn::AbsDiff(x, bestX), hn::AbsDiff(y, bestY)), hn::AbsDiff(z, bestZ));
      const auto matters = hn::Ge(hn::Add(hn::LoadU(f, out.height.data() + i), hn::Mul(reach, apart)), atLeast);
      if (hn::AllFalse(f, matters)) continue;
      const auto index = in.index != nullptr ? hn::LoadU(n, in.index + i)
                                             : hn::Add(lane, hn::Set(n, in.first + static_cast<std::uint32_t>(i)));
      hn::CompressStore(x, matters, f, out.x.data() + count);
      hn::CompressStore(y, matters, f, out.y.data() + count);
      hn::CompressStore(z, matters, f, out.z.data() + count);
      hn::CompressStore(hn::LoadU(f, in.offset + i), matters, f, out.offset.data() + count);
      count += hn::CompressStore(index, hn::RebindMask(n, matters), n, out.plane.data() + count);
    }
    for (; count % PushHulls::kBlock != 0; ++count) {
      out.x[count] = out.y[count] = out.z[count] = 0.0F;
      out.offset[count] = std::numeric_limits<float>::infinity();
      out.plane[count] = 0;
    }
  };
  take(0, in.exitCount, exit);
  out.exitCount = count;
  take(in.exitCount, in.count, any);
  out.count = count;
  return true;
}

/// Appends chosen planes to the blocks of the grid.
HWY_INLINE void append(const PushGrid::Chosen& from, bool last, PushGrid& grid) {
  PushGrid::List list{from.hull, static_cast<std::uint32_t>(grid.blocks.size()), 0, 0, last};
  for (std::size_t i = 0; i < from.count; i += PushGrid::kWidth) {
    if (i == from.exitCount) list.exitCount = grid.blocks.size() - list.firstBlock;
    if (from.offset[i] == std::numeric_limits<float>::infinity()) continue;
    PushGrid::Block& block = grid.blocks.emplace_back();
    std::copy_n(from.x.data() + i, PushGrid::kWidth, block.x.data());
    std::copy_n(from.y.data() + i, PushGrid::kWidth, block.y.data());
    std::copy_n(from.z.data() + i, PushGrid::kWidth, block.z.data());
    std::copy_n(from.offset.data() + i, PushGrid::kWidth, block.offset.data());
    std::copy_n(from.plane.data() + i, PushGrid::kWidth, grid.planes.emplace_back().data());
  }
  if (from.count == from.exitCount) list.exitCount = grid.blocks.size() - list.firstBlock;
  list.blockCount = grid.blocks.size() - list.firstBlock;
  grid.lists.push_back(list);
}

void fillGrid(const PushHulls& hulls, PushGrid& grid) {
  constexpr std::int32_t kGroup = 4;  // cells on an edge of a group: planes are first chosen per group
  const std::size_t hullCount = hulls.hulls().size();
  const float slack = hulls.margin();
  PushGrid::Chosen& ofCell = grid.chosen[hullCount];
  const auto middle = [&](std::int32_t first, std::int32_t cells) {
    return (static_cast<float>(first) + 0.5F * static_cast<float>(cells)) * grid.size;
  };
  const float halfCell = 0.5F * grid.size + slack;  // rounding may assign a point to the neighbouring cell
  const float halfGroup = 0.5F * kGroup * grid.size + slack;

  for (std::int32_t z0 = 0; z0 < grid.count[2]; z0 += kGroup) {
    for (std::int32_t y0 = 0; y0 < grid.count[1]; y0 += kGroup) {
      for (std::int32_t x0 = 0; x0 < grid.count[0]; x0 += kGroup) {
        const Vec3f center(middle(x0, kGroup), middle(y0, kGroup), middle(z0, kGroup));
        std::size_t reaching = 0;
        for (std::size_t h = 0; h < hullCount; ++h) {
          const PushHulls::Hull& hull = hulls.hulls()[h];
          if (((center.array() + halfGroup) < hull.boxMin.array()).any() ||
              ((center.array() - halfGroup) > hull.boxMax.array()).any()) {
            continue;
          }
          const std::size_t first = hull.firstPlane;
          const Planes all{hulls.x() + first,      hulls.y() + first, hulls.z() + first,
                           hulls.offset() + first, nullptr,           static_cast<std::uint32_t>(first),
                           hull.exitCount,         hull.planeCount};
          PushGrid::Chosen& chosen = grid.chosen[reaching];
          if (!choose(all, center, halfGroup, slack, chosen)) continue;
          chosen.hull = h;
          ++reaching;
        }
        if (reaching == 0) continue;
        for (std::int32_t z = z0; z < std::min(z0 + kGroup, grid.count[2]); ++z) {
          for (std::int32_t y = y0; y < std::min(y0 + kGroup, grid.count[1]); ++y) {
            for (std::int32_t x = x0; x < std::min(x0 + kGroup, grid.count[0]); ++x) {
              const Vec3f here(middle(x, 1), middle(y, 1), middle(z, 1));
              const std::size_t before = grid.lists.size();
              for (std::size_t i = 0; i < reaching; ++i) {
                const PushGrid::Chosen& c = grid.chosen[i];
                const Planes some{c.x.data(),     c.y.data(), c.z.data(),  c.offset.data(),
                                  c.plane.data(), 0,          c.exitCount, c.count};
                if (!choose(some, here, halfCell, slack, ofCell)) continue;
                ofCell.hull = c.hull;
                append(ofCell, false, grid);
              }
              if (grid.lists.size() == before) continue;
              grid.lists.back().last = true;
              const std::size_t cell = (z * grid.count[1] + y) * grid.count[0] + x;
              grid.firstList[cell] = before;
              grid.occupied[cell / 32] |= 1U << (cell % 32);
            }
          }
        }
      }
    }
  }
}

}  // namespace lorica::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace lorica {
namespace {
HWY_EXPORT(fillGrid);

constexpr double kMaxAlong = 400.0;

}  // namespace

void PushGrid::Chosen::reserveRows(std::size_t planeCount) {
  const std::size_t room =
      planeCount + 3 * PushHulls::kBlock;  // whole vectors are written, and two kinds are rounded up
  if (x.size() >= room) return;
  for (std::vector<float>* v : {&x, &y, &z, &offset, &height}) v->resize(room);
  plane.resize(room);
}

void PushGrid::build(const PushHulls& hulls, double cells) {
  lists.clear();
  blocks.clear();
  planes.clear();
  lists.emplace_back();  // 0 means no list
  const Eigen::Array3d extent = hulls.boxMax().cast<double>().array();
  const double longest = extent.maxCoeff();
  const Eigen::Array3d thick = extent.max(1e-3 * longest);
  size = std::max(std::cbrt(thick.prod() / cells), longest / kMaxAlong);
  inverseSize = 1.0F / size;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    count[axis] = static_cast<std::int32_t>(hulls.boxMax()[axis] * inverseSize) + 1;
  }
  const std::size_t cellCount = static_cast<std::size_t>(count[0]) * count[1] * count[2];
  firstList.assign(cellCount, 0);
  occupied.assign(cellCount / 32 + 1, 0);

  std::size_t max = 0;
  for (const PushHulls::Hull& hull : hulls.hulls()) max = std::max(max, hull.planeCount);
  if (chosen.size() < hulls.hulls().size() + 1) chosen.resize(hulls.hulls().size() + 1);
  for (Chosen& c : chosen) c.reserveRows(max);
  HWY_DYNAMIC_DISPATCH(fillGrid)(hulls, *this);
}

}  // namespace lorica
#endif

#include "collision/live/lifted_kernel.h"

#include <array>
#include <limits>

// Highway compiles the code between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/live/lifted_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lorica::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, LiftedPart::kBlock>;  // any smaller power of two divides a block too
using Float = hn::Vec<Floats>;

// a * b + c in two steps: fused it is rounded otherwise, and not every processor has that.
HWY_INLINE Float mulAdd(Float a, Float b, Float c) {
  return hn::Add(hn::Mul(a, b), c);
}

// Adds a block's points: weights times the bones' matrices times (position, 1).
HWY_INLINE void addPositions(const std::uint32_t* bones, std::uint32_t count, const FourColumns<float>* matrices,
                             const float* lanes, Float& x, Float& y, Float& z) {
  const Floats f;
  constexpr std::size_t kBlock = LiftedPart::kBlock;
  const auto px = hn::Load(f, lanes);
  const auto py = hn::Load(f, lanes + kBlock);
  const auto pz = hn::Load(f, lanes + 2 * kBlock);
  for (std::uint32_t b = 0; b < count; ++b) {
    const auto& m = matrices[bones[b]].column;
    const auto weight = hn::Load(f, lanes + (3 + b) * kBlock);
    const auto moved = [&](std::size_t r) HWY_ATTR {
      const auto z0 = mulAdd(hn::Set(f, m[2][r]), pz, hn::Set(f, m[3][r]));
      return mulAdd(hn::Set(f, m[0][r]), px, mulAdd(hn::Set(f, m[1][r]), py, z0));
    };
    x = mulAdd(weight, moved(0), x);
    y = mulAdd(weight, moved(1), y);
    z = mulAdd(weight, moved(2), z);
  }
}

/// The bones of a group that move its points: all but those whose matrix is 0, the shapes without weight.
struct Moving {
  std::uint32_t count = 0;
  std::array<std::uint32_t, 64> bones;  ///< of the group; not used if count is that of all bones
};

HWY_INLINE void findMoving(const std::uint32_t* bones, std::uint32_t count, const FourColumns<float>* matrices,
                           Moving& moving) {
  moving.count = 0;
  for (std::uint32_t b = 0; b < count; ++b) {
    if (matrices[bones[b]].column == decltype(FourColumns<float>::column){}) continue;
    if (moving.count < moving.bones.size()) moving.bones[moving.count] = b;
    ++moving.count;
  }
  if (moving.count > moving.bones.size()) moving.count = count;
}

// Adds a block's points: the bones' matrices times (moment, weight).
HWY_INLINE void addMoments(const std::uint32_t* bones, std::uint32_t count, const Moving& moving,
                           const FourColumns<float>* matrices, const float* block, Float& x, Float& y, Float& z) {
  const Floats f;
  constexpr std::size_t kBlock = LiftedPart::kBlock;
  for (std::uint32_t i = 0; i < moving.count; ++i) {
    const std::uint32_t b = moving.count == count ? i : moving.bones[i];
    const auto& m = matrices[bones[b]].column;
    const float* lanes = block + 4 * kBlock * b;
    const auto qx = hn::Load(f, lanes);
    const auto qy = hn::Load(f, lanes + kBlock);
    const auto qz = hn::Load(f, lanes + 2 * kBlock);
    const auto qw = hn::Load(f, lanes + 3 * kBlock);
    const auto add = [&](auto to, std::size_t r) HWY_ATTR {
      to = mulAdd(hn::Set(f, m[0][r]), qx, to);
      to = mulAdd(hn::Set(f, m[1][r]), qy, to);
      to = mulAdd(hn::Set(f, m[2][r]), qz, to);
      return mulAdd(hn::Set(f, m[3][r]), qw, to);
    };
    x = add(x, 0);
    y = add(y, 1);
    z = add(z, 2);
  }
}

float evaluateGroups(std::span<const LiftedPart::Group> groups, std::span<const std::uint32_t> groupBones,
                     const LiftedPart::Lane* lanes, const FourColumns<float>* matrices, PointRow* rows) {
  const Floats f;
  auto largest = hn::Zero(f);
  for (const LiftedPart::Group& group : groups) {
    const std::uint32_t* bones = &groupBones[group.firstBone];
    const std::size_t lanesOfOne = LiftedPart::lanesOfBlock(group.bones, group.onePosition);
    const float* block = lanes[group.firstLane].of.data();
    float* out = &rows[group.firstRow].x;
    Moving moving;
    moving.count = group.bones;
    if (group.shapes) findMoving(bones, group.bones, matrices, moving);
    for (std::uint32_t k = 0; k < group.blocks; ++k) {
      for (std::size_t lane = 0; lane < LiftedPart::kBlock; lane += hn::Lanes(f)) {
        auto x = hn::Zero(f);
        auto y = hn::Zero(f);
        auto z = hn::Zero(f);
        if (group.onePosition) {
          addPositions(bones, group.bones, matrices, block + lane, x, y, z);
        } else {
          addMoments(bones, group.bones, moving, matrices, block + lane, x, y, z);
        }
        x = hn::Round(x);
        y = hn::Round(y);
        z = hn::Round(z);
        largest = hn::Max(largest, hn::Max(hn::Abs(x), hn::Max(hn::Abs(y), hn::Abs(z))));
        hn::StoreInterleaved4(x, y, z, hn::Zero(f), f, out + 4 * lane);
      }
      block += lanesOfOne * LiftedPart::kBlock;
      out += 4 * LiftedPart::kBlock;
    }
  }
  return hn::GetLane(hn::MaxOfLanes(f, largest));
}

std::int32_t farthestOfRows(std::span<const PointRow> rows, const Vec3f& direction) {
  const Floats f;
  const hn::RebindToSigned<Floats> n;
  const std::size_t lanes = hn::Lanes(f);
  const auto dx = hn::Set(f, direction.x());
  const auto dy = hn::Set(f, direction.y());
  const auto dz = hn::Set(f, direction.z());
  auto best = hn::Set(f, -std::numeric_limits<float>::infinity());
  auto which = hn::Zero(n);
  auto index = hn::Iota(n, 0);
  std::size_t i = 0;
  for (; i + lanes <= rows.size(); i += lanes) {
    auto x = hn::Zero(f);
    auto y = hn::Zero(f);
    auto z = hn::Zero(f);
    auto w = hn::Zero(f);
    hn::LoadInterleaved4(f, &rows[i].x, x, y, z, w);
    // Not fused, so that every instruction set rounds alike.
    const auto along = hn::Add(hn::Add(hn::Mul(dx, x), hn::Mul(dy, y)), hn::Mul(dz, z));
    const auto farther = hn::Gt(along, best);
    best = hn::IfThenElse(farther, along, best);
    which = hn::IfThenElse(hn::RebindMask(n, farther), index, which);
    index = hn::Add(index, hn::Set(n, static_cast<std::int32_t>(lanes)));
  }
  std::array<float, LiftedPart::kBlock> value;
  std::array<std::int32_t, LiftedPart::kBlock> at;
  hn::StoreU(best, f, value.data());
  hn::StoreU(which, n, at.data());
  float max = value[0];
  std::int32_t row = at[0];
  for (std::size_t lane = 1; lane < lanes; ++lane) {
    if (value[lane] < max || (value[lane] == max && at[lane] > row)) continue;
    max = value[lane];
    row = at[lane];
  }
  for (; i < rows.size(); ++i) {
    const float along = (direction.x() * rows[i].x + direction.y() * rows[i].y) + direction.z() * rows[i].z;
    if (!(along > max)) continue;
    max = along;
    row = i;
  }
  return row;
}

}  // namespace lorica::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace lorica {
namespace {
HWY_EXPORT(evaluateGroups);
HWY_EXPORT(farthestOfRows);
}  // namespace

float evaluateLifted(std::span<const LiftedPart::Group> groups, std::span<const std::uint32_t> groupBones,
                     const LiftedPart::Lane* lanes, const FourColumns<float>* matrices, PointRow* rows) {
  return HWY_DYNAMIC_DISPATCH(evaluateGroups)(groups, groupBones, lanes, matrices, rows);
}

std::int32_t farthestRow(std::span<const PointRow> rows, const Vec3f& direction) {
  return HWY_DYNAMIC_DISPATCH(farthestOfRows)(rows, direction);
}

}  // namespace lorica
#endif

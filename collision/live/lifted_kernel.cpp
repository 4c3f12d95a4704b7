#include "collision/live/lifted_kernel.h"

#include <array>
#include <cstddef>
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
using Doubles = hn::CappedTag<double, 4>;  // a column, or half of one
using Double = hn::Vec<Doubles>;

// No fused multiply-add, so that every instruction set rounds alike.
HWY_INLINE Double sumOfThree(Double a, double x, Double b, double y, Double c, double z) {
  const Doubles d;
  return hn::Add(hn::Add(hn::Mul(a, hn::Set(d, x)), hn::Mul(b, hn::Set(d, y))), hn::Mul(c, hn::Set(d, z)));
}

FourColumns<double> sumBones(std::span<const Affine3> worldFromModel, const Vec3& origin,
                             std::span<const JointIndex> joints, std::span<const FourColumns<double>> constants) {
  const Doubles d;
  alignas(32) const std::array<double, 4> from = {origin.x(), origin.y(), origin.z(), 0.0};
  FourColumns<double> sum;
  for (std::size_t row = 0; row < 4; row += hn::Lanes(d)) {
    const auto from4 = hn::Load(d, from.data() + row);
    auto sum0 = hn::Zero(d);
    auto sum1 = hn::Zero(d);
    auto sum2 = hn::Zero(d);
    auto sum3 = hn::Zero(d);
    for (std::size_t b = 0; b < joints.size(); ++b) {
      const double* m = worldFromModel[joints[b]].data() + row;
      const auto m0 = hn::LoadU(d, m);
      const auto m1 = hn::LoadU(d, m + 4);
      const auto m2 = hn::LoadU(d, m + 8);
      const auto m3 = hn::Sub(hn::LoadU(d, m + 12), from4);
      const auto times = [&](const std::array<double, 4>& k) HWY_ATTR {
        return hn::Add(sumOfThree(m0, k[0], m1, k[1], m2, k[2]), hn::Mul(m3, hn::Set(d, k[3])));
      };
      sum0 = hn::Add(sum0, times(constants[b].column[0]));
      sum1 = hn::Add(sum1, times(constants[b].column[1]));
      sum2 = hn::Add(sum2, times(constants[b].column[2]));
      sum3 = hn::Add(sum3, times(constants[b].column[3]));
    }
    hn::Store(sum0, d, sum.column[0].data() + row);
    hn::Store(sum1, d, sum.column[1].data() + row);
    hn::Store(sum2, d, sum.column[2].data() + row);
    hn::Store(sum3, d, sum.column[3].data() + row);
  }
  return sum;
}

/// What to do with a bone.
enum class View { kCompare, kWrite };

// Compares or writes a part's view of a bone.
// @return whether no point would move
template <View kView>
HWY_INLINE bool viewBone(const Affine3& worldFromModel, const BoneView& view, const FourColumns<double>& steps,
                         FourColumns<float>& matrix) {
  const Doubles d;
  const hn::Rebind<float, Doubles> f;
  const double* m = worldFromModel.data();
  const Vec3& at = view.center;
  std::array<double, 3> center{};
  for (std::size_t r = 0; r < 3; ++r) {
    center[r] = m[r] * at.x() + m[4 + r] * at.y() + m[8 + r] * at.z() + (m[12 + r] - view.origin[r]);
  }
  for (std::size_t row = 0; row < 4; row += hn::Lanes(d)) {
    const auto x = hn::Load(d, steps.column[0].data() + row);
    const auto y = hn::Load(d, steps.column[1].data() + row);
    const auto z = hn::Load(d, steps.column[2].data() + row);
    const auto now0 = hn::DemoteTo(f, sumOfThree(x, m[0], y, m[1], z, m[2]));
    const auto now1 = hn::DemoteTo(f, sumOfThree(x, m[4], y, m[5], z, m[6]));
    const auto now2 = hn::DemoteTo(f, sumOfThree(x, m[8], y, m[9], z, m[10]));
    const auto now3 = hn::DemoteTo(f, sumOfThree(x, center[0], y, center[1], z, center[2]));
    if constexpr (kView == View::kWrite) {
      hn::Store(now0, f, matrix.column[0].data() + row);
      hn::Store(now1, f, matrix.column[1].data() + row);
      hn::Store(now2, f, matrix.column[2].data() + row);
      hn::Store(now3, f, matrix.column[3].data() + row);
    } else {
      const auto change = [&](auto now, std::size_t c)
                              HWY_ATTR { return hn::Abs(hn::Sub(now, hn::Load(f, matrix.column[c].data() + row))); };
      const auto turned = hn::Add(hn::Add(change(now0, 0), change(now1, 1)), change(now2, 2));
      const auto max = hn::Add(hn::Mul(turned, hn::Set(f, view.radius)), change(now3, 3));
      if (!hn::AllTrue(f, hn::Le(max, hn::Set(f, view.still)))) return false;
    }
  }
  return true;
}

bool viewAllBones(std::span<const Affine3> worldFromModel, const BoneView& view, std::span<const JointIndex> joints,
                  std::span<FourColumns<float>> matrices) {
  FourColumns<double> steps;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t r = 0; r < 3; ++r) {
      steps.column[c][r] = view.stepsFromWorld(r, c);
    }
  }
  const auto bone = [&](std::size_t b) -> const Affine3& { return worldFromModel[joints[b]]; };
  std::size_t same = 0;
  while (same < joints.size() && viewBone<View::kCompare>(bone(same), view, steps, matrices[same])) ++same;
  if (same == joints.size()) return false;
  for (std::size_t b = 0; b < joints.size(); ++b) viewBone<View::kWrite>(bone(b), view, steps, matrices[b]);
  return true;
}

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
HWY_EXPORT(sumBones);
HWY_EXPORT(viewAllBones);
HWY_EXPORT(evaluateGroups);
HWY_EXPORT(farthestOfRows);
}  // namespace

FourColumns<double> sumOverBones(std::span<const Affine3> worldFromModel, const Vec3& origin,
                                 std::span<const JointIndex> joints, std::span<const FourColumns<double>> constants) {
  return HWY_DYNAMIC_DISPATCH(sumBones)(worldFromModel, origin, joints, constants);
}

bool viewBones(std::span<const Affine3> worldFromModel, const BoneView& view, std::span<const JointIndex> joints,
               std::span<FourColumns<float>> matrices) {
  return HWY_DYNAMIC_DISPATCH(viewAllBones)(worldFromModel, view, joints, matrices);
}

float evaluateLifted(std::span<const LiftedPart::Group> groups, std::span<const std::uint32_t> groupBones,
                     const LiftedPart::Lane* lanes, const FourColumns<float>* matrices, PointRow* rows) {
  return HWY_DYNAMIC_DISPATCH(evaluateGroups)(groups, groupBones, lanes, matrices, rows);
}

std::int32_t farthestRow(std::span<const PointRow> rows, const Vec3f& direction) {
  return HWY_DYNAMIC_DISPATCH(farthestOfRows)(rows, direction);
}

}  // namespace lorica
#endif

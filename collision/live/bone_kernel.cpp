#include "collision/live/bone_kernel.h"

#include <cstddef>

// Highway compiles the code between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/live/bone_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lorica::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
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

}  // namespace lorica::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace lorica {
namespace {
HWY_EXPORT(sumBones);
HWY_EXPORT(viewAllBones);
}  // namespace

FourColumns<double> sumOverBones(std::span<const Affine3> worldFromModel, const Vec3& origin,
                                 std::span<const JointIndex> joints, std::span<const FourColumns<double>> constants) {
  return HWY_DYNAMIC_DISPATCH(sumBones)(worldFromModel, origin, joints, constants);
}

bool viewBones(std::span<const Affine3> worldFromModel, const BoneView& view, std::span<const JointIndex> joints,
               std::span<FourColumns<float>> matrices) {
  return HWY_DYNAMIC_DISPATCH(viewAllBones)(worldFromModel, view, joints, matrices);
}

}  // namespace lorica
#endif

#include "collision/lifted_kernel.h"

// Highway compiles what lies between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/lifted_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lorica::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, LiftedPart::Terms::kPoints>;  // any smaller power of two divides a block too

float evaluateGroups(std::span<const LiftedPart::Group> groups, std::span<const std::uint32_t> groupBones,
                     const LiftedPart::Terms* terms, const float* bones, PointRow* rows) {
  const Floats f;
  constexpr std::size_t kBlock = LiftedPart::Terms::kPoints;
  auto largest = hn::Zero(f);
  for (const LiftedPart::Group& group : groups) {
    const LiftedPart::Terms* blockTerms = terms + group.firstTerms;
    float* out = &rows[group.firstRow].x;
    for (std::uint32_t block = 0; block < group.blocks; ++block) {
      for (std::size_t lane = 0; lane < kBlock; lane += hn::Lanes(f)) {
        auto x = hn::Zero(f);
        auto y = hn::Zero(f);
        auto z = hn::Zero(f);
        for (std::uint32_t b = 0; b < group.bones; ++b) {
          const float* m = bones + 12 * groupBones[group.firstBone + b];
          const LiftedPart::Terms& q = blockTerms[b];
          const auto qx = hn::Load(f, q.x.data() + lane);
          const auto qy = hn::Load(f, q.y.data() + lane);
          const auto qz = hn::Load(f, q.z.data() + lane);
          const auto qw = hn::Load(f, q.weight.data() + lane);
          // Fused where there is such an instruction: alike from AVX2 and NEON on, and within rounding elsewhere.
          const auto add = [&](auto sum, const float* r) HWY_ATTR {
            sum = hn::MulAdd(hn::Set(f, r[0]), qx, sum);
            sum = hn::MulAdd(hn::Set(f, r[1]), qy, sum);
            sum = hn::MulAdd(hn::Set(f, r[2]), qz, sum);
            return hn::MulAdd(hn::Set(f, r[3]), qw, sum);
          };
          x = add(x, m);
          y = add(y, m + 4);
          z = add(z, m + 8);
        }
        x = hn::Round(x);
        y = hn::Round(y);
        z = hn::Round(z);
        largest = hn::Max(largest, hn::Max(hn::Abs(x), hn::Max(hn::Abs(y), hn::Abs(z))));
        hn::StoreInterleaved4(x, y, z, hn::Zero(f), f, out + 4 * lane);
      }
      blockTerms += group.bones;
      out += 4 * kBlock;
    }
  }
  return hn::GetLane(hn::MaxOfLanes(f, largest));
}

}  // namespace lorica::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace lorica {
namespace {
HWY_EXPORT(evaluateGroups);
}  // namespace

float evaluateLifted(std::span<const LiftedPart::Group> groups, std::span<const std::uint32_t> groupBones,
                     const LiftedPart::Terms* terms, const float* bones, PointRow* rows) {
  return HWY_DYNAMIC_DISPATCH(evaluateGroups)(groups, groupBones, terms, bones, rows);
}

}  // namespace lorica
#endif

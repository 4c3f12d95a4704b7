#include "collision/lifted_kernel.h"

#include <array>
#include <limits>

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
  std::array<float, LiftedPart::Terms::kPoints> value;
  std::array<std::int32_t, LiftedPart::Terms::kPoints> at;
  hn::StoreU(best, f, value.data());
  hn::StoreU(which, n, at.data());
  float most = value[0];
  std::int32_t row = at[0];
  for (std::size_t lane = 1; lane < lanes; ++lane) {
    if (value[lane] < most || (value[lane] == most && at[lane] > row)) continue;
    most = value[lane];
    row = at[lane];
  }
  for (; i < rows.size(); ++i) {
    const float along = (direction.x() * rows[i].x + direction.y() * rows[i].y) + direction.z() * rows[i].z;
    if (!(along > most)) continue;
    most = along;
    row = static_cast<std::int32_t>(i);
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
                     const LiftedPart::Terms* terms, const float* bones, PointRow* rows) {
  return HWY_DYNAMIC_DISPATCH(evaluateGroups)(groups, groupBones, terms, bones, rows);
}

std::int32_t farthestRow(std::span<const PointRow> rows, const Vec3f& direction) {
  return HWY_DYNAMIC_DISPATCH(farthestOfRows)(rows, direction);
}

}  // namespace lorica
#endif

#include "collision/particles/neighbour_lists.h"

#include "geometry/result.h"
#include "geometry/threads.h"

#include <algorithm>
#include <array>

// Highway compiles the code between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/particles/neighbour_lists.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lorica::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Writes the numbers of the particles within the radius, in order. Not fused, so that every instruction set finds the
// same ones. `found` has space for one vector more than `max`. Of a run, which has a dozen particles at rest, the first
// kMaxLooked are looked at: of what a hostile scene presses together these are enough.
// @return how many; more than `max` means that there are too many
int findNear(const ParticleGrid::Run* runs, int runCount, const float* x, const float* y, const float* z,
             std::uint32_t self, float radiusSq, int max, std::uint32_t* found) {
  const hn::CappedTag<float, kParticleBlock> f;
  const hn::RebindToUnsigned<decltype(f)> u;
  const std::uint32_t lanes = hn::Lanes(f);
  const auto ownX = hn::Set(f, x[self]), ownY = hn::Set(f, y[self]), ownZ = hn::Set(f, z[self]);
  const auto limit = hn::Set(f, radiusSq);
  const auto own = hn::Set(u, self), lane = hn::Load(u, kLaneNumbers.data());
  std::size_t count = 0;
  for (int r = 0; r < runCount; ++r) {
    const std::uint32_t last = std::min(runs[r].last, runs[r].first + NeighbourLists::kMaxLooked);
    for (std::uint32_t j = runs[r].first; j < last; j += lanes) {
      const auto dx = hn::Sub(hn::LoadU(f, x + j), ownX);
      const auto dy = hn::Sub(hn::LoadU(f, y + j), ownY);
      const auto dz = hn::Sub(hn::LoadU(f, z + j), ownZ);
      const auto distanceSq = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
      const auto number = hn::Add(lane, hn::Set(u, j));
      const auto inRun = hn::And(hn::Lt(number, hn::Set(u, last)), hn::Ne(number, own));
      const auto near = hn::And(hn::RebindMask(u, hn::Lt(distanceSq, limit)), inRun);
      // Not a single compress-store: on some machines that takes a hundred cycles.
      hn::StoreU(hn::Compress(number, near), u, found + count);
      count += hn::CountTrue(u, near);
      if (count > static_cast<std::size_t>(max)) return max + 1;
    }
  }
  return count;
}

constexpr auto kRoom = static_cast<std::size_t>(NeighbourLists::kMaxNeighbours) + 1 + kParticleBlock;
using Found = std::array<std::array<std::uint32_t, kRoom>, kParticleBlock>;

// Stores lists side by side.
HWY_INLINE void transpose(const Found& found, std::size_t slots, std::uint32_t* out) {
  std::size_t slot = 0;
#if HWY_TARGET != HWY_SCALAR
  const hn::FixedTag<std::uint32_t, 4> u;
  const hn::RepartitionToWide<decltype(u)> pairs;
  for (; slot + 4 <= slots; slot += 4, out += 4 * kParticleBlock) {
    for (std::size_t lane = 0; lane < kParticleBlock; lane += 4) {
      const auto a = hn::LoadU(u, &found[lane][slot]), b = hn::LoadU(u, &found[lane + 1][slot]);
      const auto c = hn::LoadU(u, &found[lane + 2][slot]), d = hn::LoadU(u, &found[lane + 3][slot]);
      const auto ab01 = hn::BitCast(pairs, hn::InterleaveLower(u, a, b));
      const auto ab23 = hn::BitCast(pairs, hn::InterleaveUpper(u, a, b));
      const auto cd01 = hn::BitCast(pairs, hn::InterleaveLower(u, c, d));
      const auto cd23 = hn::BitCast(pairs, hn::InterleaveUpper(u, c, d));
      std::uint32_t* to = out + lane;
      hn::StoreU(hn::BitCast(u, hn::InterleaveLower(pairs, ab01, cd01)), u, to);
      hn::StoreU(hn::BitCast(u, hn::InterleaveUpper(pairs, ab01, cd01)), u, to + kParticleBlock);
      hn::StoreU(hn::BitCast(u, hn::InterleaveLower(pairs, ab23, cd23)), u, to + 2 * kParticleBlock);
      hn::StoreU(hn::BitCast(u, hn::InterleaveUpper(pairs, ab23, cd23)), u, to + 3 * kParticleBlock);
    }
  }
#endif
  for (; slot < slots; ++slot, out += kParticleBlock) {
    for (std::size_t lane = 0; lane < kParticleBlock; ++lane) out[lane] = found[lane][slot];
  }
}

void buildBlocks(const ParticleGrid& grid, const float* x, const float* y, const float* z, std::size_t count,
                 float radiusSq, const std::uint8_t* skipped, std::size_t firstBlock, std::size_t lastBlock,
                 int maxNeighbours, std::uint32_t* slots, std::size_t firstSlot, std::size_t* firstSlots,
                 std::uint8_t* slotCounts) {
  Found found;
  std::array<int, kParticleBlock> counts;
  ParticleGrid::Runs runs;
  for (std::size_t block = firstBlock; block < lastBlock; ++block) {
    int longest = 0, runCount = 0;
    bool runsKnown = false;
    for (std::size_t lane = 0; lane < kParticleBlock; ++lane) {
      const std::size_t i = block * kParticleBlock + lane;
      counts[lane] = 0;
      if (i >= count) continue;
      if (skipped != nullptr && skipped[i] != 0) {
        runsKnown = false;
        continue;
      }
      if (lane == 0 || !runsKnown || !grid.sameCellAsBefore(i)) runCount = grid.runsAround(i, runs);
      runsKnown = true;
      const int near = findNear(runs.data(), runCount, x, y, z, static_cast<std::uint32_t>(i), radiusSq, maxNeighbours,
                                found[lane].data());
      counts[lane] = std::min(near, maxNeighbours);
      longest = std::max(longest, counts[lane]);
    }
    slotCounts[block] = static_cast<std::uint8_t>(longest);
    for (std::size_t lane = 0; lane < kParticleBlock; ++lane) {
      std::uint32_t* own = found[lane].data();
      std::fill(own + counts[lane], own + longest, static_cast<std::uint32_t>(block * kParticleBlock + lane));
    }
    transpose(found, longest, slots + firstSlot);
    firstSlots[block] = firstSlot;
    firstSlot += longest * kParticleBlock;
  }
}

}  // namespace lorica::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace lorica {
namespace {
HWY_EXPORT(buildBlocks);
}  // namespace

NeighbourLists::NeighbourLists(std::size_t capacity, int maxNeighbours)
    : maxNeighbours_(maxNeighbours),
      slots_(paddedCount(capacity) * static_cast<std::size_t>(maxNeighbours)),
      firstSlots_(paddedCount(capacity) / kParticleBlock),
      slotCounts_(firstSlots_.size()) {
  LORICA_CHECK(maxNeighbours > 0 && maxNeighbours <= kMaxNeighbours, "maxNeighbours must be from 1 to kMaxNeighbours");
}

void NeighbourLists::build(const ParticleGrid& grid, const float* x, const float* y, const float* z, std::size_t count,
                           float radius, std::span<const std::uint8_t> skipped) {
  constexpr std::size_t kBlocksInChunk = 32;
  const std::size_t blocks = (count + kParticleBlock - 1) / kParticleBlock;
  const std::size_t chunks = (blocks + kBlocksInChunk - 1) / kBlocksInChunk;
  parallelFor(chunks, [&](std::size_t chunk) {
    const std::size_t first = chunk * kBlocksInChunk, last = std::min(blocks, first + kBlocksInChunk);
    HWY_DYNAMIC_DISPATCH(buildBlocks)
    (grid, x, y, z, count, radius * radius, skipped.empty() ? nullptr : skipped.data(), first, last, maxNeighbours_,
     slots_.data(), first * kParticleBlock * static_cast<std::size_t>(maxNeighbours_), firstSlots_.data(),
     slotCounts_.data());
  });
}

}  // namespace lorica
#endif

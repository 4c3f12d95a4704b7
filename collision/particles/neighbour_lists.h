#pragma once

#include "collision/particles/particle_grid.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Particles are processed in blocks, one per vector lane: each particle sums over its own neighbours in the order of
/// its list, so that vectors of any width give the same bits. A block may be several vectors on a machine with narrower
/// ones.
inline constexpr std::size_t kParticleBlock = 16;

/// Particles rounded up to whole blocks, plus enough that a vector may be read from any of them on.
[[nodiscard]] constexpr std::size_t paddedCount(std::size_t count) {
  return (count + kParticleBlock - 1) / kParticleBlock * kParticleBlock + kParticleBlock;
}

/// The numbers from 0 on. hn::Iota() of a variable stores each number and then waits for all.
alignas(64) inline constexpr std::array<std::uint32_t, kParticleBlock> kLaneNumbers = {0, 1, 2,  3,  4,  5,  6,  7,
                                                                                       8, 9, 10, 11, 12, 13, 14, 15};

/// For each particle of a grid, the other ones near it. A block's lists are stored side by side: slot s of all its
/// particles, then slot s + 1. A list that is shorter than its block's longest is padded with the particle itself.
class NeighbourLists {
 public:
  /// @param maxNeighbours  in a list, at most kMaxNeighbours; further ones are left out
  NeighbourLists(std::size_t capacity, int maxNeighbours);
  static constexpr int kMaxNeighbours = 96;
  /// Of cells above each other, so many particles are compared with one near them.
  static constexpr std::uint32_t kMaxLooked = 1024;

  /// Finds the neighbours. Runs on all threads and does not allocate.
  /// @param x, y, z   in the order of the grid, paddedCount() of them
  /// @param radius    at most the grid's cellSize [m]
  /// @param skipped   for each particle: nonzero ones get no list; empty: all are 0
  void build(const ParticleGrid& grid, const float* x, const float* y, const float* z, std::size_t count, float radius,
             std::span<const std::uint8_t> skipped);

  /// Slots of a block.
  [[nodiscard]] const std::uint32_t* slots(std::size_t block) const { return &slots_[firstSlots_[block]]; }
  [[nodiscard]] int slotCount(std::size_t block) const { return slotCounts_[block]; }

 private:
  int maxNeighbours_;
  // Blocks are built in chunks and stored contiguously in a chunk's memory, so that memory is read in order.
  std::vector<std::uint32_t> slots_;
  std::vector<std::size_t> firstSlots_;  // of each block
  std::vector<std::uint8_t> slotCounts_;
};

}  // namespace lorica

#pragma once

#include "collision/particles/particle_grid.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Particles are worked on in blocks, one to each vector lane: each particle sums over its own neighbours in the order
/// of its list, so that vectors of any width give the same bits. A vector of this many particles may be a narrower
/// machine's several.
inline constexpr std::size_t kParticleBlock = 16;

/// Particles in whole blocks, and so many more that a vector may be read from any of them on.
[[nodiscard]] constexpr std::size_t paddedCount(std::size_t count) {
  return (count + kParticleBlock - 1) / kParticleBlock * kParticleBlock + kParticleBlock;
}

/// For each particle of a grid, the other ones near it. A block's lists stand side by side: slot s of all its
/// particles, then slot s + 1. A list that is shorter than its block's longest is filled up with the particle itself.
class NeighbourLists {
 public:
  /// In a slot: the neighbour is marked.
  static constexpr std::uint32_t kMarked = 0x80000000u;

  /// @param mostNeighbours  in a list, at most kMostNeighbours; those that come later are left out
  NeighbourLists(std::size_t capacity, int mostNeighbours);
  static constexpr int kMostNeighbours = 96;

  /// Finds the neighbours. Runs on all threads and allocates nothing.
  /// @param x, y, z   sorted as the grid has them, paddedCount() of them
  /// @param radius    at most the grid's cellSize [m]
  /// @param skipped   for each particle, paddedCount(): those that are not 0 have no list, and are marked in others'
  void build(const ParticleGrid& grid, const float* x, const float* y, const float* z, std::size_t count, float radius,
             std::span<const std::uint8_t> skipped);

  /// Slots of a block.
  [[nodiscard]] const std::uint32_t* slots(std::size_t block) const { return &slots_[firstSlots_[block]]; }
  [[nodiscard]] int slotCount(std::size_t block) const { return slotCounts_[block]; }
  /// Lists that had no room for all neighbours, in the last build.
  [[nodiscard]] std::size_t overflows() const;

 private:
  int mostNeighbours_;
  // Blocks are built in chunks, and lie one after the other in a chunk's room: memory is read in its order.
  std::vector<std::uint32_t> slots_;
  std::vector<std::size_t> firstSlots_;  // of each block
  std::vector<std::uint8_t> slotCounts_;
  std::vector<std::uint8_t> overflows_;  // of each block
};

}  // namespace lorica

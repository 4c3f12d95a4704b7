#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Four numbers of a particle, which are loaded at once.
struct alignas(16) ParticleRow {
  float x = 0, y = 0, z = 0, w = 0;
};

/// Particles sorted by cell, so that neighbours lie together in memory.
///
/// Cells are squares of cellSize from above, and stand in columns along y, in rows of a whole share of that height. A
/// column has cells only from its lowest particle to its highest: few cells, however far a few particles fly. Sorted by
/// z, then x, then y of the cell, stable within a cell; so cells above each other are one run of particles. Same order
/// for any number of threads. Sorting allocates nothing.
class ParticleGrid {
 public:
  /// @param capacity  most particles
  explicit ParticleGrid(std::size_t capacity);

  /// @param places    finite, within a million cells of the origin [m]; w is not looked at
  /// @param cellSize  above 0 [m]
  /// @param rows      of cells in the height of cellSize: more make shorter runs, of fewer particles that are not near
  void sort(std::span<const ParticleRow> places, float cellSize, int rows = 1);

  /// The particle, of those that were sorted, which now stands at each place.
  [[nodiscard]] std::span<const std::uint32_t> order() const { return {order_.data(), count_}; }

  /// Sorted particles, from first to before last.
  struct Run {
    std::uint32_t first = 0, last = 0;
  };
  /// A superset of those within cellSize of a sorted particle: it may hold the particle itself.
  using Runs = std::array<Run, 9>;
  /// @param place  of a sorted particle
  /// @return how many runs were set; none is empty
  [[nodiscard]] int runsAround(std::size_t place, Runs& runs) const;
  /// Whether the runs around a sorted particle, not the first, are those around the one before.
  [[nodiscard]] bool sameCellAsBefore(std::size_t place) const {
    return columnOf_[place] == columnOf_[place - 1] && rowOf_[place] == rowOf_[place - 1];
  }

  /// Visits runs of sorted particles that together hold all in a box, and more.
  /// @param visit  called with the first particle and the one behind the last
  template <class Visit>
  void visitRuns(const std::array<float, 3>& least, const std::array<float, 3>& most, const Visit& visit) const {
    if (count_ == 0) return;
    const std::array<int, 3> from = cellAt(least), to = cellAt(most);
    for (int z = clampTo(from[2] - originZ_, columnsZ_); z <= clampTo(to[2] - originZ_, columnsZ_); ++z) {
      for (int x = clampTo(from[0] - originX_, columnsX_); x <= clampTo(to[0] - originX_, columnsX_); ++x) {
        const Run run = runOf(columns_[static_cast<std::size_t>(z * columnsX_ + x)], from[1], to[1]);
        if (run.first != run.last) visit(run.first, run.last);
      }
    }
  }

 private:
  static constexpr int kMostColumns = 512;              // along x and along z; the outer ones hold what is farther out
  static constexpr int kChunks = 16;                    // of particles, for threads; fixed, so that their count is not
  static constexpr std::size_t kCellsPerParticle = 10;  // most, and one to end each column
  struct Column {
    std::int32_t firstY = 0;
    std::int32_t cells = 0;
    std::uint32_t firstCell = 0;
  };
  [[nodiscard]] static int clampTo(int value, int count) { return value < 0 ? 0 : value < count ? value : count - 1; }
  [[nodiscard]] std::array<int, 3> cellAt(const std::array<float, 3>& place) const;
  /// What a column holds from one row of cells to another.
  [[nodiscard]] Run runOf(const Column& column, int fromY, int toY) const {
    if (column.cells == 0 || toY < column.firstY) return {};
    const auto from = static_cast<std::uint32_t>(clampTo(fromY - column.firstY, column.cells));
    const auto to = static_cast<std::uint32_t>(clampTo(toY - column.firstY, column.cells));
    return {cellFirst_[column.firstCell + from], cellFirst_[column.firstCell + to + 1]};
  }
  void placeWindow(const ParticleRow* places);
  void sortSlab(int slab, const ParticleRow* places);

  std::size_t count_ = 0;
  float perCell_ = 1.0f, perRow_ = 1.0f;
  int rows_ = 1;
  int originX_ = 0, originZ_ = 0, columnsX_ = 0, columnsZ_ = 0;
  std::vector<std::uint32_t> order_, slabOrder_;
  std::vector<std::uint16_t> slabOf_;
  std::vector<std::int32_t> columnInSlab_, yOf_;  // in the order of the slabs
  std::vector<std::uint32_t> columnOf_;           // sorted
  std::vector<std::int32_t> rowOf_;               // sorted: of the cell, or above the column's last one
  std::vector<Column> columns_;
  std::vector<std::uint32_t> cellFirst_;    // sorted particle that begins each cell
  std::vector<std::uint32_t> slabFirst_;    // and the end
  std::vector<std::uint32_t> chunkSlabs_;   // chunk by slab: counts, then where the chunk's particles go
  std::vector<std::uint32_t> columnCount_;  // scratch, by column
  std::vector<std::int32_t> columnLow_, columnHigh_;
};

}  // namespace lorica

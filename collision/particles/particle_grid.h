#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Four numbers of a particle, loaded at once.
struct alignas(16) ParticleRow {
  float x = 0, y = 0, z = 0, w = 0;
};

/// Particles sorted by cell, so that neighbours are close together in memory.
///
/// Seen from above, cells are squares of side cellSize, arranged in columns along y. Their height is cellSize divided
/// by the number of rows. A column has cells only from its lowest particle to its highest, so there are few cells
/// however far single particles fly. Sorted by z, then x, then y of the cell, stable within a cell; so cells above each
/// other are one run of particles. Same order for any number of threads. Sorting does not allocate.
class ParticleGrid {
 public:
  /// @param capacity  max number of particles
  explicit ParticleGrid(std::size_t capacity);

  /// @param positions  finite, within a million cells of the origin [m]; w is ignored
  /// @param cellSize   above 0 [m]
  /// @param rows       cells per cellSize in height: more rows make shorter runs, with fewer particles that are not
  /// near
  void sort(std::span<const ParticleRow> positions, float cellSize, int rows = 1);

  /// For each sorted position, the index of the particle before sorting.
  [[nodiscard]] std::span<const std::uint32_t> order() const { return {order_.data(), count_}; }

  /// A range of sorted particles; `last` is one past the end.
  struct Run {
    std::uint32_t first = 0, last = 0;
  };
  /// A superset of the particles within cellSize of a sorted particle; may contain the particle itself.
  using Runs = std::array<Run, 9>;
  /// @param position  of a sorted particle
  /// @return how many runs were set; none is empty
  [[nodiscard]] int runsAround(std::size_t position, Runs& runs) const;
  /// Whether the runs around a sorted particle, other than the first, equal those around the previous one.
  [[nodiscard]] bool sameCellAsBefore(std::size_t position) const {
    return columnOf_[position] == columnOf_[position - 1] && rowOf_[position] == rowOf_[position - 1];
  }

  /// Visits runs of sorted particles that together contain all particles in a box, and possibly more.
  /// @param visit  called with the first particle and one past the last
  template <class Visit>
  void visitRuns(const std::array<float, 3>& min, const std::array<float, 3>& max, const Visit& visit) const {
    if (count_ == 0) return;
    const std::array<int, 3> from = cellAt(min), to = cellAt(max);
    for (int z = clampTo(from[2] - originZ_, columnsZ_); z <= clampTo(to[2] - originZ_, columnsZ_); ++z) {
      for (int x = clampTo(from[0] - originX_, columnsX_); x <= clampTo(to[0] - originX_, columnsX_); ++x) {
        const Run run = runOf(columns_[z * columnsX_ + x], from[1], to[1]);
        if (run.first != run.last) visit(run.first, run.last);
      }
    }
  }

 private:
  static constexpr int kMaxColumns = 512;  // along x and along z; the outer ones contain everything farther out
  static constexpr int kChunks = 16;       // of particles, however many threads there are: the result is the same
  static constexpr std::size_t kCellsPerParticle = 10;  // max, including one that ends each column
  struct Column {
    std::int32_t firstY = 0;
    std::int32_t cells = 0;
    std::uint32_t firstCell = 0;
  };
  [[nodiscard]] static int clampTo(int value, int count) { return value < 0 ? 0 : value < count ? value : count - 1; }
  [[nodiscard]] std::array<int, 3> cellAt(const std::array<float, 3>& position) const;
  /// The particles of a column in a range of cell rows.
  [[nodiscard]] Run runOf(const Column& column, int fromY, int toY) const {
    if (column.cells == 0 || toY < column.firstY) return {};
    const std::uint32_t from = clampTo(fromY - column.firstY, column.cells);
    const std::uint32_t to = clampTo(toY - column.firstY, column.cells);
    return {cellFirst_[column.firstCell + from], cellFirst_[column.firstCell + to + 1]};
  }
  void placeWindow(const ParticleRow* positions);
  void sortSlab(int slab, const ParticleRow* positions);

  std::size_t count_ = 0;
  float perCell_ = 1.0f, perRow_ = 1.0f;
  int rows_ = 1;
  int originX_ = 0, originZ_ = 0, columnsX_ = 0, columnsZ_ = 0;
  std::vector<std::uint32_t> order_, slabOrder_;
  std::vector<std::uint16_t> slabOf_;
  std::vector<std::int32_t> columnInSlab_, yOf_;  // in the order of the slabs
  std::vector<std::uint32_t> columnOf_;           // sorted
  std::vector<std::int32_t> rowOf_;               // sorted: row of the cell, or above the column's last one
  std::vector<Column> columns_;
  std::vector<std::uint32_t> cellFirst_;    // first sorted particle of each cell
  std::vector<std::uint32_t> slabFirst_;    // and the end
  std::vector<std::uint32_t> chunkSlabs_;   // chunk by slab: counts, then start positions of the chunk's particles
  std::vector<std::uint32_t> columnCount_;  // scratch, by column
  std::vector<std::int32_t> columnLow_, columnHigh_;
};

}  // namespace lorica

#include "collision/particles/particle_grid.h"

#include "geometry/result.h"
#include "geometry/threads.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lorica {
namespace {

// std::floor is a function call if the compiler may not use newer instructions.
inline int cellIndex(float position, float perCell) {
  const float scaled = position * perCell;
  const int whole = scaled;
  return whole > scaled ? whole - 1 : whole;
}

}  // namespace

ParticleGrid::ParticleGrid(std::size_t capacity)
    : order_(capacity),
      slabOrder_(capacity),
      slabOf_(capacity),
      columnInSlab_(capacity),
      yOf_(capacity),
      columnOf_(capacity),
      rowOf_(capacity),
      columns_(static_cast<std::size_t>(kMaxColumns) * kMaxColumns),
      cellFirst_(kCellsPerParticle * capacity),
      slabFirst_(kMaxColumns + 1),
      chunkSlabs_(static_cast<std::size_t>(kChunks) * kMaxColumns),
      columnCount_(columns_.size()),
      columnLow_(columns_.size()),
      columnHigh_(columns_.size()) {}

std::array<int, 3> ParticleGrid::cellAt(const std::array<float, 3>& position) const {
  return {cellIndex(position[0], perCell_), cellIndex(position[1], perRow_), cellIndex(position[2], perCell_)};
}

// Covers the particles; if they extend over more than the maximum number of columns, the window is centred at their
// mean.
void ParticleGrid::placeWindow(const ParticleRow* positions) {
  struct Sums {
    float minX = std::numeric_limits<float>::infinity(), maxX = -minX;
    float minZ = minX, maxZ = -minX;
    std::int64_t x = 0, z = 0;  // in cells: integers, so that the sum does not depend on the order
  };
  std::array<Sums, kChunks> chunks;
  parallelFor(kChunks, [&](int chunk) {
    Sums sums;
    const std::size_t end = count_ * (chunk + 1) / kChunks;
    for (std::size_t i = count_ * chunk / kChunks; i < end; ++i) {
      sums.minX = std::min(sums.minX, positions[i].x);
      sums.maxX = std::max(sums.maxX, positions[i].x);
      sums.minZ = std::min(sums.minZ, positions[i].z);
      sums.maxZ = std::max(sums.maxZ, positions[i].z);
      sums.x += cellIndex(positions[i].x, perCell_);
      sums.z += cellIndex(positions[i].z, perCell_);
    }
    chunks[chunk] = sums;
  });
  Sums all;
  for (const Sums& sums : chunks) {
    all.minX = std::min(all.minX, sums.minX);
    all.maxX = std::max(all.maxX, sums.maxX);
    all.minZ = std::min(all.minZ, sums.minZ);
    all.maxZ = std::max(all.maxZ, sums.maxZ);
    all.x += sums.x;
    all.z += sums.z;
  }
  const auto window = [&](float min, float max, std::int64_t sum, int& origin, int& columns) {
    origin = cellIndex(min, perCell_);
    columns = cellIndex(max, perCell_) - origin + 1;
    if (columns <= kMaxColumns) return;
    const int last = origin + columns - kMaxColumns;
    const int mean = sum / static_cast<std::int64_t>(count_);
    origin = std::clamp(mean - kMaxColumns / 2, origin, last);
    columns = kMaxColumns;
  };
  window(all.minX, all.maxX, all.x, originX_, columnsX_);
  window(all.minZ, all.maxZ, all.z, originZ_, columnsZ_);
}

void ParticleGrid::sort(std::span<const ParticleRow> positions, float cellSize, int rows) {
  const std::size_t count = positions.size();
  LORICA_CHECK(count <= order_.size() && cellSize > 0.0f && rows > 0,
               "sort() needs at most `capacity` particles, and cell size and rows above 0");
  count_ = count;
  perCell_ = 1.0f / cellSize;
  perRow_ = perCell_ * rows;
  rows_ = rows;
  if (count == 0) return;
  placeWindow(positions.data());

  // By slab, a row of columns along x: counts of each chunk, their start positions, and the particles' numbers.
  parallelFor(kChunks, [&](int chunk) {
    std::uint32_t* slabs = &chunkSlabs_[static_cast<std::size_t>(chunk) * kMaxColumns];
    std::fill_n(slabs, columnsZ_, 0u);
    const std::size_t end = count * (chunk + 1) / kChunks;
    for (std::size_t i = count * chunk / kChunks; i < end; ++i) {
      const int slab = clampTo(cellIndex(positions[i].z, perCell_) - originZ_, columnsZ_);
      slabOf_[i] = slab;
      ++slabs[slab];
    }
  });
  std::uint32_t sum = 0;
  for (int slab = 0; slab < columnsZ_; ++slab) {
    slabFirst_[slab] = sum;
    for (int chunk = 0; chunk < kChunks; ++chunk) {
      std::uint32_t& begin = chunkSlabs_[chunk * kMaxColumns + slab];
      const std::uint32_t own = begin;
      begin = sum;
      sum += own;
    }
  }
  slabFirst_[columnsZ_] = sum;
  parallelFor(kChunks, [&](int chunk) {
    std::uint32_t* next = &chunkSlabs_[static_cast<std::size_t>(chunk) * kMaxColumns];
    const std::size_t end = count * (chunk + 1) / kChunks;
    for (std::size_t i = count * chunk / kChunks; i < end; ++i) {
      slabOrder_[next[slabOf_[i]]++] = static_cast<std::uint32_t>(i);
    }
  });
  parallelFor(columnsZ_, [&](int slab) { sortSlab(slab, positions.data()); });
}

void ParticleGrid::sortSlab(int slab, const ParticleRow* positions) {
  const std::uint32_t begin = slabFirst_[slab];
  const std::uint32_t end = slabFirst_[slab + 1];
  const std::size_t firstColumn = static_cast<std::size_t>(slab) * columnsX_;
  const std::size_t columnCount = columnsX_;
  Column* columns = &columns_[firstColumn];
  std::uint32_t* counts = &columnCount_[firstColumn];
  std::int32_t* low = &columnLow_[firstColumn];
  std::int32_t* high = &columnHigh_[firstColumn];
  std::fill_n(counts, columnCount, 0u);
  for (std::uint32_t k = begin; k < end; ++k) {
    const std::uint32_t i = slabOrder_[k];
    const int column = clampTo(cellIndex(positions[i].x, perCell_) - originX_, columnsX_);
    const int cell = cellIndex(positions[i].y, perRow_);
    columnInSlab_[k] = column;
    yOf_[k] = cell;
    if (counts[column]++ == 0) {
      low[column] = high[column] = cell;
    } else {
      low[column] = std::min(low[column], cell);
      high[column] = std::max(high[column], cell);
    }
  }
  // The cells of the columns, one after the other. The number of cells is limited by the number of particles, however
  // high the highest particle is: the top cell contains everything above.
  std::uint32_t cell = kCellsPerParticle * begin;
  for (std::size_t c = 0; c < columnCount; ++c) {
    Column& column = columns[c];
    column.cells = 0;
    if (counts[c] == 0) continue;
    column.firstY = low[c];
    column.cells = std::min(high[c] - low[c] + 1, 8 * static_cast<std::int32_t>(counts[c]));
    column.firstCell = cell;
    std::fill_n(&cellFirst_[cell], column.cells + 1, 0u);
    cell += column.cells + 1;
  }
  for (std::uint32_t k = begin; k < end; ++k) {
    const Column& column = columns[columnInSlab_[k]];
    const int inColumn = clampTo(yOf_[k] - column.firstY, column.cells);
    ++cellFirst_[column.firstCell + inColumn];
  }
  const std::uint32_t firstCell = kCellsPerParticle * begin;
  std::uint32_t sum = begin;
  for (std::uint32_t c = firstCell; c < cell; ++c) {  // the end of a column is empty: the next column starts there
    const std::uint32_t own = cellFirst_[c];
    cellFirst_[c] = sum;
    sum += own;
  }
  for (std::uint32_t k = begin; k < end; ++k) {
    const std::size_t inSlab = columnInSlab_[k];
    const Column& column = columns[inSlab];
    const std::uint32_t own = column.firstCell + clampTo(yOf_[k] - column.firstY, column.cells);
    const std::uint32_t position = cellFirst_[own]++;
    order_[position] = slabOrder_[k];
    rowOf_[position] = yOf_[k];
    columnOf_[position] = firstColumn + inSlab;
  }
  // Each start has advanced to its end, which is the start of the next one.
  for (std::uint32_t c = cell; c-- > firstCell + 1;) cellFirst_[c] = cellFirst_[c - 1];
  if (cell > firstCell) cellFirst_[firstCell] = begin;
}

int ParticleGrid::runsAround(std::size_t position, Runs& runs) const {
  const int column = columnOf_[position];
  const int z = column / columnsX_, x = column % columnsX_;
  const int y = rowOf_[position];
  const int firstX = std::max(x - 1, 0), lastX = std::min(x + 1, columnsX_ - 1);
  const int firstZ = std::max(z - 1, 0), lastZ = std::min(z + 1, columnsZ_ - 1);
  int count = 0;
  for (int nearZ = firstZ; nearZ <= lastZ; ++nearZ) {
    for (int nearX = firstX; nearX <= lastX; ++nearX) {
      const Run run = runOf(columns_[nearZ * columnsX_ + nearX], y - rows_, y + rows_);
      if (run.first == run.last) continue;
      runs[count++] = run;
    }
  }
  return count;
}

}  // namespace lorica

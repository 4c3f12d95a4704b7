#include "collision/particles/particle_grid.h"

#include "geometry/result.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lorica {
namespace {

// std::floor is a call where the compiler may not use newer instructions.
inline int cellIndex(float place, float perCell) {
  const float scaled = place * perCell;
  const auto whole = static_cast<int>(scaled);
  return static_cast<float>(whole) > scaled ? whole - 1 : whole;
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
      columns_(static_cast<std::size_t>(kMostColumns) * kMostColumns),
      cellFirst_(kCellsPerParticle * capacity),
      slabFirst_(kMostColumns + 1),
      chunkSlabs_(static_cast<std::size_t>(kChunks) * kMostColumns),
      columnCount_(columns_.size()),
      columnLow_(columns_.size()),
      columnHigh_(columns_.size()) {}

std::array<int, 3> ParticleGrid::cellAt(const std::array<float, 3>& place) const {
  return {cellIndex(place[0], perCell_), cellIndex(place[1], perRow_), cellIndex(place[2], perCell_)};
}

// Where the particles are; where they are farther apart than there are columns, around their mean.
void ParticleGrid::placeWindow(const ParticleRow* places) {
  struct Sums {
    float leastX = std::numeric_limits<float>::infinity(), mostX = -leastX;
    float leastZ = leastX, mostZ = -leastX;
    std::int64_t x = 0, z = 0;  // in cells: whole, so that their sum has no order
  };
  std::array<Sums, kChunks> chunks;
  tbb::parallel_for(0, kChunks, [&](int chunk) {
    Sums sums;
    const std::size_t end = count_ * static_cast<std::size_t>(chunk + 1) / kChunks;
    for (std::size_t i = count_ * static_cast<std::size_t>(chunk) / kChunks; i < end; ++i) {
      sums.leastX = std::min(sums.leastX, places[i].x);
      sums.mostX = std::max(sums.mostX, places[i].x);
      sums.leastZ = std::min(sums.leastZ, places[i].z);
      sums.mostZ = std::max(sums.mostZ, places[i].z);
      sums.x += cellIndex(places[i].x, perCell_);
      sums.z += cellIndex(places[i].z, perCell_);
    }
    chunks[static_cast<std::size_t>(chunk)] = sums;
  });
  Sums all;
  for (const Sums& sums : chunks) {
    all.leastX = std::min(all.leastX, sums.leastX);
    all.mostX = std::max(all.mostX, sums.mostX);
    all.leastZ = std::min(all.leastZ, sums.leastZ);
    all.mostZ = std::max(all.mostZ, sums.mostZ);
    all.x += sums.x;
    all.z += sums.z;
  }
  const auto window = [&](float least, float most, std::int64_t sum, int& origin, int& columns) {
    origin = cellIndex(least, perCell_);
    columns = cellIndex(most, perCell_) - origin + 1;
    if (columns <= kMostColumns) return;
    const int last = origin + columns - kMostColumns;
    const int mean = static_cast<int>(sum / static_cast<std::int64_t>(count_));
    origin = std::clamp(mean - kMostColumns / 2, origin, last);
    columns = kMostColumns;
  };
  window(all.leastX, all.mostX, all.x, originX_, columnsX_);
  window(all.leastZ, all.mostZ, all.z, originZ_, columnsZ_);
}

void ParticleGrid::sort(std::span<const ParticleRow> places, float cellSize, int rows) {
  const std::size_t count = places.size();
  CHECK(count <= order_.size() && cellSize > 0.0f && rows > 0,
        "a grid has room for as many particles as it was made for");
  count_ = count;
  perCell_ = 1.0f / cellSize;
  perRow_ = perCell_ * static_cast<float>(rows);
  rows_ = rows;
  if (count == 0) return;
  placeWindow(places.data());

  // By slab, a row of columns along x: counts of each chunk, where they begin, and the particles' numbers.
  tbb::parallel_for(0, kChunks, [&](int chunk) {
    std::uint32_t* slabs = &chunkSlabs_[static_cast<std::size_t>(chunk) * kMostColumns];
    std::fill_n(slabs, columnsZ_, 0u);
    const std::size_t end = count * static_cast<std::size_t>(chunk + 1) / kChunks;
    for (std::size_t i = count * static_cast<std::size_t>(chunk) / kChunks; i < end; ++i) {
      const int slab = clampTo(cellIndex(places[i].z, perCell_) - originZ_, columnsZ_);
      slabOf_[i] = static_cast<std::uint16_t>(slab);
      ++slabs[slab];
    }
  });
  std::uint32_t sum = 0;
  for (int slab = 0; slab < columnsZ_; ++slab) {
    slabFirst_[static_cast<std::size_t>(slab)] = sum;
    for (int chunk = 0; chunk < kChunks; ++chunk) {
      std::uint32_t& begin = chunkSlabs_[static_cast<std::size_t>(chunk * kMostColumns + slab)];
      const std::uint32_t own = begin;
      begin = sum;
      sum += own;
    }
  }
  slabFirst_[static_cast<std::size_t>(columnsZ_)] = sum;
  tbb::parallel_for(0, kChunks, [&](int chunk) {
    std::uint32_t* next = &chunkSlabs_[static_cast<std::size_t>(chunk) * kMostColumns];
    const std::size_t end = count * static_cast<std::size_t>(chunk + 1) / kChunks;
    for (std::size_t i = count * static_cast<std::size_t>(chunk) / kChunks; i < end; ++i) {
      slabOrder_[next[slabOf_[i]]++] = static_cast<std::uint32_t>(i);
    }
  });
  tbb::parallel_for(0, columnsZ_, [&](int slab) { sortSlab(slab, places.data()); });
}

void ParticleGrid::sortSlab(int slab, const ParticleRow* places) {
  const std::uint32_t begin = slabFirst_[static_cast<std::size_t>(slab)];
  const std::uint32_t end = slabFirst_[static_cast<std::size_t>(slab) + 1];
  const std::size_t firstColumn = static_cast<std::size_t>(slab) * static_cast<std::size_t>(columnsX_);
  const auto columnCount = static_cast<std::size_t>(columnsX_);
  Column* columns = &columns_[firstColumn];
  std::uint32_t* counts = &columnCount_[firstColumn];
  std::int32_t* low = &columnLow_[firstColumn];
  std::int32_t* high = &columnHigh_[firstColumn];
  std::fill_n(counts, columnCount, 0u);
  for (std::uint32_t k = begin; k < end; ++k) {
    const std::uint32_t i = slabOrder_[k];
    const int column = clampTo(cellIndex(places[i].x, perCell_) - originX_, columnsX_);
    const int cell = cellIndex(places[i].y, perRow_);
    columnInSlab_[k] = column;
    yOf_[k] = cell;
    if (counts[column]++ == 0) {
      low[column] = high[column] = cell;
    } else {
      low[column] = std::min(low[column], cell);
      high[column] = std::max(high[column], cell);
    }
  }
  // The cells of the columns, one after the other. However high the highest particle, they are not many more than there
  // are particles: the top cell holds what is farther up.
  auto cell = static_cast<std::uint32_t>(kCellsPerParticle * begin);
  for (std::size_t c = 0; c < columnCount; ++c) {
    Column& column = columns[c];
    column.cells = 0;
    if (counts[c] == 0) continue;
    column.firstY = low[c];
    column.cells = std::min(high[c] - low[c] + 1, 8 * static_cast<std::int32_t>(counts[c]));
    column.firstCell = cell;
    std::fill_n(&cellFirst_[cell], column.cells + 1, 0u);
    cell += static_cast<std::uint32_t>(column.cells) + 1;
  }
  for (std::uint32_t k = begin; k < end; ++k) {
    const Column& column = columns[columnInSlab_[k]];
    const int inColumn = clampTo(yOf_[k] - column.firstY, column.cells);
    ++cellFirst_[column.firstCell + static_cast<std::uint32_t>(inColumn)];
  }
  const auto firstCell = static_cast<std::uint32_t>(kCellsPerParticle * begin);
  std::uint32_t sum = begin;
  for (std::uint32_t c = firstCell; c < cell; ++c) {  // the end of a column holds none: it is where the next begins
    const std::uint32_t own = cellFirst_[c];
    cellFirst_[c] = sum;
    sum += own;
  }
  for (std::uint32_t k = begin; k < end; ++k) {
    const auto inSlab = static_cast<std::size_t>(columnInSlab_[k]);
    const Column& column = columns[inSlab];
    const std::uint32_t own =
        column.firstCell + static_cast<std::uint32_t>(clampTo(yOf_[k] - column.firstY, column.cells));
    const std::uint32_t place = cellFirst_[own]++;
    order_[place] = slabOrder_[k];
    rowOf_[place] = yOf_[k];
    columnOf_[place] = static_cast<std::uint32_t>(firstColumn + inSlab);
  }
  // Each beginning has moved on to its end, which is the next one's beginning.
  for (std::uint32_t c = cell; c-- > firstCell + 1;) cellFirst_[c] = cellFirst_[c - 1];
  if (cell > firstCell) cellFirst_[firstCell] = begin;
}

int ParticleGrid::runsAround(std::size_t place, Runs& runs) const {
  const auto column = static_cast<int>(columnOf_[place]);
  const int z = column / columnsX_, x = column % columnsX_;
  const int y = rowOf_[place];
  const int firstX = std::max(x - 1, 0), lastX = std::min(x + 1, columnsX_ - 1);
  const int firstZ = std::max(z - 1, 0), lastZ = std::min(z + 1, columnsZ_ - 1);
  int count = 0;
  for (int nearZ = firstZ; nearZ <= lastZ; ++nearZ) {
    for (int nearX = firstX; nearX <= lastX; ++nearX) {
      const Run run = runOf(columns_[static_cast<std::size_t>(nearZ * columnsX_ + nearX)], y - rows_, y + rows_);
      if (run.first == run.last) continue;
      runs[static_cast<std::size_t>(count++)] = run;
    }
  }
  return count;
}

}  // namespace lorica

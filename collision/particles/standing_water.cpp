#include "collision/particles/standing_water.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

constexpr float kDrops = 3.0f;       // along the edge of a cell
constexpr float kFull = 0.7f;        // share of its drops with which a cell counts as water
constexpr float kWaterApart = 1.0f;  // from a solid, in cells: nearer, nothing is held ...
constexpr float kBlend = 6.0f;       // ... and so many cells farther, all
constexpr float kFar = 900.0f;       // a wall out there is none [m]
constexpr float kMostCells = 1e9f;   // from the origin: what is farther counts as there, so that it is a whole number
constexpr int kMaxIterations = 60;   // of the solver
constexpr double kPrecision = 1e-3;  // of the solver's error

// Of the incomplete Cholesky factor: a pivot that gets smaller than this share is replaced.
constexpr float kSafe = 0.25f;

}  // namespace

StandingWater::StandingWater(std::size_t capacity, float spacing, const Vec3f& min, const Vec3f& max)
    : full_(1.0f), origin_(Vec3f::Zero()) {
  std::size_t slots = 16;
  while (slots < 2 * capacity) slots *= 2;
  table_.resize(slots, kNone);
  cells_.reserve(capacity);
  cellOf_.resize(capacity);
  rowOf_.resize(capacity);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool low = min[axis] > -kFar, high = max[axis] < kFar;
    size_[axis] = kDrops * spacing;
    int between = 1 << 30;
    if (low && high) {  // whole cells between two walls
      const float wide = std::max(spacing, max[axis] - min[axis]);
      between = std::max(1, static_cast<int>(std::lround(wide / size_[axis])));
      size_[axis] = wide / static_cast<float>(between);
    }
    perSize_[axis] = 1.0f / size_[axis];
    weight_[axis] = perSize_[axis] * perSize_[axis];
    full_ *= size_[axis] / spacing;
    if (low) origin_[axis] = min[axis];
    first_[axis] = low ? 0 : -(1 << 30);
    last_[axis] = between - 1;
  }
  rows_.reserve(static_cast<std::size_t>(static_cast<float>(capacity) / std::max(1.0f, kFull * full_)) + 1);
}

StandingWater::Place StandingWater::cellAt(const ParticleRow& p) const {
  const Vec3f exact = (Vec3f(p.x, p.y, p.z) - origin_).cwiseProduct(perSize_);
  const Vec3f scaled = exact.cwiseMax(-kMostCells).cwiseMin(kMostCells);
  Place at;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int whole = scaled[axis];
    at[axis] = std::clamp(static_cast<float>(whole) > scaled[axis] ? whole - 1 : whole, first_[axis], last_[axis]);
  }
  return at;
}

std::uint32_t& StandingWater::slotOf(const Place& at) {
  std::uint32_t hash = static_cast<std::uint32_t>(at[0]) * 73856093u ^ static_cast<std::uint32_t>(at[1]) * 19349663u ^
                       static_cast<std::uint32_t>(at[2]) * 83492791u;
  hash ^= hash >> 15u;
  for (std::size_t slot = hash & (table_.size() - 1);; slot = (slot + 1) & (table_.size() - 1)) {
    if (table_[slot] == kNone || cells_[table_[slot]].at == at) return table_[slot];
  }
}

void StandingWater::find(std::span<const ParticleRow> positions, const Vec3f& gravity, std::span<const Solid> solids) {
  std::fill(table_.begin(), table_.end(), kNone);
  cells_.clear();
  std::uint32_t last = kNone;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Place at = cellAt(positions[i]);
    if (last == kNone || cells_[last].at != at) {  // drops that follow each other are near each other
      std::uint32_t& slot = slotOf(at);
      if (slot == kNone) {
        slot = static_cast<std::uint32_t>(cells_.size());
        cells_.push_back({at});
      }
      last = slot;
    }
    ++cells_[last].drops;
    cellOf_[i] = last;
  }
  makeRows(gravity);
  solve();
  Eigen::Index up = 0;
  gravity.cwiseAbs().maxCoeff(&up);
  findShares(solids, up);
  const auto pressureOf = [&](std::uint32_t row) {
    return row != kNone ? rows_[row].share * rows_[row].pressure : 0.0f;
  };
  for (std::uint32_t r = 0; r < rows_.size(); ++r) {
    const Row& row = rows_[r];
    Cell& cell = cells_[row.cell];
    const float own = pressureOf(r);
    cell.share = row.share;
    for (std::size_t c = 0; c < 3; ++c) {
      const float wall = -row.share * gravity[c];
      cell.low[c] = row.wallBefore[c] ? wall : (pressureOf(row.before[c]) - own) * perSize_[c];
      cell.high[c] = row.wallAfter[c] ? wall : (own - pressureOf(row.after[c])) * perSize_[c];
    }
  }
}

// The pressures hold up less and less towards solids: beside a body, the pressures of the drops themselves are needed.
void StandingWater::findShares(std::span<const Solid> solids, Eigen::Index up) {
  Vec3f min = Vec3f::Constant(1e9f), max = -min;
  for (Row& row : rows_) {
    const Vec3f middle = middleOf(row);
    min = min.cwiseMin(middle);
    max = max.cwiseMax(middle);
    row.share = 1.0f;
  }
  const Vec3f far = (kWaterApart + kBlend) * size_;
  for (const Solid& solid : solids) {
    Vec3f reach = far;
    reach[up] = size_[up];
    if (((solid.min - reach).array() > max.array()).any() || ((solid.max + reach).array() < min.array()).any())
      continue;
    for (Row& row : rows_) {
      const Vec3f middle = middleOf(row);
      Vec3f away = (solid.min - middle).cwiseMax(middle - solid.max).cwiseMax(0.0f).cwiseProduct(perSize_);
      away[up] = 0.0f;
      row.share = std::min(row.share, std::max(0.0f, (away.maxCoeff() - kWaterApart) * (1.0f / kBlend)));
    }
  }
}

Vec3f StandingWater::middleOf(const Row& row) const {
  const Place& at = cells_[row.cell].at;
  const Vec3f place(static_cast<float>(at[0]), static_cast<float>(at[1]), static_cast<float>(at[2]));
  return origin_ + size_.cwiseProduct(place + Vec3f::Constant(0.5f));
}

bool StandingWater::isWall(Place at, std::size_t axis, int step) const {
  at[axis] += step;
  return at[axis] < first_[axis] || at[axis] > last_[axis];
}

void StandingWater::makeRows(const Vec3f& gravity) {
  rows_.clear();
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    rowOf_[c] = kNone;
    if (static_cast<float>(cells_[c].drops) < kFull * full_) continue;
    rowOf_[c] = static_cast<std::uint32_t>(rows_.size());
    rows_.push_back({});
    rows_.back().cell = static_cast<std::uint32_t>(c);
  }
  for (Row& row : rows_) {
    const Place at = cells_[row.cell].at;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const int step : {-1, 1}) {
        Place beside = at;
        beside[axis] += step;
        const bool wall = isWall(at, axis, step);
        std::uint32_t other = kNone;
        if (wall) {
          row.right -= static_cast<float>(step) * -gravity[axis] * perSize_[axis];
        } else {
          row.diagonal += weight_[axis];
          if (const std::uint32_t cell = slotOf(beside); cell != kNone) other = rowOf_[cell];
        }
        (step < 0 ? row.before : row.after)[axis] = other;
        (step < 0 ? row.wallBefore : row.wallAfter)[axis] = wall;
      }
    }
  }
}

void StandingWater::solve() {
  for (std::uint32_t r = 0; r < rows_.size(); ++r) {
    Row& row = rows_[r];
    float e = row.diagonal;
    for (std::size_t c = 0; c < 3; ++c) {
      for (const std::uint32_t o : {row.before[c], row.after[c]}) {
        if (o == kNone || o >= r) continue;
        const float f = weight_[c] * rows_[o].factor;
        e -= f * f;
      }
    }
    row.factor = 1.0f / std::sqrt(e < kSafe * row.diagonal ? row.diagonal : e);
  }
  const auto dot = [&](float Row::*a, float Row::*b) {
    double sum = 0.0;
    for (const Row& row : rows_) sum += static_cast<double>(row.*a) * row.*b;
    return sum;
  };
  const double wanted = kPrecision * kPrecision * dot(&Row::right, &Row::right);
  precondition();
  for (Row& row : rows_) row.search = row.solved;
  double sigma = dot(&Row::solved, &Row::right);
  for (int iteration = 0; iteration < kMaxIterations && dot(&Row::right, &Row::right) > wanted; ++iteration) {
    double along = 0.0;
    for (Row& row : rows_) {
      float sum = row.diagonal * row.search;
      for (std::size_t c = 0; c < 3; ++c) {
        if (row.before[c] != kNone) sum -= weight_[c] * rows_[row.before[c]].search;
        if (row.after[c] != kNone) sum -= weight_[c] * rows_[row.after[c]].search;
      }
      row.image = sum;
      along += static_cast<double>(row.search) * sum;
    }
    if (!(along > 0.0)) break;
    const auto alpha = static_cast<float>(sigma / along);
    for (Row& row : rows_) {
      row.pressure += alpha * row.search;
      row.right -= alpha * row.image;
    }
    precondition();
    const double now = dot(&Row::solved, &Row::right);
    const auto beta = static_cast<float>(now / sigma);
    for (Row& row : rows_) row.search = row.solved + beta * row.search;
    sigma = now;
  }
}

void StandingWater::precondition() {
  for (std::uint32_t r = 0; r < rows_.size(); ++r) {
    Row& row = rows_[r];
    float sum = row.right;
    for (std::size_t c = 0; c < 3; ++c) {
      for (const std::uint32_t o : {row.before[c], row.after[c]}) {
        if (o != kNone && o < r) sum += weight_[c] * rows_[o].factor * rows_[o].solved;
      }
    }
    row.solved = sum * row.factor;
  }
  for (std::uint32_t r = rows_.size(); r-- > 0;) {
    Row& row = rows_[r];
    float sum = row.solved;
    for (std::size_t c = 0; c < 3; ++c) {
      for (const std::uint32_t o : {row.before[c], row.after[c]}) {
        if (o != kNone && o > r) sum += weight_[c] * row.factor * rows_[o].solved;
      }
    }
    row.solved = sum * row.factor;
  }
}

ParticleRow StandingWater::lift(std::size_t drop, const ParticleRow& at) const {
  const Cell& cell = cells_[cellOf_[drop]];
  const Vec3f place = (Vec3f(at.x, at.y, at.z) - origin_).cwiseProduct(perSize_);
  std::array<float, 3> sum;
  for (std::size_t c = 0; c < 3; ++c) {
    const float share = std::clamp(place[c] - static_cast<float>(cell.at[c]), 0.0f, 1.0f);
    sum[c] = cell.low[c] + share * (cell.high[c] - cell.low[c]);
  }
  return {sum[0], sum[1], sum[2], cell.share};
}

}  // namespace lorica

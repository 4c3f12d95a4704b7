#include "capture/tracking/people/person_evidence.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace lorica {
namespace {

constexpr int kSame = 40;  // a surface whose depth changes by less is taken for the same one [mm]

constexpr int kMovedShare = 60;  ///< min changed fraction is 1 / this; a forearm moved forward changes twice that
constexpr int kEdgeCells = 2;    ///< at either end of a run of changed cells, possibly caused by noise

}  // namespace

PersonEvidence::PersonEvidence(const DepthGrid& grid)
    : network_(PersonNetwork::shipped()),
      scale_(std::max(static_cast<float>(grid.width) / PersonNetwork::kWidth,
                      static_cast<float>(grid.height) / PersonNetwork::kHeight)),
      top_((PersonNetwork::kHeight - static_cast<int>(grid.height / scale_)) / 2),
      depthMm_(static_cast<std::size_t>(PersonNetwork::kWidth) * PersonNetwork::kHeight),
      heightMm_(depthMm_.size()),
      logits_(grid.cellCount()),
      lastDepthMm_(grid.cellCount()) {}

void PersonEvidence::update(const DepthGrid& grid, const FloorPositions& positions, bool floorFound) {
  constexpr int kWidth = PersonNetwork::kWidth, kHeight = PersonNetwork::kHeight;
  // A measured cell of each pixel's block.
  std::ranges::fill(depthMm_, std::uint16_t{0});
  for (int v = top_; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const std::size_t pixel = static_cast<std::size_t>(v) * kWidth + u;
      for (int k = 0; k < 4 && depthMm_[pixel] == 0; ++k) {
        const int right = k % 2, below = k / 2;
        const int column = static_cast<int>((u + 0.5F * right) * scale_);
        const int row = static_cast<int>((v - top_ + 0.5F * below) * scale_);
        if (column >= grid.width || row >= grid.height) continue;
        depthMm_[pixel] = grid.depthMm[grid.index(column, row)];
        if (depthMm_[pixel] == 0) continue;
        heightMm_[pixel] =
            static_cast<std::int16_t>(std::clamp(1000.0F * positions(grid, column, row).y(), -30000.0F, 30000.0F));
      }
    }
  }
  const std::span<const std::int16_t> seen = network_.run(depthMm_, heightMm_, floorFound);

  const float pixelsPerCell = 1.0F / scale_;
  for (int r = 0; r < grid.height; ++r) {
    for (int c = 0; c < grid.width; ++c) {
      const std::size_t cell = grid.index(c, r);
      const int depth = grid.depthMm[cell];
      const int was = lastDepthMm_[cell];
      if (depth == 0) {
        logits_[cell] = 0;
        continue;
      }
      // The pixel nearby that shows the same surface.
      const int u = std::min(static_cast<int>((c + 0.5F) * pixelsPerCell), kWidth - 1);
      const int v = std::min(top_ + static_cast<int>((r + 0.5F) * pixelsPerCell), kHeight - 1);
      std::size_t best = static_cast<std::size_t>(v) * kWidth + u;
      int off = std::abs(depth - depthMm_[best]);
      if (off > kSame) {
        for (int y = std::max(v - 1, 0); y <= std::min(v + 1, kHeight - 1); ++y) {
          for (int x = std::max(u - 1, 0); x <= std::min(u + 1, kWidth - 1); ++x) {
            const std::size_t pixel = static_cast<std::size_t>(y) * kWidth + x;
            const int other = std::abs(depth - depthMm_[pixel]);
            if (other >= off) continue;
            off = other;
            best = pixel;
          }
        }
      }
      const int now = seen[best];
      const bool stays = was != 0 && std::abs(depth - was) < kSame;
      logits_[cell] = static_cast<std::int16_t>(stays ? (logits_[cell] + now) / 2 : now);
    }
  }
  lastDepthMm_ = grid.depthMm;
}

PersonMoves::PersonMoves(const DepthGrid& grid)
    : tolerance_([](double depth) { return 0.03F + 5.0F * depthNoise(depth); }) {
  for (std::vector<std::uint16_t>& depth : depthMm_) depth.resize(grid.cellCount());
  for (std::vector<std::uint8_t>& covered : covered_) covered.resize(grid.cellCount());
}

void PersonMoves::remember(const DepthGrid& grid, std::span<const std::uint8_t> person, int slot) {
  const std::size_t k = slot;
  cells_[k] = 0;
  depthMm_[k] = grid.depthMm;
  for (std::size_t i = 0; i < person.size(); ++i) {
    covered_[k][i] = person[i] == slot + 1;
    cells_[k] += covered_[k][i];
  }
}

bool PersonMoves::hasMoved(const DepthGrid& grid, std::span<const std::uint8_t> person, int slot) const {
  const std::vector<std::uint16_t>& was = depthMm_[slot];
  const std::vector<std::uint8_t>& covered = covered_[slot];
  int changed = 0;
  for (int r = 0; r < grid.height; ++r) {
    int run = 0;
    for (int c = 0; c < grid.width; ++c) {
      const std::size_t i = grid.index(c, r);
      const float off = static_cast<float>(grid.depthMm[i]) - was[i];
      const float tolerance = 1000.0F * tolerance_[std::max(was[i], grid.depthMm[i])];
      const bool mine = person[i] == slot + 1, nearer = off < -tolerance;
      // Something nearer may be someone else in front of the person.
      const bool differs = covered[i] != 0
                               ? was[i] != 0 && grid.depthMm[i] != 0 && (off > tolerance || (nearer && mine))
                               : mine && (was[i] == 0 || nearer);
      run = differs ? run + 1 : 0;
      changed += run > 2 * kEdgeCells;
    }
  }
  return changed * kMovedShare > cells_[slot];
}

}  // namespace lorica

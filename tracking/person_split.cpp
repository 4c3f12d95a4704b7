#include "tracking/person_split.h"

#include <cstdlib>

namespace lorica {

void PersonSplit::apply(const DepthGrid& grid, const ComponentFinder& finder, std::size_t component, unsigned slotMask,
                        std::span<const CellShift> shifts, const LastCells& last, std::span<std::uint8_t> person) {
  const DepthComponent& one = finder.components()[component];
  const auto label = static_cast<std::int32_t>(component);
  const std::span<const std::int32_t> labels = finder.labels();
  queue_.clear();
  for (int r = one.top; r <= one.bottom; ++r) {
    for (int c = one.left; c <= one.right; ++c) {
      const std::size_t i = grid.index(c, r);
      if (labels[i] != label) continue;
      int nearest = 120;  // mm
      for (int k = 0; k < kPersonSlots; ++k) {
        if ((slotMask & (1U << static_cast<unsigned>(k))) == 0) continue;
        const CellShift shift = shifts[static_cast<std::size_t>(k)];
        const int column = c - shift.columns, row = r - shift.rows;
        if (column < 0 || column >= grid.width || row < 0 || row >= grid.height) continue;
        const std::size_t before = grid.index(column, row);
        const int off = std::abs(grid.depthMm[i] - last.depthMm[before]);
        if (last.person[before] != k + 1 || off >= nearest) continue;
        nearest = off;
        person[i] = static_cast<std::uint8_t>(k + 1);
      }
      if (person[i] != 0) queue_.push_back(static_cast<std::uint32_t>(i));
    }
  }
  const auto w = static_cast<std::size_t>(grid.width);
  for (std::size_t next = 0; next < queue_.size(); ++next) {
    const std::size_t i = queue_[next];
    const std::size_t column = i % w, row = i / w;
    const float step = 1000.0F * finder.step(grid.depthMm[i]);
    const auto visit = [&](bool inside, std::size_t j) {
      if (!inside || labels[j] != label || person[j] != 0) return;
      if (static_cast<float>(std::abs(grid.depthMm[i] - grid.depthMm[j])) >= step) return;
      person[j] = person[i];
      queue_.push_back(static_cast<std::uint32_t>(j));
    };
    visit(column > 0, i - 1);
    visit(column + 1 < w, i + 1);
    visit(row > 0, i - w);
    visit(row + 1 < static_cast<std::size_t>(grid.height), i + w);
  }
}

}  // namespace lorica

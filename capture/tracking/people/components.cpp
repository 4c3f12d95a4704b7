#include "capture/tracking/people/components.h"

#include "geometry/counts.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace lorica {
namespace {

constexpr int kMinComponentCells = 12;

}  // namespace

float DepthComponent::thickness() const {
  const float n = cells;
  const Vec3f mean = sum / n;
  Eigen::Matrix3f covariance;
  covariance << products[0], products[1], products[2],  //
      products[1], products[3], products[4],            //
      products[2], products[4], products[5];
  covariance = covariance / n - mean * mean.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> axes(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0F, axes.eigenvalues()[0]));
}

FloorPositions::FloorPositions(const DepthGrid& grid) : columns_(grid.width), rows_(grid.height) {
  set(grid, Isometry3::Identity());
}

void FloorPositions::set(const DepthGrid& grid, const Isometry3& floorFromCamera) {
  const Eigen::Matrix3f turn = floorFromCamera.linear().cast<float>();
  for (std::size_t c = 0; c < columns_.size(); ++c) columns_[c] = turn.col(0) * grid.rayX[c];
  for (std::size_t r = 0; r < rows_.size(); ++r) rows_[r] = turn.col(1) * grid.rayY[r] - turn.col(2);
  origin_ = floorFromCamera.translation().cast<float>();
}

ComponentFinder::ComponentFinder(const DepthGrid& grid)
    : labels_(grid.cellCount()), step_([](double depth) { return 0.025F + 5.0F * depthNoise(depth); }) {
  surfaces_.reserve(grid.cellCount() / 2 + 1);
  sizes_.reserve(grid.cellCount() / 2 + 1);
  componentOf_.reserve(grid.cellCount() / 2 + 1);
  components_.reserve(kMaxSurfaces);
}

void ComponentFinder::find(const DepthGrid& grid, const FloorPositions& positions, std::span<const CellKind> kinds,
                           const LastCells& last, std::span<const std::int16_t> evidence) {
  const std::size_t w = grid.width;
  surfaces_.clear();
  components_.clear();

  // Neighbours to the left and above at about the same depth belong to one surface.
  for (std::size_t r = 0, i = 0; r < static_cast<std::size_t>(grid.height); ++r) {
    for (std::size_t c = 0; c < w; ++c, ++i) {
      if (kinds[i] < CellKind::kUnknown) {
        labels_[i] = -1;
        continue;
      }
      const int depth = grid.depthMm[i];
      const int step = 1000.0F * step_[grid.depthMm[i]];
      const bool left = c > 0 && labels_[i - 1] >= 0 && std::abs(depth - grid.depthMm[i - 1]) < step;
      const bool above = r > 0 && labels_[i - w] >= 0 && std::abs(depth - grid.depthMm[i - w]) < step;
      if (left) {
        labels_[i] = labels_[i - 1];
        if (above && labels_[i - w] != labels_[i]) surfaces_.unite(labels_[i], labels_[i - w]);
      } else if (above) {
        labels_[i] = labels_[i - w];
      } else {
        labels_[i] = surfaces_.add();
      }
    }
  }

  // Remove specks; number the rest in image order.
  sizes_.assign(surfaces_.count(), 0);
  for (const std::int32_t label : labels_) {
    if (label >= 0) ++sizes_[label];
  }
  for (std::int32_t k = 0; k < countOf(sizes_); ++k) {
    const std::int32_t smallest = surfaces_.find(k);
    if (smallest != k) sizes_[smallest] += sizes_[k];
  }
  componentOf_.assign(surfaces_.count(), -1);
  for (std::int32_t k = 0; k < countOf(componentOf_); ++k) {
    const std::int32_t smallest = surfaces_.find(k);
    if (smallest == k && sizes_[k] >= kMinComponentCells && components_.size() < kMaxSurfaces) {
      componentOf_[k] = countOf(components_);
      components_.emplace_back();
    } else if (smallest != k) {
      componentOf_[k] = componentOf_[smallest];
    }
  }

  for (std::int32_t& label : labels_) {
    if (label >= 0) label = componentOf_[label];
  }

  // Measure each surface.
  for (int r = 0; r < grid.height; ++r) {
    for (int c = 0; c < grid.width; ++c) {
      const std::size_t i = grid.index(c, r);
      const std::int32_t label = labels_[i];
      if (label < 0) continue;
      DepthComponent& one = components_[label];
      const std::uint16_t depthMm = grid.depthMm[i];
      const Vec3f position = positions(grid, c, r);
      if (one.cells++ == 0) {
        one.origin = position;
        one.left = one.right = c;
        one.top = r;
      }
      one.newCells += kinds[i] == CellKind::kNew;
      one.affirmed += evidence[i] > 0;
      one.left = std::min(one.left, c);
      one.right = std::max(one.right, c);
      one.bottom = r;
      const float depth = 0.001F * depthMm;
      one.area += depth * depth;
      one.min = one.min.cwiseMin(position);
      one.max = one.max.cwiseMax(position);
      const Vec3f p = position - one.origin;
      one.sum += p;
      one.products[0] += p.x() * p.x();
      one.products[1] += p.x() * p.y();
      one.products[2] += p.x() * p.z();
      one.products[3] += p.y() * p.y();
      one.products[4] += p.y() * p.z();
      one.products[5] += p.z() * p.z();
      const std::uint8_t was = last.person[i];
      if (was != 0 && std::abs(depthMm - last.depthMm[i]) < 150) ++one.overlap[was - 1U];

      // Its border: where the surface ends, and whether it really ends or continues into known background.
      bool border = false, contact = false;
      const auto look = [&](bool inside, std::size_t other) {
        if (!inside) return;
        if (labels_[other] == label) return;
        border = true;
        contact = contact || (kinds[other] == CellKind::kBackground &&
                              std::abs(depthMm - grid.depthMm[other]) < 500.0F * step_[depthMm]);
      };
      look(c > 0, i - 1);
      look(c + 1 < grid.width, i + 1);
      look(r > 0, i - w);
      look(r + 1 < grid.height, i + w);
      one.borderCells += border;
      one.backgroundContacts += contact;
    }
  }
  for (DepthComponent& one : components_) one.area *= grid.cellArea;
}

bool isOversize(const DepthComponent& one) {
  const Vec3f size = one.max - one.min;
  return std::hypot(size.x(), size.z()) > 2.4F || size.y() > 2.5F || one.area > 2.0;
}

bool goesOnIntoBackground(const DepthComponent& one) {
  return 2 * one.newCells < one.cells && !isAffirmed(one) &&
         one.backgroundContacts > std::max(6, one.borderCells * 3 / 20);
}

bool isTooNear(const DepthComponent& one, const DepthGrid& grid) {
  return one.area < double{kNearestKnown} * kNearestKnown * grid.cellArea * one.cells;
}

bool isAffirmed(const DepthComponent& one) {
  return 2 * one.affirmed > one.cells;
}

bool isMainPiece(const DepthComponent& one, int cells, int slot) {
  return 2 * one.overlap[slot] > cells;
}

bool mayBePerson(const DepthComponent& one, const DepthGrid& grid, bool floorFound) {
  const bool cutAbove = one.top <= grid.firstRow + 1, cutBelow = one.bottom >= grid.lastRow - 1;
  const bool cut = cutAbove || cutBelow || one.left <= grid.firstColumn + 1 || one.right >= grid.lastColumn - 1;
  const bool moving = 5 * one.newCells > 3 * one.cells;
  const Vec3f size = one.max - one.min;
  if (isOversize(one) || std::min(size.x(), size.z()) > 1.3F) return false;
  // Little of a person close to the camera fits into the image, but that part fills much of it.
  const bool closeUp = cut && one.cells * 25 >= static_cast<int>(grid.cellCount());
  if (one.area < (cut ? 0.1 : 0.15) && !closeUp) return false;
  if (floorFound && !closeUp) {
    if (one.max.y() < (moving || isAffirmed(one) ? 0.8F : 1.1F) && !cutAbove) return false;
    if (one.min.y() > 0.5F && !cutBelow && !moving) return false;
  }
  if (!floorFound && size.norm() < 0.45F) return false;
  const float depth = std::sqrt(static_cast<float>(one.area / (grid.cellArea * one.cells)));
  if (depth > 5.5F) return false;
  return one.thickness() > 0.008F + 0.6F * depthNoise(depth);
}

bool mayBePartOfPerson(const DepthComponent& one) {
  return one.area > 0.03 && (2 * one.newCells > one.cells || isAffirmed(one)) && !isOversize(one);
}

bool hasHeadAndShoulders(const DepthGrid& grid, const FloorPositions& positions, std::span<const std::uint8_t> person,
                         int slot, float top, bool cutAside) {
  // Widths of two slices, perpendicular to the viewing direction.
  std::array<float, 2> min{1e9F, 1e9F}, max{-1e9F, -1e9F};
  for (int r = 0; r < grid.height; ++r) {
    for (int c = 0; c < grid.width; ++c) {
      if (person[grid.index(c, r)] != slot + 1) continue;
      const Vec3f position = positions(grid, c, r);
      const float down = top - position.y();
      const bool head = down > 0.06F && down < 0.16F;
      const bool shoulders = down > 0.33F && down < 0.55F;
      if (!head && !shoulders) continue;
      const std::size_t slice = head ? 0 : 1;
      min[slice] = std::min(min[slice], position.x());
      max[slice] = std::max(max[slice], position.x());
    }
  }
  const float head = max[0] - min[0], shoulders = max[1] - min[1];
  const float part = cutAside ? 0.5F : 1.0F;
  return head > 0.1F * part && head < 0.34F && shoulders > 0.26F * part && shoulders < 0.8F && shoulders > 1.35F * head;
}

}  // namespace lorica

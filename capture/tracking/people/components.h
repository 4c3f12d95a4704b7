#pragma once

#include "capture/tracking/people/background.h"
#include "capture/tracking/people/depth_grid.h"
#include "capture/tracking/people/person_slot.h"
#include "geometry/math.h"
#include "geometry/union_find.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

inline constexpr std::size_t kMaxSurfaces = 2048;

/// A connected surface that is neither floor nor known background. Positions are in the floor frame [m].
struct DepthComponent {
  int cells = 0;
  int newCells = 0;                              ///< nearer than a known background
  int affirmed = 0;                              ///< taken for a person's by the network
  int borderCells = 0;                           ///< next to something else
  int backgroundContacts = 0;                    ///< border cells that continue smoothly into known background
  int left = 0, top = 0, right = 0, bottom = 0;  ///< inclusive [cells]
  double area = 0.0;                             ///< as seen from the camera [m^2]
  Vec3f sum = Vec3f::Zero();
  Vec3f min = Vec3f::Constant(1e9F), max = Vec3f::Constant(-1e9F);
  Eigen::Matrix<float, 6, 1> products = Eigen::Matrix<float, 6, 1>::Zero();  ///< about `origin`: xx xy xz yy yz zz
  Vec3f origin = Vec3f::Zero();
  std::array<int, kPersonSlots> overlap{};  ///< cells that were the person's in the last frame, at about that depth

  [[nodiscard]] Vec3f middle() const { return origin + sum / static_cast<float>(cells); }
  /// Root mean square distance from the best-fit plane [m].
  [[nodiscard]] float thickness() const;
};

/// Converts cells to positions in the floor frame.
class FloorPositions {
 public:
  explicit FloorPositions(const DepthGrid& grid);
  void set(const DepthGrid& grid, const Isometry3& floorFromCamera);
  [[nodiscard]] Vec3f operator()(const DepthGrid& grid, int column, int row) const {
    const float depth = 0.001F * grid.depthMm[grid.index(column, row)];
    return depth * (columns_[column] + rows_[row]) + origin_;
  }
  /// Height over the floor at a depth of 1 m on the ray of a row and column, minus the camera's height.
  [[nodiscard]] float slope(int column, int row) const { return columns_[column].y() + rows_[row].y(); }
  [[nodiscard]] float cameraHeight() const { return origin_.y(); }

 private:
  std::vector<Vec3f> columns_, rows_;
  Vec3f origin_ = Vec3f::Zero();
};

/// The cells of the last frame.
struct LastCells {
  std::span<const std::uint8_t> person;    ///< slot + 1, 0 = nobody
  std::span<const std::uint16_t> depthMm;  ///< of that frame
};

/// Finds connected surfaces: neighbouring cells with a small depth difference.
class ComponentFinder {
 public:
  explicit ComponentFinder(const DepthGrid& grid);

  /// @param evidence  of each cell, positive for people
  void find(const DepthGrid& grid, const FloorPositions& positions, std::span<const CellKind> kinds,
            const LastCells& last, std::span<const std::int16_t> evidence);

  [[nodiscard]] std::span<const DepthComponent> components() const { return components_; }
  /// For each cell: index of the component, or -1. Surfaces of only a few cells belong to none.
  [[nodiscard]] std::span<const std::int32_t> labels() const { return labels_; }
  /// Largest depth step between neighbours on the same surface [m].
  [[nodiscard]] float step(std::uint16_t depthMm) const { return step_[depthMm]; }

 private:
  std::vector<std::int32_t> labels_;
  UnionFind surfaces_;  ///< known by their smallest label, so that they follow the order of the image
  std::vector<std::int32_t> sizes_;
  std::vector<std::int32_t> componentOf_;
  std::vector<DepthComponent> components_;
  DepthTable step_;
};

}  // namespace lorica

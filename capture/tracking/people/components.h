#pragma once

#include "capture/tracking/people/background.h"
#include "capture/tracking/people/depth_grid.h"
#include "geometry/math.h"
#include "geometry/union_find.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

inline constexpr std::size_t kMaxSurfaces = 2048;
/// Maximum number of people remembered at once, reported or not.
inline constexpr int kPersonSlots = 8;

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

/// Too wide, too high or too large in area for one person: merged with something else.
[[nodiscard]] bool isOversize(const DepthComponent& one);

/// Its border continues smoothly into known background: a part of the room that was hidden until now.
[[nodiscard]] bool goesOnIntoBackground(const DepthComponent& one);

/// The network was shown nobody nearer than this [m].
inline constexpr float kNearestKnown = 1.2F;
/// So near that the network cannot judge it.
[[nodiscard]] bool isTooNear(const DepthComponent& one, const DepthGrid& grid);

/// Whether the network takes most of it for a person's.
[[nodiscard]] bool isAffirmed(const DepthComponent& one);

/// Whether most of a person's cells of the last frame lie on it.
/// @param cells  of that person in the last frame
[[nodiscard]] bool isMainPiece(const DepthComponent& one, int cells, int slot);

/// Size, height and thickness are plausible for a person, or for the part of one inside the image.
[[nodiscard]] bool mayBePerson(const DepthComponent& one, const DepthGrid& grid, bool floorFound);

/// Large enough to be the first visible part of a person who reappears from behind something.
[[nodiscard]] bool mayBePartOfPerson(const DepthComponent& one);

/// Narrow at the top and wider below.
/// @param person    slot + 1 of each cell
/// @param top       height of the person [m]
/// @param cutAside  one side of the person is outside the image: half of either width is enough
[[nodiscard]] bool hasHeadAndShoulders(const DepthGrid& grid, const FloorPositions& positions,
                                       std::span<const std::uint8_t> person, int slot, float top, bool cutAside);

}  // namespace lorica

#pragma once

#include "capture/tracking/people/depth_grid.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Content of a cell before it is assigned to a person.
enum class CellKind : std::uint8_t {
  kNone,        ///< nothing measured
  kFloor,       ///< floor, or below it
  kWall,        ///< a wall of the room
  kBackground,  ///< as far as what was seen there before, without people
  kFurniture,   ///< not known, and connected to a person, but the network says that it is the room's
  kUnknown,     ///< the background there is not known
  kNew,         ///< nearer than the background
};

/// Model of the room without people: for each cell the distance of what stays there for long.
///
/// An empty room is not required. Cells are learnt while no person covers them. Something deeper than the background
/// replaces it within a few frames. Something nearer that belongs to nobody and stays in place for 1.5 s becomes part
/// of it, such as a moved chair or an opened door.
class Background {
 public:
  explicit Background(const DepthGrid& grid);

  /// Distinguishes background from the rest. Cells that are already kFloor or kWall stay unchanged.
  void classify(const DepthGrid& grid, std::span<CellKind> kinds) const;

  /// Learns from the cells that are not a person's.
  /// @param taken  for each cell, nonzero if a person is or may be there
  void learn(const DepthGrid& grid, std::span<const CellKind> kinds, std::span<const std::uint8_t> taken);

  /// Whether the depth of a cell has been seen for half a second: what was learned before somebody came stays room.
  [[nodiscard]] bool isSettled(std::size_t cell) const { return trust_[cell] >= kSettledTrust; }

  /// What is behind the present content of the cell is not known.
  void forget(std::size_t cell);

  /// Nothing is known any more: the camera was moved.
  void forget();

  /// Makes the present content of the cell background.
  void absorb(const DepthGrid& grid, std::size_t cell);

 private:
  static constexpr std::uint8_t kSettledTrust = 15;

  void findNearest();

  int width_, height_;
  std::vector<float> depth_;              ///< [mm]; 0 = not known
  std::vector<std::uint8_t> trust_;       ///< how certain the depth is, 0 to 40
  std::vector<std::uint16_t> candidate_;  ///< [mm] possible replacement
  std::vector<std::uint8_t> seen_;        ///< frames in which the candidate was seen
  std::vector<float> nearest_;  ///< over the surrounding 3 x 3 cells; edges move by a cell from frame to frame
  std::vector<float> rowNearest_;
  DepthTable tolerance_;  ///< [m]
  int frameCount_ = 0;
};

}  // namespace lorica

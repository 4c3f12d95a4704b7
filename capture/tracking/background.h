#pragma once

#include "capture/tracking/depth_grid.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// What a cell shows, before it is known whose it is.
enum class CellKind : std::uint8_t {
  kNone,        ///< nothing measured
  kFloor,       ///< or below it
  kBackground,  ///< as far as what was seen there before, when nobody stood there
  kUnknown,     ///< nothing is known of the background there
  kNew,         ///< nearer than the background
};

/// The room without its people: for each cell how far it is to what stands there for long.
///
/// No empty room is asked for. Cells are learnt where nobody is; what appears deeper than the background replaces it
/// within some frames; what stays nearer, in the same place for 1.5 s and is nobody's, becomes part of it: chairs that
/// were moved, doors that were opened.
class Background {
 public:
  explicit Background(const DepthGrid& grid);

  /// Tells background from the rest. Writes no kFloor, and leaves cells alone that are kFloor already.
  void classify(const DepthGrid& grid, std::span<CellKind> kinds) const;

  /// Learns from the cells that are not a person's.
  /// @param taken  for each cell not 0 where a person is, or may be
  void learn(const DepthGrid& grid, std::span<const CellKind> kinds, std::span<const std::uint8_t> taken);

  /// Takes what the cell shows now for background from now on.
  void absorb(const DepthGrid& grid, std::size_t cell);

 private:
  void findNearest();

  int width_, height_;
  std::vector<float> depth_;              ///< [mm]; 0 = not known
  std::vector<std::uint8_t> trust_;       ///< how well it is known, 0 to 40
  std::vector<std::uint16_t> candidate_;  ///< [mm] what may replace it
  std::vector<std::uint8_t> seen_;        ///< frames that the candidate was seen in
  std::vector<float> nearest_;            ///< of the 3 x 3 cells around; edges move by a cell from frame to frame
  std::vector<float> rowNearest_;
  DepthTable tolerance_;  ///< [m]
  int frameCount_ = 0;
};

}  // namespace lorica

#pragma once

/// Sheets of surface and walls around them. Internal: not installed.

#include "geometry/tri_mesh.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lorica {

/// A surface as sheets: two-manifolds that may have borders.
struct Sheets {
  /// Of the mesh; those of one sheet face the same way.
  std::vector<Triangle> triangles;
  /// For each side of a triangle, from its corner i to the next one: the triangle across, or -1 at a border.
  std::vector<std::array<std::int32_t, 3>> across;
  std::vector<std::int32_t> sheetOfTriangle;
  std::size_t count = 0;
};

/// Divides a surface into sheets. Where more than two triangles meet at an edge, those that continue each other best
/// stay together, and one that is left over ends there. A sheet also ends where it is folded flat onto itself, and
/// where a one-sided surface, like a Moebius strip, would have to change sides.
/// @param mesh  without triangles that have a repeated corner
[[nodiscard]] Sheets findSheets(const TriMesh& mesh);

/// Closed walls around sheets, half of the thickness on each side. At an edge both faces are offset by that much,
/// unless it is sharper than 60 degrees.
/// @param which      for each triangle, whether it gets a wall
/// @param thickness  more than 0 [m]
/// @return two vertices for each corner of a sheet
[[nodiscard]] TriMesh wallsAround(const TriMesh& mesh, const Sheets& sheets, const std::vector<bool>& which,
                                  double thickness);

/// The narrowest gap between sides of a surface that face each other, where that is less than `upTo`; else `upTo`.
/// Two sides that meet at an edge form a corner and no gap; so a hundredth of the area is left out.
/// @param which  for each triangle, whether gaps in front of and behind it count; those to all triangles do
/// @param upTo   [m]
[[nodiscard]] double narrowestGap(const TriMesh& mesh, const std::vector<bool>& which, double upTo);

/// Which triangles are next to space that cannot be reached from outside. Openings narrower than 3 to 4 % of the
/// surface's longest side are no way in.
[[nodiscard]] std::vector<bool> aroundSealedSpace(const TriMesh& mesh);

}  // namespace lorica

#pragma once

#include "export/robots/robot.h"

#include <span>
#include <utility>
#include <vector>

namespace lorica {

/// A geom's mesh and what replaces it, in the geom's frame.
struct GeomShapes {
  const TriMesh* surface = nullptr;
  const std::vector<TriMesh>* shapes = nullptr;  ///< convex
};

struct NewContacts {
  std::vector<std::pair<int, int>> links;  ///< ascending
  bool all = true;                         ///< false: there was too much to look at
};

/// Pairs of links of which shapes touch in the rest pose though their meshes do not. Links that move as one, or of
/// which one hangs on the other, are left out, as are those that the file lets pass through each other. Other shapes
/// of the links, such as boxes, are not looked at. Internal: not installed.
/// @param geoms  as those of the robot
[[nodiscard]] NewContacts newContacts(const RobotFile& robot, std::span<const GeomShapes> geoms);

}  // namespace lorica

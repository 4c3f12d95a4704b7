#pragma once

#include "acd/decomposition.h"

#include <vector>

namespace lorica {

/// A point of a live hull.
struct CoverPoint {
  PointIndex point = 0;         ///< of the decomposition
  Vec3 outward = Vec3::Zero();  ///< offset from the surface, in the bind pose [m]; rotates with the point's bones
};

/// The points of a live body, chosen and displaced so that its hulls enclose the posed surface.
struct HullCover {
  double tolerance = 0.0;                       ///< max protrusion before enlarging [m]; 0 = exact in every pose
  int maxHullVertices = 0;                      ///< of each hull in every frame; 0 = unlimited
  std::vector<std::vector<CoverPoint>> points;  ///< for each part, its own points or vertices of no part
  int sampledPoses = 0;                         ///< number of poses used to choose the points
  int heldOutPoses = 0;                         ///< number of poses used to verify the cover, none of them sampled
  double growth = 0.0;                          ///< largest displacement [m]
  double sampledShortfall = 0.0;                ///< before enlarging: largest protrusion in the sampled poses [m]
  double heldOutShortfall = 0.0;                ///< after enlarging: largest protrusion in the held-out poses [m]
};

}  // namespace lorica

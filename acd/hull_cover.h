#pragma once

#include "acd/decomposition.h"

#include <vector>

namespace lorica {

/// A point that a live hull is made of.
struct CoverPoint {
  PointIndex point = 0;
  Vec3 outward = Vec3::Zero();  ///< moves it from the surface, in the bind pose [m]; turns with the point's bones
};

/// What a live body that is made of these points promises: that the posed surface lies inside its hulls.
struct CoverPromise {
  double tolerance = 0.0;                       ///< [m]; 0 = exact, in every pose
  int maxHullVertices = 0;                      ///< of each hull in every frame; 0 = no bound
  std::vector<std::vector<CoverPoint>> points;  ///< for each part, points of that part, or vertices of no part
  int sampledPoses = 0;                         ///< that the points were chosen in
  int heldOutPoses = 0;                         ///< that the promise was measured in, none of them sampled
  double growth = 0.0;                          ///< the longest of all displacements [m]
  double sampledShortfall = 0.0;                ///< before growing: farthest outside, in the sampled poses [m]
  double heldOutShortfall = 0.0;                ///< after growing: farthest outside, in the poses held out [m]
};

}  // namespace lorica

#include "prepare/used_hulls.h"

#include <tbb/parallel_for.h>

namespace lorica {

UsedHulls liveHulls(const Character& character, const Decomposition& decomposition, const HullCover& cover,
                    BonePoseView poses) {
  const std::vector<LiftedPoint> lifted = liftPoints(character, decomposition);
  UsedHulls hulls(poses.poseCount());
  tbb::parallel_for(0, poses.poseCount(), [&](int k) {
    std::vector<Vec3> positions;
    for (const std::vector<CoverPoint>& points : cover.points) {
      positions.clear();
      for (const CoverPoint& p : points) {
        positions.push_back(positionOf(pushed(lifted[p.point], p.outward), poses.pose(k)));
      }
      hulls[k].push_back(convexHull(positions));
    }
  });
  return hulls;
}

}  // namespace lorica

#include "prepare/cover_choice.h"

#include "collision/live/choose_cover.h"
#include "collision/live/lifted_point.h"
#include "geometry/convex_hull.h"

namespace lorica {
namespace {

constexpr int kVolumeStride = 4;  // 32 of 128 poses give the same mean, four times faster

}  // namespace

Result<HullCover> chooseCover(const Character& character, const Decomposition& decomposition, const CoverPoses& poses,
                              const CoverRequest& request, int threads,
                              const std::function<bool(int partsDone, int parts)>& progress) {
  CoverSettings settings;
  settings.tolerance = request.tolerance.value_or(0.0);
  settings.maxHullVertices = request.hullVertices;
  settings.threads = threads;
  settings.progress = progress;
  return chooseCover(decomposition, liftPoints(character, decomposition), poses.sampledView(), poses.heldOutView(),
                     settings);
}

double volumeGrowth(const Character& character, const Decomposition& decomposition, const CoverPoses& poses,
                    const HullCover& cover) {
  const std::vector<LiftedPoint> lifted = liftPoints(character, decomposition);
  const HullCover exact = coverExactly(decomposition, lifted);
  const auto volume = [&](const HullCover& chosen, std::span<const Affine3> worldFromModel) {
    double sum = 0.0;
    for (const std::vector<CoverPoint>& points : chosen.points) {
      std::vector<Vec3> positions;
      positions.reserve(points.size());
      for (const CoverPoint& p : points) {
        positions.push_back(positionOf(pushed(lifted[p.point], p.outward), worldFromModel));
      }
      sum += convexHullVolume(positions);
    }
    return sum;
  };
  const BonePoseView view = poses.sampledView();
  double before = 0.0;
  double after = 0.0;
  for (int p = 0; p < view.poseCount(); p += kVolumeStride) {
    before += volume(exact, view.pose(p));
    after += volume(cover, view.pose(p));
  }
  return before > 0.0 ? after / before - 1.0 : 0.0;
}

}  // namespace lorica

#include "prepare/quality.h"

#include "acd/hull_distance.h"
#include "acd/transfer.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace lorica {

Quality measureQuality(const TriMesh& mesh, PoseView keyframes, const UsedHulls& hulls) {
  Quality quality;
  const double share = 1.0 / keyframes.keyframeCount();
  for (int k = 0; k < keyframes.keyframeCount(); ++k) {
    PoseError pose;
    pose.meshVolume = signedVolume(keyframes.keyframe(k), mesh.triangles);
    for (const ConvexHull& hull : hulls[k]) pose.hullVolume += hull.volume;
    quality.errorPerKeyframe.push_back(pose.relative());
    quality.meshVolume += share * pose.meshVolume;
    quality.hullVolume += share * pose.hullVolume;
    quality.score += share * pose.meshVolume / pose.hullVolume;
    quality.error += share * pose.relative();
  }
  return quality;
}

double measureDistance(const Decomposition& decomposition, PoseView keyframes, const UsedHulls& hulls,
                       double ignoreBelow) {
  double worst = 0.0;
  std::vector<Vec3> points(decomposition.pointCount());
  std::vector<double> ofPart(decomposition.parts.size());
  for (int k = 0; k < keyframes.keyframeCount(); ++k) {
    transfer(decomposition, keyframes.keyframe(k), points);
    tbb::parallel_for(std::size_t{0}, ofPart.size(), [&](std::size_t i) {
      ofPart[i] = hullDistance(hulls[k][i], points, decomposition.parts[i].triangles, ignoreBelow);
    });
    worst = std::max(worst, *std::max_element(ofPart.begin(), ofPart.end()));
  }
  return worst;
}

}  // namespace lorica

#include "session/prepare/quality.h"

#include "acd/hull_distance.h"
#include "acd/transfer.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace lorica {

Quality measureQuality(const Decomposition& decomposition, const TriMesh& mesh, PoseView keyframes) {
  Quality quality;
  const double share = 1.0 / keyframes.keyframeCount();
  for (int k = 0; k < keyframes.keyframeCount(); ++k) {
    const PoseError pose = errorInPose(decomposition, mesh, keyframes.keyframe(k));
    quality.errorPerKeyframe.push_back(pose.relative());
    quality.meshVolume += share * pose.meshVolume;
    quality.hullVolume += share * pose.hullVolume;
    quality.score += share * pose.meshVolume / pose.hullVolume;
    quality.error += share * pose.relative();
  }
  return quality;
}

double measureDistance(const Decomposition& decomposition, PoseView keyframes, double ignoreBelow) {
  double worst = 0.0;
  std::vector<Vec3> points(static_cast<std::size_t>(decomposition.pointCount()));
  std::vector<double> ofPart(decomposition.parts.size());
  for (int k = 0; k < keyframes.keyframeCount(); ++k) {
    transfer(decomposition, keyframes.keyframe(k), points);
    tbb::parallel_for(std::size_t{0}, ofPart.size(), [&](std::size_t i) {
      const Part& part = decomposition.parts[i];
      ofPart[i] = hullDistance(partHull(part, points), points, part.triangles, ignoreBelow);
    });
    worst = std::max(worst, *std::max_element(ofPart.begin(), ofPart.end()));
  }
  return worst;
}

}  // namespace lorica

#include "apps/quality.h"

#include "acd/transfer.h"

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

}  // namespace lorica

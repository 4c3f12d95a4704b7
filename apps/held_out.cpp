#include "apps/held_out.h"

#include "collision/live/choose_cover.h"
#include "collision/live/lifted_point.h"
#include "geometry/counts.h"
#include "session/prepare/quality.h"
#include "skinning/linear_blend.h"

#include <span>

namespace lorica {

HeldOutError heldOutError(const Character& character, const Decomposition& decomposition,
                          const std::optional<HullCover>& cover, const CoverPoses& poses) {
  constexpr int kEvery = 4;
  const BonePoseView all = poses.heldOutView();
  const int vertexCount = countOf(character.mesh.vertices);
  std::vector<Affine3> bones;
  std::vector<Vec3> positions;
  for (int p = 0; p < all.poseCount(); p += kEvery) {
    const std::span<const Affine3> pose = all.pose(p);
    bones.insert(bones.end(), pose.begin(), pose.end());
    positions.resize(positions.size() + vertexCount);
    skinLinearBlend(character, pose, std::span(positions).last(vertexCount));
  }
  const HullCover used = cover ? *cover : coverExactly(decomposition, liftPoints(character, decomposition));
  const UsedHulls hulls = liveHulls(character, decomposition, used, {bones, all.jointCount});
  const Quality quality = measureQuality(character.mesh, {positions, vertexCount}, hulls);
  return {quality.error, countOf(hulls)};
}

}  // namespace lorica

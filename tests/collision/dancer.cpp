#include "tests/collision/dancer.h"

#include "acd/decompose.h"
#include "acd/transfer.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/collision/parts.h"

namespace lorica::test {

Dancer::Dancer() : character(makeMannequin()), worldFromModel(character.jointFromModel.size(), Affine3::Identity()) {
  const PoseView bindPose{character.mesh.vertices, static_cast<int>(character.mesh.vertices.size())};
  Result<Decomposition> made = decompose(character.mesh, bindPose, {.maxParts = 8});
  LORICA_CHECK(made.ok(), "cutting the mannequin must succeed");
  decomposition = std::move(made).value();
}

void Dancer::dance(std::mt19937_64& random, double max) {
  Pose pose = restPose(character.skeleton);
  for (JointTransform& joint : pose) {
    const Vec3 turn = uniformVec3(random, -1.0, 1.0);
    joint.rotation = Quat(Eigen::AngleAxisd(max * turn.norm(), turn.normalized())) * joint.rotation;
  }
  pose[0].translation += uniformVec3(random, -5.0, 5.0);
  computeWorldFromJoint(character.skeleton, pose, worldFromModel);
  computeWorldFromModel(character, worldFromModel, worldFromModel);
}

std::vector<Vec3> Dancer::points() const {
  std::vector<Vec3> all(static_cast<std::size_t>(decomposition.pointCount()));
  const auto posed = std::span(all).first(character.mesh.vertices.size());
  skinLinearBlend(character, worldFromModel, posed);
  transfer(decomposition, posed, all);
  return all;
}

}  // namespace lorica::test

#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/allocations.h"

#include <gtest/gtest.h>

namespace lorica::test {
namespace {

TEST(PerFrame, KinematicsAndSkinningAllocateNothing) {
  const Character character = makeMannequin();
  const Pose pose = restPose(character.skeleton);
  std::vector<Affine3> world(pose.size());
  std::vector<Affine3> skin(pose.size());
  std::vector<Vec3> vertices(character.mesh.vertices.size());

  const long before = allocationCount();
  ASSERT_GT(before, 0);  // the counter works: the setup above allocated memory
  computeWorldFromJoint(character.skeleton, pose, world);
  computeWorldFromModel(character, world, skin);
  skinLinearBlend(character, skin, vertices);
  EXPECT_EQ(allocationCount() - before, 0);
}

}  // namespace
}  // namespace lorica::test

#include "skinning/linear_blend.h"

#include "skinning/mannequin/mannequin.h"
#include "tests/skinning/random_pose.h"

#include <gtest/gtest.h>

namespace lorica::test {
namespace {

std::vector<Vec3> posed(const Character& character, const Pose& pose) {
  std::vector<Affine3> world(pose.size());
  std::vector<Affine3> skin(pose.size());
  std::vector<Vec3> vertices(character.mesh.vertices.size());
  computeWorldFromJoint(character.skeleton, pose, world);
  computeWorldFromModel(character, world, skin);
  skinLinearBlend(character, skin, vertices);
  return vertices;
}

TEST(LinearBlend, EqualsBlendedMatricesMadeByHand) {
  const Character character = makeMannequin();
  for (unsigned seed = 1; seed <= 5; ++seed) {
    std::mt19937 random(seed);
    const Pose pose = randomPose(character.skeleton, random, true);
    const std::vector<Vec3> actual = posed(character, pose);

    // The other order: all matrices computed from scratch, blended first, then applied once.
    std::vector<Mat4> worldFromModel;
    for (JointIndex j = 0; j < character.skeleton.jointCount(); ++j) {
      worldFromModel.push_back(worldFromJointByHand(character.skeleton, pose, j) *
                               character.jointFromModel[j].matrix());
    }
    double worst = 0.0;
    for (std::size_t v = 0; v < actual.size(); ++v) {
      Mat4 blended = Mat4::Zero();
      for (std::uint32_t i = character.influenceBegin[v]; i < character.influenceBegin[v + 1]; ++i) {
        const Influence& influence = character.influences[i];
        blended += influence.weight * worldFromModel[influence.joint];
      }
      const Eigen::Vector4d expected = blended * character.mesh.vertices[v].homogeneous();
      worst = std::max(worst, (actual[v] - expected.head<3>()).norm());
    }
    EXPECT_LT(worst, 1e-11) << "seed " << seed;
  }
}

TEST(LinearBlend, RestPoseGivesTheBindMesh) {
  const Character character = makeMannequin();
  const std::vector<Vec3> vertices = posed(character, restPose(character.skeleton));
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    ASSERT_LT((vertices[v] - character.mesh.vertices[v]).norm(), 1e-14) << "vertex " << v;
  }
}

TEST(LinearBlend, RigidMotionOfTheWorldMovesEveryVertexRigidly) {
  const Character character = makeMannequin();
  for (unsigned seed = 1; seed <= 3; ++seed) {
    std::mt19937 random(seed);
    Pose pose = randomPose(character.skeleton, random, false);
    const std::vector<Vec3> before = posed(character, pose);
    const Isometry3 motion = Eigen::Translation3d(randomVector(random, 3.0)) * randomRotation(random);
    pose[0].translation = motion * pose[0].translation;
    pose[0].rotation = Quat(motion.rotation()) * pose[0].rotation;
    const std::vector<Vec3> after = posed(character, pose);
    for (std::size_t v = 0; v < before.size(); ++v) {
      ASSERT_LT((after[v] - motion * before[v]).norm(), 1e-12) << "seed " << seed << ", vertex " << v;
    }
  }
}

TEST(LinearBlend, VertexOfOneJointIsMovedByItsMatrixAlone) {
  Character character;
  character.mesh.vertices = {{1.0, 2.0, 3.0}};
  character.skeleton = *Skeleton::create({Joint{}});
  character.jointFromModel = {Affine3(Eigen::Translation3d(-1.0, -2.0, -2.0))};
  character.influences = {{0, 1.0}};
  character.influenceBegin = {0, 1};
  const std::vector<Affine3> world = {Affine3(Eigen::Translation3d(5.0, 0.0, 0.0) * Eigen::Scaling(2.0))};
  std::vector<Affine3> skin(1);
  std::vector<Vec3> vertices(1);
  computeWorldFromModel(character, world, skin);
  skinLinearBlend(character, skin, vertices);
  EXPECT_EQ(vertices[0], Vec3(5.0, 0.0, 2.0));
  EXPECT_EQ(skin[0] * Vec3(1.0, 2.0, 2.0), Vec3(5.0, 0.0, 0.0));
}

}  // namespace
}  // namespace lorica::test

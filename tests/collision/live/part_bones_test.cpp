#include "collision/live/part_bones.h"

#include "skinning/mannequin/mannequin.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace lorica {
namespace {

/// A bar of 4 x 1 x 1 along x, from -2 to 2: vertices with x < 0 move with "left", the others with "right".
Character bar() {
  Character character;
  character.name = "bar";
  character.mesh = test::makeBox({-2, 0, 0}, {2, 1, 1});
  std::vector<Joint> joints(3);
  joints[0].name = "root";
  joints[1].name = "left";
  joints[2].name = "right";
  joints[1].parent = joints[2].parent = 0;
  character.skeleton = Skeleton::create(joints).value();
  character.jointFromModel.resize(3, Affine3::Identity());
  for (std::size_t v = 0; v < character.mesh.vertices.size(); ++v) {
    character.influenceBegin.push_back(static_cast<std::uint32_t>(v));
    character.influences.push_back({character.mesh.vertices[v].x() < 0.0 ? 1 : 2, 1.0});
  }
  character.influenceBegin.push_back(static_cast<std::uint32_t>(character.mesh.vertices.size()));
  return character;
}

std::map<std::string, double> byName(const std::vector<BoneShare>& bones) {
  std::map<std::string, double> shares;
  for (const BoneShare& bone : bones) shares[bone.bone] = bone.share;
  return shares;
}

Decomposition wholeOf(const TriMesh& mesh) {
  Decomposition whole;
  whole.vertexCount = static_cast<int>(mesh.vertices.size());
  whole.triangleCount = static_cast<int>(mesh.triangles.size());
  whole.parts.resize(1);
  whole.parts[0].triangles = mesh.triangles;
  for (int i = 0; i < whole.triangleCount; ++i) whole.parts[0].sourceTriangle.push_back(i);
  for (int v = 0; v < whole.vertexCount; ++v) whole.parts[0].points.push_back(v);
  return whole;
}

TEST(PartBones, OfAWholeBarAreHalfAndHalf) {
  const Character character = bar();
  const auto bones = bonesOfParts(wholeOf(character.mesh), character);
  ASSERT_EQ(bones.size(), 1u);
  const auto shares = byName(bones[0]);
  ASSERT_EQ(shares.size(), 2u) << "the root moves nothing";
  // The diagonals of the box need not be symmetric, so the two triangles of a long face may favour one side by up to
  // 1/6.
  EXPECT_NEAR(shares.at("left"), 0.5, 1.0 / 6.0);
  EXPECT_NEAR(shares.at("left") + shares.at("right"), 1.0, 1e-12);
}

TEST(PartBones, CutPointsCountAsTheirEndsDoAndCapsDoNot) {
  // One triangle from (0, 0, 0) and (4, 0, 0) of "left" to (0, 3, 0) of "right", cut halfway up its sides: the lower
  // part has corners of weight 1, 1, 1/2, 1/2, the upper one 1/2, 1/2 and 0.
  Character character = bar();
  character.mesh = {{{0, 0, 0}, {4, 0, 0}, {0, 3, 0}}, {{0, 1, 2}}};
  character.influences = {{1, 1.0}, {1, 1.0}, {2, 1.0}};
  character.influenceBegin = {0, 1, 2, 3};
  Decomposition d;
  d.vertexCount = 3;
  d.triangleCount = 1;
  d.cutPoints = {{0, 2, 0.5}, {1, 2, 0.5}};
  d.splitFrom = {0, 0};
  d.parts.resize(3);
  d.parts[0] = {{{0, 1, 4}, {0, 4, 3}}, {0, 0}, {0, 1, 3, 4}};
  d.parts[1] = {{{3, 4, 2}, {2, 4, 3}}, {0, -1}, {2, 3, 4}};
  d.parts[2] = {{{3, 4, 2}}, {-1}, {2, 3, 4}};
  const auto bones = bonesOfParts(d, character);
  ASSERT_EQ(bones.size(), 3u);
  // Areas 3 and 1.5, mean weight of "left" at their corners 5/6 and 2/3.
  EXPECT_NEAR(byName(bones[0]).at("left"), (3.0 * 5.0 / 6.0 + 1.5 * 2.0 / 3.0) / 4.5, 1e-12);
  EXPECT_EQ(bones[0][0].bone, "left");
  EXPECT_NEAR(byName(bones[1]).at("left"), 1.0 / 3.0, 1e-12);
  EXPECT_EQ(bones[1][0].bone, "right");
  EXPECT_TRUE(bones[2].empty());
}

TEST(PartBones, OfTheWholeMannequinAreAsSymmetricAsItIs) {
  const Character character = makeMannequin();
  const auto bones = bonesOfParts(wholeOf(character.mesh), character);
  ASSERT_EQ(bones.size(), 1u);
  double sum = 0.0;
  for (const BoneShare& bone : bones[0]) sum += bone.share;
  EXPECT_NEAR(sum, 1.0, 1e-9);
  EXPECT_TRUE(std::is_sorted(bones[0].begin(), bones[0].end(),
                             [](const BoneShare& a, const BoneShare& b) { return a.share > b.share; }));
  const auto shares = byName(bones[0]);
  for (const char* limb : {"UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot"}) {
    const double left = shares.at(std::string("left") + limb);
    EXPECT_GT(left, 0.001) << limb;
    EXPECT_NEAR(left, shares.at(std::string("right") + limb), 0.01 * left) << limb;
  }
}

}  // namespace
}  // namespace lorica

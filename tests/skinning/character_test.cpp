#include "skinning/character.h"

#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace lorica::test {
namespace {

/// A tetrahedron with two joints; vertex 0 follows both.
Character smallCharacter() {
  Character character;
  character.mesh = makeTetrahedron();
  Joint root;
  root.name = "root";
  Joint tail;
  tail.name = "tail";
  tail.parent = 0;
  character.skeleton = *Skeleton::create({root, tail});
  character.jointFromModel.assign(2, Affine3::Identity());
  character.influences = {{0, 0.25}, {1, 0.75}, {0, 1.0}, {1, 1.0}, {1, 1.0}};
  character.influenceBegin = {0, 2, 3, 4, 5};
  return character;
}

TEST(CheckCharacter, SoundOnePasses) {
  const Result<void> checked = checkCharacter(smallCharacter());
  EXPECT_TRUE(checked.ok()) << checked.error().message;
}

TEST(CheckCharacter, EveryFlawIsNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const struct {
    const char* named;
    std::function<void(Character&)> spoil;
  } flaws[] = {
      {"no joints", [](Character& c) { c.skeleton = Skeleton(); }},
      {"no vertices", [](Character& c) { c.mesh.vertices.clear(); }},
      {"inverse bind", [](Character& c) { c.jointFromModel.pop_back(); }},
      {"influenceBegin", [](Character& c) { c.influenceBegin.pop_back(); }},
      {"influenceBegin", [](Character& c) { c.influenceBegin.back() = 4; }},
      {"influenceBegin", [](Character& c) { c.influenceBegin.front() = 1; }},
      {"vertex 1", [](Character& c) { c.influenceBegin[2] = 1; }},
      {"vertex 0", [](Character& c) { c.influenceBegin[1] = 4000000000u; }},
      {"joint 1", [=](Character& c) { c.jointFromModel[1](0, 3) = nan; }},
      {"triangle 2", [](Character& c) { c.mesh.triangles[2][1] = 4; }},
      {"triangle 0", [](Character& c) { c.mesh.triangles[0][0] = -1; }},
      {"vertex 3", [=](Character& c) { c.mesh.vertices[3].z() = nan; }},
      {"joint 2", [](Character& c) { c.influences[1].joint = 2; }},
      {"joint -1", [](Character& c) { c.influences[1].joint = -1; }},
      {"vertex 1", [=](Character& c) { c.influences[2].weight = nan; }},
      {"vertex 0",
       [](Character& c) {
         c.influences = {{0, -0.25}, {1, 1.25}, {0, 1}, {1, 1}, {1, 1}};
       }},
      {"0.9", [](Character& c) { c.influences[1].weight = 0.65; }},
      {"sum to 0",
       [](Character& c) {
         c.influenceBegin = {0, 0, 2, 3, 5};
       }},
  };
  for (const auto& flaw : flaws) {
    Character character = smallCharacter();
    flaw.spoil(character);
    const Result<void> checked = checkCharacter(character);
    ASSERT_FALSE(checked.ok()) << flaw.named;
    EXPECT_EQ(checked.error().code, ErrorCode::kBadMesh);
    EXPECT_NE(checked.error().message.find(flaw.named), std::string::npos)
        << flaw.named << " in: " << checked.error().message;
  }
}

TEST(CheckCharacter, WeightsMayMissOneByAThousandth) {
  Character character = smallCharacter();
  character.influences[1].weight = 0.7509;
  EXPECT_TRUE(checkCharacter(character).ok());
  character.influences[1].weight = 0.7511;
  EXPECT_FALSE(checkCharacter(character).ok());
}

}  // namespace
}  // namespace lorica::test

#include "acd/decompose.h"
#include "collision/live/live_body.h"
#include "geometry/random_numbers.h"
#include "skinning/body/closed_body.h"
#include "skinning/humanoid/joint_limits.h"
#include "skinning/import/character_file.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/skinning/body/hard_characters.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

namespace lorica {
namespace {

/// A target that pushes the belly of a mannequin forward by up to `depth` [m].
Morphs bellyOf(const Character& mannequin, float depth) {
  const JointIndex spine = mannequin.skeleton.jointOf(HumanBone::kSpine);
  const Vec3 middle = mannequin.jointFromModel[spine].inverse().translation();
  Morphs morphs;
  morphs.targets.push_back({"belly", 0.0F, {}});
  for (std::size_t v = 0; v < mannequin.mesh.vertices.size(); ++v) {
    const Vec3& p = mannequin.mesh.vertices[v];
    const double away = (p - middle).head<2>().norm();
    if (p.z() < middle.z() || away > 0.2) continue;
    const auto share = static_cast<float>(1.0 - away / 0.2);
    morphs.targets[0].offsets.push_back({static_cast<VertexIndex>(v), {0, 0, depth * share}, Vec3f::Zero()});
  }
  return morphs;
}

std::vector<ReachedPosition> reachedBy(const Character& character, const Morphs& morphs, float weight) {
  return reachedPositions(morphs, std::vector<float>{weight}, character.mesh.vertices, kReachTolerance);
}

double farthestFromParts(const LiveBody& body, const Vec3& point) {
  double least = kInfinity;
  for (const LivePart& part : body.parts()) {
    const Vec3 own = part.worldFromPart.inverse() * point;
    least = std::min(least, largestViolation(part.shape, std::span(&own, 1)));
  }
  return least;
}

TEST(ReachedBody, PositionsInTheBodyOrCloseToItAddNothing) {
  const Character mannequin = makeMannequin();
  for (const float depth : {-0.02F, 0.0015F}) {
    ClosedBody body = makeBody(mannequin).value();
    const ClosedBody before = body;
    std::vector<ReachedPosition> reached = reachedBy(mannequin, bellyOf(mannequin, depth), 1.0F);
    if (depth > 0.0F) reached.push_back({0, mannequin.mesh.vertices[0] + Vec3(0.0, 1e-3, 0.0)});
    EXPECT_FALSE(reached.empty());
    EXPECT_EQ(coverReached(body, mannequin, reached), 0);
    EXPECT_EQ(body.character.mesh.vertices, before.character.mesh.vertices);
    EXPECT_EQ(body.notes, before.notes);
  }
}

TEST(ReachedBody, HullsHoldTheLargestWeightsInEveryPose) {
  const Character mannequin = makeMannequin();
  const Morphs morphs = bellyOf(mannequin, 0.12F);
  ClosedBody body = makeBody(mannequin).value();
  const std::size_t before = body.character.mesh.vertices.size();
  const int added = coverReached(body, mannequin, reachedBy(mannequin, morphs, 1.0F));
  ASSERT_GT(added, 20);
  EXPECT_EQ(body.reachedVertices, added);
  EXPECT_EQ(body.character.mesh.vertices.size(), before + static_cast<std::size_t>(added));
  EXPECT_TRUE(checkCharacter(body.character).ok());
  EXPECT_NE(body.notes.back().find("the hulls hold morph targets"), std::string::npos);

  const auto bodyOf = [](const Character& character) {
    const PoseView bind{character.mesh.vertices, static_cast<int>(character.mesh.vertices.size())};
    return LiveBody::create(decompose(character.mesh, bind, {.maxParts = 12}).value(), character).value();
  };
  LiveBody grown = bodyOf(body.character);
  LiveBody bare = bodyOf(mannequin);
  Character fat = mannequin;
  RandomNumbers random(5);
  std::vector<Affine3> worldFromModel(static_cast<std::size_t>(mannequin.skeleton.jointCount()));
  std::vector<Vec3> posed(fat.mesh.vertices.size());
  double farthest = 0.0;
  double halfway = 0.0;
  double farthestOfBare = 0.0;
  for (int pose = 0; pose < 20; ++pose) {
    computeWorldFromJoint(mannequin.skeleton, randomPoseWithinLimits(mannequin.skeleton, random), worldFromModel);
    computeWorldFromModel(mannequin, worldFromModel, worldFromModel);
    grown.update(worldFromModel);
    bare.update(worldFromModel);
    for (const float weight : {1.0F, 0.5F}) {
      applyMorphs(morphs, std::vector<float>{weight}, mannequin.mesh.vertices, {}, fat.mesh.vertices, {});
      skinLinearBlend(fat, worldFromModel, posed);
      for (const MorphOffset& offset : morphs.targets[0].offsets) {
        const double out = farthestFromParts(grown, posed[offset.vertex]);
        (weight == 1.0F ? farthest : halfway) = std::max(weight == 1.0F ? farthest : halfway, out);
        farthestOfBare = std::max(farthestOfBare, farthestFromParts(bare, posed[offset.vertex]));
      }
    }
  }
  EXPECT_LT(farthest, kReachTolerance);
  EXPECT_LT(halfway, 0.01);  // the way there may lead between two hulls
  EXPECT_GT(farthestOfBare, 0.05);
  std::cout << "largest weight " << 1000.0 * farthest << " mm outside, half of it " << 1000.0 * halfway
            << " mm, without growing " << 1000.0 * farthestOfBare << " mm\n";
}

TEST(ReachedBody, AMadeBodyKeepsWhatIsShownAndMeasured) {
  const Character open = test::openMannequin();
  ClosedBody body = makeBody(open).value();
  const ClosedBody before = body;
  ASSERT_TRUE(body.made);
  ASSERT_GT(coverReached(body, open, reachedBy(open, bellyOf(open, 0.12F), 1.0F)), 20);
  EXPECT_EQ(body.character.shown, before.character.shown);
  EXPECT_EQ(body.character.mesh.triangles, before.character.mesh.triangles);
  const std::vector<Affine3> bind(open.jointFromModel.size(), Affine3::Identity());
  EXPECT_EQ(distancesInPose(body, bind).farthestOutside, before.distances.farthestOutside);
}

/// Eyes, brows and mouths move by up to a few centimetres, nearly all of it inside the head.
TEST(ReachedBody, GodettesFacesHardlyLeaveHerHead) {
  LORICA_REQUIRE_DATASET(path, "characters/godette/Godette_vrm_v4.vrm");
  const CharacterFile file = readCharacterFile(path).value();
  const ClosedBody body = makeBody(file.character).value();
  const auto grownFor = [&](const std::vector<float>& chosen) {
    const std::vector<float> used = usedWeightSets(file.morphs, file.expressions, chosen);
    ClosedBody grown = body;
    (void)coverReached(grown, file.character,
                       reachedPositions(file.morphs, used, file.character.mesh.vertices, kReachTolerance));
    return grown;
  };
  std::vector<float> chosen(file.expressions.list.size(), 0.0F);
  EXPECT_EQ(grownFor(chosen).reachedVertices, 0);  // her hulls stay as they are
  int most = 0;
  for (std::size_t e = 0; e < chosen.size(); ++e) {
    chosen.assign(chosen.size(), 0.0F);
    chosen[e] = 1.0F;
    const ClosedBody grown = grownFor(chosen);
    most = std::max(most, grown.reachedVertices);
    if (grown.reachedVertices > 0) std::cout << file.expressions.list[e].name << ": " << grown.notes.back() << "\n";
  }
  EXPECT_LT(most, 40);  // of the face's 630
}

}  // namespace
}  // namespace lorica

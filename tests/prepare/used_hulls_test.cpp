#include "prepare/file_content.h"

#include "acd/decompose.h"
#include "acd/level_of_detail.h"
#include "capture/synthetic/synthetic_motion.h"
#include "collision/live/live_body.h"
#include "prepare/cover_choice.h"
#include "prepare/quality.h"
#include "prepare/training.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

/// The mannequin with a rod of 40 cm in its left hand that no triangle of the body uses.
Character withRod() {
  Character character = makeMannequin();
  const JointIndex hand = character.skeleton.jointOf(HumanBone::kLeftHand);
  const Vec3 grip = character.jointFromModel[hand].inverse().translation();
  for (int k = 0; k <= 20; ++k) {
    character.mesh.vertices.emplace_back(grip + Vec3(0.08, 0.0, 0.02 * k));
    character.influences.push_back({hand, 1.0});
    character.influenceBegin.push_back(static_cast<std::uint32_t>(character.influences.size()));
  }
  return character;
}

TEST(UsedHulls, AreTheHullsThatPlay) {
  const Character character = withRod();
  Host host;
  Motion wave;
  wave.name = "wave";
  wave.joints = synthesizeMotion(SyntheticMotion::kWave);
  const std::vector<Motion> motions = {wave};
  const Training training = test::valueOf(trainingMotions(character, motions, {}, {}));
  for (const int count : {3, kChooseKeyframes}) {
    const Keyframes keyframes = test::valueOf(trainingKeyframes(character, training, count));
    const PoseView poses{keyframes.positions, static_cast<int>(character.mesh.vertices.size())};
    const Decomposition parts = test::valueOf(decompose(character.mesh, poses, {.maxParts = 6}));
    const CoverPoses coverIn = test::valueOf(coverPoses(character, training.motions, 8));
    const HullCover few = test::valueOf(chooseCover(character, parts, coverIn, {std::nullopt, 100}, host));
    const BonePoseView bones{keyframes.worldFromModel, character.skeleton.jointCount()};
    ASSERT_EQ(bones.poseCount(), keyframes.count);
    std::vector<double> errors;
    for (const HullCover& cover : {coverExactly(parts, liftPoints(character, parts)), few}) {
      const UsedHulls hulls = liveHulls(character, parts, cover, bones);
      LiveBody body = test::valueOf(LiveBody::create(parts, character, cover));
      for (int k = 0; k < keyframes.count; ++k) {
        body.update(bones.pose(k));
        for (std::size_t i = 0; i < parts.parts.size(); ++i) {
          const ConvexHull played = worldHull(body.parts()[i]);
          const double volume = signedVolume(played.vertices, played.triangles);
          EXPECT_NEAR(hulls[k][i].volume, volume, 1e-5 * volume) << "keyframe " << k << ", part " << i;
        }
      }
      errors.push_back(measureQuality(character.mesh, poses, hulls).error);
    }
    // Both are larger than the hulls of the parts: one holds the rod, the other has few points too.
    EXPECT_GT(errors[0], measureQuality(character.mesh, poses, hullsOfParts(parts, poses)).error + 0.01);
    EXPECT_GT(errors[1], errors[0]);
  }
}

}  // namespace
}  // namespace lorica

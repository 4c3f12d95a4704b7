// Characters by other artists, each open, torn or in many shells in its own way.

#include "acd/decompose.h"
#include "acd/transfer.h"
#include "collision/live/attached_vertices.h"
#include "collision/live/live_body.h"
#include "skinning/body/closed_body.h"
#include "skinning/import/character_file.h"
#include "skinning/linear_blend.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lorica {
namespace {

struct Shared {
  const char* file;
  bool made;  ///< its surface is not closed, or not one solid
};

void PrintTo(const Shared& shared, std::ostream* out) {
  *out << shared.file;
}

std::span<const Influence> influencesOf(const Character& character, std::size_t v) {
  return std::span(character.influences)
      .subspan(character.influenceBegin[v], character.influenceBegin[v + 1] - character.influenceBegin[v]);
}

double weightOf(std::span<const Influence> influences, std::span<const JointIndex> joints) {
  double sum = 0.0;
  for (const Influence& i : influences) {
    if (std::find(joints.begin(), joints.end(), i.joint) != joints.end()) sum += i.weight;
  }
  return sum;
}

/// The joints of one leg; none if the skeleton is not human.
std::vector<JointIndex> legOf(const Skeleton& skeleton, const std::array<HumanBone, 4>& bones) {
  std::vector<JointIndex> joints;
  for (const HumanBone bone : bones) {
    if (skeleton.jointOf(bone) != kNoJoint) joints.push_back(skeleton.jointOf(bone));
  }
  return joints;
}

/// The largest weight of the right leg in a vertex that the left thigh moves most, and the other way round.
double strayed(const Character& character, std::size_t begin, std::size_t end) {
  const Skeleton& skeleton = character.skeleton;
  const std::vector<JointIndex> left =
      legOf(skeleton, {HumanBone::kLeftUpperLeg, HumanBone::kLeftLowerLeg, HumanBone::kLeftFoot, HumanBone::kLeftToes});
  const std::vector<JointIndex> right = legOf(
      skeleton, {HumanBone::kRightUpperLeg, HumanBone::kRightLowerLeg, HumanBone::kRightFoot, HumanBone::kRightToes});
  double max = 0.0;
  for (std::size_t v = begin; v < end; ++v) {
    const auto influences = influencesOf(character, v);
    const double ofLeft = weightOf(influences, left), ofRight = weightOf(influences, right);
    if (std::max(ofLeft, ofRight) > 0.5) max = std::max(max, std::min(ofLeft, ofRight));
  }
  return max;
}

class SharedCharacter : public testing::TestWithParam<Shared> {};

TEST_P(SharedCharacter, HasABodyAndHullsThatHoldAllThatPeopleSee) {
  LORICA_REQUIRE_DATASET(file, std::string("characters/") + GetParam().file);
  const CharacterFile read = test::valueOf(readCharacterFile(file));
  const Character& original = read.character;
  const ClosedBody made = test::valueOf(makeBody(original));
  const Character& character = made.character;
  const auto bodyVertices = static_cast<std::size_t>(made.bodyVertices);

  ASSERT_TRUE(checkClosedTwoManifold(character.mesh).ok());
  ASSERT_TRUE(checkCharacter(character).ok());
  EXPECT_EQ(made.made, GetParam().made);
  if (made.made) {
    EXPECT_GE(bodyVertices, 5000u);
    EXPECT_LE(bodyVertices, 15000u);
    EXPECT_LT(made.distances.meanToOriginal, 0.2 * made.resolution);
    EXPECT_LT(made.distances.farthestToOriginal, 2.0 * made.resolution);
  }
  // No more weight of the other leg than in the original itself, between the legs.
  EXPECT_LE(strayed(character, 0, bodyVertices), strayed(original, 0, original.mesh.vertices.size()));

  // Decomposed in the bind pose, posed by its own clips: everything visible is in the hulls.
  const PoseView bindPose{character.mesh.vertices, static_cast<int>(character.mesh.vertices.size())};
  const Decomposition parts = test::valueOf(decompose(character.mesh, bindPose, {.maxParts = 12}));
  LiveBody body = LiveBody::create(parts, character).value();
  Pose pose = restPose(character.skeleton);
  std::vector<Affine3> worldFromModel(pose.size());
  std::vector<Vec3> points(static_cast<std::size_t>(parts.pointCount()));
  const auto posed = std::span(points).first(character.mesh.vertices.size());
  const std::vector<std::vector<PointIndex>> attached = attachedVerticesOf(parts, liftPoints(character, parts));
  std::vector<Vec3> own;
  double farthest = 0.0;
  BodyDistances worst;
  const std::size_t clips = std::min<std::size_t>(read.clips.size(), 3);
  for (std::size_t k = 0; k < std::max<std::size_t>(2 * clips, 1); ++k) {
    if (clips > 0) {
      const Clip& clip = read.clips[k / 2];
      sampleClip(clip, (0.3 + 0.4 * static_cast<double>(k % 2)) * clip.seconds, pose);
    }
    computeWorldFromJoint(character.skeleton, pose, worldFromModel);
    computeWorldFromModel(character, worldFromModel, worldFromModel);
    body.update(worldFromModel);
    skinLinearBlend(character, worldFromModel, posed);
    transfer(parts, posed, points);
    for (std::size_t i = 0; i < attached.size(); ++i) {
      const LivePart& part = body.parts()[i];
      const Isometry3 partFromWorld = part.worldFromPart.inverse();
      own.clear();
      for (const auto* held : {&parts.parts[i].points, &attached[i]}) {
        for (const PointIndex p : *held) own.push_back(partFromWorld * points[p]);
      }
      farthest = std::max(farthest, largestViolation(part.shape, own));
    }
    const BodyDistances d = distancesInPose(made, worldFromModel);
    worst.farthestOutside = std::max(worst.farthestOutside, d.farthestOutside);
    worst.meanToOriginal = std::max(worst.meanToOriginal, d.meanToOriginal);
    worst.farthestToOriginal = std::max(worst.farthestToOriginal, d.farthestToOriginal);
  }
  EXPECT_LT(farthest, 1e-5 * character.height);
  EXPECT_LT(worst.meanToOriginal, 0.01 * character.height);
  const double percent = 100.0 / character.height;
  std::cout << bodyVertices << " vertices, voxel " << percent * made.resolution << " % of the height; bind pose: "
            << "to original mean " << percent * made.distances.meanToOriginal << " farthest "
            << percent * made.distances.farthestToOriginal << ", outside farthest "
            << percent * made.distances.farthestOutside << "; clips: mean " << percent * worst.meanToOriginal
            << " farthest " << percent * worst.farthestToOriginal << ", outside " << percent * worst.farthestOutside
            << "\n";
  for (const std::string& note : made.notes) std::cout << "  " << note << "\n";
}

INSTANTIATE_TEST_SUITE_P(Characters, SharedCharacter,
                         testing::Values(Shared{"cesiumman/CesiumMan.glb", false}, Shared{"arnaud/arnaud.fbx", false},
                                         Shared{"greenman/greenman.glb", false}, Shared{"fox/Fox.glb", false},
                                         Shared{"kaykit/Barbarian.glb", true}, Shared{"kaykit/Mage.glb", true},
                                         Shared{"raylib_robot/robot.glb", true},
                                         Shared{"godette/Godette_vrm_v4.vrm", true}));

}  // namespace
}  // namespace lorica

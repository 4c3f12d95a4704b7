#include "skinning/body/mesh_body.h"

#include "acd/decompose.h"
#include "acd/transfer.h"
#include "collision/live/attached_vertices.h"
#include "collision/live/live_body.h"
#include "geometry/random_numbers.h"
#include "skinning/body/closed_body.h"
#include "skinning/humanoid/joint_limits.h"
#include "skinning/import/character_file.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "skinning/morphs/expressions.h"
#include "tests/skinning/body/hard_characters.h"
#include "tests/support/damaged_meshes.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <iostream>
#include <numbers>

namespace lorica::test {
namespace {

/// A sphere of radius 1 whose top is missing.
TriMesh bowl() {
  TriMesh mesh = makeSphere(1.0, 48, 64);
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return mesh.vertices[t[0]].y() > 0.8; });
  return mesh;
}

TEST(MeshBody, IsClosedAndHasTheVolumeOfWhatIsBelowTheHole) {
  const TriMesh mesh = bowl();
  const MeshBody body = valueOf(makeMeshBody(mesh));
  EXPECT_TRUE(checkClosedTwoManifold(body.mesh));
  const double ball = 4.0 / 3.0 * std::numbers::pi;
  const double cap = std::numbers::pi * 0.04 * (3.0 - 0.2) / 3.0;  // of height 0.2
  const double volume = signedVolume(body.mesh.vertices, body.mesh.triangles);
  EXPECT_GT(volume, 0.97 * (ball - cap));
  EXPECT_LT(volume, ball);
  EXPECT_GT(body.resolution, 0.0);
  EXPECT_LE(body.distances.meanToOriginal, body.resolution);
  EXPECT_LE(body.distances.farthestOutside, body.resolution);
}

TEST(MeshBody, EndsWithTheOriginalVertices) {
  TriMesh mesh = bowl();
  mesh.vertices.emplace_back(1e6, 0, 0);  // that no triangle uses
  const MeshBody body = valueOf(makeMeshBody(mesh));
  ASSERT_EQ(body.mesh.vertices.size(), mesh.vertices.size() + static_cast<std::size_t>(body.firstOriginal));
  EXPECT_TRUE(std::equal(mesh.vertices.begin(), mesh.vertices.end(), body.mesh.vertices.begin() + body.firstOriginal));
  for (const Triangle& t : body.mesh.triangles) {
    for (const VertexIndex v : t) EXPECT_LT(v, body.firstOriginal);
  }
}

TEST(MeshBody, DoesNotDependOnTheUnit) {
  const MeshBody one = makeMeshBody(bowl()).value();
  for (const double scale : {1e-6, 1e-3, 1e3, 1e9}) {
    TriMesh mesh = bowl();
    for (Vec3& p : mesh.vertices) p = scale * p + scale * Vec3(0.3, 0.2, 0.1);
    const MeshBody other = valueOf(makeMeshBody(mesh));
    EXPECT_EQ(other.mesh.triangles, one.mesh.triangles) << scale;
    EXPECT_NEAR(other.resolution / scale, one.resolution, 1e-9);
    EXPECT_NEAR(other.distances.meanToOriginal / scale, one.distances.meanToOriginal, 1e-9);
    EXPECT_NEAR(other.distances.farthestOutside / scale, one.distances.farthestOutside, 1e-9);
  }
}

TEST(MeshBody, ResolutionIsInTheMeshsUnit) {
  TriMesh mesh = bowl();
  for (Vec3& p : mesh.vertices) p *= 100.0;
  BodySettings settings;
  settings.resolution = 8.0;
  EXPECT_DOUBLE_EQ(makeMeshBody(mesh, settings).value().resolution, 8.0);
}

TEST(MeshBody, AClosedMeshIsRebuiltToo) {
  const MeshBody body = valueOf(makeMeshBody(makeLShape()));
  EXPECT_GT(body.firstOriginal, 12);
  EXPECT_NEAR(signedVolume(body.mesh.vertices, body.mesh.triangles), 3.0, 0.1);
}

/// A ball with a blade and a needle, both far thinner than a voxel, and with a hole.
TEST(MeshBody, HoldsWhatIsThinnerThanItsVoxels) {
  const TriMesh blade = makeBox({0.5, -0.5, -0.002}, {2.5, 0.5, 0.002});
  const TriMesh needle = makeBox({-0.002, 0.5, -0.002}, {0.002, 3.0, 0.002});
  TriMesh mesh = joined(joined(makeSphere(1.0, 24, 32), blade), needle);
  mesh.triangles.erase(mesh.triangles.begin() + 300);
  const MeshBody body = valueOf(makeMeshBody(mesh));
  ASSERT_GT(body.resolution, 0.02);
  EXPECT_TRUE(checkClosedTwoManifold(body.mesh));
  EXPECT_LE(body.distances.farthestOutside, 0.5 * body.resolution);
  // A voxel or two thick.
  const double ball = 4.0 / 3.0 * std::numbers::pi, outside = 1.6;  // of the blade
  const double volume = signedVolume(body.mesh.vertices, body.mesh.triangles);
  EXPECT_GT(volume, 0.98 * ball);
  EXPECT_LT(volume, ball + 2.0 * body.resolution * outside + 4.0 * body.resolution * body.resolution * 2.5);
}

TEST(MeshBody, HasTheCornersOfTheMesh) {
  const TriMesh mesh = makeBox({0, 0, 0}, {1, 2, 3});
  const MeshBody body = valueOf(makeMeshBody(mesh));
  const double volume = signedVolume(body.mesh.vertices, body.mesh.triangles);
  EXPECT_NEAR(volume, 6.0, 0.1);
  for (const Vec3& corner : mesh.vertices) {
    double nearest = kInfinity;
    for (VertexIndex v = 0; v < body.firstOriginal; ++v) {
      nearest = std::min(nearest, (body.mesh.vertices[v] - corner).norm());
    }
    EXPECT_LE(nearest, 1e-9) << corner.transpose();
  }
}

TEST(MeshBody, EveryDamagedTorusGetsOne) {
  const TriMesh torus = makeTorus(1.0, 0.4, 32, 20);
  const double volume = signedVolume(torus.vertices, torus.triangles);
  for (const DamagedMesh& damaged : damagedMeshes(torus)) {
    const Result<MeshBody> body = makeMeshBody(damaged.mesh);
    ASSERT_TRUE(body) << damaged.damage << ": " << body.error().message;
    EXPECT_TRUE(checkClosedTwoManifold(body->mesh)) << damaged.damage;
    const double made = signedVolume(body->mesh.vertices, body->mesh.triangles);
    if (damaged.damage == "a fifth cut off") continue;
    EXPECT_NEAR(made, volume, 0.05 * volume) << damaged.damage;
  }
}

TEST(MeshBody, WithoutSizeThereIsNone) {
  EXPECT_FALSE(makeMeshBody({}));
  EXPECT_FALSE(makeMeshBody({{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {{0, 1, 2}}}));
  EXPECT_FALSE(makeMeshBody({{{0, 0, 0}, {1e300, 0, 0}, {0, 1e308, -1e308}}, {{0, 1, 2}}}));
}

TEST(MeshBody, AFlatMeshIsRefusedInASentence) {
  // In any plane.
  for (const Vec3& normal : {Vec3(0.0, 0.0, 1.0), Vec3(1.0, 2.0, 3.0)}) {
    TriMesh quad{{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
    for (Vec3& p : quad.vertices) p = rotationBetween(Vec3(Vec3::UnitZ()), normal) * p;
    const Result<MeshBody> body = makeMeshBody(quad);
    ASSERT_FALSE(body);
    EXPECT_EQ(body.error().message, "it is exactly flat and has no volume to cut, give it a thickness");
  }
}

TEST(MeshBody, OfTooManyLayersIsRefusedInASentence) {
  // Every triangle is near every test point: 1,000 boxes look at 300,000,000, and 3,000 took minutes.
  for (const int boxes : {10, 1000}) {
    TriMesh nested;
    for (int i = 0; i < boxes; ++i) {
      const TriMesh box = makeBox(Vec3::Constant(-1.0 - 1e-3 * i), Vec3::Constant(1.0 + 1e-3 * i));
      const VertexIndex first = countOf(nested.vertices);
      nested.vertices.insert(nested.vertices.end(), box.vertices.begin(), box.vertices.end());
      for (const Triangle& t : box.triangles) {
        nested.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      }
    }
    const Result<MeshBody> body = makeMeshBody(nested);
    ASSERT_EQ(body.ok(), boxes == 10);
    if (boxes == 1000) {
      EXPECT_NE(body.error().message.find("in too many layers"), std::string::npos);
    }
  }
}

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

// Characters by other artists, each open, torn or in many shells in its own way.

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
}  // namespace lorica::test

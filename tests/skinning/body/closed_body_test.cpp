#include "skinning/body/closed_body.h"

#include "geometry/random_numbers.h"
#include "skinning/body/limbs.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/skinning/body/hard_characters.h"
#include "tests/support/has.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

std::span<const Influence> influencesOf(const Character& character, std::size_t v) {
  return std::span(character.influences)
      .subspan(character.influenceBegin[v], character.influenceBegin[v + 1] - character.influenceBegin[v]);
}

double volumeOf(const Character& character) {
  return signedVolume(character.mesh.vertices, character.mesh.triangles);
}

bool hasNote(const ClosedBody& body, const std::string& part) {
  return std::any_of(body.notes.begin(), body.notes.end(),
                     [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

/// Checks the guarantees of every body, whatever its input.
void expectSound(const ClosedBody& body) {
  EXPECT_TRUE(checkClosedTwoManifold(body.character.mesh).ok());
  const Result<void> checked = checkCharacter(body.character);
  EXPECT_TRUE(checked.ok()) << checked.error().message;
  const auto bodyVertices = static_cast<VertexIndex>(body.bodyVertices);
  for (const Triangle& t : body.character.mesh.triangles) {
    EXPECT_LT(std::max({t[0], t[1], t[2]}), bodyVertices);
  }
  std::vector<bool> used(body.character.mesh.vertices.size(), false);
  for (const auto* triangles : {&body.character.mesh.triangles, &body.character.shown}) {
    for (const Triangle& t : *triangles) {
      for (const VertexIndex v : t) used[v] = true;
    }
  }
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 0) << "invisible vertices need not be covered";
  for (std::size_t v = 0; v < static_cast<std::size_t>(bodyVertices) && body.made; ++v) {
    EXPECT_LE(influencesOf(body.character, v).size(), 8u);
  }
}

/// A character of one joint.
Character rigid(const TriMesh& mesh) {
  Character character = test::bonesAt({{"root", kNoJoint, Vec3::Zero()}});
  test::add(character, mesh, 0);
  return test::finished(std::move(character));
}

TEST(Body, AClosedMeshStaysAsItIs) {
  const Character mannequin = makeMannequin();
  const ClosedBody body = test::valueOf(makeBody(mannequin));
  expectSound(body);
  EXPECT_FALSE(body.made);
  EXPECT_EQ(body.shells, 1);
  EXPECT_EQ(body.resolution, 0.0);
  EXPECT_TRUE(body.notes.empty());
  EXPECT_TRUE(body.character.shown.empty());
  EXPECT_EQ(body.character.mesh.vertices, mannequin.mesh.vertices);
  EXPECT_EQ(body.character.mesh.triangles, mannequin.mesh.triangles);
  EXPECT_EQ(body.character.height, mannequin.height);
  EXPECT_EQ(body.distances.farthestOutside, 0.0);
}

TEST(Body, ASeamIsWeldedAndKeepsItsWeights) {
  const Character mannequin = makeMannequin();
  const ClosedBody body = test::valueOf(makeBody(test::unindexed(mannequin)));
  expectSound(body);
  EXPECT_FALSE(body.made);
  ASSERT_EQ(body.character.mesh.vertices.size(), mannequin.mesh.vertices.size());
  EXPECT_TRUE(hasNote(body, "welded"));
  EXPECT_DOUBLE_EQ(volumeOf(body.character), volumeOf(mannequin));
  // Vertices are in another order: those of the first triangle come first.
  for (std::size_t k = 0; k < mannequin.mesh.triangles.size(); k += 97) {
    const auto was = static_cast<std::size_t>(mannequin.mesh.triangles[k][0]);
    const auto is = static_cast<std::size_t>(body.character.mesh.triangles[k][0]);
    EXPECT_EQ(body.character.mesh.vertices[is], mannequin.mesh.vertices[was]);
    double sum = 0.0;
    for (const Influence& i : influencesOf(body.character, is)) {
      for (const Influence& j : influencesOf(mannequin, was)) {
        if (i.joint == j.joint) sum += std::min(i.weight, j.weight);
      }
    }
    EXPECT_NEAR(sum, 1.0, 1e-9);
  }
}

TEST(Body, WhereWeldedVerticesDifferTheMeanOfTheirWeightsIsTaken) {
  Character box = test::bonesAt({{"a", kNoJoint, Vec3::Zero()}, {"b", 0, Vec3(0.5, 0.5, 0.5)}});
  TriMesh left = test::makeBox(Vec3(0, 0, 0), Vec3(1, 1, 1));
  TriMesh right = left;
  right.triangles.assign(left.triangles.begin() + 6, left.triangles.end());
  left.triangles.resize(6);
  test::add(box, left, 0);
  test::add(box, right, 1);
  const ClosedBody body = test::valueOf(makeBody(test::finished(box)));
  expectSound(body);
  EXPECT_FALSE(body.made);
  EXPECT_EQ(body.bodyVertices, 8);
  EXPECT_TRUE(hasNote(body, "their mean is used"));
  int shared = 0;
  for (std::size_t v = 0; v < 8; ++v) {
    const auto influences = influencesOf(body.character, v);
    if (influences.size() == 1) continue;
    ++shared;
    EXPECT_DOUBLE_EQ(influences[0].weight, 0.5);
    EXPECT_DOUBLE_EQ(influences[1].weight, 0.5);
  }
  EXPECT_GT(shared, 0);
}

TEST(Body, WhatIsInsideOutIsTurned) {
  TriMesh box = test::makeBox(Vec3(0, 0, 0), Vec3(1, 1, 1));
  for (Triangle& t : box.triangles) std::swap(t[1], t[2]);
  const ClosedBody body = test::valueOf(makeBody(rigid(box)));
  EXPECT_FALSE(body.made);
  EXPECT_NEAR(volumeOf(body.character), 1.0, 1e-12);
  EXPECT_TRUE(hasNote(body, "inside out"));
}

TEST(Body, NonManifoldEdgesOfAClosedMeshAreRepaired) {
  const ClosedBody body =
      test::valueOf(makeBody(rigid(test::makeVoxelSurface({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 1}, {1, 1, 1}}))));
  expectSound(body);
  EXPECT_FALSE(body.made);
  EXPECT_NEAR(volumeOf(body.character), 5.0, 1e-12);
}

TEST(Body, ShellsThatAreApartStayAsTheyAre) {
  const ClosedBody body = test::valueOf(makeBody(
      rigid(test::joined(test::makeBox(Vec3(0, 0, 0), Vec3(1, 1, 1)), test::makeBox(Vec3(2, 0, 0), Vec3(3, 1, 1))))));
  EXPECT_FALSE(body.made);
  EXPECT_EQ(body.shells, 2);
}

// The volumes of these solids are known. Smoothing rounds edges, which costs 2 % at this coarse resolution.
TEST(Body, OverlappingShellsBecomeOneSurface) {
  const TriMesh two = test::joined(test::makeBox(Vec3(0, 0, 0), Vec3(1, 1, 1)),
                                   test::makeBox(Vec3(0.5, 0.25, 0.25), Vec3(2, 0.75, 0.75)));
  const ClosedBody body = test::valueOf(makeBody(rigid(two)));
  expectSound(body);
  EXPECT_TRUE(body.made);
  EXPECT_NEAR(volumeOf(body.character), 1.25, 0.02);
  EXPECT_EQ(connectedComponents(body.character.mesh.vertices.size(), body.character.mesh.triangles).count, 1);
  EXPECT_EQ(body.shells, 2);
  EXPECT_LT(body.distances.farthestToOriginal, body.resolution);
  EXPECT_LT(body.distances.farthestOutside, std::sqrt(3.0) * body.resolution);  // corners are rounded
  EXPECT_EQ(body.character.mesh.vertices.size(), static_cast<std::size_t>(body.bodyVertices) + 16);
}

TEST(Body, WhatLiesInsideCountsOnce) {
  for (const bool insideOut : {false, true}) {
    TriMesh eye = test::makeSphere(0.3, 12, 16);
    if (insideOut) {
      for (Triangle& t : eye.triangles) std::swap(t[1], t[2]);
    }
    const TriMesh head = test::makeSphere(1.0, 24, 32);
    const ClosedBody body = test::valueOf(makeBody(rigid(test::joined(head, eye))));
    expectSound(body);
    EXPECT_NEAR(volumeOf(body.character), signedVolume(head.vertices, head.triangles), 0.02);
  }
}

TEST(Body, ASheetAloneEnclosesNothing) {
  TriMesh sheet;
  sheet.vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  for (const bool both : {false, true}) {
    if (both) sheet.triangles.insert(sheet.triangles.end(), {{0, 2, 1}, {0, 3, 2}});
    const Error body = test::errorOf(makeBody(rigid(sheet)));
    EXPECT_EQ(body.code, ErrorCode::kBadMesh);
    EXPECT_TRUE(test::has(body.message, "enclose nothing thicker than"));
  }
}

TEST(Body, DegenerateInputIsRefusedInWords) {
  Character none = rigid({});
  EXPECT_EQ(makeBody(none).error().code, ErrorCode::kBadMesh);
  Character points = rigid({{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {}});
  EXPECT_TRUE(test::has(makeBody(points).error().message, "3 vertices and 0 triangles"));
  Character needle = rigid({{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)}, {{0, 1, 2}, {0, 1, 1}}});
  EXPECT_EQ(makeBody(needle).error().code, ErrorCode::kBadMesh);
  Character spot = rigid({{Vec3(1, 1, 1), Vec3(1, 1, 1), Vec3(1, 1, 1)}, {{0, 1, 2}}});
  EXPECT_EQ(makeBody(spot).error().code, ErrorCode::kBadMesh);
  Character broken = rigid(test::makeTetrahedron());
  broken.mesh.vertices[0].x() = std::nan("");
  EXPECT_EQ(makeBody(broken).error().code, ErrorCode::kBadMesh);
  Character open = rigid(test::makeBox(Vec3(0, 0, 0), Vec3(1, 1, 1)));
  open.mesh.triangles.pop_back();
  EXPECT_EQ(makeBody(open, {.resolution = -1.0}).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(makeBody(open, {.resolution = std::nan("")}).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(makeBody(open, {.threads = -1}).error().code, ErrorCode::kInvalidArgument);
  const Error fine = test::errorOf(makeBody(open, {.resolution = 1e-6}));
  EXPECT_EQ(fine.code, ErrorCode::kInvalidArgument);
  test::expectAll(fine.message, {"voxels of 1e-06 m", "expected voxels of at least 0."});
  EXPECT_EQ(test::errorOf(makeBody(open, {.resolution = 0.13})).message,
            "body resolution 0.13 m: expected at most 0.125 m, an eighth of the character's longest side");
}

/// Thin closed things tell how fine the voxels have to be, and open surfaces how large the grid is.
TEST(Body, AChosenResolutionIsNeverTooFineForTheGrid) {
  TriMesh corner = test::makeBox(Vec3(0, 0, 0), Vec3(1, 1, 1));
  corner.triangles.resize(6);
  const TriMesh crumb = test::makeBox(Vec3(1.5, 0, 0), Vec3(1.501, 0.001, 0.001));
  const Character both = rigid(test::joined(corner, crumb));
  const ClosedBody body = test::valueOf(makeBody(both));
  EXPECT_GT(body.resolution, 0.0);
  EXPECT_LT(body.resolution, 0.01);
}

TEST(Body, CanBeCancelledAtEveryStep) {
  const Character boxes =
      rigid(test::joined(test::makeBox(Vec3(0, 0, 0), Vec3(1, 1, 1)), test::makeBox(Vec3(0.5, 0, 0), Vec3(2, 1, 1))));
  int calls = 0;
  int last = -1;
  BodySettings settings{.resolution = 0.1};
  settings.progress = [&](int done, int steps) {
    EXPECT_GT(done, last);
    EXPECT_LE(done, steps);
    last = done;
    ++calls;
    return true;
  };
  ASSERT_TRUE(makeBody(boxes, settings).ok());
  EXPECT_GE(calls, 4);
  for (int at = 0; at + 1 < calls; ++at) {
    int k = 0;
    settings.progress = [&](int, int) { return k++ < at; };
    const Result<ClosedBody> body = makeBody(boxes, settings);
    ASSERT_FALSE(body.ok()) << at;
    EXPECT_EQ(body.error().code, ErrorCode::kCancelled);
  }
}

TEST(Body, DoesNotDependOnThreads) {
  const Character torn = test::tornMannequin(40);
  const Result<ClosedBody> one = makeBody(torn, {.resolution = 0.03, .threads = 1});
  const Result<ClosedBody> three = makeBody(torn, {.resolution = 0.03, .threads = 3});
  ASSERT_TRUE(one.ok() && three.ok());
  EXPECT_EQ(one->character.mesh.vertices, three->character.mesh.vertices);
  EXPECT_EQ(one->character.mesh.triangles, three->character.mesh.triangles);
  ASSERT_EQ(one->character.influences.size(), three->character.influences.size());
  for (std::size_t i = 0; i < one->character.influences.size(); ++i) {
    ASSERT_EQ(one->character.influences[i].joint, three->character.influences[i].joint);
    ASSERT_EQ(one->character.influences[i].weight, three->character.influences[i].weight);
  }
  EXPECT_EQ(one->distances.meanOutside, three->distances.meanOutside);
}

TEST(BodyDistances, AgreeWithAClosedForm) {
  // A body of 2 m in the middle of a visible box of 2.4 m, which is 0.2 m outside, or more at edges and corners.
  ClosedBody body;
  body.made = true;
  body.bodyVertices = 8;
  body.character = rigid(test::makeBox(Vec3::Constant(-1.0), Vec3::Constant(1.0)));
  const std::vector<Triangle> own = body.character.mesh.triangles;
  test::add(body.character, test::makeBox(Vec3::Constant(-1.2), Vec3::Constant(1.2)), 0);
  body.character.shown.assign(body.character.mesh.triangles.begin() + 12, body.character.mesh.triangles.end());
  body.character.mesh.triangles = own;
  Affine3 pose = Affine3::Identity();
  for (int k = 0; k < 2; ++k) {
    const std::vector<Affine3> worldFromModel{pose};
    const BodyDistances d = distancesInPose(body, worldFromModel);
    EXPECT_NEAR(d.farthestOutside, 0.2 * std::sqrt(3.0), 1e-12);
    EXPECT_NEAR(d.meanToOriginal, 0.2, 1e-12);
    EXPECT_NEAR(d.farthestToOriginal, 0.2, 1e-12);
    // The mean over the large box: 0.2 on faces; along borders, where the distance increases, by integration.
    double mean = 0.0;
    constexpr int kCells = 600;
    for (int i = 0; i < kCells; ++i) {
      for (int j = 0; j < kCells; ++j) {
        const auto beyond = [](int c) { return std::max(0.0, std::abs(-1.2 + 2.4 * (c + 0.5) / kCells) - 1.0); };
        mean += Vec3(0.2, beyond(i), beyond(j)).norm() / (kCells * kCells);
      }
    }
    EXPECT_NEAR(d.meanOutside, mean, 1e-3);
    // The same at any position.
    pose = Eigen::Translation3d(3.0, -2.0, 1.0) * Eigen::AngleAxisd(1.0, Vec3(1, 2, 3).normalized());
  }
}

TEST(Limbs, TellWhatTouchesFromWhatBends) {
  const Character mannequin = makeMannequin();
  const Limbs limbs(mannequin);
  const auto joint = [&](HumanBone bone) { return mannequin.skeleton.jointOf(bone); };
  const auto positionOf = [&](HumanBone bone) -> Vec3 {
    return mannequin.jointFromModel[joint(bone)].inverse().translation();
  };
  const JointIndex leftThigh = joint(HumanBone::kLeftUpperLeg), rightThigh = joint(HumanBone::kRightUpperLeg);
  const JointIndex leftShin = joint(HumanBone::kLeftLowerLeg), forearm = joint(HumanBone::kLeftLowerArm);
  const Vec3 crotch = positionOf(HumanBone::kHips) - Vec3(0, 0.12, 0);
  const Vec3 knees = 0.5 * (positionOf(HumanBone::kLeftLowerLeg) + positionOf(HumanBone::kRightLowerLeg));
  for (int turn = 0; turn < 2; ++turn) {
    const auto apart = [&](JointIndex a, JointIndex b, const Vec3& at) {
      return turn == 0 ? limbs.apart(a, b, at) : limbs.apart(b, a, at);
    };
    EXPECT_FALSE(apart(leftThigh, rightThigh, crotch));
    EXPECT_TRUE(apart(leftThigh, rightThigh, knees));
    EXPECT_TRUE(apart(leftShin, rightThigh, knees));
    EXPECT_FALSE(apart(leftThigh, leftShin, positionOf(HumanBone::kLeftLowerLeg)));
    EXPECT_FALSE(apart(joint(HumanBone::kHips), leftThigh, positionOf(HumanBone::kLeftUpperLeg)));
    EXPECT_FALSE(apart(joint(HumanBone::kSpine), leftThigh, positionOf(HumanBone::kHips) + Vec3(0.15, 0, 0)));
    EXPECT_FALSE(apart(joint(HumanBone::kHips), joint(HumanBone::kChest), positionOf(HumanBone::kSpine)));
    EXPECT_TRUE(apart(forearm, joint(HumanBone::kChest), positionOf(HumanBone::kChest)));
    EXPECT_TRUE(apart(joint(HumanBone::kLeftHand), leftThigh, positionOf(HumanBone::kLeftUpperLeg) - Vec3(0, 0.4, 0)));
    EXPECT_TRUE(apart(joint(HumanBone::kLeftHand), joint(HumanBone::kRightHand), positionOf(HumanBone::kChest)));
    EXPECT_FALSE(
        apart(joint(HumanBone::kLeftUpperArm), joint(HumanBone::kChest), positionOf(HumanBone::kLeftUpperArm)));
    EXPECT_FALSE(apart(leftThigh, leftThigh, knees));
  }
  EXPECT_TRUE(limbs.onOneBranch(joint(HumanBone::kHips), leftShin));
  EXPECT_TRUE(limbs.onOneBranch(leftShin, joint(HumanBone::kHips)));
  EXPECT_FALSE(limbs.onOneBranch(leftThigh, rightThigh));
  EXPECT_FALSE(limbs.onOneBranch(leftShin, rightThigh));
}

}  // namespace
}  // namespace lorica

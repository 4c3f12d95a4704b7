#include "skinning/morphs/shapes.h"

#include "geometry/work_budgets.h"
#include "skinning/linear_blend.h"
#include "skinning/morphs/expressions.h"
#include "tests/skinning/random_pose.h"
#include "tests/support/allocations.h"
#include "tests/support/has.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

namespace lorica {
namespace {

using test::randomVector;
using test::uniform;

/// A box of random positions over a chain of joints with random inverse bind matrices; each vertex follows one to
/// three.
Character randomCharacter(std::mt19937& random, int jointCount, int vertexCount) {
  Character character;
  character.name = "random";
  std::vector<Joint> joints;
  for (int j = 0; j < jointCount; ++j) {
    joints.push_back({"joint " + std::to_string(j), j - 1, {randomVector(random, 0.5)}, {}});
    character.jointFromModel.emplace_back(Eigen::Translation3d(randomVector(random, 1.0)) *
                                          test::randomRotation(random));
  }
  character.skeleton = test::valueOf(Skeleton::create(std::move(joints)));
  character.influenceBegin.push_back(0);
  for (int v = 0; v < vertexCount; ++v) {
    character.mesh.vertices.push_back(randomVector(random, 1.0));
    const int count = 1 + v % 3;
    for (int i = 0; i < count; ++i) character.influences.push_back({(v + i) % jointCount, 1.0 / count});
    character.influenceBegin.push_back(static_cast<std::uint32_t>(character.influences.size()));
  }
  for (int v = 0; v + 2 < vertexCount; ++v) character.mesh.triangles.push_back({v, v + 1, v + 2});
  character.height = 2.0;
  return character;
}

/// Targets that each move every third vertex by up to `size`, the second with a default weight.
Morphs randomTargets(std::mt19937& random, int targetCount, int vertexCount, double size) {
  Morphs morphs;
  for (int t = 0; t < targetCount; ++t) {
    MorphTarget target{"target " + std::to_string(t), t == 1 ? 0.25F : 0.0F, {}};
    for (int v = t % 3; v < vertexCount; v += 3) {
      target.offsets.push_back({v, randomVector(random, size).cast<float>(), Vec3f::Zero()});
    }
    morphs.targets.push_back(std::move(target));
  }
  return morphs;
}

/// A clip of all targets' weights at random keys, and a turn of joint 0.
Clip addClip(std::mt19937& random, KeyInterpolation interpolation, Morphs& morphs) {
  MorphWeightTrack track{0, static_cast<int>(morphs.targets.size()), interpolation, {0.25, 0.5, 1.5}, {}};
  const std::size_t values = track.times.size() * morphs.targets.size();
  for (std::size_t i = 0; i < values * (interpolation == KeyInterpolation::kCubicSpline ? 3 : 1); ++i) {
    track.values.push_back(static_cast<float>(uniform(random, -1.5, 1.5)));
  }
  morphs.clips.push_back({track});
  Clip clip{"clip", 1.5, {}};
  clip.tracks.push_back(
      {0,
       {},
       KeyTrack<Quat>{KeyInterpolation::kLinear, {0.0, 1.5}, {Quat::Identity(), test::randomRotation(random)}},
       {}});
  return clip;
}

Expressions noExpressions(const Morphs& morphs) {
  Expressions expressions;
  for (const MorphTarget& target : morphs.targets) expressions.baseWeights.push_back(target.defaultWeight);
  return expressions;
}

std::vector<Affine3> bonesIn(const Character& character, std::span<const JointTransform> pose) {
  std::vector<Affine3> bones(character.skeleton.jointCount());
  computeWorldFromJoint(character.skeleton, pose, bones);
  computeWorldFromModel(character, bones, bones);
  return bones;
}

std::vector<Vec3> skinned(const Character& character, std::span<const JointTransform> pose) {
  std::vector<Vec3> posed(character.mesh.vertices.size());
  skinLinearBlend(character, bonesIn(character, pose), posed);
  return posed;
}

/// The truth morphs the bind pose first and skins it then, as glTF says.
TEST(Shapes, PosesOfAClipAreTheMorphedBindPoseSkinned) {
  for (const KeyInterpolation interpolation :
       {KeyInterpolation::kStep, KeyInterpolation::kLinear, KeyInterpolation::kCubicSpline}) {
    for (unsigned seed = 0; seed < 6; ++seed) {
      SCOPED_TRACE(seed);
      std::mt19937 random(seed);
      const int vertices = 7 + 11 * static_cast<int>(seed);
      const Character plain = randomCharacter(random, 2 + static_cast<int>(seed), vertices);
      Morphs morphs = randomTargets(random, 1 + static_cast<int>(seed), vertices, 0.8);
      std::vector<Clip> clips = {addClip(random, interpolation, morphs), {"still", 1.0, {}}};
      morphs.clips.emplace_back();
      Character shaped = plain;
      const int count = addShapes(shaped, clips, morphs, noExpressions(morphs));
      EXPECT_EQ(count, static_cast<int>(morphs.targets.size()));
      ASSERT_TRUE(checkCharacter(shaped).ok()) << checkCharacter(shaped).error().message;
      EXPECT_EQ(shaped.mesh.vertices, plain.mesh.vertices);
      for (const double time : {0.0, 0.25, 0.3, 0.5, 0.77, 1.49, 1.5, 2.0}) {
        Pose pose = test::randomPose(shaped.skeleton, random, false);
        for (std::size_t j = plain.jointFromModel.size(); j < pose.size(); ++j) {
          pose[j] = shaped.skeleton.joint(static_cast<JointIndex>(j)).rest;
        }
        sampleClip(clips[0], time, pose);
        std::vector<float> weights = noExpressions(morphs).baseWeights;
        sampleMorphWeights(morphs.clips[0], time, weights);
        Character morphed = plain;
        applyMorphs(morphs, weights, plain.mesh.vertices, {}, morphed.mesh.vertices, {});
        const std::vector<Vec3> truth = skinned(morphed, std::span(pose).first(plain.jointFromModel.size()));
        const std::vector<Vec3> posed = skinned(shaped, pose);
        for (std::size_t v = 0; v < truth.size(); ++v) {
          ASSERT_LT((posed[v] - truth[v]).norm(), 1e-5) << "vertex " << v << " at " << time;
        }
      }
    }
  }
}

TEST(Shapes, NothingMovesInTheBindPoseAndInAClipWithoutWeights) {
  std::mt19937 random(7);
  const Character plain = randomCharacter(random, 4, 40);
  Morphs morphs = randomTargets(random, 5, 40, 0.5);
  std::vector<Clip> clips = {addClip(random, KeyInterpolation::kLinear, morphs)};
  Character shaped = plain;
  ASSERT_GT(addShapes(shaped, clips, morphs, noExpressions(morphs)), 0);
  const std::vector<Affine3> bind(shaped.jointFromModel.size(), Affine3::Identity());
  std::vector<Vec3> posed(shaped.mesh.vertices.size());
  const long before = test::allocationCount();
  skinLinearBlend(shaped, bind, posed);
  EXPECT_EQ(test::allocationCount(), before);
  std::vector<Vec3> truth(posed.size());
  skinLinearBlend(plain, std::span(bind).first(plain.jointFromModel.size()), truth);
  EXPECT_EQ(posed, truth);
  const std::vector<Vec3> resting = skinned(shaped, restPose(shaped.skeleton));
  const std::vector<Vec3> plainResting = skinned(plain, restPose(plain.skeleton));
  for (std::size_t v = 0; v < resting.size(); ++v) EXPECT_LT((resting[v] - plainResting[v]).norm(), 1e-12);
}

TEST(Shapes, SmallMotionsAndWeightsThatStayAreNone) {
  std::mt19937 random(8);
  const Character plain = randomCharacter(random, 3, 30);
  struct Case {
    double size;
    float weight;
    int shapes;
  };
  // The diagonal is some 3 m, of which a fiftieth counts.
  for (const Case& c : {Case{0.5, 1.0F, 1}, {0.01, 1.0F, 0}, {0.01, 20.0F, 1}, {0.5, 0.0F, 0}, {0.5, 0.01F, 0}}) {
    Morphs morphs = randomTargets(random, 3, 30, c.size);
    morphs.clips = {{MorphWeightTrack{1, 2, KeyInterpolation::kLinear, {0.0, 1.0}, {0.25F, 0.0F, 0.25F, c.weight}}}};
    std::vector<Clip> clips = {{"clip", 1.0, {}}};
    Character shaped = plain;
    EXPECT_EQ(addShapes(shaped, clips, morphs, noExpressions(morphs)), c.shapes) << c.size << " " << c.weight;
    EXPECT_EQ(shaped.shapes.empty(), c.shapes == 0);
    EXPECT_EQ(clips[0].tracks.empty(), c.shapes == 0);
    EXPECT_EQ(shaped.skeleton.jointCount() == plain.skeleton.jointCount(), c.shapes == 0);
  }
}

TEST(Shapes, TooManyAreNone) {
  std::mt19937 random(10);
  const Character plain = randomCharacter(random, 40, 60);
  for (const int targets : {10, 100}) {  // each moves vertices of all 40 joints; there may be 2,048
    Morphs morphs = randomTargets(random, targets, 60, 0.5);
    std::vector<Clip> clips = {addClip(random, KeyInterpolation::kLinear, morphs)};
    Character shaped = plain;
    const int made = addShapes(shaped, clips, morphs, noExpressions(morphs));
    EXPECT_EQ(made, targets == 10 ? 10 : kTooManyShapes);
    EXPECT_EQ(shaped.shapes.empty(), targets != 10);
    EXPECT_LE(static_cast<std::size_t>(shaped.skeleton.jointCount()), kMaxJoints);
  }
}

/// A body of other vertices, as welding and closing make it, follows its surface.
TEST(Shapes, ABodyIsDeformedAsItsSurface) {
  const TriMesh box = test::makeBox(Vec3(-0.5, 0.0, -0.5), Vec3(0.5, 2.0, 0.5));
  std::vector<Vec3> frames = box.vertices;
  for (const Vec3& p : box.vertices) frames.emplace_back(p.x() + 0.5 * p.y(), p.y(), p.z());  // sheared
  PlayedMesh played = test::valueOf(playedMesh("box", box, frames, std::vector<double>{0.0, 1.0}));
  Character body;
  body.skeleton = played.character.skeleton;
  body.jointFromModel = played.character.jointFromModel;
  body.mesh.vertices = {Vec3(0.5, 1.0, 0.2), Vec3(-0.5, 0.5, -0.5), Vec3(0.1, 2.0, 0.3)};
  body.mesh.vertices.insert(body.mesh.vertices.end(), box.vertices.begin(), box.vertices.end());
  body.mesh.triangles = {{0, 1, 2}};
  const std::size_t count = body.mesh.vertices.size();
  body.influences.assign(count, {0, 1.0});
  for (std::size_t v = 0; v <= count; ++v) body.influenceBegin.push_back(static_cast<std::uint32_t>(v));
  carryShapes(played.character, 3, body);
  body.mesh.vertices.emplace_back(0.0, 9.0, 0.0);  // one more, which nothing deforms
  body.influences.push_back({0, 1.0});
  body.influenceBegin.push_back(static_cast<std::uint32_t>(count + 1));
  ASSERT_TRUE(checkCharacter(body).ok());
  Pose pose = restPose(body.skeleton);
  sampleClip(played.clip, 0.5, pose);
  const std::vector<Vec3> posed = skinned(body, pose);
  for (std::size_t v = 0; v < count; ++v) {
    const Vec3& p = body.mesh.vertices[v];
    EXPECT_LT((posed[v] - Vec3(p.x() + 0.25 * p.y(), p.y(), p.z())).norm(), 1e-6) << v;
  }
  EXPECT_EQ(posed.back(), Vec3(0.0, 9.0, 0.0));
}

TEST(Shapes, AMeshPlaysItsFramesLinearly) {
  for (const std::size_t frameCount : {1u, 2u, 3u, 20u}) {
    SCOPED_TRACE(frameCount);
    std::mt19937 random(static_cast<unsigned>(frameCount));
    TriMesh mesh = test::makeLShape();
    const std::size_t vertices = mesh.vertices.size();
    std::vector<Vec3> frames = mesh.vertices;
    std::vector<double> times = {0.5};
    for (std::size_t f = 1; f < frameCount; ++f) {
      times.push_back(times.back() + uniform(random, 0.01, 0.2));
      for (const Vec3& p : mesh.vertices) frames.emplace_back(p + randomVector(random, 1.0));
    }
    const PlayedMesh played = test::valueOf(playedMesh("soft", mesh, frames, times));
    EXPECT_EQ(played.character.mesh.triangles, mesh.triangles);
    EXPECT_EQ(played.clip.seconds, times.back());
    Pose pose = restPose(played.character.skeleton);
    const auto expect = [&](double time, std::size_t from, double share) {
      sampleClip(played.clip, time, pose);
      const std::vector<Vec3> posed = skinned(played.character, pose);
      const std::size_t to = std::min(from + 1, frameCount - 1);
      for (std::size_t v = 0; v < vertices; ++v) {
        const Vec3 truth = (1.0 - share) * frames[from * vertices + v] + share * frames[to * vertices + v];
        ASSERT_LT((posed[v] - truth).norm(), 1e-6) << "vertex " << v << " at " << time;
      }
    };
    for (std::size_t f = 0; f < frameCount; ++f) {
      expect(times[f], f, 0.0);
      if (f + 1 < frameCount) expect(times[f] + 0.3 * (times[f + 1] - times[f]), f, 0.3);
    }
    expect(0.0, 0, 0.0);
    expect(times.back() + 1.0, frameCount - 1, 0.0);
  }
}

TEST(Shapes, FramesThatDoNotFitAreRefused) {
  const TriMesh mesh = test::makeTetrahedron();
  std::vector<Vec3> frames = mesh.vertices;
  frames.insert(frames.end(), mesh.vertices.begin(), mesh.vertices.end());
  const auto refused = [&](std::vector<Vec3> positions, std::vector<double> times, const char* said) {
    const Error error = test::errorOf(playedMesh("soft", mesh, positions, times));
    test::expectAll(error.message, {said});
  };
  refused(frames, {0.0}, "found 8 positions for 1 frames of 4 vertices");
  refused({}, {}, "found 0 positions");
  refused(frames, {1.0, 1.0}, "frame 1 is at 1 s");
  refused(frames, {-1.0, 1.0}, "frame 0 is at -1 s");
  refused(frames, {0.0, std::numeric_limits<double>::infinity()}, "frame 1 is at inf s");
  frames[5].x() = std::numeric_limits<double>::quiet_NaN();
  refused(frames, {0.0, 1.0}, "not finite");
}

TEST(Shapes, WhatDoesNotFitACharacterIsRefused) {
  std::mt19937 random(9);
  const Character plain = randomCharacter(random, 2, 10);
  const auto refused = [&](const auto& change) {
    Character character = plain;
    character.shapes.append(std::vector<ShapeOffset>{{1, Vec3::UnitX()}});
    EXPECT_TRUE(checkCharacter(character).ok());
    change(character.shapes);
    EXPECT_FALSE(checkCharacter(character).ok());
  };
  refused([](Shapes& shapes) { shapes.offsets[0].joint = 0; });  // a root
  refused([](Shapes& shapes) { shapes.offsets[0].joint = 2; });
  refused([](Shapes& shapes) { shapes.offsets[0].joint = -1; });
  refused([](Shapes& shapes) { shapes.offsets[0].offset.x() = std::numeric_limits<double>::infinity(); });
  refused([](Shapes& shapes) { shapes.begin = {0, 2}; });
  refused([](Shapes& shapes) { shapes.begin = {1, 0}; });
  refused([](Shapes& shapes) { shapes.begin.assign(12, 1); });
}

}  // namespace
}  // namespace lorica

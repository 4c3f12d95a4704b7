#include "skinning/morphs/morphs.h"

#include "tests/support/allocations.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lorica {
namespace {

/// Random targets over `vertexCount` vertices, each of which moves about half of them.
[[nodiscard]] Morphs randomMorphs(std::mt19937& random, int targetCount, int vertexCount) {
  std::uniform_real_distribution<float> number(-1.0F, 1.0F);
  Morphs morphs;
  for (int t = 0; t < targetCount; ++t) {
    MorphTarget target;
    target.name = "target " + std::to_string(t);
    target.defaultWeight = t % 2 == 0 ? 0.0F : 0.25F;
    for (int v = 0; v < vertexCount; ++v) {
      if (number(random) > 0.0F) continue;
      target.offsets.push_back(
          {v, {number(random), number(random), number(random)}, {number(random), number(random), number(random)}});
    }
    morphs.targets.push_back(std::move(target));
  }
  return morphs;
}

TEST(Morphs, DefaultWeightsAreTheBindPose) {
  std::mt19937 random(1);
  const Morphs morphs = randomMorphs(random, 4, 10);
  const std::vector<Vec3> bind(10, Vec3(1.0, 2.0, 3.0));
  const std::vector<Vec3f> bindNormals(10, Vec3f::UnitY());
  std::vector<Vec3> positions(10);
  std::vector<Vec3f> normals(10);
  std::vector<float> weights(4);
  defaultWeights(morphs, weights);
  applyMorphs(morphs, weights, bind, bindNormals, positions, normals);
  EXPECT_EQ(positions, bind);
  EXPECT_EQ(normals, bindNormals);
}

TEST(Morphs, SparseTargetsGiveWhatDenseOnesDo) {
  constexpr int kVertices = 50;
  constexpr int kTargets = 6;
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> number(-1.0F, 1.5F);
    const Morphs morphs = randomMorphs(random, kTargets, kVertices);
    std::vector<Vec3> bind;
    std::vector<Vec3f> bindNormals;
    for (int v = 0; v < kVertices; ++v) {
      bind.emplace_back(number(random), number(random), number(random));
      bindNormals.push_back(Vec3f(number(random), number(random), 2.0F).normalized());
    }
    std::vector<float> weights;
    for (int t = 0; t < kTargets; ++t) weights.push_back(t == 3 ? 0.25F : number(random));

    std::vector<Vec3> positions(kVertices);
    std::vector<Vec3f> normals(kVertices);
    applyMorphs(morphs, weights, bind, bindNormals, positions, normals);

    for (int v = 0; v < kVertices; ++v) {
      Vec3 position = bind[v];
      Vec3 normal = bindNormals[v].cast<double>();
      for (int t = 0; t < kTargets; ++t) {
        const double factor = static_cast<double>(weights[t]) - morphs.targets[t].defaultWeight;
        for (const MorphOffset& offset : morphs.targets[t].offsets) {
          if (offset.vertex != v) continue;
          position += factor * offset.position.cast<double>();
          normal += factor * offset.normal.cast<double>();
        }
      }
      EXPECT_LT((positions[v] - position).norm(), 1e-6);
      EXPECT_LT((normals[v].cast<double>() - normal.normalized()).norm(), 1e-4);
    }
  }
}

TEST(Morphs, MeshesWithoutNormalsAreMovedToo) {
  std::mt19937 random(3);
  const Morphs morphs = randomMorphs(random, 1, 4);
  const std::vector<Vec3> bind(4, Vec3::Zero());
  std::vector<Vec3> positions(4);
  const std::vector<float> weights = {1.0F};
  applyMorphs(morphs, weights, bind, {}, positions, {});
  for (const MorphOffset& offset : morphs.targets[0].offsets) {
    EXPECT_EQ(positions[offset.vertex], offset.position.cast<double>());
  }
}

TEST(Morphs, TracksAreInterpolatedAsGltfDefines) {
  MorphWeightTrack track{1, 2, KeyInterpolation::kLinear, {1.0, 3.0}, {0.0F, 1.0F, 1.0F, 0.5F}};
  const auto at = [&](double time) {
    std::vector<float> weights = {9.0F, 9.0F, 9.0F};
    sampleMorphWeights(std::span(&track, 1), time, weights);
    EXPECT_EQ(weights[0], 9.0F);  // it has no track
    return std::pair(weights[1], weights[2]);
  };
  EXPECT_EQ(at(-5.0), std::pair(0.0F, 1.0F));
  EXPECT_EQ(at(2.0), std::pair(0.5F, 0.75F));
  EXPECT_EQ(at(99.0), std::pair(1.0F, 0.5F));
  track.interpolation = KeyInterpolation::kStep;
  EXPECT_EQ(at(2.9), std::pair(0.0F, 1.0F));
  EXPECT_EQ(at(3.0), std::pair(1.0F, 0.5F));

  // The cubic 2 t^3 - t + 1 of the time since the first key, with its slopes as tangents; the second target is
  // constant.
  track.interpolation = KeyInterpolation::kCubicSpline;
  const auto cubic = [](double s) { return 2.0 * s * s * s - s + 1.0; };
  const auto slope = [](double s) { return 6.0 * s * s - 1.0; };
  track.values.clear();
  for (const double s : {0.0, 2.0}) {
    const auto m = static_cast<float>(slope(s));
    track.values.insert(track.values.end(), {m, 0.0F, static_cast<float>(cubic(s)), 0.5F, m, 0.0F});
  }
  for (const double time : {1.0, 1.3, 2.0, 2.71, 3.0}) {
    EXPECT_NEAR(at(time).first, cubic(time - 1.0), 1e-5);
    EXPECT_NEAR(at(time).second, 0.5, 1e-6);
  }
}

TEST(Morphs, AFrameAllocatesNothing) {
  std::mt19937 random(5);
  const Morphs morphs = randomMorphs(random, 3, 100);
  const std::vector<Vec3> bind(100, Vec3::Zero());
  const std::vector<Vec3f> bindNormals(100, Vec3f::UnitX());
  std::vector<Vec3> positions(100);
  std::vector<Vec3f> normals(100);
  std::vector<float> weights(3);
  const MorphWeightTrack track{0, 3, KeyInterpolation::kLinear, {0.0, 1.0}, {0, 0, 0, 1, 1, 1}};
  const long before = test::allocationCount();
  ASSERT_GT(before, 0);
  defaultWeights(morphs, weights);
  sampleMorphWeights(std::span(&track, 1), 0.5, weights);
  applyMorphs(morphs, weights, bind, bindNormals, positions, normals);
  EXPECT_EQ(test::allocationCount() - before, 0);
}

}  // namespace
}  // namespace lorica

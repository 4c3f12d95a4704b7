#include "geometry/files.h"
#include "tests/acd/parts.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

namespace lorica {
namespace {

/// A torus in two keyframes, the second deformed. Positions are on a coarse grid, so that they do not depend on the
/// math library.
struct Subject {
  Subject() : mesh(test::makeTorus(1.0, 0.4, 40, 20)) {
    for (Vec3& v : mesh.vertices) v = snapped(v);
    for (int k = 0; k < 2; ++k) {
      for (const Vec3& v : mesh.vertices) keyframes.push_back(snapped(v + Vec3(0.0, 0.0, k * v.x() * v.x() * 0.3)));
    }
  }
  static Vec3 snapped(const Vec3& v) {
    return {std::round(v.x() * 1024.0) / 1024.0, std::round(v.y() * 1024.0) / 1024.0,
            std::round(v.z() * 1024.0) / 1024.0};
  }
  TriMesh mesh;
  std::vector<Vec3> keyframes;
};

/// Expected hashes for every compiler, optimization level and number of threads. If the algorithm changes, update them
/// and increase kAlgorithmVersion in acd/decompose.h.
class SameEverywhere : public ::testing::TestWithParam<std::tuple<DecomposePreset, const char*>> {};

TEST_P(SameEverywhere, HashOfTheResult) {
  const Subject subject;
  const auto [preset, expected] = GetParam();
  for (const int threads : {1, 2, 3, 8}) {
    const Decomposition d = test::decomposed(subject.mesh, {subject.keyframes, countOf(subject.mesh.vertices)},
                                             {.maxParts = 7, .preset = preset, .threads = threads});
    EXPECT_EQ(hexDigits(hashOf(d)), expected) << threads << " threads";
  }
}

INSTANTIATE_TEST_SUITE_P(Presets, SameEverywhere,
                         ::testing::Values(std::tuple(DecomposePreset::kPaper, "c792b853036b8116"),
                                           std::tuple(DecomposePreset::kFast, "2bf1589230d92d3e"),
                                           std::tuple(DecomposePreset::kQuality, "d563b875ec9165c9")));

}  // namespace
}  // namespace lorica

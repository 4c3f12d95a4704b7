#include "geometry/counts.h"
#include "tests/skinning/import/agreement.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <fstream>

namespace lorica {
namespace {

/// Every shared character, at rest and in every clip.
class GltfSpecification : public testing::TestWithParam<const char*> {};

TEST_P(GltfSpecification, SkinnedPositionsAgreeWithAnIndependentEvaluation) {
  LORICA_REQUIRE_DATASET(path, GetParam());
  const CharacterFile file = test::valueOf(readCharacterFile(path));
  const test::GltfTruth truth = test::GltfTruth::ofFile(path);
  ASSERT_EQ(countOf(file.clips), truth.animationCount());
  const double tolerance = 1e-5 * file.character.height;
  ASSERT_GT(tolerance, 0.0);

  EXPECT_LE(test::farthestFromTruth(file, truth, -1, 0.0), tolerance);
  double worst = 0.0;
  for (int clip = 0; clip < truth.animationCount(); ++clip) {
    const double seconds = truth.seconds(clip);
    EXPECT_NEAR(file.clips[clip].seconds, seconds, 1e-12);
    for (const double part : {0.0, 0.3819, 1.0}) {
      const double far = test::farthestFromTruth(file, truth, clip, part * seconds);
      EXPECT_LE(far, tolerance) << "clip " << clip << " at " << part * seconds << " s";
      worst = std::max(worst, far);
    }
  }
  RecordProperty("farthestOfHeight", std::to_string(worst / file.character.height));
}

INSTANTIATE_TEST_SUITE_P(Shared, GltfSpecification,
                         testing::Values("characters/cesiumman/CesiumMan.glb", "characters/fox/Fox.glb",
                                         "characters/greenman/greenman.glb", "characters/kaykit/Barbarian.glb",
                                         "characters/kaykit/Mage.glb", "characters/raylib_robot/robot.glb",
                                         "characters/godette/Godette_vrm_v4.vrm"));

TEST(GltfFile, EveryShortenedFileIsRefusedInASentence) {
  LORICA_REQUIRE_DATASET(path, "characters/cesiumman/CesiumMan.glb");
  std::ifstream in(path, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  for (std::size_t length = 0; length < whole.size(); length += length < 200 ? 1 : 997) {
    const std::string part = whole.substr(0, length);
    const Result<CharacterFile> file = parseCharacterFile(std::as_bytes(std::span(part)), "man.glb");
    ASSERT_FALSE(file.ok()) << length;
    EXPECT_EQ(file.error().message.substr(0, 9), "man.glb: ") << length;
  }
}

}  // namespace
}  // namespace lorica

#include "geometry/counts.h"
#include "tests/skinning/import/agreement.h"
#include "tests/skinning/import/random_glb.h"

#include <gtest/gtest.h>

#include <set>

namespace lorica {
namespace {

TEST(GltfRandom, EveryMixOfFeaturesAgreesWithTheSpecification) {
  int compared = 0;
  int clipsSeen = 0;
  std::set<int> influences;
  int withCopies = 0;
  int withShear = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    const std::string glb = test::randomGlb(seed);
    const Result<CharacterFile> file = parseCharacterFile(std::as_bytes(std::span(glb)), "random.glb");
    const test::GltfTruth truth(glb);
    if (truth.triangles(-1, 0.0).empty()) continue;
    ASSERT_TRUE(file.ok()) << file.error().message;
    EXPECT_EQ(file->repairedVertices, 0);
    const double tolerance = 1e-5 * boundsOf(file->character.mesh.vertices).diagonal();
    EXPECT_LE(test::farthestFromTruth(*file, truth, -1, 0.0), tolerance);
    ++compared;
    influences.insert(file->maxInfluences);
    for (const std::string& note : file->notes) {
      withCopies += note.find("more than one bind matrix") != std::string::npos ? 1 : 0;
      withShear += note.find("sheared") != std::string::npos ? 1 : 0;
    }
    // A clip of nodes that move nothing is skipped; only then do the lists differ.
    if (countOf(file->clips) != truth.animationCount()) continue;
    for (int clip = 0; clip < truth.animationCount(); ++clip) {
      ++clipsSeen;
      for (const double time : {-1.0, 0.3, 0.71, 1.4, 2.0, 9.0}) {
        EXPECT_LE(test::farthestFromTruth(*file, truth, clip, time), tolerance) << "clip " << clip << " at " << time;
      }
    }
  }
  EXPECT_GT(compared, 300);
  EXPECT_GT(clipsSeen, 200);
  EXPECT_GT(withCopies, 20);
  EXPECT_GT(withShear, 100);
  EXPECT_EQ(*influences.rbegin(), 8);
}

}  // namespace
}  // namespace lorica

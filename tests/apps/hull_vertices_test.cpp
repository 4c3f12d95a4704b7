#include "geometry/convex_hull.h"
#include "geometry/mesh_files.h"
#include "tests/apps/mesh_text.h"
#include "tests/apps/run_command.h"

#include <gtest/gtest.h>

namespace lorica::test {
namespace {

TEST(HullVertices, ExportedHullsKeepTheBudgetAndHoldTheMesh) {
  const TemporaryFolder folder;
  const TriMesh ball = makeSphere(1.0, 12, 18);
  const std::filesystem::path mesh = writeObj(folder, "ball.obj", ball);
  const std::filesystem::path hulls = folder.path() / "hulls.obj";
  const CommandResult result =
      runLorica({"decompose", mesh, "--parts", "1", "--hull-vertices", "24", "--export-obj", hulls, "--json", "-"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const nlohmann::json json = result.json();
  const Result<std::vector<NamedMesh>> objects = readObjObjects(hulls);
  ASSERT_TRUE(objects.ok());
  ASSERT_EQ(objects->size(), 1u);
  const ConvexHull exported = convexHull(objects->front().mesh.vertices);
  EXPECT_LE(exported.vertices.size(), 24u);
  EXPECT_LE(largestViolation(exported, ball.vertices), 1e-8);  // numbers in the file have nine digits
  EXPECT_EQ(json["hullVertices"], 24);
  const double growth = exported.volume / convexHull(ball.vertices).volume;
  EXPECT_NEAR(json["hullGrowth"].get<double>(), growth, 1e-8);
  ASSERT_EQ(json["hullGrowthPerPart"].size(), 1u);
  EXPECT_NEAR(json["hullGrowthPerPart"][0].get<double>(), growth, 1e-8);
  EXPECT_GT(growth, 1.0);
  EXPECT_LT(growth, 1.2);
}

TEST(HullVertices, GrowthIsReportedWithoutAnExportToo) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "ball.obj", makeSphere(1.0, 12, 18));
  const CommandResult result = runLorica({"decompose", mesh, "--parts", "1", "--hull-vertices", "24"});
  EXPECT_EQ(result.exitCode, 0) << result.err;
  EXPECT_NE(result.out.find("at most 24, before 200"), std::string::npos) << result.out;
  const CommandResult without = runLorica({"decompose", mesh, "--parts", "1", "--json", "-"});
  EXPECT_FALSE(without.json().contains("hullGrowth"));
}

TEST(HullVertices, BoxesNeedNoMore) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "l.obj", makeLShape());
  const CommandResult result = runLorica({"decompose", mesh, "--hull-vertices", "32", "--json", "-"});
  EXPECT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.json()["hullGrowth"], 1.0);
}

TEST(HullVertices, TooFewForACharacterSayWhatHelps) {
  const CommandResult result = runLorica({"decompose", "mannequin", "--parts", "2", "--hull-vertices", "4"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_NE(result.err.find("allow more vertices\n"), std::string::npos) << result.err;
}

TEST(HullVertices, FewerThanFourAreRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "l.obj", makeLShape());
  for (const char* bad : {"3", "0", "-1", "many", "32.5"}) {
    const CommandResult result = runLorica({"decompose", mesh, "--hull-vertices", bad});
    EXPECT_EQ(result.exitCode, 2) << bad;
    EXPECT_NE(result.err.find("--hull-vertices"), std::string::npos) << result.err;
    EXPECT_NE(result.err.find(bad), std::string::npos) << result.err;
  }
}

}  // namespace
}  // namespace lorica::test

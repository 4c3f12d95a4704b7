#include "tests/apps/mesh_text.h"
#include "tests/apps/run_command.h"

#include <gtest/gtest.h>

namespace lorica::test {
namespace {

TEST(Score, DecomposedLShapeIsPerfect) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "l.obj", makeLShape());
  const std::filesystem::path hulls = folder.path() / "hulls.obj";
  ASSERT_EQ(runLorica({"decompose", mesh, "--parts", "2", "--export-obj", hulls}).exitCode, 0);
  const CommandResult result = runLorica({"score", mesh, hulls, "--json", "-"});
  EXPECT_EQ(result.exitCode, 0) << result.err;
  const nlohmann::json json = result.json();
  EXPECT_EQ(json["parts"], 2);
  EXPECT_NEAR(json["score16"].get<double>(), 1.0, 1e-6 + 3 * json["score16StandardError"].get<double>());
  EXPECT_NEAR(json["score17"].get<double>(), 1.0, 1e-6);
  EXPECT_NEAR(json["distance"].get<double>(), 0.0, 1e-6);
  EXPECT_NEAR(json["distancePercentDiagonal"].get<double>(), 0.0, 1e-4);
  EXPECT_NEAR(json["uncoveredFraction"].get<double>(), 0.0, 1e-4);
}

TEST(Score, OneHullOfTheLShapeHasItsClosedForm) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "l.obj", makeLShape());
  // The mesh as its own single part: its hull has volume 3.5, the mesh 3.
  const nlohmann::json json = runLorica({"score", mesh, mesh, "--json", "-"}).json();
  EXPECT_EQ(json["parts"], 1);
  EXPECT_NEAR(json["score17"].get<double>(), 3.0 / 3.5, 1e-9);
  // No sample of the mesh can be outside its own hull: the estimate is exact.
  EXPECT_NEAR(json["score16"].get<double>(), 3.0 / 3.5, 1e-9);
  EXPECT_EQ(json["score16StandardError"], 0.0);
  EXPECT_NEAR(json["uncoveredFraction"].get<double>(), 0.0, 1e-4);
}

TEST(Score, HalfOfABoxLeavesHalfUncovered) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "box.obj", makeBox({0, 0, 0}, {2, 1, 1}));
  const std::filesystem::path half = writeObj(folder, "half.obj", makeBox({0, 0, 0}, {1, 1, 1}));
  const nlohmann::json json = runLorica({"score", mesh, half, "--json", "-"}).json();
  EXPECT_NEAR(json["score16"].get<double>(), 0.5, 5 * json["score16StandardError"].get<double>());
  EXPECT_GT(json["score16StandardError"].get<double>(), 0.0);
  EXPECT_NEAR(json["score17"].get<double>(), 2.0, 1e-9);
  EXPECT_NEAR(json["uncoveredFraction"].get<double>(), 0.5, 0.01);
}

TEST(Score, PartsOfAnotherMeshCauseAWarning) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "box.obj", makeBox({0, 0, 0}, {1, 1, 1}));
  // At another position; in another unit, so that they cover everything; too small.
  for (const TriMesh& other : {makeBox({5, 0, 0}, {6, 1, 1}), makeBox({-500, -500, -500}, {500, 500, 500}),
                               makeBox({0.4, 0.4, 0.4}, {0.6, 0.6, 0.6})}) {
    const CommandResult result = runLorica({"score", mesh, writeObj(folder, "other.obj", other), "--json", "-"});
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_EQ(result.err.rfind("lorica: warning: ", 0), 0u) << result.err;
    EXPECT_NE(result.err.find("other.obj: these may be parts of another mesh"), std::string::npos) << result.err;
    EXPECT_TRUE(result.json().contains("warning"));
  }
  const CommandResult own = runLorica({"score", mesh, mesh, "--json", "-"});
  EXPECT_EQ(own.err, "");
  EXPECT_FALSE(own.json().contains("warning"));
}

TEST(Score, PartsWithoutVolumeAreRefusedByFile) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "box.obj", makeBox({0, 0, 0}, {1, 1, 1}));
  const std::filesystem::path flat = folder.write("flat.obj", "o flat\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const CommandResult result = runLorica({"score", mesh, flat, "--json", "-"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_NE(result.err.find("flat.obj"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace lorica::test

#include "tests/apps/mesh_text.h"
#include "tests/apps/run_command.h"

#include <gtest/gtest.h>

namespace lorica::test {
namespace {

TEST(Info, DescribesAClosedMesh) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "l.obj", makeLShape());
  const CommandResult result = runLorica({"info", mesh, "--json", "-"});
  EXPECT_EQ(result.exitCode, 0) << result.err;
  const nlohmann::json json = result.json();
  EXPECT_EQ(json["kind"], "mesh");
  EXPECT_EQ(json["vertices"], 12);
  EXPECT_EQ(json["triangles"], 20);
  EXPECT_EQ(json["components"], 1);
  EXPECT_EQ(json["closed"], true);
  EXPECT_TRUE(json["problem"].is_null());
  EXPECT_NEAR(json["volume"].get<double>(), 3.0, 1e-12);
  EXPECT_NEAR(json["convexity"].get<double>(), 3.0 / 3.5, 1e-12);
  EXPECT_EQ(json["boundingBox"], nlohmann::json::parse("[[0.0,0.0,0.0],[2.0,2.0,1.0]]"));
}

TEST(Info, SaysWhatIsWrongWithAnOpenMesh) {
  const TemporaryFolder folder;
  TriMesh mesh = makeBox({0, 0, 0}, {1, 1, 1});
  mesh.triangles.pop_back();
  const CommandResult result = runLorica({"info", writeObj(folder, "open.obj", mesh), "--json", "-"});
  EXPECT_EQ(result.exitCode, 0) << "to look at a broken mesh is no error: " << result.err;
  const nlohmann::json json = result.json();
  EXPECT_EQ(json["closed"], false);
  EXPECT_NE(json["problem"].get<std::string>().find("edge"), std::string::npos) << json["problem"];
}

TEST(Info, CountsComponents) {
  const TemporaryFolder folder;
  const TriMesh mesh = joined(makeBox({0, 0, 0}, {1, 1, 1}), makeBox({2, 0, 0}, {3, 1, 1}));
  EXPECT_EQ(runLorica({"info", writeObj(folder, "two.obj", mesh), "--json", "-"}).json()["components"], 2);
}

TEST(Info, DescribesTheMannequin) {
  const nlohmann::json json = runLorica({"info", "mannequin", "--json", "-"}).json();
  EXPECT_EQ(json["kind"], "character");
  EXPECT_EQ(json["closed"], true) << json["problem"];
  EXPECT_GE(json["joints"].get<int>(), 22);
  EXPECT_LE(json["influencesAtMost"].get<int>(), 4);
  EXPECT_NEAR(json["height"].get<double>(), 1.75, 0.1);
}

TEST(Info, DescribesARecording) {
  const nlohmann::json byName = runLorica({"info", "walk", "--json", "-"}).json();
  EXPECT_EQ(byName["kind"], "recording");
  EXPECT_NEAR(byName["framesPerSecond"].get<double>(), 30.0, 0.1);
  EXPECT_GE(byName["seconds"].get<double>(), 5.0);
  EXPECT_NEAR(byName["jointsSeen"].get<double>() + byName["jointsGuessed"].get<double>() +
                  byName["jointsUnknown"].get<double>(),
              1.0, 1e-12);
  EXPECT_EQ(runLorica({"info", recordingsFolder() / "walk.csv", "--json", "-"}).json(), byName);
}

}  // namespace
}  // namespace lorica::test

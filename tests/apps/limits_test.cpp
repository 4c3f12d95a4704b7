// Limits hold, and figures are true, on the hulls that are exported.

#include "geometry/convex_hull.h"
#include "geometry/mesh_files.h"
#include "geometry/triangle_tree.h"
#include "tests/apps/mesh_text.h"
#include "tests/apps/run_command.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lorica::test {
namespace {

/// What is measured on the exported hulls, by other means than the command's.
struct Measured {
  double hullVolume = 0.0;
  double distance = 0.0;  // of a vertex of a hull from the mesh: not more than the largest distance of a hull
  std::size_t vertices = 0;
};

Measured measure(const std::filesystem::path& hulls, const TriMesh& mesh) {
  Measured measured;
  const TriangleTree surface(mesh.vertices, mesh.triangles);
  const Result<std::vector<NamedMesh>> objects = readObjObjects(hulls);
  EXPECT_TRUE(objects.ok());
  for (const NamedMesh& object : *objects) {
    measured.hullVolume += signedVolume(object.mesh.vertices, object.mesh.triangles);
    measured.vertices = std::max(measured.vertices, object.mesh.vertices.size());
    for (const Vec3& p : object.mesh.vertices) {
      if (surface.windingNumber(p) < 0.5) measured.distance = std::max(measured.distance, surface.distance(p));
    }
  }
  return measured;
}

class Limits : public ::testing::Test {
 protected:
  /// Runs the command on a torus and compares its figures with those of the hulls that it wrote.
  CommandResult runOn(const TriMesh& mesh, std::vector<std::string> arguments) {
    const std::filesystem::path file = writeObj(folder_, "mesh.obj", mesh);
    const std::filesystem::path hulls = folder_.path() / "hulls.obj";
    arguments.insert(arguments.begin(), {"decompose", file});
    arguments.insert(arguments.end(), {"--export-obj", hulls, "--json", "-"});
    CommandResult result = runLorica(arguments);
    EXPECT_EQ(result.exitCode, 0) << result.err;
    json_ = result.json();
    measured_ = measure(hulls, mesh);
    const double volume = signedVolume(mesh.vertices, mesh.triangles);
    EXPECT_NEAR(json_["hullVolume"].get<double>(), measured_.hullVolume, 1e-7 * volume);
    EXPECT_NEAR(json_["error"].get<double>(), measured_.hullVolume / volume - 1.0, 1e-7);
    EXPECT_NEAR(json_["score"].get<double>(), volume / measured_.hullVolume, 1e-7);
    if (json_.contains("distance")) {
      EXPECT_GE(json_["distance"].get<double>(), measured_.distance - 1e-7);
    }
    return result;
  }

  TemporaryFolder folder_;
  nlohmann::json json_;
  Measured measured_;
};

TEST_F(Limits, FiguresAreThoseOfEnlargedHulls) {
  const TriMesh torus = makeTorus(1.0, 0.4, 32, 16);
  runOn(torus, {"--parts", "6"});
  const double exact = measured_.hullVolume;
  const CommandResult result = runOn(torus, {"--parts", "6", "--hull-vertices", "12"});
  EXPECT_TRUE(result.err.empty()) << result.err;
  EXPECT_GT(measured_.hullVolume, 1.02 * exact);
  EXPECT_LE(measured_.vertices, 12u);
}

TEST_F(Limits, ErrorHoldsOnHullsOfFewVertices) {
  const TriMesh torus = makeTorus(1.0, 0.4, 32, 16);
  runOn(torus, {"--max-error", "10%"});
  const int before = json_["parts"];
  const CommandResult result = runOn(torus, {"--max-error", "10%", "--hull-vertices", "12"});
  EXPECT_EQ(json_["endedBy"], "error");
  EXPECT_LE(measured_.hullVolume, (1.1 + 1e-7) * signedVolume(torus.vertices, torus.triangles));
  EXPECT_LE(measured_.vertices, 12u);
  EXPECT_GT(json_["parts"].get<int>(), before);
  EXPECT_NE(result.err.find("--hull-vertices 12 will, and --max-error 10.0 % will not"), std::string::npos)
      << result.err;
}

TEST_F(Limits, DistanceHoldsOnHullsOfFewVertices) {
  const TriMesh torus = makeTorus(1.0, 0.4, 32, 16);
  runOn(torus, {"--max-distance", "0.2"});
  const int before = json_["parts"];
  runOn(torus, {"--max-distance", "0.2", "--hull-vertices", "16"});
  EXPECT_EQ(json_["endedBy"], "distance");
  EXPECT_GT(json_["parts"].get<int>(), before);
  EXPECT_LE(measured_.distance, 0.2);
  EXPECT_LE(json_["distance"].get<double>(), 0.2);
  EXPECT_LE(measured_.vertices, 16u);
}

TEST_F(Limits, BothHoldWhereBothAreGiven) {
  const TriMesh torus = makeTorus(1.0, 0.4, 32, 16);
  runOn(torus, {"--max-error", "20%"});
  const int forError = json_["parts"];
  runOn(torus, {"--max-distance", "0.05"});
  const int forDistance = json_["parts"];
  ASSERT_NE(forError, forDistance);
  runOn(torus, {"--max-distance", "0.05", "--max-error", "20%"});
  EXPECT_EQ(json_["endedBy"], "limits");
  EXPECT_LE(json_["error"].get<double>(), 0.2);
  EXPECT_LE(json_["distance"].get<double>(), 0.05);
  EXPECT_GE(json_["parts"].get<int>(), std::max(forError, forDistance));
}

TEST_F(Limits, OfVerticesHoldsWhereTheErrorCannot) {
  // A ball has nothing to cut: its only hull is too large with eight vertices.
  runOn(makeSphere(1.0, 12, 18), {"--max-error", "5%", "--hull-vertices", "8"});
  EXPECT_EQ(json_["endedBy"], "convex");
  EXPECT_GT(json_["error"].get<double>(), 0.05);
  EXPECT_LE(measured_.vertices, 8u);
}

}  // namespace
}  // namespace lorica::test

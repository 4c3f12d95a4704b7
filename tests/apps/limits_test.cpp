// Limits hold, and figures are true, on the hulls that are exported.

#include "geometry/convex_hull.h"
#include "geometry/files.h"
#include "geometry/mesh_files.h"
#include "geometry/triangle_tree.h"
#include "geometry/work_budgets.h"
#include "tests/apps/mesh_text.h"
#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"
#include "viewer/page/page_files.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

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
    arguments.insert(arguments.end(), {"--force", "--export-obj", hulls, "--json", "-"});
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

TEST(WorkBudgets, AreThoseOfTheTableInTheDocuments) {
  const std::string page = readFile(sourceFile("docs/SECURITY.md")).value();
  struct Budget {
    const char* what;
    double most;
  };
  const std::vector<Budget> budgets = {
      {"threads", kMaxThreads},
      {"parts, vertices of a hull, frames and pictures that are asked for", kMaxOfAnything},
      {"avatars of a command or scene", kMaxCast},
      {"frames of a mesh in several poses", kMaxSequenceFrames},
      {"points of a mesh in several poses, in all frames", kMaxSequencePoints},
      {"people who are followed live", kMaxPeople},
      {"people in a recording of joints", kMaxRecordedPeople},
      {"elements of a kind in a glTF file", kMaxGltfElements},
      {"primitives that all nodes draw together", kMaxDraws},
      {"triangles of a character or mesh", kMaxTriangles},
      {"steps to unite the pieces of a mesh", kMaxUnionSteps},
      {"triangles looked at to tell what is inside a surface", kMaxLooked},
      {"and as many more for each triangle", kMaxLookedEach},
      {"joints of a character with skins, clips or springs", kMaxJoints},
      {"clips of a character", kMaxClips},
      {"frames times joints of a clip that is played, at 60 a second", kMaxClipPoses},
      {"frames times joints of all clips that hulls are fitted to, looked at less often", kMaxTrainingPoses},
      {"texels of all pictures together, left out", kMaxStoredTexels},
      {"texels of all pictures as they are drawn, reduced to fit", kMaxKeptTexels},
      {"width or height of a picture", kMaxPictureSide},
      {"pixels of a picture", kMaxPicturePixels},
      {"morph targets of a character, left out", kMaxMorphTargets},
      {"expressions of a character, left out", kMaxExpressions},
      {"morph targets and materials that expressions change, left out", kMaxExpressionBinds},
      {"joints that swing", kMaxSprings},
      {"colliders of springs", kMaxSpringColliders},
      {"pairs of a swinging joint and a collider", kMaxSpringPairs},
      {"constraints of nodes", kMaxNodeConstraints},
      {"props of a scene", kMaxSceneProps},
      {"different meshes of a scene", kMaxSceneMeshes},
      {"convex parts of a scene's meshes", kMaxSceneHulls},
      {"vertices of those parts, counted for each prop", kMaxSceneHullVertices},
      {"pairs of props of a scene whose boxes overlap", kMaxSceneNearPairs},
      {"vertices of a scene's mesh", kMaxPropVertices},
      {"convex parts of one mesh of a scene", kMaxPropParts},
      {"particles", kMaxParticles},
      {"sources of water or sand", kMaxParticleSources},
      {"pairs of a particle and a prop near it, left out", kMaxParticlePairs},
      {"avatars of a recorded session", kMaxRecordedAvatars},
      {"frames of the network that wait, the oldest left out", kMaxWaitingFrames},
      {"frames of a recording of packets", kMaxStreamFrames},
      {"expressions of a pose that is sent or recorded, left out", kMaxPoseExpressions},
      {"bytes of the name of such an expression, left out", kMaxExpressionName},
      {"bytes of a file that somebody at a page opens", kMaxSentFile},
      {"bytes of all such files in their folder", kMaxSentFiles},
      {"rows of a table of contacts", kMaxContactRows},
      {"files that a robot's file includes or attaches", kMaxRobotIncludes},
      {"different collision meshes of a robot", kMaxRobotMeshes},
      {"shapes of a robot that collide with a mesh", kMaxRobotGeoms},
      {"triangles of a robot's collision mesh", kMaxRobotTriangles}};
  for (const Budget& budget : budgets) {
    std::string number = fmt::format("{:.0f}", budget.most);
    for (auto at = static_cast<std::ptrdiff_t>(number.size()) - 3; at > 0; at -= 3) number.insert(at, ",");
    const std::string row = fmt::format("\n| {} | {} |\n", budget.what, number);
    EXPECT_NE(page.find(row), std::string::npos) << row;
  }
  const std::size_t begin = page.find("| what | most |");
  const std::string table = page.substr(begin, page.find("\n\n", begin) - begin);
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), static_cast<std::ptrdiff_t>(budgets.size()) + 1);
}

/// What is asked for at a limit is taken, and one more is a sentence.
TEST(WorkBudgets, OptionsAreTakenAtTheirLimitsAndRefusedAboveThem) {
  struct Case {
    std::vector<std::string> arguments;
    std::string option;
    int most;
  };
  for (const Case& c : {Case{{"info", "mannequin"}, "--threads", kMaxThreads},
                        {{"decompose", "none.off"}, "--parts", kMaxOfAnything},
                        {{"decompose", "none.off"}, "--hull-vertices", kMaxOfAnything},
                        {{"play", "none.bvh"}, "--frames", kMaxOfAnything}}) {
    const auto sentence = [&](int number) {
      std::vector<std::string> arguments = c.arguments;
      arguments.insert(arguments.end(), {c.option, std::to_string(number)});
      return runLorica(arguments).err;
    };
    EXPECT_EQ(sentence(c.most).find(c.option), std::string::npos) << c.option;
    EXPECT_NE(sentence(c.most + 1).find("to " + std::to_string(c.most)), std::string::npos) << c.option;
  }
}

TEST(WorkBudgets, SoAreMotionsAndPeople) {
  for (const int more : {0, 1}) {
    std::string motions = "none.bvh";
    for (std::size_t i = 1; i < kMaxCast + more; ++i) motions += ",none.bvh";
    EXPECT_EQ(runLorica({"play", motions}).err.find("at most 64") != std::string::npos, more > 0);
    const std::string people = std::to_string(kMaxPeople + more);
    const std::string sentence =
        runLorica({"live", "--virtual", "--headless", "--frames", "1", "--people", people, "--character", "none.glb"})
            .err;
    EXPECT_EQ(sentence.find("at most 6") != std::string::npos, more > 0) << sentence;
  }
}

}  // namespace
}  // namespace lorica::test

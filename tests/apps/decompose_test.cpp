#include "geometry/convex_hull.h"
#include "geometry/files.h"
#include "tests/apps/mesh_text.h"
#include "tests/apps/refusals.h"
#include "tests/apps/run_command.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"
#include "viewer/pictures/image_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace lorica::test {
namespace {

TEST(Decompose, LShapeFallsIntoTwoBoxes) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "l.obj", makeLShape());
  // One concave edge: Algorithm 1 stops at two parts, both convex. Without options, so does a concavity of 0.05.
  const nlohmann::json json = jsonOf({"decompose", mesh, "--exact"});
  EXPECT_EQ(json["endedBy"], "convex");
  const nlohmann::json byDefault = jsonOf({"decompose", mesh});
  EXPECT_EQ(byDefault["hash"], json["hash"]);
  EXPECT_NEAR(byDefault["maxConcavity"].get<double>(), 0.05, 1e-12);
  EXPECT_EQ(byDefault["endedBy"], "concavity");
  EXPECT_EQ(json["parts"], 2);
  EXPECT_NEAR(json["meshVolume"].get<double>(), 3.0, 1e-9);
  EXPECT_NEAR(json["hullVolume"].get<double>(), 3.0, 1e-9);
  EXPECT_NEAR(json["score"].get<double>(), 1.0, 1e-9);
  EXPECT_NEAR(json["error"].get<double>(), 0.0, 1e-9);
  EXPECT_EQ(json["vertices"], 12);
}

TEST(Decompose, OnePartIsTheConvexHull) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "l.obj", makeLShape());
  const nlohmann::json json = jsonOf({"decompose", mesh, "--parts", "1"});
  EXPECT_EQ(json["parts"], 1);
  // The hull of the L: a 2 x 2 x 1 box less the prism over the triangle (2,1) (2,2) (1,2).
  EXPECT_NEAR(json["hullVolume"].get<double>(), 3.5, 1e-9);
  EXPECT_NEAR(json["error"].get<double>(), 0.5 / 3.0, 1e-9);
}

TEST(Decompose, AnErrorAboveAHalfIsAWarning) {
  const TemporaryFolder folder;
  // Legs of 0.1: an area of 0.39 in a hull of 2.195.
  const TriMesh legs = moved(
      makeLShape(), [](const Vec3& p) { return Vec3(p.x() == 1.0 ? 0.1 : p.x(), p.y() == 1.0 ? 0.1 : p.y(), p.z()); });
  const std::string mesh = writeObj(folder, "legs.obj", legs);
  const std::string said = "the hulls have 462.8 % more volume than the mesh";
  for (const char* parts : {"1", "2"}) {
    const bool doubtful = parts == std::string("1");
    const CommandResult text = runLorica({"decompose", mesh, "--parts", parts});
    EXPECT_EQ(text.exitCode, 0) << text.err;
    EXPECT_EQ(text.err.find("lorica: warning: " + said) != std::string::npos, doubtful) << text.err;
    const nlohmann::json warnings = jsonOf({"decompose", mesh, "--parts", parts})["warnings"];
    ASSERT_EQ(warnings.size(), doubtful ? 1u : 0u);
    for (const nlohmann::json& warning : warnings) EXPECT_TRUE(has(warning.get<std::string>(), said));
  }
}

/// What is small beside the length of a profile is much beside its volume: --max-error is what keeps its inside free.
TEST(Decompose, TheErrorIsLimitedBesideTheConcavity) {
  const TemporaryFolder folder;
  const TriMesh profile = moved(makeLShape(), [](const Vec3& p) {
    return Vec3(p.x() == 1.0 ? 0.1 : p.x(), p.y() == 1.0 ? 0.1 : p.y(), 60.0 * p.z());
  });
  const std::string mesh = writeObj(folder, "profile.obj", profile);
  const nlohmann::json full = jsonOf({"decompose", mesh, "--max-concavity", "5%"});
  EXPECT_EQ(full["parts"], 1);
  EXPECT_NEAR(full["error"].get<double>(), 4.628, 0.001);
  const nlohmann::json hollow = jsonOf({"decompose", mesh, "--max-concavity", "5%", "--max-error", "50%"});
  EXPECT_EQ(hollow["parts"], 2);
  EXPECT_LT(hollow["error"].get<double>(), 0.5);
  EXPECT_LE(hollow["concavity"].get<double>(), 0.05);
}

TEST(Decompose, JsonHasItsKeysAndTypes) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "l.obj", makeLShape());
  const nlohmann::json json = jsonOf({"decompose", mesh, "--threads", "1"});
  for (const char* key : {"parts", "threads", "vertices"}) EXPECT_TRUE(json[key].is_number_integer()) << key;
  for (const char* key : {"meshVolume", "hullVolume", "score", "error", "seconds"}) {
    EXPECT_TRUE(json[key].is_number()) << key;
  }
  EXPECT_EQ(json["threads"], 1);
  const std::string hash = json["hash"];
  EXPECT_EQ(hash.size(), 16u);
  EXPECT_EQ(hash.find_first_not_of("0123456789abcdef"), std::string::npos) << hash;
  EXPECT_FALSE(json.contains("keyframes"));
}

TEST(Decompose, JsonFileHoldsTheSameAndTheReportIsForPeople) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "l.obj", makeLShape());
  const std::filesystem::path report = folder.path() / "report.json";
  const CommandResult result = runLorica({"decompose", mesh, "--json", report});
  EXPECT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.out.rfind("l.obj: 2 convex parts", 0), 0u) << result.out;
  CommandResult file;
  file.out = readFile(report).value();
  EXPECT_EQ(file.json()["hash"], jsonOf({"decompose", mesh})["hash"]);
}

TEST(Decompose, WhatIsWrittenIsNamed) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "l.obj", makeLShape());
  const std::string file = folder.path() / "l.lorica";
  const std::string hulls = folder.path() / "hulls.obj";
  const nlohmann::json json = jsonOf({"decompose", mesh, "-o", file, "--export-obj", hulls});
  EXPECT_EQ(json["output"], file);
  EXPECT_EQ(json["exportObj"], hulls);
  const CommandResult text = runLorica({"decompose", "--force", mesh, "-o", file, "--export-obj", hulls});
  expectAll(text.out, {file, hulls});
  const nlohmann::json neither = jsonOf({"decompose", mesh});
  EXPECT_FALSE(neither.contains("output"));
  EXPECT_FALSE(neither.contains("exportObj"));
}

TEST(Decompose, StopsAtTheRequestedError) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "torus.obj", makeTorus(1.0, 0.3, 48, 24));
  const nlohmann::json json = jsonOf({"decompose", mesh, "--preset", "paper", "--parts", "60", "--max-error", "20%"});
  EXPECT_EQ(json["endedBy"], "error");
  EXPECT_EQ(json["maxError"], 0.2);
  EXPECT_LE(json["error"].get<double>(), 0.2);
  // More cuts would reduce the error: it stopped long before no concave edge was left.
  EXPECT_GT(json["error"].get<double>(), 0.05);
  EXPECT_LT(json["parts"].get<int>(), 20);
  EXPECT_EQ(jsonOf({"decompose", mesh, "--preset", "paper", "--parts", "60", "--max-error", "0.2"})["hash"],
            json["hash"]);
}

TEST(Decompose, StopsAtTheRequestedDistance) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "torus.obj", makeTorus(1.0, 0.3, 48, 24));
  const nlohmann::json json =
      jsonOf({"decompose", mesh, "--preset", "paper", "--parts", "60", "--max-distance", "0.1"});
  EXPECT_EQ(json["endedBy"], "distance");
  EXPECT_LE(json["distance"].get<double>(), 0.1);
  EXPECT_LT(json["parts"].get<int>(), 30);
}

TEST(Decompose, ReportsALimitThatCouldNotBeMet) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "torus.obj", makeTorus(1.0, 0.3, 48, 24));
  const std::vector<std::string> arguments = {"decompose",   mesh,     "--parts",        "3",
                                              "--max-error", "0.0001", "--max-distance", "0.0001"};
  const CommandResult text = runLorica(arguments);
  EXPECT_TRUE(has(text.out, "the limit of 3 parts was reached; an error of 0.0 % and a distance of 0.0001 were not"));
  std::vector<std::string> withJson = arguments;
  withJson.insert(withJson.end(), {"--json", "-"});
  const nlohmann::json json = runLorica(withJson).json();
  EXPECT_EQ(json["endedBy"], "parts");
  EXPECT_GT(json["distance"].get<double>(), 0.0001);
}

TEST(Decompose, EdgeOfFourTrianglesIsRepairedAndReported) {
  const TemporaryFolder folder;
  // Two boxes that share the edge between their corners (1, 0, 1) and (1, 1, 1): four triangles meet there.
  TriMesh mesh = makeBox({0, 0, 0}, {1, 1, 1});
  const TriMesh other = makeBox({1, 0, 1}, {2, 1, 2});
  std::vector<VertexIndex> index;
  for (const Vec3& vertex : other.vertices) {
    const auto same = std::find(mesh.vertices.begin(), mesh.vertices.end(), vertex);
    index.push_back(static_cast<VertexIndex>(same - mesh.vertices.begin()));
    if (same == mesh.vertices.end()) mesh.vertices.push_back(vertex);
  }
  for (const Triangle& t : other.triangles) mesh.triangles.push_back({index[t[0]], index[t[1]], index[t[2]]});
  const std::filesystem::path file = writeObj(folder, "fan.obj", mesh);
  const nlohmann::json json = jsonOf({"decompose", file, "--parts", "2"});
  EXPECT_NEAR(json["meshVolume"].get<double>(), 2.0, 1e-12);
  EXPECT_TRUE(has(json["repaired"].get<std::string>(), "1 non-manifold edge")) << json["repaired"];
}

TEST(Decompose, ConvexMeshIsNotCut) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "box.obj", makeBox({0, 0, 0}, {2, 1, 1}));
  const nlohmann::json json =
      jsonOf({"decompose", mesh, "--parts", "9", "--max-error", "1%", "--max-distance", "0.001"});
  EXPECT_EQ(json["parts"], 1);
  EXPECT_EQ(json["endedBy"], "limits");
  EXPECT_EQ(jsonOf({"decompose", mesh, "--parts", "9"})["endedBy"], "convex");
}

TEST(Decompose, ATorusIsHardlyConcaveByDefault) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "torus.obj", makeTorus(1.0, 0.3, 48, 24));
  const CommandResult result = runLorica({"decompose", mesh});
  EXPECT_TRUE(has(result.out, "a concavity of 0.05 was reached"));
  for (const char* limit : {"--max-error", "--max-concavity"}) {
    expectRefused(runLorica({"decompose", mesh, "--exact", limit, "1%"}), {"--exact"});
  }
}

TEST(Decompose, OverlappingBoxesCountOnce) {
  const TemporaryFolder folder;
  // A U of three boxes, and the same again 2 mm higher.
  const TriMesh u =
      joined(makeBox({0, 0, 0}, {3, 1, 1}), joined(makeBox({0, 0, 0}, {1, 3, 1}), makeBox({2, 0, 0}, {3, 3, 1})));
  for (const auto& [mesh, volume] : {std::pair(u, 7.0), std::pair(joined(u, shifted(u, {0, 0.002, 0})), 7.006)}) {
    const std::filesystem::path hulls = folder.path() / "hulls.obj";
    const std::filesystem::path file = writeObj(folder, "u.obj", mesh);
    const nlohmann::json json = jsonOf({"decompose", "--force", file, "--parts", "8", "--export-obj", hulls});
    EXPECT_NEAR(json["meshVolume"].get<double>(), volume, 1e-9);
    EXPECT_LE(json["score"].get<double>(), 1.0 + 1e-9);
    EXPECT_GE(json["error"].get<double>(), -1e-9);
    EXPECT_TRUE(has(json["repaired"].get<std::string>(), "overlapping pieces united"));
    const std::vector<NamedMesh> objects = valueOf(readObjObjects(hulls));
    if (volume == 7.0) {
      EXPECT_EQ(objects.size(), 3u);
    }
    const Vec3 between(1.5, 2.0, 0.5);
    for (const NamedMesh& object : objects) {
      EXPECT_GT(largestViolation(convexHull(object.mesh.vertices), std::span(&between, 1)), 0.4);
    }
    const nlohmann::json score = jsonOf({"score", file, hulls});
    EXPECT_NEAR(score["score17"].get<double>(), 1.0, 1e-3);
    EXPECT_LE(score["score17"].get<double>(), 1.0 + 1e-9);
  }
}

TEST(Decompose, ThreadsAndRunsAgree) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "torus.obj", makeTorus(1.0, 0.4, 48, 24));
  const auto hashWith = [&mesh](const char* threads) {
    return jsonOf({"decompose", mesh, "--parts", "12", "--threads", threads})["hash"];
  };
  const nlohmann::json one = hashWith("1");
  EXPECT_TRUE(one.is_string());
  EXPECT_EQ(hashWith("1"), one);
  EXPECT_EQ(hashWith("2"), one);
  EXPECT_EQ(hashWith("3"), one);
}

/// Largest distance of a vertex from its nearest hull; 0 if all are inside.
double worstVertex(const TriMesh& mesh, const std::vector<NamedMesh>& objects) {
  std::vector<ConvexHull> hulls;
  for (const NamedMesh& object : objects) hulls.push_back(convexHull(object.mesh.vertices));
  double worst = 0.0;
  for (const Vec3& vertex : mesh.vertices) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const ConvexHull& hull : hulls) {
      if (!hull.degenerate()) nearest = std::min(nearest, largestViolation(hull, std::span(&vertex, 1)));
      if (nearest == 0.0) break;
    }
    worst = std::max(worst, nearest);
  }
  return worst;
}

TEST(Decompose, ExportedHullsContainTheMesh) {
  const TemporaryFolder folder;
  const TriMesh torus = makeTorus(1.0, 0.4, 48, 24);
  const std::filesystem::path mesh = writeObj(folder, "torus.obj", torus);
  const std::filesystem::path hulls = folder.path() / "hulls.obj";
  const CommandResult result = runLorica({"decompose", mesh, "--parts", "9", "--export-obj", hulls});
  EXPECT_EQ(result.exitCode, 0) << result.err;
  const std::vector<NamedMesh> objects = valueOf(readObjObjects(hulls));
  ASSERT_EQ(objects.size(), 9u);
  for (std::size_t i = 0; i < objects.size(); ++i) EXPECT_EQ(objects[i].name, "part_" + std::to_string(i));
  EXPECT_LE(worstVertex(torus, objects), 1e-6 * boundsOf(torus.vertices).diagonal());
}

TEST(Decompose, CharacterTrainsOnKeyframes) {
  const TemporaryFolder folder;
  const std::filesystem::path output = folder.path() / "body.lorica";
  const std::filesystem::path hulls = folder.path() / "hulls.obj";
  const nlohmann::json json =
      jsonOf({"decompose", "mannequin", "--parts", "5", "--keyframes", "3", "-o", output, "--export-obj", hulls});
  EXPECT_EQ(json["parts"], 5);
  EXPECT_EQ(json["keyframes"], 3);
  ASSERT_EQ(json["errorPerKeyframe"].size(), 3u);
  double mean = 0.0;
  for (const nlohmann::json& error : json["errorPerKeyframe"]) mean += error.get<double>() / 3.0;
  EXPECT_NEAR(json["error"].get<double>(), mean, 1e-12);
  EXPECT_GT(mean, 0.0);

  const nlohmann::json info = jsonOf({"info", output});
  EXPECT_EQ(info["kind"], "decomposition");
  EXPECT_EQ(info["source"], "mannequin");
  EXPECT_EQ(info["hash"], json["hash"]);
  EXPECT_EQ(info["error"], json["error"]);

  // The bind pose is not a keyframe, but its hulls are exported.
  const std::vector<NamedMesh> objects = valueOf(readObjObjects(hulls));
  EXPECT_EQ(objects.size(), 5u);
}

TEST(Decompose, MotionNamesWhatIsTrainedOn) {
  const auto hashOn = [](const char* motion) {
    return jsonOf({"decompose", "mannequin", "--parts", "3", "--keyframes", "2", "--motion", motion})["hash"];
  };
  const nlohmann::json walk = hashOn("walk");
  EXPECT_TRUE(walk.is_string());
  EXPECT_EQ(walk, hashOn((recordingsFolder() / "walk.csv").c_str()));
  EXPECT_NE(walk, hashOn("jumping_jacks"));
}

TEST(Decompose, InterruptLeavesNothingBehind) {
  const TemporaryFolder folder;
  // About 46,000 triangles until nothing is concave: far more work than the pause.
  const std::filesystem::path mesh = writeObj(folder, "torus.obj", makeTorus(1.0, 0.4, 240, 96));
  const std::vector<std::string> before = filesIn(folder.path());
  const CommandResult result =
      runLorica({"decompose", mesh, "--exact", "-o", folder.path() / "torus.lorica", "--export-obj",
                 folder.path() / "hulls.obj", "--json", folder.path() / "report.json"},
                {.folder = ".", .cache = {}, .interruptWhen = [](const RunningCommand& command) {
                   return hasWorked(command, 1.5);
                 }});
  EXPECT_EQ(result.exitCode, 130) << result.err;
  EXPECT_TRUE(has(result.err, "lorica: cancelled"));
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(filesIn(folder.path()), before);
}

struct Benchmark {
  const char* file;
  const char* parts;
  double score;
};

void PrintTo(const Benchmark& row, std::ostream* out) {
  *out << row.file << ", " << row.parts << " parts";
}

class DecomposeBenchmark : public testing::TestWithParam<Benchmark> {};

TEST_P(DecomposeBenchmark, ReachesItsScoreAndCoversTheMesh) {
  LORICA_REQUIRE_DATASET(file, GetParam().file);
  const TemporaryFolder folder;
  const std::filesystem::path hulls = folder.path() / "hulls.obj";
  const nlohmann::json json =
      jsonOf({"decompose", "--force", file, "--parts", GetParam().parts, "--export-obj", hulls});
  EXPECT_EQ(json["parts"], std::atoi(GetParam().parts));
  EXPECT_GE(json["score"].get<double>(), GetParam().score);

  const Result<TriMesh> mesh = readMesh(file);
  const Result<std::vector<NamedMesh>> objects = readObjObjects(hulls);
  ASSERT_TRUE(mesh && objects);
  EXPECT_LE(worstVertex(*mesh, *objects), 1e-6 * boundsOf(mesh->vertices).diagonal());
}

INSTANTIATE_TEST_SUITE_P(VHacd, DecomposeBenchmark,
                         testing::Values(Benchmark{"vhacd/Bunny.off", "8", 0.89},
                                         Benchmark{"vhacd/Bunny.off", "28", 0.95},
                                         Benchmark{"vhacd/Block.off", "19", 0.90},
                                         Benchmark{"vhacd/Horse.off", "10", 0.80}));

/// How many of twelve hues cover at least a thousandth of a picture.
std::ptrdiff_t huesOf(const std::filesystem::path& file) {
  const Result<Image> image = readPng(file);
  if (!image) return -1;
  std::array<std::size_t, 12> pixels{};
  for (std::size_t i = 0; i < image->rgba.size(); i += 4) {
    const double r = image->rgba[i], g = image->rgba[i + 1], b = image->rgba[i + 2];
    if (std::max({r, g, b}) - std::min({r, g, b}) < 40.0) continue;  // floor and background are grey
    const double angle = std::atan2(std::sqrt(3.0) * (g - b), 2.0 * r - g - b);
    ++pixels[static_cast<std::size_t>((angle + std::numbers::pi) / (2.0 * std::numbers::pi) * 11.999)];
  }
  const std::size_t enough = image->rgba.size() / 4000;
  return std::ranges::count_if(pixels, [&](std::size_t count) { return count > enough; });
}

TEST(Decompose, APictureShowsEachPartInItsColour) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "l.obj", makeLShape());
  const std::filesystem::path one = folder.path() / "one.png", two = folder.path() / "two.png";
  const CommandResult made = runLorica({"decompose", mesh, "--picture", two, "--json", "-"});
  EXPECT_EQ(made.json()["picture"], two.string()) << made.err;
  EXPECT_EQ(runLorica({"decompose", mesh, "--parts", "1", "--picture", one}).exitCode, 0);
  EXPECT_EQ(huesOf(one), 1);
  EXPECT_EQ(huesOf(two), 2);
  expectRefused(runLorica({"decompose", mesh, "--picture", one}), {"--force"});
  expectRefused(runLorica({"decompose", mesh, "--up", "z"}), {"--up", "--picture"});
}

TEST(Score, DecomposedLShapeIsPerfect) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "l.obj", makeLShape());
  const std::filesystem::path hulls = folder.path() / "hulls.obj";
  ASSERT_EQ(runLorica({"decompose", mesh, "--parts", "2", "--export-obj", hulls}).exitCode, 0);
  const nlohmann::json json = jsonOf({"score", mesh, hulls});
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
  const nlohmann::json json = jsonOf({"score", mesh, mesh});
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
  const nlohmann::json json = jsonOf({"score", mesh, half});
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
    EXPECT_TRUE(has(result.err, "other.obj: these may be parts of another mesh"));
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
  EXPECT_TRUE(has(result.err, "flat.obj"));
}

}  // namespace
}  // namespace lorica::test

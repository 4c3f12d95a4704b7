// Meshes as people have them: open, flipped, in any unit, in any format.

#include "geometry/convex_hull.h"
#include "skinning/import/character_file.h"
#include "tests/apps/mannequin_glb.h"
#include "tests/apps/mesh_text.h"
#include "tests/apps/refusals.h"
#include "tests/apps/run_command.h"
#include "tests/skinning/import/glb_writer.h"
#include "tests/support/has.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

/// A glTF file with one mesh, no skin and no clips.
std::string staticGlb(const TriMesh& mesh, const Affine3& worldFromMesh) {
  GlbWriter writer;
  const int positions = writer.positions(mesh.vertices);
  const int indices = writer.triangles(mesh.triangles);
  writer.add("meshes", {{"primitives", {{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}}});
  std::vector<double> matrix(worldFromMesh.matrix().data(), worldFromMesh.matrix().data() + 16);
  writer.add("nodes", {{"mesh", 0}, {"matrix", matrix}});
  writer.document["scenes"] = {{{"nodes", {0}}}};
  writer.document["scene"] = 0;
  return writer.glb();
}

/// A torus without the quarter beyond x: a hole too large to be a pinhole.
TriMesh openTorus(double scale = 1.0) {
  TriMesh mesh = makeTorus(1.0, 0.4, 40, 20);
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return mesh.vertices[t[0]].x() > 0.9; });
  // Only vertices that triangles use: readers of some formats drop the others.
  TriMesh kept;
  std::vector<VertexIndex> number(mesh.vertices.size(), -1);
  for (const Triangle& t : mesh.triangles) {
    for (const VertexIndex v : t) number[v] = 0;
  }
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<VertexIndex>(kept.vertices.size());
    kept.vertices.push_back(scale * mesh.vertices[v]);
  }
  for (const auto& [a, b, c] : mesh.triangles) kept.triangles.push_back({number[a], number[b], number[c]});
  return kept;
}

/// Largest distance of a vertex that triangles use from its nearest hull; 0 if all are inside.
double farthestOutside(const TriMesh& mesh, const fs::path& hulls) {
  const Result<std::vector<NamedMesh>> objects = readObjObjects(hulls);
  EXPECT_TRUE(objects);
  if (!objects) return std::numeric_limits<double>::infinity();
  std::vector<ConvexHull> solids;
  for (const NamedMesh& object : *objects) solids.push_back(convexHull(object.mesh.vertices));
  double worst = 0.0;
  for (const Triangle& t : mesh.triangles) {
    for (const VertexIndex v : t) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const ConvexHull& hull : solids) {
        if (!hull.degenerate()) nearest = std::min(nearest, largestViolation(hull, {&mesh.vertices[v], 1}));
      }
      worst = std::max(worst, nearest);
    }
  }
  return worst;
}

double hullVolume(const fs::path& hulls) {
  const Result<std::vector<NamedMesh>> objects = readObjObjects(hulls);
  EXPECT_TRUE(objects);
  double sum = 0.0;
  for (const NamedMesh& object : *objects) sum += convexHullVolume(object.mesh.vertices);
  return sum;
}

TEST(MeshInput, SmallFaultsAreMendedAndSaid) {
  const TemporaryFolder folder;
  TriMesh mesh = makeLShape();
  std::swap(mesh.triangles[4][0], mesh.triangles[4][1]);
  mesh.triangles.push_back(mesh.triangles[7]);
  mesh.triangles.erase(mesh.triangles.begin() + 12);
  const fs::path file = writeObj(folder, "l.obj", mesh);
  const nlohmann::json json = jsonOf({"decompose", file});
  EXPECT_NEAR(json["meshVolume"].get<double>(), 3.0, 1e-12);
  EXPECT_EQ(json["repaired"], "1 repeated triangle dropped, 1 triangle turned, 1 pinhole closed with 1 triangle");
  EXPECT_FALSE(json.contains("body"));
  const CommandResult text = runLorica({"decompose", file});
  expectAll(text.out, {"repaired ", "1 triangle turned"});
}

TEST(MeshInput, InsideOutIsReversed) {
  const TemporaryFolder folder;
  TriMesh mesh = makeLShape();
  const auto whole = jsonOf({"decompose", writeObj(folder, "l.obj", mesh)});
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  const auto json = jsonOf({"decompose", writeObj(folder, "out.obj", mesh)});
  EXPECT_EQ(json["parts"], whole["parts"]);
  EXPECT_NEAR(json["hullVolume"].get<double>(), whole["hullVolume"].get<double>(), 1e-12);
}

TEST(MeshInput, AnOpenMeshGetsABodyThatHoldsItsVertices) {
  const TemporaryFolder folder;
  const TriMesh mesh = openTorus();
  const fs::path file = writeObj(folder, "open.obj", mesh);
  const fs::path hulls = folder.path() / "hulls.obj";
  const fs::path parts = folder.path() / "open.lorica";
  const nlohmann::json json =
      jsonOf({"decompose", "--force", file, "--parts", "8", "--walls", "solid", "--export-obj", hulls, "-o", parts});
  const nlohmann::json& body = json["body"];
  EXPECT_TRUE(has(body["problem"].get<std::string>(), "belongs to one triangle")) << body;
  EXPECT_GT(body["voxel"].get<double>(), 0.0);
  EXPECT_LT(body["voxel"].get<double>(), 0.2);
  EXPECT_LT(body["meanDistance"].get<double>(), body["farthestDistance"].get<double>());
  EXPECT_LT(body["meanDistance"].get<double>(), 0.05);
  EXPECT_LE(json["attachedVertices"].get<int>(), 5);  // the body holds nearly all
  const double diagonal = boundsOf(mesh.vertices).diagonal();
  EXPECT_LE(farthestOutside(mesh, hulls), 1e-6 * diagonal);
  // All figures are of these hulls: report, export and file.
  EXPECT_NEAR(json["hullVolume"].get<double>(), hullVolume(hulls), 1e-6 * hullVolume(hulls));
  const nlohmann::json info = jsonOf({"info", parts});
  EXPECT_EQ(info["error"], json["error"]);
  EXPECT_NEAR(info["detailLevels"].back()["error"].get<double>(), json["error"].get<double>(), 1e-7);
  EXPECT_EQ(info["hash"], json["hash"]);

  const CommandResult text = runLorica({"decompose", file, "--parts", "8", "--walls", "solid"});
  expectAll(text.out, {"closed body", "from its surface to the original"});
}

TEST(MeshInput, AnOpenMeshIsAThinWall) {
  const TemporaryFolder folder;
  const TriMesh mesh = openTorus();
  const fs::path file = writeObj(folder, "open.obj", mesh);
  const fs::path hulls = folder.path() / "hulls.obj";
  const nlohmann::json json = jsonOf({"decompose", file, "--export-obj", hulls, "--thickness", "0.02"});
  EXPECT_EQ(json["body"]["shells"], 1);
  EXPECT_EQ(json["body"]["thickness"], 0.02);
  EXPECT_EQ(json["endedBy"], "concavity");
  EXPECT_LE(json["concavity"].get<double>(), 0.052);  // sampled
  EXPECT_LT(json["meanConcavity"].get<double>(), json["concavity"].get<double>());
  const double area = surfaceArea(mesh.vertices, mesh.triangles);
  EXPECT_NEAR(json["meshVolume"].get<double>(), 0.02 * area, 0.001 * area);
  EXPECT_LE(farthestOutside(mesh, hulls), 1e-6 * boundsOf(mesh.vertices).diagonal());
  // The score is of the file's own surface, and its concavity much the same.
  const CommandResult text = runLorica({"score", file, hulls, "--thickness", "0.02"});
  EXPECT_TRUE(has(text.out, "1 thin wall of 0.02, 100 % of the surface"));
  const nlohmann::json score = jsonOf({"score", file, hulls, "--thickness", "0.02"});
  EXPECT_TRUE(score["score17"].is_null());
  EXPECT_NEAR(score["concavity"].get<double>(), json["concavity"].get<double>(), 0.01);
  EXPECT_LT(score["surfaceToHulls"]["largest"].get<double>(), 0.1);
  EXPECT_LT(score["hullsToSurface"]["largest"].get<double>(), 0.1);
  EXPECT_EQ(runLorica({"decompose", file, "--thickness", "0.5"}).exitCode, 2);
  EXPECT_EQ(runLorica({"decompose", file, "--walls", "thick"}).exitCode, 2);
}

TEST(MeshInput, LimitedHullsHoldEveryVertexToo) {
  const TemporaryFolder folder;
  const TriMesh mesh = openTorus();
  const fs::path hulls = folder.path() / "hulls.obj";
  const nlohmann::json run = jsonOf({"decompose", writeObj(folder, "open.obj", mesh), "--parts", "6", "--hull-vertices",
                                     "12", "--export-obj", hulls});
  EXPECT_LE(farthestOutside(mesh, hulls), 1e-6 * boundsOf(mesh.vertices).diagonal());
  const std::vector<NamedMesh> objects = readObjObjects(hulls).value();
  for (const NamedMesh& object : objects) EXPECT_LE(object.mesh.vertices.size(), 12u);
}

TEST(MeshInput, ASheetFarOutsideTheBodyIsInTheHulls) {
  const TemporaryFolder folder;
  TriMesh mesh = makeBox({0, 0, 0}, {1, 1, 1});
  const auto [a, b, c] = mesh.triangles.front();
  mesh.vertices.emplace_back(3, 3, 3);
  mesh.triangles.push_back({b, a, static_cast<VertexIndex>(mesh.vertices.size() - 1)});
  const fs::path hulls = folder.path() / "hulls.obj";
  const nlohmann::json run =
      jsonOf({"decompose", writeObj(folder, "fin.obj", mesh), "--parts", "2", "--export-obj", hulls});
  EXPECT_LE(farthestOutside(mesh, hulls), 1e-6 * boundsOf(mesh.vertices).diagonal());
}

TEST(MeshInput, TheUnitDoesNotMatter) {
  const TemporaryFolder folder;
  std::vector<nlohmann::json> results;
  for (const double scale : {1.0, 1e-3, 1e3}) {
    const fs::path file = writeObj(folder, "open.obj", openTorus(scale));
    nlohmann::json json = jsonOf({"decompose", file, "--parts", "8", "--walls", "solid"});
    for (const char* key : {"voxel", "meanDistance", "farthestDistance"}) {
      json["body"][key] = json["body"][key].get<double>() / scale;
    }
    results.push_back(std::move(json));
  }
  for (const nlohmann::json& json : results) {
    EXPECT_EQ(json["parts"], results[0]["parts"]);
    EXPECT_EQ(json["vertices"], results[0]["vertices"]);
    EXPECT_EQ(json["attachedVertices"], results[0]["attachedVertices"]);
    // A torus looks the same all around: rounding decides between cuts that are equally good.
    EXPECT_NEAR(json["score"].get<double>(), results[0]["score"].get<double>(), 2e-3);
    for (const char* key : {"voxel", "meanDistance", "farthestDistance"}) {
      EXPECT_NEAR(json["body"][key].get<double>(), results[0]["body"][key].get<double>(), 1e-9) << key;
    }
  }
}

TEST(MeshInput, NeverRefusesWithTheReason) {
  const TemporaryFolder folder;
  expectRefused(runLorica({"decompose", writeObj(folder, "open.obj", openTorus()), "--parts", "4", "--body", "never"}),
                {"open.obj", "belongs to one triangle"});
  const fs::path torn = folder.write("torn.glb", mannequinGlb(true));
  expectRefused(runLorica({"decompose", torn, "--parts", "4", "--body", "never"}), {"--body never"});
}

TEST(MeshInput, AlwaysBuildsABodyForAClosedMesh) {
  const TemporaryFolder folder;
  const fs::path file = writeObj(folder, "l.obj", makeLShape());
  const nlohmann::json json =
      jsonOf({"decompose", file, "--parts", "2", "--body", "always", "--body-resolution", "0.05"});
  EXPECT_TRUE(json["body"]["problem"].is_null());
  EXPECT_DOUBLE_EQ(json["body"]["voxel"].get<double>(), 0.05);
  EXPECT_NEAR(json["meshVolume"].get<double>(), 3.0, 0.1);
  EXPECT_LE(json["body"]["farthestDistance"].get<double>(), 0.05);
}

TEST(MeshInput, AStaticGlbIsExportedWhereItsVerticesAre) {
  const TemporaryFolder folder;
  const TriMesh mesh = makeLShape();
  for (const double size : {17.0, 1.0, 0.001, 2000.0}) {
    Affine3 worldFromMesh = Affine3::Identity();
    worldFromMesh.translate(Vec3(3.0, -1.0, 2.0) * size);
    worldFromMesh.rotate(Quat(0.5, 0.5, -0.5, 0.5));
    worldFromMesh.scale(0.5 * size);  // two units long
    const fs::path file = folder.write("l.glb", staticGlb(mesh, worldFromMesh));
    const fs::path hulls = folder.path() / "hulls.obj";
    const nlohmann::json run = jsonOf({"decompose", "--force", file, "--export-obj", hulls});
    EXPECT_NEAR(run["meshVolume"].get<double>(), 3.0 * std::pow(0.5 * size, 3), 1e-5 * std::pow(size, 3));
    // An L cut into boxes: the hulls have the mesh's own corners.
    const std::vector<NamedMesh> objects = readObjObjects(hulls).value();
    for (const NamedMesh& object : objects) {
      for (const Vec3& p : object.mesh.vertices) {
        const Vec3 local = worldFromMesh.inverse() * p;
        const Vec3 corner(std::round(local.x()), std::round(local.y()), std::round(local.z()));
        EXPECT_LE((local - corner).norm(), 1e-5) << "size " << size;
      }
    }
    TriMesh placed = mesh;
    for (Vec3& p : placed.vertices) p = worldFromMesh * p;
    EXPECT_LE(farthestOutside(placed, hulls), 1e-6 * boundsOf(placed.vertices).diagonal());
  }
}

TEST(MeshInput, AllFormatsGiveTheSameParts) {
  const TemporaryFolder folder;
  // Positions that floats hold exactly.
  TriMesh mesh = openTorus();
  for (Vec3& p : mesh.vertices) p = p.cast<float>().cast<double>();
  const fs::path obj = writeObj(folder, "open.obj", mesh);
  const fs::path glb = folder.write("open.glb", staticGlb(mesh, Affine3::Identity()));
  const auto first = jsonOf({"decompose", obj, "--parts", "6"});
  const auto second = jsonOf({"decompose", glb, "--parts", "6"});
  EXPECT_EQ(first["hash"], second["hash"]);
  EXPECT_EQ(first["body"], second["body"]);
  EXPECT_EQ(first["error"], second["error"]);
}

TEST(MeshInput, WhatEnclosesNothingIsAWallOrRefusedWithBothReasons) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("flat.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 2 1\n");
  const CommandResult wall = runLorica({"decompose", file});
  EXPECT_EQ(wall.exitCode, 0) << wall.err;
  EXPECT_TRUE(has(wall.out, "1 thin wall of 0.01"));
  expectRefused(runLorica({"decompose", file, "--walls", "solid"}), {"volume", "no closed body can be made"});
}

TEST(MeshInput, AMeshThatIsThereIsNoMissingCharacter) {
  const TemporaryFolder folder;
  const fs::path mesh = writeObj(folder, "l.obj", makeLShape());
  expectRefused(runLorica({"record", folder.path() / "o.bvh", "walk", "--character", mesh}),
                {"l.obj: is a mesh without bones"});
}

TEST(MeshInput, ATornCharactersExportHoldsItsVertices) {
  const TemporaryFolder folder;
  const fs::path torn = folder.write("torn.glb", mannequinGlb(true));
  const fs::path hulls = folder.path() / "hulls.obj";
  const CommandResult run = runLorica({"decompose", torn, "--parts", "8", "--keyframes", "2", "--export-obj", hulls});
  ASSERT_EQ(run.exitCode, 0) << run.err;
  EXPECT_TRUE(has(run.out, "metres, Y up, facing +Z"));
  const TriMesh mesh = readCharacterFile(torn).value().character.mesh;
  EXPECT_LE(farthestOutside(mesh, hulls), 1e-6 * boundsOf(mesh.vertices).diagonal());
}

TEST(MeshInput, ScoreTakesAnOpenMesh) {
  const TemporaryFolder folder;
  const fs::path file = writeObj(folder, "open.obj", openTorus());
  const fs::path hulls = folder.path() / "hulls.obj";
  ASSERT_EQ(runLorica({"decompose", file, "--parts", "8", "--export-obj", hulls}).exitCode, 0);
  const nlohmann::json run = jsonOf({"score", file, hulls});
  EXPECT_TRUE(run.contains("body"));
  EXPECT_LT(run["uncoveredFraction"].get<double>(), 1e-3);
}

}  // namespace
}  // namespace lorica::test

// The volumes of exported hulls in physics engines, and the physics extensions of exported GLB files against schemas.
#include "export/glb_colliders.h"
#include "export/mesh_export.h"
#include "export/rigid_model.h"
#include "export/robot_files.h"
#include "geometry/files.h"
#include "tests/peers/blender.h"
#include "tests/peers/exported.h"
#include "tests/peers/peer.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

Vec3 normalOf(const TriMesh& mesh, const Triangle& t) {
  const Vec3& a = mesh.vertices[t[0]];
  return (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).normalized();
}

/// Whether two triangles with a common edge are so nearly in a plane that Rapier makes one face of them and so cuts a
/// little off: the dot product of their normals is within the root of single precision of 1 (ConvexPolyhedron of
/// parry).
bool hasFlatEdges(const TriMesh& hull) {
  const double limit = 1.0 - std::sqrt(static_cast<double>(std::numeric_limits<float>::epsilon()));
  std::map<std::pair<std::uint32_t, std::uint32_t>, Vec3> normals;
  for (const Triangle& t : hull.triangles) {
    for (int i = 0; i < 3; ++i) normals[{t[i], t[(i + 1) % 3]}] = normalOf(hull, t);
  }
  return std::any_of(normals.begin(), normals.end(), [&](const auto& edge) {
    return edge.second.dot(normals.at({edge.first.second, edge.first.first})) > limit;
  });
}

class PeerColliderFiles : public testing::TestWithParam<test::Animated> {};

TEST_P(PeerColliderFiles, HaveTheirVolumesInRapierAndJolt) {
  LORICA_REQUIRE_EXPORT(made);
  const std::vector<std::string> names = test::namesOf(*made);
  std::vector<NamedMesh> hulls;
  for (std::size_t i = 0; i < names.size(); ++i) hulls.push_back({names[i], made->colliders[i].hull});
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "hero.obj", out = folder.path() / "out.json";
  ASSERT_TRUE(writeMeshes(file, hulls).ok());
  ASSERT_TRUE(test::runPeer("hull_volumes.mjs", {file.string(), out.string()}));
  const json found = test::readJson(out);
  ASSERT_EQ(found.size(), hulls.size());
  double jolt = 0.0, rapier = 0.0, flattened = 0.0;
  int flat = 0;
  for (const NamedMesh& hull : hulls) {
    const std::string& name = hull.name;
    const double volume = signedVolume(hull.mesh.vertices, hull.mesh.triangles);
    const auto error = [&](const char* engine) { return std::abs(found[name][engine].get<double>() / volume - 1.0); };
    EXPECT_LT(error("jolt"), 1e-3) << name;
    jolt = std::max(jolt, error("jolt"));
    const bool isFlat = hasFlatEdges(hull.mesh);
    EXPECT_LT(error("rapier"), isFlat ? 1e-2 : 1e-3) << name;
    flat += isFlat ? 1 : 0;
    (isFlat ? flattened : rapier) = std::max(isFlat ? flattened : rapier, error("rapier"));
  }
  std::printf(
      "%s: volumes within %.2g %% of Jolt's, %.2g %% of Rapier's; %.2g %% for %d of %zu hulls with flat edges\n",
      GetParam().name, 100.0 * jolt, 100.0 * rapier, 100.0 * flattened, flat, hulls.size());
}

json checkedBySchemas(const fs::path& glb, const test::TemporaryFolder& folder) {
  const fs::path out = folder.path() / "schemas.json";
  if (!test::runPeer("collider_schemas.mjs",
                     {glb.string(), out.string(), test::sourceFile("tests/peers/schemas").string()}))
    return {};
  return test::readJson(out);
}

TEST_P(PeerColliderFiles, FollowTheSchemasOfTheirExtensions) {
  LORICA_REQUIRE_EXPORT(made);
  CharacterDocument document = test::documentOf(*made);
  addColliders(document, made->colliders, test::namesOf(*made), {"", "", true});
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "hero.glb";
  ASSERT_TRUE(writeDocument(file, document).ok());
  const json found = checkedBySchemas(file, folder);
  EXPECT_EQ(found["errors"], json::array());
  const std::size_t count = made->colliders.size();
  EXPECT_EQ(found["checked"],
            (json{{"OMI_physics_shape", 1}, {"OMI_physics_body", count}, {"KHR_physics_rigid_bodies", count}}));
}

TEST_P(PeerColliderFiles, AreFoundByTheScriptsForEngines) {
  LORICA_REQUIRE_EXPORT(made);
  CharacterDocument document = test::documentOf(*made);
  addColliders(document, made->colliders, test::namesOf(*made), {"", "", false, false});
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "hero.glb", out = folder.path() / "engine.json", log = folder.path() / "log";
  ASSERT_TRUE(writeDocument(file, document).ok());
  ASSERT_TRUE(test::runPeer("engine_colliders.mjs", {file.string(), out.string()}));
  const json found = test::readJson(out);
  EXPECT_EQ(found["colliders"], made->colliders.size());
  EXPECT_NEAR(found["low"].get<double>(), 0.0, 0.2);
  EXPECT_NEAR(found["high"].get<double>(), made->character.height, 0.2);
  const fs::path model = folder.path() / "hero.xml";
  ASSERT_TRUE(writeMjcf(model, made->model, MjcfMotion::kJoints).ok());
  EXPECT_TRUE(test::runPeer("mujoco_bodies.mjs", {model.string()}));
  if (!test::missingForBlender().empty()) return;
  const std::string command = "blender -b --factory-startup --python-exit-code 1 --python '" +
                              test::sourceFile("samples/engines/blender_colliders.py").string() + "' -- '" +
                              file.string() + "' >'" + log.string() + "' 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  EXPECT_NE(readFile(log).value().find(std::to_string(made->colliders.size()) + " colliders on "), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(, PeerColliderFiles, testing::ValuesIn(test::kExported),
                         [](const auto& each) { return std::string(each.param.name); });

TEST(PeerColliderSchemas, AcceptTheHullsOfAMeshAndFindEachFault) {
  LORICA_REQUIRE_PEERS();
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "mesh.glb", wrong = folder.path() / "wrong.glb";
  const TriMesh tetrahedron{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  ASSERT_TRUE(writeGlbHulls(file, {{"a", tetrahedron}, {"b", tetrahedron}}, {"", "", true}).ok());
  EXPECT_EQ(checkedBySchemas(file, folder)["errors"], json::array());
  const auto errorsWith = [&](const std::function<void(json&)>& edit) {
    test::writeEdited(file, wrong, edit);
    return checkedBySchemas(wrong, folder)["errors"];
  };
  const auto omi = [](json& d) -> json& { return d["nodes"][1]["extensions"]["OMI_physics_body"]; };
  const auto khr = [](json& d) -> json& { return d["nodes"][1]["extensions"]["KHR_physics_rigid_bodies"]; };
  EXPECT_EQ(errorsWith([&](json& d) { omi(d)["collider"]["shape"] = 2; }), json::array({"node 1: shape 2 of 2"}));
  EXPECT_EQ(errorsWith([&](json& d) { khr(d)["collider"]["geometry"]["mesh"] = 9; }),
            json::array({"node 1: mesh 9 of 2"}));
  EXPECT_EQ(errorsWith([&](json& d) { d["extensions"]["OMI_physics_shape"]["shapes"][0]["convex"]["mesh"] = 2; }),
            json::array({"shape 0: mesh 2 of 2"}));
  EXPECT_EQ(errorsWith([&](json& d) { d["extensionsUsed"].erase(0); }).size(), 2U);
  EXPECT_FALSE(errorsWith([&](json& d) { omi(d)["motion"]["type"] = "rigid"; }).empty());
  EXPECT_FALSE(errorsWith([&](json& d) { khr(d)["collider"].erase("geometry"); }).empty());
  EXPECT_FALSE(errorsWith([&](json& d) { d["extensions"]["OMI_physics_shape"]["shapes"][0].erase("type"); }).empty());
}

}  // namespace
}  // namespace lorica

#include "acd/separating_plane.h"
#include "collision/hulls/cover_choice.h"
#include "export/glb_colliders.h"
#include "export/mesh_export.h"
#include "export/rigid_model.h"
#include "export/robot_files.h"
#include "geometry/files.h"
#include "geometry/triangle_tree.h"
#include "session/prepare/training_motions.h"
#include "skinning/body/closed_body.h"
#include "skinning/clip_files/character_document.h"
#include "skinning/linear_blend.h"
#include "tests/peers/animated.h"
#include "tests/peers/blender.h"
#include "tests/peers/peer.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The characters whose exports are tested.
inline constexpr Animated kExported[] = {
    {"mannequin", "", "walk"},
    {"cesiumman", "characters/cesiumman/CesiumMan.glb", "walk"},
    {"godette", "characters/godette/Godette_vrm_v4.vrm", "punch_and_kick"},
    {"arnaud", "characters/arnaud/arnaud.fbx", "walk"},
};

/// A character with a rigid hull of 32 vertices for each bone.
struct Exported {
  Animated animated;
  std::optional<CharacterFile> file;
  Character character;
  SkeletalMotion motion;
  CoverPoses poses;
  std::vector<RigidCollider> colliders;
  RigidModel model;
};

/// Makes the character of a parametrised test, or skips the test with the reason.
#define LORICA_REQUIRE_EXPORT(name)                                                                 \
  LORICA_REQUIRE_PEERS();                                                                           \
  if (!::lorica::test::available(GetParam())) GTEST_SKIP() << GetParam().character << " is absent"; \
  const std::optional<::lorica::test::Exported> name = ::lorica::test::exported(GetParam());        \
  ASSERT_TRUE(name)

constexpr int kVertices = 32;  // of a hull

/// The whole mesh as one part: hulls for each bone do not use parts.
Decomposition undivided(const Character& character) {
  Decomposition one;
  one.vertexCount = static_cast<int>(character.mesh.vertices.size());
  one.triangleCount = static_cast<int>(character.mesh.triangles.size());
  return one;
}

/// Makes it. Fails the test, and returns none, if that fails.
std::optional<Exported> exported(const Animated& animated) {
  std::optional<Performance> performance = performanceOf(animated);
  if (!performance) return std::nullopt;
  Exported made{
      animated, std::move(performance->file), std::move(performance->character), std::move(performance->motion), {}, {},
      {}};
  Result<ClosedBody> body = makeBody(made.character);
  EXPECT_TRUE(body.ok());
  if (!body.ok()) return std::nullopt;
  made.character = body->character;
  made.poses = coverPoses(made.character, std::span(&made.motion, 1)).value();
  made.colliders =
      makeRigidColliders(made.character, undivided(made.character), made.poses.sampledView(), {{kVertices}, true, 0})
          .value();
  made.model = rigidModelOf(made.character, made.colliders);
  return made;
}

/// Its file with nothing added, or what a file of it would hold.
CharacterDocument documentOf(const Exported& made) {
  if (!made.file) return characterDocument(made.character);
  return characterDocument({dataset(made.animated.character), &*made.file}).value();
}

/// Names of its hulls, in their order.
std::vector<std::string> namesOf(const Exported& made) {
  std::vector<std::string> names;
  for (const RigidCollider& each : made.colliders) {
    names.push_back(made.character.skeleton.joint(each.joint).name + "_hull");
  }
  return plainNames(names);
}

// Exported colliders as the engines and viewers of others have them.

json runMujoco(const test::TemporaryFolder& folder, const json& job) {
  const fs::path out = folder.path() / "mujoco.json";
  const fs::path in = folder.write("job.json", job.dump());
  if (!test::runPeer("mujoco.mjs", {in.string(), out.string()})) return {};
  return test::readJson(out);
}

class PeerExports : public testing::TestWithParam<test::Animated> {};

TEST_P(PeerExports, ComeToRestOnTheFloorInMujoco) {
  LORICA_REQUIRE_EXPORT(made);
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "hero.xml";
  ASSERT_TRUE(writeMjcf(file, made->model, MjcfMotion::kJoints).ok());
  const json found =
      runMujoco(folder, {{"model", file.string()}, {"seconds", 10.0}, {"floor", 0.1 * made->character.height}});
  ASSERT_FALSE(found.is_null());
  EXPECT_EQ(found["bodies"], made->model.bodies.size());
  EXPECT_EQ(found["warnings"], 0);
  EXPECT_TRUE(found["finite"].get<bool>());
  EXPECT_LT(found["moved"].get<double>(), 0.01);  // [m], in the last second
  EXPECT_GT(found["lowest"].get<double>(), -0.05 * made->character.height);
  double mass = 0.0;
  for (const RigidBody& body : made->model.bodies) mass += body.mass;
  EXPECT_NEAR(found["mass"].get<double>(), mass, 1e-6 * mass);
  std::printf("%s: %zu bodies, %.3g kg, at rest within %.2g mm a second\n", GetParam().name, made->model.bodies.size(),
              mass, 1e3 * found["moved"].get<double>());
}

TEST_P(PeerExports, HaveTheirVolumesInMujoco) {
  LORICA_REQUIRE_EXPORT(made);
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "hero.xml";
  ASSERT_TRUE(writeMjcf(file, made->model, MjcfMotion::kJoints).ok());
  const json found = runMujoco(folder, {{"model", file.string()}, {"volumes", true}});
  ASSERT_FALSE(found.is_null());
  double worst = 0.0;
  for (const RigidBody& body : made->model.bodies) {
    double volume = 0.0;
    for (const NamedMesh& hull : body.hulls) volume += signedVolume(hull.mesh.vertices, hull.mesh.triangles);
    const double theirs = found["masses"][body.name].get<double>() / 1000.0;
    worst = std::max(worst, std::abs(theirs - volume) / volume);
    EXPECT_NEAR(theirs, volume, 1e-3 * volume) << body.name;
  }
  std::printf("%s: volumes within %.2g %% of MuJoCo's\n", GetParam().name, 100.0 * worst);
}

/// The distance of two segments.
double segmentDistance(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = d - c, w = a - c;
  const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), uw = u.dot(w), vw = v.dot(w);
  const double denominator = uu * vv - uv * uv;
  double least = kInfinity;
  const auto consider = [&](double s, double t) {
    s = std::clamp(s, 0.0, 1.0);
    t = std::clamp(t, 0.0, 1.0);
    least = std::min(least, (a + s * u - c - t * v).norm());
  };
  if (denominator > 1e-14) {
    const double s = (uv * vw - vv * uw) / denominator;
    const double t = (uu * vw - uv * uw) / denominator;
    if (s >= 0.0 && s <= 1.0 && t >= 0.0 && t <= 1.0) consider(s, t);
  }
  for (const double s : {0.0, 1.0}) consider(s, (s * uv + vw) / vv);
  for (const double t : {0.0, 1.0}) consider((t * uv - uw) / uu, t);
  return least;
}

/// The distance of two hulls that do not overlap: that of their nearest triangles, by trying all.
double slowDistance(const TriMesh& a, const TriMesh& b) {
  double least = kInfinity;
  const auto corners = [](const TriMesh& mesh, const Triangle& t) {
    return std::array<Vec3, 3>{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
  };
  for (const auto& [points, faces] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    for (const Vec3& p : points->vertices) {
      for (const Triangle& t : faces->triangles) {
        least = std::min(least, std::sqrt(nearestOnTriangle(p, corners(*faces, t)).first));
      }
    }
  }
  for (const Triangle& s : a.triangles) {
    for (const Triangle& t : b.triangles) {
      const auto p = corners(a, s), q = corners(b, t);
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          least = std::min(least, segmentDistance(p[i], p[(i + 1) % 3], q[j], q[(j + 1) % 3]));
        }
      }
    }
  }
  return least;
}

TriMesh placed(const TriMesh& hull, const Affine3& worldFromModel) {
  TriMesh mesh = hull;
  for (Vec3& p : mesh.vertices) p = worldFromModel * p;
  return mesh;
}

TEST_P(PeerExports, AreAsFarApartInMujocoInHundredPoses) {
  LORICA_REQUIRE_EXPORT(made);
  const std::vector<RigidCollider>& colliders = made->colliders;
  const BonePoseView poses = made->poses.heldOutView();
  ASSERT_GE(poses.poseCount(), GetParam().motion[0] == '\0' ? 10 : 100);
  Mat3 turn;  // as zUp()
  turn << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  json job = {{"model", ""}, {"mocap", json::array()}};
  std::vector<double> ours;
  for (int k = 0; k < std::min(100, poses.poseCount()); ++k) {
    const std::span<const Affine3> bones = poses.pose(k);
    json pose = json::object(), pairs = json::array();
    for (const RigidBody& body : made->model.bodies) {
      const Affine3& moved = bones[static_cast<std::size_t>(*body.joint)];
      const Vec3 at = zUp(Vec3(moved * body.origin));
      const Quat q(Mat3(turn * moved.linear() * turn.transpose()));
      pose[body.name] = {at.x(), at.y(), at.z(), q.w(), q.x(), q.y(), q.z()};
    }
    // Pairs of bodies, others in each pose.
    const std::size_t count = colliders.size();
    for (std::size_t n = 0, tried = 0; n < 2 && tried < 50; ++tried) {
      const std::size_t a = (static_cast<std::size_t>(k) * 7 + tried * 3) % count;
      const std::size_t b = (static_cast<std::size_t>(k) * 5 + tried * 11 + 1) % count;
      if (a == b) continue;
      const TriMesh first = placed(colliders[a].hull, bones[colliders[a].joint]);
      const TriMesh second = placed(colliders[b].hull, bones[colliders[b].joint]);
      if (!separatingPlane(first.vertices, second.vertices)) continue;
      // One hull a body, in the same order.
      pairs.push_back(json::array({made->model.bodies[a].hulls[0].name, made->model.bodies[b].hulls[0].name}));
      ours.push_back(slowDistance(first, second));
      ++n;
    }
    job["mocap"].push_back({{"pose", std::move(pose)}, {"pairs", std::move(pairs)}});
  }
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "hero.xml";
  ASSERT_TRUE(writeMjcf(file, made->model, MjcfMotion::kMocap).ok());
  job["model"] = file.string();
  const json found = runMujoco(folder, job);
  ASSERT_EQ(found["distances"].size(), ours.size());
  double worst = 0.0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    worst = std::max(worst, std::abs(found["distances"][i].get<double>() - std::min(ours[i], 10.0)));
  }
  EXPECT_LT(worst, 1e-3);
  EXPECT_GT(ours.size(), 20U);
  std::printf("%s: %zu distances within %.2g mm of MuJoCo's\n", GetParam().name, ours.size(), 1e3 * worst);
}

TEST_P(PeerExports, AreRobotsForRos) {
  if (std::system("command -v check_urdf >/dev/null 2>&1") != 0) {
    GTEST_SKIP() << "check_urdf is missing; scripts/peers installs it and runs these tests";
  }
  LORICA_REQUIRE_EXPORT(made);
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "hero.urdf";
  ASSERT_TRUE(writeUrdf(file, made->model).ok());
  EXPECT_EQ(std::system(("check_urdf " + file.string() + " >/dev/null 2>&1").c_str()), 0);
  json job = {{"model", file.string()}, {"seconds", 10.0}, {"meshes", json::array()}};
  for (const auto& entry : fs::directory_iterator(folder.path() / "hero_meshes")) job["meshes"].push_back(entry.path());
  const json found = runMujoco(folder, job);
  ASSERT_FALSE(found.is_null());
  EXPECT_EQ(found["warnings"], 0);
  EXPECT_TRUE(found["finite"].get<bool>());
  EXPECT_EQ(found["geoms"], made->colliders.size());
}

TEST_P(PeerExports, FollowTheirBonesInThree) {
  LORICA_REQUIRE_EXPORT(made);
  CharacterDocument document = test::documentOf(*made);
  const std::vector<std::string> names = test::namesOf(*made);
  addColliders(document, made->colliders, names, {"", "", true});
  const test::TemporaryFolder folder;
  fs::create_directory(folder.path() / "files");
  const fs::path glb = folder.path() / "files" / "hero.glb";
  ASSERT_TRUE(writeDocument(glb, document).ok());
  const bool keeps = made->file && made->file->format != "FBX";
  if (keeps) fs::copy_file(test::dataset(GetParam().character), folder.path() / "files" / "own.glb");

  const fs::path report = folder.path() / "report.json";
  ASSERT_TRUE(test::runPeer("validate.mjs", {(folder.path() / "files").string(), report.string()}));
  const auto errors = [&](const char* name) {
    const json issues = test::readJson(report).at(name);
    return std::count_if(issues.begin(), issues.end(), [](const json& issue) { return issue.at("severity") == 0; });
  };
  EXPECT_EQ(errors("hero.glb"), keeps ? errors("own.glb") : 0);

  const fs::path read = folder.path() / "read.json";
  ASSERT_TRUE(test::runPeer("gltf_transform.mjs", {glb.string(), read.string()}));
  const json nodes = test::readJson(read).at("nodes");
  for (std::size_t i = 0; i < names.size(); ++i) {
    ASSERT_TRUE(nodes.contains(names[i])) << names[i];
    EXPECT_EQ(nodes[names[i]]["triangles"], made->colliders[i].hull.triangles.size()) << names[i];
  }

  // Each joint with a hull turned a little: the hull's corners are where Lorica has them.
  const Skeleton& skeleton = made->character.skeleton;
  Pose pose = restPose(skeleton);
  json shots = {{"picture", false}, {"vertices", true}};
  shots["metresPerUnit"] = keeps ? made->file->metresPerUnit : 1.0;
  for (const RigidCollider& each : made->colliders) {
    const int node = document.nodeOfJoint[each.joint];
    if (node < 0 || skeleton.joint(each.joint).parent <= 0) continue;
    pose[each.joint].rotation =
        (pose[each.joint].rotation * Quat(Eigen::AngleAxisd(0.2, Vec3(1, 2, 3).normalized()))).normalized();
    const Quat& q = pose[each.joint].rotation;
    shots["shots"]["turned"]["nodes"][std::to_string(node)]["rotation"] = {q.x(), q.y(), q.z(), q.w()};
  }
  std::vector<Affine3> bones(pose.size());
  computeWorldFromJoint(skeleton, pose, bones);
  computeWorldFromModel(made->character, bones, bones);
  const auto shot = test::shootWithPeer(glb, shots);
  ASSERT_EQ(shot.size(), 1U);
  const json& meshes = shot.at("turned").facts.at("meshes");
  const json& allNames = shot.at("turned").facts.at("nodeNames");
  std::size_t first = 0, compared = 0;
  double farthest = 0.0;
  for (const json& mesh : meshes) {
    const std::string name = allNames.at(mesh.at("node").get<std::size_t>());
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) {
      const RigidCollider& collider = made->colliders[static_cast<std::size_t>(found - names.begin())];
      ++compared;
      for (std::size_t v = 0; v < collider.hull.vertices.size(); ++v) {
        const Vec3 there = shot.at("turned").vertices[first + v].cast<double>();
        farthest = std::max(farthest, (bones[collider.joint] * collider.hull.vertices[v] - there).norm());
      }
    }
    first += mesh.at("count").get<std::size_t>();
  }
  EXPECT_EQ(compared, names.size());
  EXPECT_LT(farthest, 2e-5 * std::max(1.0, made->character.height));
  std::printf("%s: %zu hulls below their bones, corners within %.2g mm in three.js\n", GetParam().name, compared,
              1e3 * farthest);
}

INSTANTIATE_TEST_SUITE_P(, PeerExports, testing::ValuesIn(test::kExported),
                         [](const auto& each) { return std::string(each.param.name); });

TEST(PeerExportsOfVrm, KeepPointsOutOfTheBody) {
  LORICA_REQUIRE_DATASET(path, "characters/godette/Godette_vrm_v4.vrm");
  LORICA_REQUIRE_PEERS();
  const std::optional<test::Exported> made =
      test::exported({"godette", "characters/godette/Godette_vrm_v4.vrm", "walk"});
  ASSERT_TRUE(made);
  CharacterDocument document = test::documentOf(*made);
  const int added =
      addSpringColliders(document, made->colliders, made->character.skeleton, made->file->springs, "Godette_vrm_v4.vrm")
          .value();
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "hero.vrm";
  ASSERT_TRUE(writeDocument(file, document).ok());
  EXPECT_EQ(readCharacterFile(file).value().springs.colliders.size(),
            made->file->springs.colliders.size() + static_cast<std::size_t>(added));

  // The middle of every capsule is inside in three-vrm too, by half a radius even between two balls of a row; two
  // metres beside the figure is outside.
  json shots = {{"picture", false}};
  json& probes = shots["shots"]["rest"]["probes"] = json::array();
  const Pose rest = restPose(made->character.skeleton);
  std::vector<Affine3> bones(rest.size());
  computeWorldFromJoint(made->character.skeleton, rest, bones);
  computeWorldFromModel(made->character, bones, bones);
  std::vector<double> radii;
  for (const RigidCollider& each : made->colliders) {
    if (document.hangOn[each.joint] < 0) continue;
    bool swings = false;
    for (const SpringChain& chain : made->file->springs.chains) {
      for (JointIndex j = each.joint; j != kNoJoint; j = made->character.skeleton.joint(j).parent) {
        for (const SpringJoint& joint : chain.joints) swings |= joint.joint == j;
      }
    }
    if (swings) continue;
    const Vec3 p = bones[each.joint] * Vec3(0.5 * (each.capsule.from + each.capsule.to));
    probes.push_back({p.x(), p.y(), p.z()});
    radii.push_back(withVolume(each.capsule, std::min(each.volume, each.capsule.volume())).radius);
  }
  probes.push_back({2.0, 1.0, 0.0});
  const auto shot = test::shootWithPeer(file, shots);
  ASSERT_EQ(shot.size(), 1U);
  const json& depths = shot.at("rest").facts.at("depths");
  ASSERT_EQ(depths.size(), radii.size() + 1);
  ASSERT_GT(radii.size(), 10U);
  for (std::size_t i = 0; i < radii.size(); ++i) EXPECT_LT(depths[i].get<double>(), -0.49 * radii[i]) << i;
  EXPECT_GT(depths.back().get<double>(), 0.3);
  std::printf("godette: %d balls for %zu springs; three-vrm keeps %zu points out\n", added,
              made->file->springs.chains.size(), radii.size());
}

// The volumes of exported hulls in physics engines, and the physics extensions of exported GLB files against schemas.

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
                              test::sourceFile("docs/samples/engines/blender_colliders.py").string() + "' -- '" +
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
}  // namespace lorica::test

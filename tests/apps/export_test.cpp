// `lorica export`: what is written, and what is refused in a sentence.
#include "capture/files/joint_csv.h"
#include "geometry/convex_hull.h"
#include "geometry/files.h"
#include "geometry/mesh_files.h"
#include "session/pose_source.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/apps/refusals.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

std::string writeL(const TemporaryFolder& folder) {
  const fs::path file = folder.path() / "l.obj";
  EXPECT_TRUE(writeObjObjects(file, {{"l", makeLShape()}}).ok());
  return file;
}

CommandResult runIn(const TemporaryFolder& folder, std::vector<std::string> arguments) {
  CommandSurroundings surroundings;
  surroundings.folder = folder.path();
  surroundings.cache = folder.path() / "cache";
  return runLorica(arguments, surroundings);
}

TEST(Export, AMeshComesInEveryFormat) {
  const TemporaryFolder folder;
  (void)writeL(folder);
  for (const std::string out : {"h.obj", "h.stl", "h.ply", "h.xml", "h.urdf", "h.glb"}) {
    const CommandResult result = runIn(folder, {"export", "l.obj", out, "--parts", "2", "--json", "-"});
    ASSERT_EQ(result.exitCode, 0) << out << ": " << result.err;
    EXPECT_EQ(result.json()["hulls"], 2) << out;
    EXPECT_TRUE(fs::exists(folder.path() / out));
  }
  for (const char* mesh : {"h.obj", "h.stl", "h.ply"}) {
    const TriMesh hulls = readMesh(folder.path() / mesh).value();
    EXPECT_NEAR(signedVolume(hulls.vertices, hulls.triangles), 3.0, 1e-9) << mesh;
  }
  EXPECT_NE(readFile(folder.path() / "h.xml").value().find("<freejoint"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder.path() / "h_meshes" / "l_hull_1.stl"));
}

/// (x, y, z) is written as (z, x, y), or as it is.
TEST(Export, WhichAxisOfAMeshPointsUpIsChosen) {
  const TemporaryFolder folder;
  const TriMesh l = valueOf(readMesh(writeL(folder)));
  const Aabb box = boundsOf(l.vertices);
  const auto written = [&](const std::string& up) {
    const CommandResult made = runIn(folder, {"export", "l.obj", up + ".urdf", "--parts", "2", "--up", up});
    EXPECT_EQ(made.exitCode, 0) << made.err;
    Aabb all;
    for (const char* hull : {"l_hull_0.stl", "l_hull_1.stl"}) {
      const TriMesh mesh = valueOf(readMesh(folder.path() / (up + "_meshes") / hull));
      for (const Vec3& p : mesh.vertices) all.extend(p);
    }
    return all;
  };
  const Vec3 size = box.max - box.min;
  const Aabb kept = written("z"), turned = written("y");
  EXPECT_LT((kept.min - box.min).norm() + (kept.max - box.max).norm(), 1e-6);
  EXPECT_LT((turned.max - turned.min - Vec3(size.z(), size.x(), size.y())).norm(), 1e-6);
  EXPECT_GT(std::abs(size.x() - size.z()), 0.1) << "else the turn would not show";
}

TEST(Export, OfDecomposeIsTheSame) {
  const TemporaryFolder folder;
  (void)writeL(folder);
  ASSERT_EQ(runIn(folder, {"decompose", "l.obj", "--parts", "2", "-o", "l.lorica", "--export-obj", "a.obj"}).exitCode,
            0);
  ASSERT_EQ(runIn(folder, {"export", "l.obj", "b.obj", "--parts", "2"}).exitCode, 0);
  ASSERT_EQ(runIn(folder, {"export", "l.lorica", "c.obj"}).exitCode, 0);
  const std::string hulls = readFile(folder.path() / "a.obj").value();
  EXPECT_EQ(readFile(folder.path() / "b.obj").value(), hulls);
  EXPECT_EQ(readFile(folder.path() / "c.obj").value(), hulls);
}

TEST(Export, EnginesLimitTheVertices) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "ball.obj";
  ASSERT_TRUE(writeObjObjects(file, {{"ball", makeSphere(1.0, 12, 24)}}).ok());
  const CommandResult unreal =
      runIn(folder, {"export", "ball.obj", "h.glb", "--engine", "unreal", "--parts", "1", "--json", "-"});
  ASSERT_EQ(unreal.exitCode, 0) << unreal.err;
  EXPECT_EQ(unreal.json()["maxVertices"], 32);
  EXPECT_NE(readFile(folder.path() / "h.glb").value().find("\"UCX_part_0\""), std::string::npos);
  const auto most = [&](std::vector<std::string> given) {
    given.insert(given.begin(), {"export", "ball.obj", "h.obj", "--parts", "1", "--force", "--json", "-"});
    return runIn(folder, given).json()["maxVertices"];
  };
  EXPECT_EQ(most({}), 64);
  EXPECT_EQ(most({"--engine", "godot"}), 64);
  EXPECT_EQ(most({"--hull-vertices", "0"}), most({"--engine", "jolt", "--hull-vertices", "300"}));
}

TEST(Export, HullsOfAMomentHoldTheSkin) {
  const TemporaryFolder folder;
  const CommandResult made = runIn(
      folder, {"decompose", "mannequin", "--parts", "2", "--keyframes", "2", "--motion", "walk", "-o", "body.lorica"});
  ASSERT_EQ(made.exitCode, 0) << made.err;
  const CommandResult result = runIn(folder, {"export", "body.lorica", "at.obj", "--motion", "walk", "--at", "1.5"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  std::vector<ConvexHull> hulls;
  const std::vector<NamedMesh> parts = readObjObjects(folder.path() / "at.obj").value();
  for (const NamedMesh& part : parts) {
    hulls.push_back(convexHull(part.mesh.vertices));
  }
  ASSERT_EQ(hulls.size(), 2U);

  const Character mannequin = makeMannequin();
  const SkeletalMotion walk = perform(mannequin, readJointCsv(recordingsFolder() / "walk.csv").value()).value();
  Pose pose = restPose(mannequin.skeleton);
  poseAt(walk, walk.times.front() + 1.5, pose);
  std::vector<Affine3> bones(pose.size());
  computeWorldFromJoint(mannequin.skeleton, pose, bones);
  computeWorldFromModel(mannequin, bones, bones);
  std::vector<Vec3> skin(mannequin.mesh.vertices.size());
  skinLinearBlend(mannequin, bones, skin);
  double farthest = 0.0;
  for (std::size_t v = 0; v < skin.size(); v += 7) {
    const std::span<const Vec3> one(&skin[v], 1);
    farthest = std::max(farthest, std::min(largestViolation(hulls[0], one), largestViolation(hulls[1], one)));
  }
  EXPECT_LT(farthest, 1e-5);
  const CommandResult late = runIn(folder, {"export", "body.lorica", "b.obj", "--motion", "walk", "--at", "100"});
  EXPECT_EQ(late.exitCode, 2);
  EXPECT_NE(late.err.find("--at 100: walk lasts"), std::string::npos) << late.err;
}

TEST(Export, WhatCannotBeIsRefusedInASentence) {
  const TemporaryFolder folder;
  (void)writeL(folder);
  expectRefused(folder, {"export", "l.obj", "l.obj"}, {"l.obj", "overwritten"});
  expectRefused(folder, {"export", "l.obj", "l.usd"}, {"`.usd`", ".obj", ".glb"});
  expectRefused(folder, {"export", "l.obj", "l"}, {"extension ``", ".xml"});
  expectRefused(folder, {"export", "l.obj", "h.vrm"}, {"h.vrm", "springs", "l.obj", ".glb"});
  expectRefused(folder, {"export", "l.obj", "h.stl", "--per-bone"}, {"--per-bone", "static mesh"});
  expectRefused(folder, {"export", "l.obj", "h.stl", "--motion", "walk", "--at", "1"}, {"--at", "static mesh"});
  expectRefused(folder, {"export", "l.obj", "h.xml", "--motion", "walk", "--at", "1"}, {"h.xml", "--at", ".ply"});
  expectRefused(folder, {"export", "mannequin", "h.stl", "--at", "1"}, {"--at", "--motion"});
  expectRefused(folder, {"export", "mannequin", "h.stl", "--motion", "walk"}, {"--motion", "--at"});
  expectRefused(folder, {"export", "l.obj", "h.stl", "--mocap"}, {"--mocap", ".xml"});
  expectRefused(folder, {"export", "l.obj", "h.xml", "--khr"}, {"--khr", ".glb"});
  expectRefused(folder, {"export", "l.obj", "h.xml", "--show-colliders"}, {"--show-colliders", ".glb"});
  expectRefused(folder, {"export", "l.obj", "h.xml", "--hull-vertices", "3"}, {"--hull-vertices 3", "0 for no limit"});
  expectRefused(folder, {"export", "l.obj", "h.xml", "--engine", "quake"}, {"quake", "unity", "godot"});
  expectRefused(folder, {"export", "l.obj", "h.stl", "--up", "z"}, {"--up z", ".urdf", "h.stl"});
  expectRefused(folder, {"export", "l.obj", "h.xml", "--up", "x"}, {"--up", "y, z"});
  expectRefused(folder, {"export", "l.obj", "no/h.xml"}, {"no"});
  expectRefused(folder, {"export", "mannequin", "h.glb", "--parts", "4"}, {"--parts", "mannequin", "--decomposition"});
  folder.write("r_meshes", "a file");
  expectRefused(folder, {"export", "l.obj", "r.urdf"}, {"r_meshes is a file, expected a folder"});
  expectRefused(folder, {"export", "gone.lorica", "h.glb"}, {"gone.lorica"});
}

TEST(Export, ADecompositionNeedsWhatItWasMadeFrom) {
  const TemporaryFolder folder;
  (void)writeL(folder);
  ASSERT_EQ(runIn(folder, {"decompose", "l.obj", "--parts", "2", "-o", "l.lorica"}).exitCode, 0);
  fs::rename(folder.path() / "l.obj", folder.path() / "m.obj");
  expectRefused(folder, {"export", "l.lorica", "h.ply"}, {"l.lorica", "l.obj", "--decomposition"});
  EXPECT_EQ(runIn(folder, {"export", "m.obj", "h.ply", "--decomposition", "l.lorica"}).exitCode, 0);
  ASSERT_TRUE(writeObjObjects(folder.path() / "t.obj", {{"t", makeTetrahedron()}}).ok());
  expectRefused(folder, {"export", "t.obj", "i.ply", "--decomposition", "l.lorica"}, {"l.lorica", "t.obj"});
}

}  // namespace
}  // namespace lorica::test

#include "capture/files/joint_csv.h"
#include "geometry/convex_hull.h"
#include "geometry/files.h"
#include "geometry/mesh_files.h"
#include "session/pose_source.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/apps/refusals.h"
#include "tests/apps/run_command.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <tuple>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// `lorica export`: what is written, and what is refused in a sentence.

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
  EXPECT_TRUE(has(readFile(folder.path() / "h.xml").value(), "<freejoint"));
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
  EXPECT_TRUE(has(readFile(folder.path() / "h.glb").value(), "\"UCX_part_0\""));
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
  expectRefused(runIn(folder, {"export", "body.lorica", "b.obj", "--motion", "walk", "--at", "100"}),
                {"--at 100: walk lasts"});
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

// `lorica export` of characters that formats and folders cannot take as they are.

class ExportInput : public testing::Test {
 protected:
  void write(const GlbWriter& writer) { folder_.write("hero.glb", writer.glb()); }

  CommandResult exportTo(const std::string& out, std::vector<std::string> options = {}) {
    CommandSurroundings surroundings;
    surroundings.folder = folder_.path();
    options.insert(options.begin(), {"export", "hero.glb", out, "--body", "never"});
    return runLorica(options, surroundings);
  }

  void expectRefused(const std::string& out, const std::string& sentence,
                     const std::vector<std::string>& options = {}) {
    const CommandResult result = exportTo(out, options);
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_EQ(result.err, "lorica: " + sentence + "\n");
    EXPECT_FALSE(fs::exists(folder_.path() / out));
  }

  std::string text(const std::string& file) { return readFile(folder_.path() / file).value(); }

  TemporaryFolder folder_;
};

/// The small character with more joints, all below the first one.
GlbWriter withJoints(int count) {
  GlbWriter writer = smallCharacter();
  std::vector<Affine3> inverseBinds(static_cast<std::size_t>(count), Affine3::Identity());
  inverseBinds[1] = Affine3(Eigen::Translation3d(0.0, -1.0, 0.0));
  for (int i = 2; i < count; ++i) {
    const int node = writer.add("nodes", json::object());
    writer.document["nodes"][0]["children"].push_back(node);
    writer.document["skins"][0]["joints"].push_back(node);
  }
  writer.document["skins"][0]["inverseBindMatrices"] = writer.matrices(inverseBinds);
  return writer;
}

TEST_F(ExportInput, NamesThatCollideOrAreInvalidBecomePlain) {
  GlbWriter writer = smallCharacter();
  writer.document["nodes"][0]["name"] = "a\"b<";
  writer.document["nodes"][1]["name"] = "a\"b>";
  write(writer);
  for (const auto& [out, second] : {std::pair("hero.xml", "\"a_b__2\""), std::pair("hero.urdf", "\"a_b__2\""),
                                    std::pair("bones.glb", "\"a_b__0_2\"")}) {
    const CommandResult result = exportTo(out, {"--per-bone"});
    EXPECT_EQ(result.exitCode, 0) << out << result.err;
    EXPECT_TRUE(has(text(out), second)) << out;
  }
  EXPECT_FALSE(has(text("hero.xml"), "a\"b"));
  ASSERT_EQ(exportTo("bones.obj", {"--per-bone"}).exitCode, 0);
  std::set<std::string> names;
  const std::vector<NamedMesh> hulls = readObjObjects(folder_.path() / "bones.obj").value();
  for (const NamedMesh& hull : hulls) names.insert(hull.name);
  EXPECT_EQ(names.size(), 2U);
}

TEST_F(ExportInput, EqualNamesOfBonesStayApart) {
  GlbWriter writer = smallCharacter();
  writer.document["nodes"][0]["name"] = "bone";
  writer.document["nodes"][1]["name"] = "bone";
  write(writer);
  ASSERT_EQ(exportTo("hero.xml", {"--per-bone"}).exitCode, 0);
  expectAll(text("hero.xml"), {"<body name=\"bone\"", "<body name=\"bone_2\""});
}

TEST_F(ExportInput, ACharacterWithoutBonesIsAMesh) {
  GlbWriter writer = smallCharacter();
  writer.document.erase("skins");
  writer.document.erase("animations");
  writer.document["nodes"][2].erase("skin");
  write(writer);
  expectRefused("bones.glb", "--per-bone is for characters, but hero is a static mesh", {"--per-bone"});
  ASSERT_EQ(exportTo("hero.xml").exitCode, 0);
  EXPECT_TRUE(has(text("hero.xml"), "<freejoint"));
}

TEST_F(ExportInput, MoreBonesThanAnyCharacterHasAreRefused) {
  write(withJoints(2049));
  expectRefused("hero.xml", "hero.glb: 2,049 joints, expected at most 2,048");
  GlbWriter writer = smallCharacter();
  const json bone = {{"name", "bone"}};
  for (int i = 3; i <= 100'000; ++i) writer.document["nodes"].push_back(bone);
  write(writer);
  expectRefused("hero.glb.xml", "hero.glb: 100,001 nodes, expected at most 100,000");
}

TEST_F(ExportInput, AsManyBonesAsAllowedAreExported) {
  write(withJoints(2048));
  const CommandResult result = exportTo("hero.xml", {"--per-bone", "--json", "-"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(result.json()["bones"], 2);  // those with skin
}

TEST_F(ExportInput, FoldersThatTakeNoFileAreRefused) {
  write(smallCharacter());
  expectRefused("/proc/self/hero.xml", "OUT: /proc/self/hero.xml: the folder /proc/self is not writable");
  expectRefused("/proc/self/hero.urdf", "OUT: /proc/self/hero.urdf: the folder /proc/self is not writable");
  expectRefused("hero.glb/hero.xml", "OUT: hero.glb/hero.xml: no such folder: hero.glb");
  expectRefused("gone/hero.xml", "OUT: gone/hero.xml: no such folder: gone");
}

TEST(ExportRobot, WhatIsWrongIsOneSentenceAndNothingIsWritten) {
  const TemporaryFolder folder;
  CommandSurroundings surroundings;
  surroundings.folder = folder.path();
  folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  const auto robot = [](const std::string& attributes, bool mjcf) {
    return mjcf ? "<mujoco><asset><mesh name=\"m\" " + attributes +
                      "/></asset><worldbody><geom type=\"mesh\" mesh=\"m\"/></worldbody></mujoco>"
                : "<robot name=\"r\"><link name=\"a\"><collision><geometry><mesh " + attributes +
                      "/></geometry></collision></link></robot>";
  };
  const std::string outside = " is outside the file's folder, expected a file in it (or --trust-paths)";
  for (const auto& [mesh, mjcf, sentence] :
       {std::tuple("file=\"none.obj\"", true, std::string("none.obj: cannot be read: No such file or directory")),
        {"file=\"/etc/passwd\"", true, "'/etc/passwd'" + outside},
        {"file=\"../t.obj\"", true, "'../t.obj'" + outside},
        {"file=\"t.max\"", true, "t.max: found the extension '.max', expected .obj, .stl, .ply, .off, .msh or .dae"},
        {"file=\"flat.obj\"", true, "flat.obj: "},
        {"file=\"t.obj\" scale=\"1 0 1\"", true,
         "scale: found a mesh without volume, expected three numbers other than 0"},
        {"filename=\"none.obj\"", false, "none.obj: cannot be read: No such file or directory"},
        {"filename=\"package://arm/t.obj\"", false,
         "'package://arm/t.obj' is in the package 'arm', expected --package arm=FOLDER"},
        {"filename=\"file:///etc/passwd\"", false, "'file:///etc/passwd'" + outside}}) {
    const std::string in = mjcf ? "robot.xml" : "robot.urdf", out = mjcf ? "out.xml" : "out.urdf";
    folder.write(in, robot(mesh, mjcf));
    if (std::string(mesh).find("t.max") != std::string::npos) folder.write("t.max", "");
    const std::vector<std::string> before = filesIn(folder.path());
    const CommandResult result = runLorica({"export", in, out}, surroundings);
    EXPECT_EQ(result.exitCode, 2) << mesh;
    EXPECT_EQ(result.err.rfind("lorica: " + in + ":1: " + sentence, 0), 0U) << result.err;
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    EXPECT_EQ(filesIn(folder.path()), before) << mesh;
  }
  // A mirrored mesh is no mistake: its hull is mirrored alike.
  folder.write("robot.xml", robot("file=\"t.obj\" scale=\"-1 1 1\"", true));
  const CommandResult mirrored = runLorica({"export", "robot.xml", "out.xml"}, surroundings);
  EXPECT_EQ(mirrored.exitCode, 0) << mirrored.err;
  EXPECT_TRUE(has(readFile(folder.path() / "out.xml").value(), "scale=\"-1 1 1\""));
}

}  // namespace
}  // namespace lorica::test

// `lorica export` of characters that formats and folders cannot take as they are.
#include "geometry/files.h"
#include "geometry/mesh_files.h"
#include "tests/apps/run_command.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <tuple>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

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
    EXPECT_NE(text(out).find(second), std::string::npos) << out;
  }
  EXPECT_EQ(text("hero.xml").find("a\"b"), std::string::npos);
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
  EXPECT_NE(text("hero.xml").find("<body name=\"bone\""), std::string::npos);
  EXPECT_NE(text("hero.xml").find("<body name=\"bone_2\""), std::string::npos);
}

TEST_F(ExportInput, ACharacterWithoutBonesIsAMesh) {
  GlbWriter writer = smallCharacter();
  writer.document.erase("skins");
  writer.document.erase("animations");
  writer.document["nodes"][2].erase("skin");
  write(writer);
  expectRefused("bones.glb", "--per-bone is for characters, but hero is a static mesh", {"--per-bone"});
  ASSERT_EQ(exportTo("hero.xml").exitCode, 0);
  EXPECT_NE(text("hero.xml").find("<freejoint"), std::string::npos);
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
  EXPECT_NE(readFile(folder.path() / "out.xml").value().find("scale=\"-1 1 1\""), std::string::npos);
}

}  // namespace
}  // namespace lorica::test

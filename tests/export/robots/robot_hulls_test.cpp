#include "export/robots/robot_hulls.h"

#include "export/capsule.h"
#include "export/robots/robot.h"
#include "geometry/convex_hull.h"
#include "geometry/files.h"
#include "geometry/mesh_files.h"
#include "tests/export/robots/made_robot.h"
#include "tests/support/meshes.h"
#include "tests/support/utf16.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <pugixml.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace lorica {
namespace {

namespace fs = std::filesystem;

std::size_t timesIn(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

/// The lines of a text for which keep(line) is true.
template <typename Keep>
std::string lines(const std::string& text, const Keep& keep) {
  std::istringstream in(text);
  std::string kept;
  for (std::string line; std::getline(in, line);) kept += keep(line) ? line + "\n" : "";
  return kept;
}

std::vector<double> numbers(const pugi::xml_attribute& attribute) {
  std::istringstream in(attribute.value());
  return {std::istream_iterator<double>(in), std::istream_iterator<double>()};
}

Vec3 vectorOf(const pugi::xml_attribute& attribute) {
  const std::vector<double> n = numbers(attribute);
  return n.size() == 3 ? Vec3(n[0], n[1], n[2]) : Vec3(Vec3::Zero());
}

RobotReport exported(const RobotExportOptions& options) {
  Host host;
  Result<RobotReport> report = exportRobot(options, host);
  EXPECT_TRUE(report.ok()) << (report.ok() ? "" : report.error().message);
  return report.ok() ? *report : RobotReport();
}

TEST(RobotHulls, OfMjcfLeaveAllElseByteForByte) {
  const test::TemporaryFolder folder;
  const fs::path robot = test::writeMadeMjcf(folder);
  const auto before = test::contentOf(folder.path());
  const RobotReport report = exported(test::madeOptions(robot, "out.xml"));
  auto after = test::contentOf(folder.path());
  EXPECT_EQ(report.meshes, 2U);  // the L is in two assets
  EXPECT_EQ(report.files, 2U);
  EXPECT_EQ(report.links.size(), 3U);
  ASSERT_EQ(after.size(), before.size() + 2);
  for (const auto& [name, content] : before) EXPECT_EQ(after[name], content) << name;

  // The main file: without the new lines it is what it was, but for the three that were changed.
  const std::string main = after["out.xml"];
  const auto isOld = [](const std::string& line) {
    return line.find("_hull_") == std::string::npos && line.find("asset>") == std::string::npos && !line.empty() &&
           line.find("\"trunk\"") == std::string::npos && line.find("leg.xml") == std::string::npos &&
           line.find("\"upper\"") == std::string::npos;
  };
  EXPECT_EQ(lines(main, isOld), lines(before.at("robot.xml"), isOld));
  EXPECT_EQ(timesIn(main, "<include file=\"out_leg.xml\"/>"), 1U);
  EXPECT_EQ(timesIn(main, "<include file=\"parts/assets.xml\"/>"), 1U);
  // What gives mass stays, in its own bytes but for two attributes; what does not is gone.
  EXPECT_EQ(timesIn(main,
                    "<geom contype=\"0\" conaffinity=\"0\" name=\"trunk\"   mesh='l' pos=\"0.01 0 0\" "
                    "euler=\"0 0 0.5\"\tfriction=\"0.9 0.005 0.0001\" />"),
            1U);
  EXPECT_EQ(timesIn(main, "\"upper\""), 0U);
  EXPECT_EQ(timesIn(main, "<geom mass=\"0\" name=\"trunk_hull_0\"   mesh='l_hull_0' pos=\"0.01 0 0\""), 1U);
  EXPECT_EQ(timesIn(main, "<geom mass=\"0\" name=\"upper_hull_0\" class=\"soft\" mesh=\"mirrored_hull_0\"/>"), 1U);
  // A pair for each hull.
  EXPECT_EQ(timesIn(main, "<pair geom1=\"upper_hull_"), timesIn(main, "class=\"soft\" mesh"));
  // The leg is seen: it stays, and its hulls are in a group that is not drawn.
  const std::string leg = after["out_leg.xml"];
  EXPECT_EQ(timesIn(leg, "<geom contype=\"0\" conaffinity=\"0\" mesh=\"torus\" group=\"0\"/>"), 1U);
  EXPECT_EQ(timesIn(leg, "<geom mass=\"0\" mesh=\"torus_hull_0\" group=\"3\"/>"), 1U);
}

TEST(RobotHulls, OfMjcfHoldTheirMeshesInTheirAssetsFrames) {
  const test::TemporaryFolder folder;
  (void)exported(test::madeOptions(test::writeMadeMjcf(folder), "out.xml"));
  pugi::xml_document document;
  ASSERT_TRUE(document.load_file((folder.path() / "out.xml").c_str()));
  std::map<std::string, std::vector<ConvexHull>> hulls;
  std::map<std::string, double> volumes;
  for (const pugi::xml_node& asset : document.child("mujoco").children("asset")) {
    for (const pugi::xml_node& mesh : asset.children("mesh")) {
      const std::string name = mesh.attribute("name").value();
      const std::string base = name.substr(0, name.find("_hull_"));
      const std::vector<double> n = numbers(mesh.attribute("vertex"));
      std::vector<Vec3> points;
      for (std::size_t i = 0; i + 2 < n.size(); i += 3) points.emplace_back(n[i], n[i + 1], n[i + 2]);
      hulls[base].push_back(convexHull(points));
      volumes[base] += hulls[base].back().volume;
      if (base == "mirrored") {
        EXPECT_STREQ(mesh.attribute("scale").value(), "-0.1 0.1 0.2");
        EXPECT_STREQ(mesh.attribute("refpos").value(), "0.5 0.5 0");
        EXPECT_STREQ(mesh.attribute("refquat").value(), "0.9 0.1 0.3 0.2");
      }
    }
  }
  ASSERT_EQ(hulls.size(), 3U);
  // In the coordinates of the file, whatever the scale: the L is two boxes.
  EXPECT_EQ(hulls["l"].size(), 2U);
  EXPECT_NEAR(volumes["l"], 3.0, 1e-6);
  EXPECT_NEAR(volumes["mirrored"], 3.0, 1e-6);
  for (const auto& [name, file] : {std::pair("l", "l.obj"), {"mirrored", "l.obj"}, {"torus", "torus.stl"}}) {
    const TriMesh mesh = readMesh(folder.path() / "meshes" / file).value();
    for (const Vec3& p : mesh.vertices) {
      double least = kInfinity;
      for (const ConvexHull& hull : hulls[name]) least = std::min(least, largestViolation(hull, {{p}}));
      EXPECT_LT(least, 1e-5 * boundsOf(mesh.vertices).diagonal()) << name;
    }
  }
}

TEST(RobotHulls, FiguresOfALinkAreThoseOfItsMeshes) {
  const test::TemporaryFolder folder;
  const RobotReport report = exported(test::madeOptions(test::writeMadeMjcf(folder), "out.xml"));
  ASSERT_EQ(report.links.size(), 3U);
  const RobotLinkReport& torso = report.links[0];
  EXPECT_EQ(torso.name, "torso");
  EXPECT_EQ(torso.shapes, 2);
  EXPECT_NEAR(torso.volumes[0], 0.003, 1e-9);  // 3 units of (0.1 m)^3
  EXPECT_NEAR(torso.volumes[1], 0.0035, 1e-9);
  EXPECT_NEAR(torso.volumes[2], 0.003, 1e-9);
  EXPECT_NEAR(torso.covered, 1.0, 1e-6);
  EXPECT_NEAR(torso.standOff[1], 0.0, 1e-9);
  EXPECT_NEAR(report.links[1].volumes[0], 0.006, 1e-9);  // mirrored and stretched
  EXPECT_GT(report.links[2].standOff[1], 0.0);
  EXPECT_EQ(report.links[2].name, "leg");
}

TEST(RobotHulls, OneHullForTheLReachesWhereTheTwoDoNot) {
  // A small box in the notch of the L, which the hull of the whole L covers.
  const test::TemporaryFolder folder;
  ASSERT_TRUE(writeObjObjects(folder.path() / "l.obj", {{"l", test::makeLShape()}}).ok());
  const TriMesh box = test::makeBox(Vec3(1.2, 1.2, 0.2), Vec3(1.4, 1.4, 0.8));
  ASSERT_TRUE(writeObjObjects(folder.path() / "box.obj", {{"box", box}}).ok());
  const fs::path robot = folder.write("robot.xml", R"(<mujoco><asset><mesh file="l.obj"/><mesh file="box.obj"/></asset>
    <worldbody><body name="a"><freejoint/><geom type="mesh" mesh="l"/></body>
    <body name="b"><freejoint/><geom type="mesh" mesh="box"/></body></worldbody></mujoco>)");
  RobotExportOptions options = test::madeOptions(robot, "out.xml");
  options.replace = true;
  EXPECT_TRUE(exported(options).newContacts.empty());
  options.source.parts = 1;
  const std::vector<std::pair<std::string, std::string>> expected = {{"a", "b"}};
  EXPECT_EQ(exported(options).newContacts, expected);
  // The body of what was written is as it was.
  options.source.parts = 0;
  (void)exported(options);
  const std::string once = readFile(options.output).value();
  (void)exported(options);
  EXPECT_EQ(readFile(options.output).value(), once);
}

/// A closed surface without any symmetry, that is not convex.
TriMesh lumpyRing() {
  TriMesh mesh = test::makeTorus(1.0, 0.3, 14, 8);
  for (Vec3& p : mesh.vertices) {
    p +=
        Vec3(0.1 * std::sin(3.0 * p.y() + 1.0), 0.08 * std::cos(4.0 * p.x()) + 0.3, 0.2 * p.x() * p.x() + 0.05 * p.y());
  }
  return mesh;
}

/// Its mirror image in an axis, with vertices and triangles in another order.
TriMesh mirrorImage(const TriMesh& mesh, int axis) {
  TriMesh image;
  const int count = static_cast<int>(mesh.vertices.size());
  for (int v = count - 1; v >= 0; --v) {
    Vec3 p = mesh.vertices[v];
    p[axis] = -p[axis];
    image.vertices.push_back(p);
  }
  for (std::size_t i = mesh.triangles.size(); i-- > 0;) {
    const Triangle& t = mesh.triangles[i];
    image.triangles.push_back({count - 1 - t[2], count - 1 - t[1], count - 1 - t[0]});
    std::rotate(image.triangles.back().begin(), image.triangles.back().begin() + i % 3, image.triangles.back().end());
  }
  return image;
}

/// The vertices of the hulls of a mesh in a file of MuJoCo, sorted; one coordinate may be mirrored.
std::vector<std::array<double, 3>> hullVertices(const pugi::xml_document& document, const std::string& mesh,
                                                int mirrorAxis = -1) {
  std::vector<std::array<double, 3>> all;
  for (const pugi::xpath_node& each : document.select_nodes("//mesh[@vertex]")) {
    if (!std::string(each.node().attribute("name").value()).starts_with(mesh + "_hull_")) continue;
    const std::vector<double> n = numbers(each.node().attribute("vertex"));
    for (std::size_t i = 0; i + 2 < n.size(); i += 3) {
      all.push_back({n[i], n[i + 1], n[i + 2]});
      if (mirrorAxis >= 0) all.back()[mirrorAxis] = 0.0 - all.back()[mirrorAxis];
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

TEST(RobotHulls, OfMirrorImagesAreMirrorImages) {
  const TriMesh ring = lumpyRing();
  for (int axis = 0; axis < 3; ++axis) {
    SCOPED_TRACE(axis);
    // The mesh; another file that is its mirror image; the mesh again with a scale that mirrors.
    const test::TemporaryFolder folder;
    ASSERT_TRUE(writeObjObjects(folder.path() / "left.obj", {{"m", ring}}).ok());
    ASSERT_TRUE(writeObjObjects(folder.path() / "right.obj", {{"m", mirrorImage(ring, axis)}}).ok());
    Vec3 scale(0.2, 0.3, 0.25);
    const auto text = [](const Vec3& v) { return fmt::format("{} {} {}", v.x(), v.y(), v.z()); };
    std::string assets = "<mesh file=\"left.obj\" scale=\"" + text(scale) + "\"/><mesh file=\"right.obj\" scale=\"" +
                         text(scale) + "\"/>";
    scale[axis] = -scale[axis];
    assets += "<mesh name=\"turned\" file=\"left.obj\" scale=\"" + text(scale) + "\"/>";
    std::string bodies;
    for (const char* mesh : {"left", "right", "turned"}) {
      bodies += fmt::format("<body name=\"{0}\" pos=\"0 0 {1}\"><geom type=\"mesh\" mesh=\"{0}\"/></body>", mesh,
                            bodies.size());
    }
    const fs::path robot = folder.write(
        "robot.xml", "<mujoco><asset>" + assets + "</asset><worldbody>" + bodies + "</worldbody></mujoco>");
    for (const bool capsules : {false, true}) {
      RobotExportOptions options = test::madeOptions(robot, "out.xml");
      options.capsules = capsules;
      options.replace = true;
      const RobotReport report = exported(options);
      EXPECT_EQ(report.meshes, 1U);
      ASSERT_EQ(report.links.size(), 3U);
      EXPECT_GT(report.links[0].shapes, 1);
      for (const RobotLinkReport& link : report.links) {  // to the last bit
        EXPECT_EQ(link.volumes, report.links[0].volumes) << link.name;
        EXPECT_EQ(link.standOff, report.links[0].standOff) << link.name;
        EXPECT_EQ(link.covered, report.links[0].covered) << link.name;
      }
      pugi::xml_document document;
      ASSERT_TRUE(document.load_file((folder.path() / "out.xml").c_str()));
      if (!capsules) {
        const auto left = hullVertices(document, "left");
        ASSERT_GT(left.size(), 8U);
        EXPECT_EQ(hullVertices(document, "right", axis), left);
        EXPECT_EQ(hullVertices(document, "turned"), left);  // whose scale mirrors
        continue;
      }
      std::map<std::string, std::vector<std::array<double, 4>>> middles;
      for (const pugi::xml_node& body : document.child("mujoco").child("worldbody").children("body")) {
        const std::string name = body.attribute("name").value();
        for (const pugi::xml_node& geom : body.children("geom")) {
          const std::vector<double> pos = numbers(geom.attribute("pos")), size = numbers(geom.attribute("size"));
          if (pos.size() != 3 || size.empty()) continue;
          middles[name].push_back({pos[0], pos[1], pos[2], size[0]});
          if (name != "left") middles[name].back()[axis] = 0.0 - middles[name].back()[axis];
        }
        std::sort(middles[name].begin(), middles[name].end());
      }
      EXPECT_GT(middles["left"].size(), 1U);
      EXPECT_EQ(middles["right"], middles["left"]);
      EXPECT_EQ(middles["turned"], middles["left"]);
    }
  }
  // What is nearly a mirror image is a mesh of its own.
  const test::TemporaryFolder folder;
  TriMesh other = mirrorImage(ring, 0);
  other.vertices[5].x() += 1e-6;
  ASSERT_TRUE(writeObjObjects(folder.path() / "left.obj", {{"m", ring}}).ok());
  ASSERT_TRUE(writeObjObjects(folder.path() / "right.obj", {{"m", other}}).ok());
  const fs::path robot = folder.write(
      "robot.xml",
      "<mujoco><asset><mesh file=\"left.obj\"/><mesh file=\"right.obj\"/></asset><worldbody><geom type=\"mesh\" "
      "mesh=\"left\"/><geom type=\"mesh\" mesh=\"right\"/></worldbody></mujoco>");
  EXPECT_EQ(exported(test::madeOptions(robot, "out.xml")).meshes, 2U);
}

TEST(RobotHulls, OfAttachedModelsAreInTheirFiles) {
  const test::TemporaryFolder folder;
  const fs::path robot = test::writeAttachingMjcf(folder);
  const auto before = test::contentOf(folder.path());
  const RobotReport report = exported(test::madeOptions(robot, "out.xml"));
  auto after = test::contentOf(folder.path());
  EXPECT_EQ(report.meshes, 1U);  // two files, mirrored and not
  EXPECT_EQ(report.files, 3U);
  ASSERT_EQ(after.size(), before.size() + 3);
  for (const auto& [name, content] : before) EXPECT_EQ(after[name], content) << name;
  EXPECT_EQ(timesIn(after["out.xml"], "<model name=\"arm\" file=\"parts/out_arm.xml\"/>"), 1U);
  EXPECT_EQ(timesIn(after["parts/out_arm.xml"], "<model file=\"out_hand.xml\"/>"), 1U);
  // Each element once, however often it is attached; a pair by the names that it has where the pair is.
  EXPECT_EQ(timesIn(after["parts/out_arm.xml"], "name=\"g_hull_"), 2U);
  EXPECT_EQ(timesIn(after["parts/out_arm.xml"], "<pair geom1=\"g_hull_"), 4U);
  EXPECT_EQ(timesIn(after["parts/out_arm.xml"], "geom2=\"h_palm_hull_1\"/>"), 2U);
  EXPECT_EQ(timesIn(after["out.xml"], "<pair geom1=\"l_g_hull_0\" geom2=\"r_g_hull_1\"/>"), 1U);
  EXPECT_EQ(timesIn(after["out.xml"], "<pair "), 4U);
  EXPECT_EQ(timesIn(after["out.xml"], "_hull_"), 2 * 2 + 4 * 2U);  // its own mesh's: assets and geoms; the pairs'

  std::map<std::string, double> litres;
  for (const RobotLinkReport& link : report.links) litres[link.name] = 1e3 * link.volumes[0];
  const std::map<std::string, double> expected = {{"base", 12.0},      {"l_upper", 3.0},  {"l_fore", 3.0},
                                                  {"l_h_palm", 0.375}, {"r_upper", 3.0},  {"r_fore", 3.0},
                                                  {"r_h_palm", 0.375}, {"t_tb", 3.0},     {"all_tb", 3.0},
                                                  {"all_upper", 3.0},  {"all_fore", 3.0}, {"all_h_palm", 0.375}};
  ASSERT_EQ(litres.size(), expected.size());
  for (const auto& [name, volume] : expected) EXPECT_NEAR(litres[name], volume, 1e-9) << name;
}

TEST(RobotHulls, AttachedModelsAreWhereMujocoPutsThem) {
  // As in OneHullForTheLReachesWhereTheTwoDoNot, but the L is attached: at its own pose in the frame around the
  // attachment, whatever frames it is in at home; its angles are in degrees there.
  const test::TemporaryFolder folder;
  fs::create_directory(folder.path() / "parts");
  ASSERT_TRUE(writeObjObjects(folder.path() / "parts" / "l.obj", {{"l", test::makeLShape()}}).ok());
  folder.write("parts/part.xml", R"(<mujoco model="m"><asset><mesh file="l.obj"/></asset><worldbody><frame pos="9 9 9">
    <body name="part" pos="0 0 1" euler="0 0 90"><joint/><geom type="mesh" mesh="l"/></body></frame></worldbody></mujoco>)");
  folder.write("parts/nest.xml", R"(<mujoco><asset><model name="x" file="part.xml"/></asset><worldbody>
    <body name="holder"><attach model="x" body="part" prefix="p_"/></body></worldbody></mujoco>)");
  // The L is turned by a right angle at (1, 0, 1), so (x, y, z) of it is at (1 - y, x, 1 + z).
  const TriMesh notch = test::makeBox(Vec3(-0.4, 1.2, 1.2), Vec3(-0.2, 1.4, 1.8));
  ASSERT_TRUE(writeObjObjects(folder.path() / "box.obj", {{"box", notch}}).ok());
  for (const std::string attach :
       {"<attach model=\"m\" body=\"part\" prefix=\"p_\"/>", "<attach model=\"n\" body=\"p_part\" prefix=\"\"/>"}) {
    const fs::path robot =
        folder.write("robot.xml",
                     "<mujoco><compiler angle=\"radian\"/><asset><model file=\"parts/part.xml\"/><model name=\"n\" "
                     "file=\"parts/nest.xml\"/><mesh file=\"box.obj\"/></asset><worldbody><frame pos=\"1 0 0\">" +
                         attach +
                         "</frame><body name=\"b\"><freejoint/><geom type=\"mesh\" mesh=\"box\"/></body>"
                         "</worldbody></mujoco>");
    RobotExportOptions options = test::madeOptions(robot, "out.xml");
    options.replace = true;
    EXPECT_TRUE(exported(options).newContacts.empty());
    options.source.parts = 1;
    const std::vector<std::pair<std::string, std::string>> contacts = {{"p_part", "b"}};
    EXPECT_EQ(exported(options).newContacts, contacts) << attach;
  }
}

TEST(RobotHulls, WhatIsAttachedByANameOfMujocosStays) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(writeObjObjects(folder.path() / "l.obj", {{"l", test::makeLShape()}}).ok());
  folder.write("row.xml", R"(<mujoco><asset><mesh file="l.obj"/></asset><worldbody><replicate count="2" offset="4 0 0">
    <body name="b"><geom type="mesh" mesh="l"/></body></replicate></worldbody></mujoco>)");
  const fs::path robot =
      folder.write("robot.xml", R"(<mujoco><asset><model name="m" file="row.xml"/><mesh file="l.obj"/></asset>
    <worldbody><geom type="mesh" mesh="l"/>
    <attach model="m" body="b1" prefix="p_"/></worldbody></mujoco>)");
  const RobotReport report = exported(test::madeOptions(robot, "out.xml"));
  EXPECT_EQ(report.files, 1U);
  ASSERT_EQ(report.notes.size(), 1U);
  EXPECT_TRUE(
      report.notes[0].ends_with("robot.xml:3: the body 'b1' is in no file: what is attached there stays as it is."));
  EXPECT_EQ(timesIn(readFile(folder.path() / "out.xml").value(), "<attach model=\"m\" body=\"b1\" prefix=\"p_\"/>"),
            1U);
}

TEST(RobotHulls, NamesOfOutputsNeverClash) {
  // An included file and an attached one of the same name.
  const test::TemporaryFolder folder;
  ASSERT_TRUE(writeObjObjects(folder.path() / "l.obj", {{"l", test::makeLShape()}}).ok());
  fs::create_directory(folder.path() / "parts");
  folder.write("parts/a.xml", "<mujoco><body name=\"i\"><geom type=\"mesh\" mesh=\"l\"/></body></mujoco>");
  folder.write("a.xml", R"(<mujoco><asset><mesh file="l.obj"/></asset><worldbody>
    <body name="b"><geom type="mesh" mesh="l"/></body></worldbody></mujoco>)");
  const fs::path robot =
      folder.write("robot.xml", R"(<mujoco><asset><mesh file="l.obj"/><model name="m" file="a.xml"/></asset>
    <worldbody><include file="parts/a.xml"/><attach model="m" body="b" prefix="m_"/></worldbody></mujoco>)");
  EXPECT_EQ(exported(test::madeOptions(robot, "out.xml")).files, 3U);
  const std::string text = readFile(folder.path() / "out.xml").value();
  const std::size_t model = text.find("file=\"out_a"), include = text.find("<include file=\"out_a");
  ASSERT_NE(model, std::string::npos);
  ASSERT_NE(include, std::string::npos);
  const auto named = [&](std::size_t at) { return text.substr(at, text.find(".xml", at) - at); };
  EXPECT_NE(named(text.find("out_a", model)), named(text.find("out_a", include)));
}

TEST(RobotHulls, OfUrdfLeaveAllElseByteForByte) {
  const test::TemporaryFolder folder;
  const fs::path robot = test::writeMadeUrdf(folder);
  const std::string before = readFile(robot).value();
  const RobotReport report = exported(test::madeOptions(robot, "out.urdf"));
  const std::string after = readFile(folder.path() / "out.urdf").value();
  EXPECT_EQ(report.meshes, 2U);
  ASSERT_EQ(report.links.size(), 2U);

  // Each collision of a mesh as often as it has hulls, with another file and name, and nothing else.
  const auto copyOf = [&](std::size_t from, const std::vector<std::pair<std::string, std::string>>& edits) {
    std::string text = before.substr(from, before.find("</collision>", from) + 12 - from);
    for (const auto& [a, b] : edits) text.replace(text.find(a), a.size(), b);
    return text;
  };
  const std::size_t first = before.find("<collision name");
  std::string expected = before.substr(0, first);
  for (int k = 0; k < 2; ++k) {
    expected += k == 0 ? "" : "\n    ";
    expected += copyOf(first, {{"\"solid\"", fmt::format("\"solid_hull_{}\"", k)},
                               {"meshes/l.obj", fmt::format("out_meshes/l_hull_{}.stl", k)}});
  }
  const std::size_t second = before.find("<collision><geometry><mesh");
  const std::size_t behind = first + copyOf(first, {}).size();
  expected += before.substr(behind, second - behind);
  for (int k = 0; k < report.links[1].shapes; ++k) {
    expected += k == 0 ? "" : "\n    ";
    expected += copyOf(second, {{"made/meshes/torus.stl", fmt::format("made/out_meshes/torus_hull_{}.stl", k)}});
  }
  expected += before.substr(second + copyOf(second, {}).size());
  EXPECT_EQ(after, expected);

  double volume = 0.0;
  for (const char* name : {"l_hull_0.stl", "l_hull_1.stl"}) {
    const TriMesh hull = readMesh(folder.path() / "out_meshes" / name).value();
    volume += signedVolume(hull.vertices, hull.triangles);  // outward: the scale mirrors it as it did the mesh
  }
  EXPECT_NEAR(volume, 3.0, 1e-6);
}

TEST(RobotHulls, CapsulesHoldTheirMeshesWhereverTheGeomLies) {
  const test::TemporaryFolder folder;
  RobotExportOptions options = test::madeOptions(test::writeMadeMjcf(folder), "out.xml");
  options.capsules = true;
  const RobotReport report = exported(options);
  pugi::xml_document document;
  ASSERT_TRUE(document.load_file((folder.path() / "out.xml").c_str()));
  const pugi::xml_node torso = document.child("mujoco").child("worldbody").child("body");
  std::vector<Capsule> capsules;
  for (const pugi::xml_node& geom : torso.children("geom")) {
    if (std::string(geom.attribute("type").value()) != "capsule") continue;
    EXPECT_FALSE(geom.attribute("mesh") || geom.attribute("euler"));
    const std::vector<double> size = numbers(geom.attribute("size"));
    const std::vector<double> q = numbers(geom.attribute("quat"));
    ASSERT_EQ(size.size(), 2U);
    ASSERT_EQ(q.size(), 4U);
    const Vec3 along = Quat(q[0], q[1], q[2], q[3]) * Vec3(0.0, 0.0, size[1]);
    const Vec3 middle = vectorOf(geom.attribute("pos"));
    capsules.push_back({middle - along, middle + along, size[0]});
  }
  ASSERT_EQ(capsules.size(), 2U);
  const Isometry3 place = Eigen::Translation3d(0.01, 0.0, 0.0) * Isometry3(Eigen::AngleAxisd(0.5, Vec3::UnitZ()));
  for (const Vec3& p : test::makeLShape().vertices) {
    const double out = std::min(capsules[0].outside(place * (0.1 * p)), capsules[1].outside(place * (0.1 * p)));
    EXPECT_LT(out, 1e-8);
  }
  EXPECT_NEAR(report.links[0].covered, 1.0, 1e-6);
  EXPECT_GT(report.links[0].standOff[1], 0.01);
  EXPECT_NEAR(report.links[0].volumes[2], capsules[0].volume() + capsules[1].volume(), 1e-8);

  // URDF has no capsules: each is a cylinder between two balls.
  const test::TemporaryFolder other;
  options = test::madeOptions(test::writeMadeUrdf(other), "out.urdf");
  options.capsules = true;
  EXPECT_EQ(exported(options).files, 1U);
  const std::string text = readFile(other.path() / "out.urdf").value();
  EXPECT_EQ(timesIn(text, "<sphere"), 2 * timesIn(text, "<cylinder"));
  EXPECT_EQ(timesIn(text, "<mesh"), 1U);  // the visual
  pugi::xml_document urdf;
  ASSERT_TRUE(urdf.load_string(text.c_str()));
  const Isometry3 base = Eigen::Translation3d(0.1, 0.2, 0.3) *
                         Isometry3(Eigen::AngleAxisd(0.6, Vec3::UnitZ()) * Eigen::AngleAxisd(0.5, Vec3::UnitY()) *
                                   Eigen::AngleAxisd(0.4, Vec3::UnitX()));
  std::vector<Capsule> rods;
  for (const pugi::xml_node& each : urdf.child("robot").child("link").children("collision")) {
    const pugi::xml_node cylinder = each.child("geometry").child("cylinder");
    if (!cylinder) continue;
    const Vec3 rpy = vectorOf(each.child("origin").attribute("rpy"));
    const Vec3 along = Eigen::AngleAxisd(rpy.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vec3::UnitY()) *
                       Eigen::AngleAxisd(rpy.x(), Vec3::UnitX()) *
                       Vec3(0.0, 0.0, 0.5 * cylinder.attribute("length").as_double());
    const Vec3 middle = vectorOf(each.child("origin").attribute("xyz"));
    rods.push_back({middle - along, middle + along, cylinder.attribute("radius").as_double()});
  }
  ASSERT_EQ(rods.size(), 2U);
  for (const Vec3& p : test::makeLShape().vertices) {
    const Vec3 q = base * Vec3(-0.1 * p.x(), 0.1 * p.y(), 0.1 * p.z());
    EXPECT_LT(std::min(rods[0].outside(q), rods[1].outside(q)), 1e-7);
  }
}

TEST(RobotHulls, EveryFormatAndUpAxisGivesTheSameShapes) {
  const TriMesh mesh{{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 2.0, 0.0}, {0.0, 0.0, 3.0}},
                     {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  // Robots' programs take COLLADA along the file's own axes, whatever it says is up.
  const auto collada = [](const std::string& up) {
    return R"(<?xml version="1.0"?><!-- <up_axis>X_UP</up_axis> -->
      <COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
      <asset><comments>was <![CDATA[<up_axis>Z_UP</up_axis>]]></comments><unit name="centimeter" meter="0.01"/><up_axis>)" +
           up + R"(</up_axis></asset><library_geometries><geometry id="g"><mesh>
      <source id="p"><float_array id="pa" count="12">0 0 0 100 0 0 0 200 0 0 0 300</float_array><technique_common>
      <accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
      <param name="Z" type="float"/></accessor></technique_common></source>
      <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
      <triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>
      </mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s"><node id="n">
      <instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
      <scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
  };
  const test::TemporaryFolder folder;
  ASSERT_TRUE(writeObjObjects(folder.path() / "m.obj", {{"m", mesh}}).ok());
  folder.write("m.msh", test::mshOf(mesh));
  for (const std::string up : {"X_UP", "Y_UP", "Z_UP"}) folder.write(up + ".dae", collada(up));
  folder.write("blank.dae", collada("\n Z_UP "));
  folder.write("utf16.dae", test::asUtf16(collada("Z_UP"), true, true));
  for (const std::string file : {"m.obj", "m.msh", "X_UP.dae", "Y_UP.dae", "Z_UP.dae", "blank.dae", "utf16.dae"}) {
    const fs::path robot = folder.write("robot.xml", "<mujoco><asset><mesh name=\"m\" file=\"" + file +
                                                         "\"/></asset><worldbody><geom type=\"mesh\" mesh=\"m\"/>"
                                                         "</worldbody></mujoco>");
    RobotExportOptions options = test::madeOptions(robot, "out.xml");
    options.replace = true;
    EXPECT_EQ(exported(options).meshes, 1U);
    pugi::xml_document document;
    ASSERT_TRUE(document.load_file((folder.path() / "out.xml").c_str()));
    const std::vector<double> n = numbers(document.select_node("//mesh[@vertex]").node().attribute("vertex"));
    ASSERT_EQ(n.size(), 12U) << file;
    Vec3 most = Vec3::Zero();
    for (std::size_t i = 0; i < n.size(); ++i) most[i % 3] = std::max(most[i % 3], n[i]);
    EXPECT_LT((most - Vec3(1.0, 2.0, 3.0)).norm(), 1e-6) << file;
  }
}

TEST(RobotHulls, NamesNeverClash) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(writeObjObjects(folder.path() / "l.obj", {{"l", test::makeLShape()}}).ok());
  const fs::path robot = folder.write("robot.xml", R"(<mujoco>
    <asset><mesh name="l" file="l.obj"/><mesh name="l_hull_0" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>
    <worldbody><body><freejoint/><geom name="g&amp;" type="mesh" mesh="l"/>
    <geom name="g&amp;_hull_1" type="mesh" mesh="l_hull_0"/></body></worldbody>
    <sensor><distance geom1="g&amp;" geom2="g&amp;_hull_1"/></sensor></mujoco>)");
  const RobotReport report = exported(test::madeOptions(robot, "out.xml"));
  const std::string text = readFile(folder.path() / "out.xml").value();
  EXPECT_EQ(timesIn(text, "name=\"l_hull_0\""), 1U);
  EXPECT_EQ(timesIn(text, "name=\"l_hull_0_\""), 1U);
  EXPECT_EQ(timesIn(text, "name=\"g&amp;_hull_1\""), 1U);
  EXPECT_EQ(timesIn(text, "name=\"g&amp;_hull_1_\""), 1U);
  // A sensor names the geom: it stays.
  EXPECT_EQ(timesIn(text, "name=\"g&amp;\""), 1U);
  EXPECT_EQ(report.notes.size(), 2U);
}

}  // namespace
}  // namespace lorica

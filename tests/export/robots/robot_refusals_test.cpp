#include "export/robots/robot_hulls.h"
#include "export/robots/xml_text.h"
#include "geometry/mesh_files.h"
#include "geometry/work_budgets.h"
#include "tests/export/robots/made_robot.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstring>

namespace lorica {
namespace {

namespace fs = std::filesystem;

// Robots that are refused: one sentence each, and nothing is written.

/// A robot of one body that collides with a mesh.
std::string mjcf(const std::string& mesh = "file=\"l.obj\"", const std::string& more = "",
                 const std::string& compiler = "") {
  return "<mujoco><compiler " + compiler + "/><asset><mesh name=\"m\" " + mesh + "/></asset>" + more +
         "<worldbody><body><freejoint/><geom type=\"mesh\" mesh=\"m\"/></body></worldbody></mujoco>";
}

std::string urdf(const std::string& mesh, const std::string& more = "") {
  return "<robot name=\"r\"><link name=\"a\"><collision><geometry><mesh " + mesh + "/></geometry></collision></link>" +
         more + "</robot>";
}

class RobotRefusals : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(writeObjObjects(folder_.path() / "l.obj", {{"l", test::makeLShape()}}).ok()); }

  /// Exports a robot with this text, which must fail and write nothing. @return the sentence
  std::string refusal(const std::string& text, const std::string& name = "robot.xml",
                      PathTrust trust = PathTrust::kBeneath) {
    return refusal(test::madeOptions(folder_.write(name, text), "out" + fs::path(name).extension().string()), trust);
  }

  std::string refusal(const RobotExportOptions& options, PathTrust trust = PathTrust::kBeneath) {
    const std::vector<std::string> before = names();
    Host host;
    host.paths = trust;
    const Result<RobotReport> report = exportRobot(options, host);
    EXPECT_EQ(names(), before);
    EXPECT_FALSE(report.ok());
    if (report.ok()) return "";
    const std::string sentence = report.error().message;
    EXPECT_EQ(sentence.find('\n'), std::string::npos);
    // The folder of the test is not what matters.
    std::string shown = sentence;
    const std::string folder = folder_.path().string() + "/";
    for (std::size_t at = shown.find(folder); at != std::string::npos; at = shown.find(folder))
      shown.erase(at, folder.size());
    return shown;
  }

  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& each : fs::recursive_directory_iterator(folder_.path())) all.push_back(each.path().string());
    std::sort(all.begin(), all.end());
    return all;
  }

  test::TemporaryFolder folder_;
};

TEST_F(RobotRefusals, MeshesThatAreNotThereOrNotTheirs) {
  EXPECT_EQ(refusal(mjcf("file=\"none.obj\"")), "robot.xml:1: none.obj: cannot be read: No such file or directory");
  const std::string outside = " is outside the file's folder, expected a file in it (or --trust-paths)";
  EXPECT_EQ(refusal(mjcf("file=\"/etc/passwd\"")), "robot.xml:1: '/etc/passwd'" + outside);
  EXPECT_EQ(refusal(mjcf("file=\"../l.obj\"")), "robot.xml:1: '../l.obj'" + outside);
  EXPECT_EQ(refusal(mjcf("file=\"l.obj\"", "", "meshdir=\"../x\"")), "robot.xml:1: '../x/l.obj'" + outside);
  fs::create_symlink("/etc/passwd", folder_.path() / "link.obj");
  EXPECT_EQ(refusal(mjcf("file=\"link.obj\"")), "robot.xml:1: 'link.obj'" + outside);
  EXPECT_EQ(refusal(urdf("filename=\"package://other/l.obj\""), "robot.urdf"),
            "robot.urdf:1: 'package://other/l.obj' is in the package 'other', expected --package other=FOLDER");
  EXPECT_EQ(refusal(urdf("filename=\"package://made/../l.obj\""), "robot.urdf"), "robot.urdf:1: '../l.obj'" + outside);
  EXPECT_EQ(refusal(urdf("filename=\"file:///etc/passwd\""), "robot.urdf"),
            "robot.urdf:1: 'file:///etc/passwd'" + outside);
  EXPECT_EQ(refusal(urdf("filename=\"http://a/l.obj\""), "robot.urdf"), "robot.urdf:1: 'http://a/l.obj'" + outside);
}

TEST_F(RobotRefusals, AFileOfAPackageMayNameItsFilesAndNoOthers) {
  for (const char* folder : {"outer/my_robot/urdf/arms", "outer/my_robot/meshes"})
    fs::create_directories(folder_.path() / folder);
  fs::copy(folder_.path() / "l.obj", folder_.path() / "outer/my_robot/meshes/l.obj");
  fs::copy(folder_.path() / "l.obj", folder_.path() / "outer/l.obj");
  folder_.write("outer/package.xml", "<package><name>outer</name></package>");
  folder_.write("outer/my_robot/package.xml",
                "<?xml version=\"1.0\"?>\n<!-- made -->\n<package format=\"3\"><version>1</version>\n"
                "  <name>\n my_robot </name></package>");
  int outputs = 0;
  for (const std::string name :
       {"package://my_robot/meshes/l.obj", "model://my_robot/meshes/l.obj", "../../meshes/l.obj"}) {
    SCOPED_TRACE(name);
    const RobotExportOptions options =
        test::madeOptions(folder_.write("outer/my_robot/urdf/arms/bot.urdf", urdf("filename=\"" + name + "\"")),
                          "out" + std::to_string(++outputs) + ".urdf");
    Host host;
    const Result<RobotReport> report = exportRobot(options, host);
    EXPECT_TRUE(report.ok()) << report.error().message;
  }
  const auto robot = [&](const std::string& name) {
    return refusal(urdf("filename=\"" + name + "\""), "outer/my_robot/urdf/arms/robot.urdf");
  };
  for (const char* name : {"../../../l.obj", "package://my_robot/../l.obj", "/etc/passwd", "../../../../l.obj"}) {
    EXPECT_TRUE(test::has(robot(name), " is outside the file's folder, expected a file in it")) << name;
  }
  fs::create_symlink(folder_.path() / "outer/l.obj", folder_.path() / "outer/my_robot/meshes/link.obj");
  EXPECT_TRUE(test::has(robot("../../meshes/link.obj"), " is outside the file's folder"));
  EXPECT_TRUE(test::has(robot("package://outer/l.obj"), "expected --package outer=FOLDER"));
  for (const char* name : {"$(find my_robot)/meshes/l.obj", "file://$(find my_robot)/meshes/l.obj",
                           "package://my_robot/meshes/${side}.obj"}) {
    EXPECT_TRUE(test::has(
        robot(name), "has a substitution of xacro left: `xacro outer/my_robot/urdf/arms/robot.urdf > robot.urdf`"));
  }
}

TEST_F(RobotRefusals, FilesThatAreNoMeshes) {
  ASSERT_EQ(mkfifo((folder_.path() / "pipe.stl").c_str(), 0600), 0);
  EXPECT_TRUE(test::has(refusal(mjcf("file=\"pipe.stl\"")), "robot.xml:1: pipe.stl: "));
  ASSERT_EQ(mkfifo((folder_.path() / "pipe.dae").c_str(), 0600), 0);
  EXPECT_TRUE(test::has(refusal(mjcf("file=\"pipe.dae\"")), "robot.xml:1: pipe.dae: "));
  folder_.write("m.3ds", "");
  EXPECT_EQ(refusal(mjcf("file=\"m.3ds\"")),
            "robot.xml:1: m.3ds: found the extension '.3ds', expected .obj, .stl, .ply, .off, .msh or .dae");
  folder_.write("broken.stl", "no mesh at all");
  EXPECT_TRUE(test::has(refusal(mjcf("file=\"broken.stl\"")), "robot.xml:1: broken.stl"));
}

TEST_F(RobotRefusals, MshFilesThatAreNotWhole) {
  const std::string whole = test::mshOf(test::makeLShape());
  for (std::size_t length = 0; length < whole.size(); length += 5) {
    folder_.write("m.msh", whole.substr(0, length));
    EXPECT_TRUE(test::has(refusal(mjcf("file=\"m.msh\"")), "robot.xml:1: m.msh: byte "));
  }
  for (const auto& [from, value, sentence] : {std::tuple(std::size_t{0}, -1, "positions is 4294967295"),
                                              {std::size_t{12}, 0x7fffffff, "triangles is 2147"},
                                              {std::size_t{4}, 1, "bytes to the end, expected"},
                                              {std::size_t{16}, 0x7fc00000, "found a position that"},
                                              {whole.size() - 4, -1, "a corner is -1, expected 0 to 11"}}) {
    std::string broken = whole;
    std::memcpy(broken.data() + from, &value, sizeof value);
    folder_.write("m.msh", broken);
    EXPECT_TRUE(test::has(refusal(mjcf("file=\"m.msh\"")), sentence)) << sentence;
  }
}

TEST_F(RobotRefusals, MeshesWithoutVolumeOrWithTooManyTriangles) {
  folder_.write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  EXPECT_TRUE(test::has(refusal(mjcf("file=\"line.obj\"")), "robot.xml:1: line.obj: "));
  EXPECT_EQ(refusal(mjcf("file=\"l.obj\" scale=\"1 0 1\"")),
            "robot.xml:1: scale: found a mesh without volume, expected three numbers other than 0");
  EXPECT_EQ(refusal(urdf("filename=\"l.obj\" scale=\"1 0 1\""), "robot.urdf"),
            "robot.urdf:1: scale: found a mesh without volume, expected three numbers other than 0");
  // A fan of a million triangles, binary.
  constexpr std::uint32_t kCount = 1'000'000;
  std::string stl(84 + std::size_t{50} * kCount, '\0');
  std::memcpy(stl.data() + 80, &kCount, 4);
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const float corners[] = {0.0f, 0.0f, 0.0f, 1.0f, static_cast<float>(i), 0.0f, 1.0f, static_cast<float>(i + 1),
                             0.0f};
    std::memcpy(stl.data() + 84 + std::size_t{50} * i + 12, corners, sizeof corners);
  }
  folder_.write("many.stl", stl);
  EXPECT_EQ(refusal(mjcf("file=\"many.stl\"")),
            "robot.xml:1: many.stl: found 1,000,000 triangles, expected at most 500,000 of a mesh that collides");
}

TEST_F(RobotRefusals, IncludesThatDoNotEnd) {
  EXPECT_EQ(refusal(mjcf("file=\"l.obj\"", "<include file=\"robot.xml\"/>")),
            "robot.xml:1: 'robot.xml' includes itself, expected files that end");
  folder_.write("b.xml", "<mujoco>\n<include file=\"c.xml\"/></mujoco>");
  folder_.write("c.xml", "<mujoco>\n\n<include file=\"b.xml\"/></mujoco>");
  EXPECT_EQ(refusal(mjcf("file=\"l.obj\"", "<include file=\"b.xml\"/>")),
            "robot.xml:1: b.xml:2: c.xml:3: 'b.xml' includes itself, expected files that end");
  folder_.write("d.xml", "<mujoco/>");
  EXPECT_EQ(refusal(mjcf("file=\"l.obj\"", "<include file=\"d.xml\"/><include file=\"d.xml\"/>")),
            "robot.xml:1: 'd.xml' is included twice, expected each file once");
  EXPECT_EQ(refusal(mjcf("file=\"l.obj\"", "<include file=\"e.xml\"/>")),
            "robot.xml:1: e.xml: cannot be read: No such file or directory");
  EXPECT_TRUE(
      test::has(refusal(mjcf("file=\"l.obj\"", "<include file=\"/etc/passwd\"/>")), "outside the file's folder"));
  std::string many;
  for (std::size_t i = 0; i <= kMaxRobotIncludes; ++i) {
    folder_.write("i" + std::to_string(i) + ".xml", "<mujoco/>");
    many += "<include file=\"i" + std::to_string(i) + ".xml\"/>";
  }
  EXPECT_TRUE(
      test::has(refusal(mjcf("file=\"l.obj\"", many)), "found more than 100 files that are included or attached"));
}

TEST_F(RobotRefusals, AttachedModelsThatDoNotEndOrAreNotThere) {
  const auto robot = [&](const std::string& models, const std::string& attach) {
    return "<mujoco><asset><mesh name=\"m\" file=\"l.obj\"/>" + models +
           "</asset>\n<worldbody><body><geom type=\"mesh\" " + "mesh=\"m\"/></body>" + attach + "</worldbody></mujoco>";
  };
  const auto part = [](const std::string& model, const std::string& inside) {
    return "<mujoco><asset>" + model + "</asset>\n<worldbody><body name=\"b\">" + inside +
           "</body></worldbody></mujoco>";
  };
  const std::string attach = "<attach model=\"x\" body=\"b\" prefix=\"p_\"/>";
  EXPECT_EQ(refusal(robot("<model name=\"x\" file=\"robot.xml\"/>", "")),
            "robot.xml:1: 'robot.xml' attaches itself, expected files that end");
  folder_.write("b.xml", part("<model name=\"x\" file=\"c.xml\"/>", attach));
  folder_.write("c.xml", part("\n<model name=\"x\" file=\"./b.xml\"/>", attach));
  EXPECT_EQ(refusal(robot("<model name=\"x\" file=\"b.xml\"/>", attach)),
            "robot.xml:1: b.xml:1: c.xml:2: './b.xml' attaches itself, expected files that end");
  EXPECT_EQ(refusal(robot("", "<body name=\"a\"><attach body=\"a\" prefix=\"p_\"/></body>")),
            "robot.xml:2: 'a' attaches itself, expected bodies that end");
  EXPECT_EQ(refusal(robot("", "<attach prefix=\"p_\"/>")),
            "robot.xml:2: found neither model, body nor frame, expected one");
  EXPECT_EQ(refusal(robot("", attach)), "robot.xml:2: found the model 'x', expected one of the assets");
  EXPECT_EQ(refusal(robot("<model name=\"x\" file=\"none.xml\"/>", "")),
            "robot.xml:1: none.xml: cannot be read: No such file or directory");
  const std::string outside = " is outside the file's folder, expected a file in it (or --trust-paths)";
  for (const std::string name : {"/etc/passwd", "../b.xml"}) {
    EXPECT_EQ(refusal(robot("<model name=\"x\" file=\"" + name + "\"/>", "")), "robot.xml:1: '" + name + "'" + outside);
  }
  folder_.write("d.xml", "<robot/>");
  EXPECT_EQ(refusal(robot("<model name=\"x\" file=\"d.xml\"/>", "")),
            "robot.xml:1: d.xml: found the element <robot>, expected <mujoco>");
  // What an attached model names may be beside its folder, and not beside the robot's.
  fs::create_directory(folder_.path() / "parts");
  folder_.write("parts/e.xml",
                "<mujoco><asset><mesh name=\"m\" file=\"../../l.obj\"/></asset><worldbody><body name=\"b\">"
                "<geom type=\"mesh\" mesh=\"m\"/></body></worldbody></mujoco>");
  EXPECT_EQ(refusal(robot("<model name=\"x\" file=\"parts/e.xml\"/>", attach)), "parts/e.xml:1: '../l.obj'" + outside);
}

TEST_F(RobotRefusals, AttachedModelsThatMultiply) {
  // Each model attaches the next one twice: a thousand million bodies.
  constexpr int kModels = 30;
  for (int i = 0; i < kModels; ++i) {
    const std::string next = "n" + std::to_string(i + 1) + ".xml";
    const std::string twice =
        "<attach model=\"x\" body=\"b\" prefix=\"p\"/><attach model=\"x\" body=\"b\" prefix=\"q\"/>";
    const bool last = i + 1 == kModels;
    folder_.write("n" + std::to_string(i) + ".xml",
                  "<mujoco><asset>" + (last ? "" : "<model name=\"x\" file=\"" + next + "\"/>") +
                      "</asset><worldbody><body name=\"b\">" + (last ? "" : twice) + "</body></worldbody></mujoco>");
  }
  const std::string models = "<asset><model name=\"x\" file=\"n0.xml\"/></asset>";
  const std::string text =
      "<mujoco>" + models + "<worldbody><attach model=\"x\" body=\"b\" prefix=\"p\"/></worldbody></mujoco>";
  EXPECT_TRUE(test::has(refusal(text), "with all that it attaches the robot has more than 524,288 elements"));
  // Levels count through models.
  std::string levels, ends;
  for (int i = 0; i < 120; ++i) {
    levels += "<frame>";
    ends += "</frame>";
  }
  folder_.write("n1.xml",
                "<mujoco><worldbody><body name=\"b\">" + levels + "<body/>" + ends + "</body></worldbody></mujoco>");
  folder_.write("n0.xml", "<mujoco><asset><model name=\"x\" file=\"n1.xml\"/></asset><worldbody><body name=\"b\">" +
                              levels + "<attach model=\"x\" body=\"b\" prefix=\"p\"/>" + ends +
                              "</body></worldbody></mujoco>");
  EXPECT_TRUE(test::has(refusal(text), "found more than 200 levels of elements"));
  const std::string prefix(1001, 'p');
  folder_.write("n0.xml", "<mujoco><worldbody><body name=\"b\"/></worldbody></mujoco>");
  EXPECT_TRUE(test::has(refusal("<mujoco>" + models + "<worldbody><attach model=\"x\" body=\"b\" prefix=\"" + prefix +
                                "\"/></worldbody></mujoco>"),
                        "robot.xml:1: found prefixes of 1001 bytes together, expected at most 1000"));
}

TEST_F(RobotRefusals, HostileXml) {
  std::string bomb = "<!DOCTYPE lolz [<!ENTITY a \"ha\">";
  for (char c = 'b'; c < 'k'; ++c)
    bomb += std::string("<!ENTITY ") + c + " \"&" + char(c - 1) + ";&" + char(c - 1) + ";\">";
  EXPECT_EQ(refusal(bomb + "]>" + mjcf()), "robot.xml: found a DTD (<!DOCTYPE>), expected a file without one");
  EXPECT_EQ(refusal("<!DOCTYPE a SYSTEM \"/etc/passwd\">" + mjcf()),
            "robot.xml: found a DTD (<!DOCTYPE>), expected a file without one");
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "<body>";
  std::string end;
  for (int i = 0; i < 100000; ++i) end += "</body>";
  EXPECT_EQ(refusal("<mujoco><worldbody>" + deep + end + "</worldbody></mujoco>"),
            "robot.xml: found more than 200 levels of elements, expected at most that");
  EXPECT_TRUE(test::has(refusal("<mujoco>\n<a></b></mujoco>"), "robot.xml:2: found no XML"));
  EXPECT_TRUE(test::has(refusal(""), "robot.xml:1: found no XML"));
  EXPECT_EQ(refusal(std::string("<mujoco>\n\0</mujoco>", 19)), "robot.xml:2: found a zero byte, expected XML in UTF-8");
  EXPECT_TRUE(test::has(refusal(mjcf() + std::string(std::size_t{17} << 20, ' ')), "robot.xml: "));
  EXPECT_EQ(refusal("<robot/>"), "robot.xml: found the element <robot>, expected <mujoco>");
  EXPECT_EQ(refusal("<mujoco/>", "robot.urdf"), "robot.urdf: found the element <mujoco>, expected <robot>");
}

TEST_F(RobotRefusals, LevelsCountThroughIncludes) {
  std::string levels;
  std::string ends;
  for (int i = 0; i < 150; ++i) {
    levels += "<body>";
    ends += "</body>";
  }
  folder_.write("b.xml", "<mujoco>" + levels + ends + "</mujoco>");
  EXPECT_TRUE(
      test::has(refusal("<mujoco><worldbody>" + levels + "<include file=\"b.xml\"/>" + ends + "</worldbody></mujoco>"),
                "found more than 200 levels"));
}

TEST_F(RobotRefusals, WhatDoesNotFitTogether) {
  EXPECT_EQ(refusal("<mujoco><worldbody><geom size=\"1\"/></worldbody></mujoco>"),
            "robot.xml: found no mesh that collides and is not convex by itself, expected one to divide");
  EXPECT_EQ(refusal("<mujoco>\n<worldbody>\n<geom type=\"mesh\" mesh=\"x\"/></worldbody></mujoco>"),
            "robot.xml:3: found the mesh 'x', expected one of the assets");
  EXPECT_EQ(refusal("<mujoco><worldbody><geom class=\"x\"/></worldbody></mujoco>"),
            "robot.xml:1: found the class 'x', expected one of the defaults");
  EXPECT_EQ(refusal("<mujoco><default><default class=\"main\"/></default></mujoco>"),
            "robot.xml:1: found the default class 'main' again, expected each once");
  EXPECT_EQ(refusal(mjcf("file=\"l.obj\" scale=\"1 2\"")), "robot.xml:1: scale: found '1 2', expected 3 numbers");
  EXPECT_TRUE(test::has(refusal(mjcf("vertex=\"0 0 0 1 0 0 0 1 0 0 0 1\" face=\"0 1 2 0 1 3 0 2 3 1 2 9\"")),
                        "robot.xml:1: face: found vertex 9, expected 0 to 3"));
  const std::string joint =
      "<link name=\"b\"/><joint><parent link=\"b\"/><child link=\"a\"/></joint>"
      "<joint><parent link=\"a\"/><child link=\"b\"/></joint>";
  EXPECT_EQ(refusal(urdf("filename=\"l.obj\"", joint), "robot.urdf"),
            "robot.urdf: found 2 links in circles of joints, expected a tree");
  EXPECT_EQ(refusal(urdf("filename=\"l.obj\"", "<link name=\"a\"/>"), "robot.urdf"),
            "robot.urdf:1: found the link 'a' again, expected each once");
  EXPECT_TRUE(
      test::has(refusal("<robot xmlns:xacro=\"x\"><xacro:arm/></robot>", "robot.urdf"), "found a macro of xacro"));
}

TEST_F(RobotRefusals, OutputsThatWouldBreakTheRobot) {
  const fs::path robot = test::writeMadeMjcf(folder_);
  RobotExportOptions options = test::madeOptions(robot, "out.urdf");
  EXPECT_TRUE(test::has(refusal(options), "out.urdf: found the extension '.urdf', expected that of robot.xml"));
  options = test::madeOptions(robot, "parts/out.xml");
  EXPECT_TRUE(test::has(refusal(options), "expected a file in the folder of robot.xml"));
  options = test::madeOptions(robot, "robot.xml");
  options.replace = true;
  EXPECT_TRUE(test::has(refusal(options), "robot.xml: would replace a file of the robot"));
  folder_.write("out_leg.xml", "mine");
  options = test::madeOptions(robot, "out.xml");
  EXPECT_TRUE(test::has(refusal(options), "out_leg.xml: exists already"));
  options.packages = {"=x"};
  EXPECT_EQ(refusal(options), "--package =x: expected NAME=FOLDER");
}

TEST_F(RobotRefusals, NothingStaysOfWhatCannotBeWritten) {
  // A folder lies where a hull's file should be: what was written before it goes again.
  const fs::path robot = test::writeMadeUrdf(folder_);
  RobotExportOptions options = test::madeOptions(robot, "out.urdf");
  options.replace = true;
  fs::create_directories(folder_.path() / "out_meshes" / "torus_hull_0.stl");
  EXPECT_TRUE(test::has(refusal(options), "torus_hull_0.stl"));
}

TEST_F(RobotRefusals, PathsOfTheUsersChoiceAreRead) {
  const test::TemporaryFolder other;
  ASSERT_TRUE(writeObjObjects(other.path() / "l.obj", {{"l", test::makeLShape()}}).ok());
  const fs::path robot = folder_.write("robot.xml", mjcf("file=\"" + (other.path() / "l.obj").string() + "\""));
  Host host;
  host.paths = PathTrust::kAnywhere;
  EXPECT_TRUE(exportRobot(test::madeOptions(robot, "out.xml"), host).ok());
}

TEST(XmlText, EditedElementsKeepAllOtherBytes) {
  const std::string element = "<geom\n\tname = 'a>b'  mesh=\"m\" size='1'><plugin x=\"/>\"/></geom>";
  EXPECT_EQ(editedElement(element, {}), element);
  EXPECT_EQ(editedElement(element, {{"mesh", "n&'"}}),
            "<geom\n\tname = 'a>b'  mesh=\"n&amp;&apos;\" size='1'><plugin x=\"/>\"/></geom>");
  EXPECT_EQ(editedElement(element, {{"name", std::nullopt}, {"mass", "0"}, {"pos", std::nullopt}}),
            "<geom mass=\"0\"  mesh=\"m\" size='1'><plugin x=\"/>\"/></geom>");
  EXPECT_EQ(editedElement("<a/>", {{"b", "c"}}), "<a b=\"c\"/>");
}

TEST(XmlText, ReplacedElementsLeaveTheRestAsItIs) {
  const std::string before = "\xef\xbb\xbf<?xml version=\"1.0\"?>\r\n<a x='>'><!-- <b> --><![CDATA[<b>]]>\r\n\t";
  const std::string element = "<b y=\"/>\"><b><!-- </b> --></b ><c/></b>";
  const std::string after = "<c z='&#10;&lt;'/>\r\n</a>\r\n<!-- end -->";
  const test::TemporaryFolder folder;
  const auto file = folder.write("a.xml", before + element + after);
  XmlText xml = XmlText::read(file, "a.xml", NamedBy::kUser).value();
  const pugi::xml_node b = xml.root().child("b");
  EXPECT_EQ(xml.textOf(b), element);
  EXPECT_EQ(xml.where(b), "a.xml:3");
  EXPECT_EQ(xml.changedText(), before + element + after);
  xml.append(xml.root(), "<e/>");
  xml.replace(b, {"<d/>", "<d/>"});
  EXPECT_EQ(xml.changedText(), before + "<d/>\n\t<d/>" + "<c z='&#10;&lt;'/>\r\n<e/></a>\r\n<!-- end -->");
}

TEST(XmlText, EveryTruncatedPrefixIsRefused) {
  const std::string text = "<a x='1'><!-- c --><b y=\"2\">t</b><![CDATA[d]]></a>";
  const test::TemporaryFolder folder;
  for (std::size_t size = 0; size < text.size(); ++size) {
    const auto file = folder.write("a.xml", text.substr(0, size));
    EXPECT_FALSE(XmlText::read(file, "a.xml", NamedBy::kUser).ok()) << text.substr(0, size);
  }
}

TEST(XmlText, NumbersAreAllOrNone) {
  EXPECT_EQ(numbersOf("f:1", "pos", " 1\t-2e-3 \n+3 ", 3, 3).value(), (std::vector<double>{1.0, -2e-3, 3.0}));
  for (const char* bad : {"", "1 2", "1 2 3 4", "1 2 x", "1 2 3x", "1 2 nan", "1 2 1e999", "1,2,3"}) {
    const auto numbers = numbersOf("f:1", "pos", bad, 3, 3);
    ASSERT_FALSE(numbers.ok()) << bad;
    EXPECT_EQ(numbers.error().message, std::string("f:1: pos: found '") + bad + "', expected 3 numbers");
  }
}

}  // namespace
}  // namespace lorica

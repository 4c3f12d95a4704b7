// A robot's own file with hulls in place of its collision meshes, as MuJoCo and urdfdom have it before and after.
#include "geometry/files.h"
#include "tests/export/robots/made_robot.h"
#include "tests/peers/peer.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// What MuJoCo makes of a model.
json ran(json job, const fs::path& model) {
  const test::TemporaryFolder jobs;
  job["model"] = model.string();
  const fs::path in = jobs.write("job.json", job.dump());
  const fs::path out = jobs.path() / "out.json";
  if (!test::runPeer("mujoco.mjs", {in.string(), out.string()})) return {};
  return test::readJson(out);
}

/// The same of a model in a folder with all that it names.
json loaded(const fs::path& folder, const std::string& model, double seconds) {
  return ran({{"folder", folder.string()}, {"rest", true}, {"seconds", seconds}}, model);
}

void exportTo(const RobotExportOptions& options, RobotReport& report) {
  Host host;
  Result<RobotReport> made = exportRobot(options, host);
  ASSERT_TRUE(made.ok()) << made.error().message;
  report = *made;
}

TEST(PeerRobots, AreAsHeavyInMujocoAsBefore) {
  LORICA_REQUIRE_PEERS();
  for (const bool capsules : {false, true}) {
    const test::TemporaryFolder folder;
    const fs::path robot = test::writeMadeMjcf(folder);
    RobotExportOptions options = test::madeOptions(robot, "out.xml");
    options.capsules = capsules;
    RobotReport report;
    exportTo(options, report);
    const json before = loaded(folder.path(), "robot.xml", 10.0);
    const json after = loaded(folder.path(), "out.xml", 10.0);
    ASSERT_FALSE(before.is_null() || after.is_null());
    EXPECT_GT(before["mass"].get<double>(), 3.0);  // [kg]
    // Not nearly: what has mass was not touched, so they are the same to the last bit.
    EXPECT_EQ(after["inertias"], before["inertias"]);
    EXPECT_EQ(after["warnings"], 0);
    EXPECT_TRUE(after["finite"].get<bool>());
    int shapes = 0;
    for (const RobotLinkReport& link : report.links) shapes += link.shapes;
    EXPECT_GT(shapes, 5);
    // Floor and box stay; three meshes became shapes.
    EXPECT_EQ(before["collides"], 5);
    EXPECT_EQ(after["collides"], 2 + shapes);
  }
}

TEST(PeerRobots, WhatIsAttachedStaysWhereAndWhatItWas) {
  LORICA_REQUIRE_PEERS();
  for (const bool capsules : {false, true}) {
    const test::TemporaryFolder folder;
    RobotExportOptions options = test::madeOptions(test::writeAttachingMjcf(folder), "out.xml");
    options.capsules = capsules;
    RobotReport report;
    exportTo(options, report);
    const json before = loaded(folder.path(), "robot.xml", 0.0);
    const json after = loaded(folder.path(), "out.xml", 0.0);
    ASSERT_FALSE(before.is_null() || after.is_null());
    EXPECT_EQ(after["inertias"], before["inertias"]);
    ASSERT_EQ(before["collides"], 15);  // all of them meshes
    int shapes = 0;
    for (const RobotLinkReport& link : report.links) {
      shapes += link.shapes;
      EXPECT_TRUE(before["inertias"].contains(link.name)) << link.name;
    }
    EXPECT_EQ(after["collides"], shapes);
  }
}

TEST(PeerRobots, HullsAreWhereMujocoPutsTheMesh) {
  LORICA_REQUIRE_PEERS();
  // A convex mesh, mirrored, stretched and placed in every way that a file has: its one hull has the same extent.
  const test::TemporaryFolder folder;
  folder.write("c.obj", "v 0 0 0\nv 2 0 0\nv 0 3 0\nv 0 0 5\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  std::string bodies;
  for (const char* pose : {"pos=\"1 2 3\" quat=\"0.5 0.1 0.2 0.3\"", "axisangle=\"1 2 3 40\"", "euler=\"10 20 30\"",
                           "xyaxes=\"1 2 3 0 1 2\"", "zaxis=\"1 2 3\""}) {
    bodies += std::string("<body><joint/><geom type=\"mesh\" mesh=\"c\" ") + pose + "/></body>";
  }
  const fs::path robot = folder.write(
      "robot.xml",
      "<mujoco><compiler eulerseq=\"zYx\"/><asset><mesh file=\"c.obj\" scale=\"-0.1 0.2 0.3\" refpos=\"1 2 3\" "
      "refquat=\"0.9 0.1 0.3 0.2\"/></asset><worldbody><frame euler=\"5 6 7\">" +
          bodies + "</frame></worldbody></mujoco>");
  RobotExportOptions options = test::madeOptions(robot, "out.xml");
  RobotReport report;
  exportTo(options, report);
  // Weighed by the hulls alone: what stayed for its mass goes, and the hulls weigh.
  std::string text = readFile(folder.path() / "out.xml").value();
  for (std::size_t at = text.find("<geom contype"); at != std::string::npos; at = text.find("<geom contype")) {
    text.erase(at, text.find("/>", at) + 2 - at);
  }
  for (std::size_t at = text.find(" mass=\"0\""); at != std::string::npos; at = text.find(" mass=\"0\""))
    text.erase(at, 9);
  folder.write("hulls.xml", text);
  const json before = loaded(folder.path(), "robot.xml", 0.0);
  const json after = loaded(folder.path(), "hulls.xml", 0.0);
  ASSERT_FALSE(before.is_null() || after.is_null());
  ASSERT_EQ(before["inertias"].size(), after["inertias"].size());
  for (const auto& [name, values] : before["inertias"].items()) {
    for (std::size_t i = 0; i < 7; ++i) {  // mass, moments, centre
      EXPECT_NEAR(after["inertias"][name][i].get<double>(), values[i].get<double>(),
                  2e-6 * std::max(1.0, std::abs(values[i].get<double>())))
          << name << ' ' << i;
    }
  }
}

TEST(PeerRobots, OfRosAreReadByUrdfdomAndMujoco) {
  LORICA_REQUIRE_PEERS();
  const test::TemporaryFolder folder;
  RobotExportOptions options = test::madeOptions(test::writeMadeUrdf(folder), "out.urdf");
  RobotReport report;
  exportTo(options, report);
  if (std::system("command -v check_urdf >/dev/null 2>&1") == 0) {
    for (const char* name : {"robot.urdf", "out.urdf"}) {
      EXPECT_EQ(std::system(("check_urdf " + (folder.path() / name).string() + " >/dev/null 2>&1").c_str()), 0) << name;
    }
  }
  json job = {{"rest", true}, {"seconds", 10.0}, {"meshes", json::array()}};
  for (const char* from : {"meshes", "out_meshes"}) {
    for (const auto& each : fs::directory_iterator(folder.path() / from)) job["meshes"].push_back(each.path());
  }
  const json before = ran(job, folder.path() / "robot.urdf");
  const json after = ran(job, folder.path() / "out.urdf");
  ASSERT_FALSE(before.is_null() || after.is_null());
  EXPECT_EQ(after["inertias"], before["inertias"]);
  EXPECT_EQ(after["warnings"], 0);
  EXPECT_EQ(after["geoms"].get<int>() - before["geoms"].get<int>(),
            report.links[0].shapes + report.links[1].shapes - 2);
}

}  // namespace
}  // namespace lorica

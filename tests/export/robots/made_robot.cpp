#include "tests/export/robots/made_robot.h"

#include "export/mesh_export.h"
#include "geometry/counts.h"
#include "geometry/files.h"
#include "geometry/little_endian.h"
#include "geometry/mesh_files.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMain = R"(<?xml version="1.0"?>
<!-- A robot for tests: a > b, <geom name="no geom"/>, "quotes" -->
<mujoco model='made'>
  <compiler angle="radian" meshdir="meshes" />
  <include file="parts/assets.xml"/>
  <default>
    <geom density='500'/>
    <default class="visual">
      <geom type="mesh" contype="0" conaffinity="0" group="2" rgba="0.2 0.3 0.4 1"/>
    </default>
    <default class="collision">
      <geom type="mesh" group="3" friction="0.7 0.005 0.0001"/>
      <default class="soft"><geom solref="0.04 1"/></default>
    </default>
  </default>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1"/>
    <body name="torso" pos="0 0 0.8" childclass="collision">
      <freejoint/>
      <geom class="visual" mesh="l"/>
      <geom name="trunk"   mesh='l' pos="0.01 0 0" euler="0 0 0.5"	friction="0.9 0.005 0.0001" />
      <geom name="box" type="box" size="0.05 0.05 0.05" pos="0 0 0.3"/>
      <frame pos="0 0.5 0" euler="0.2 0 0">
        <body name="arm" pos="0 0.1 0">
          <joint name="shoulder" axis="1 0 0" range="-1 1" limited="true" damping="1"/>
          <inertial pos="0 0.1 0" mass="0.7" diaginertia="0.01 0.01 0.01"/>
          <geom name="upper" class="soft" mesh="mirrored"/>
        </body>
      </frame>
      <include file="parts/leg.xml"/>
    </body>
  </worldbody>
  <contact>
    <pair geom1="upper" geom2="floor"/>
    <exclude body1="arm" body2="leg"/>
  </contact>
</mujoco>
)";

constexpr const char* kAssets = R"(<mujocoinclude>
  <asset>
    <mesh name="l" file="l.obj" scale="0.1 0.1 0.1"/>
    <mesh name="mirrored" file="l.obj" scale="-0.1 0.1 0.2" refpos="0.5 0.5 0" refquat="0.9 0.1 0.3 0.2"/>
    <mesh file="torus.stl" scale="0.001 0.001 0.001"/>
  </asset>
</mujocoinclude>
)";

constexpr const char* kLeg = R"(<mujoco>
  <body name="leg" pos="0 -0.5 -0.2">
    <joint axis="0 1 0" range="-1 1" limited="true" damping="1"/>
    <geom mesh="torus" group="0"/>
  </body>
</mujoco>
)";

constexpr const char* kAttaching = R"(<mujoco>
  <compiler angle="radian"/>
  <default><default class="seen"><geom type="mesh" contype="0" conaffinity="0"/></default></default>
  <asset>
    <model name="arm" file="parts/arm.xml"/>
    <mesh file="top.obj" scale="0.1 0.1 0.1"/>
  </asset>
  <worldbody>
    <body name="base" childclass="seen" pos="0 0 5">
      <freejoint/>
      <geom class="main" type="mesh" mesh="top"/>
      <frame pos="1 0 0" euler="0 0 0.5"><attach model="arm" body="upper" prefix="l_"/></frame>
      <frame pos="-1 0 0"><attach model="arm" body="upper" prefix="r_"/></frame>
      <frame pos="0 3 0"><attach model="arm" frame="tool" prefix="t_"/></frame>
      <frame pos="0 -3 0"><attach model="arm" prefix="all_"/></frame>
    </body>
  </worldbody>
  <contact><pair geom1="l_g" geom2="r_g"/></contact>
</mujoco>
)";

constexpr const char* kArm = R"(<mujoco model="an arm">
  <compiler angle="degree" meshdir="m" eulerseq="zyx"/>
  <default><geom density="300"/><default class="v"><geom friction="0.5 0.005 0.0001"/></default></default>
  <asset><mesh file="l.obj" scale="-0.1 0.1 0.1"/><model file="hand.xml"/></asset>
  <worldbody>
    <geom name="wg" type="mesh" mesh="l" pos="7 7 7"/>
    <frame pos="9 9 9">
      <frame name="tool" pos="0 0.1 0" euler="90 0 0">
        <geom type="mesh" mesh="l"/>
        <body name="tb" pos="0 0 1"><geom name="tg" mesh="l" type="mesh"/></body>
      </frame>
      <body name="upper" childclass="v" pos="0 0 0.2" euler="0 0 90">
        <joint axis="1 0 0"/>
        <geom name="g" type="mesh" mesh="l"/>
        <body name="fore" pos="0 0 0.4">
          <joint axis="0 1 0"/>
          <geom name="f" mesh="l" type="mesh"/>
          <attach model="a hand" body="palm" prefix="h_"/>
        </body>
      </body>
    </frame>
  </worldbody>
  <contact><exclude body1="upper" body2="fore"/><pair geom1="g" geom2="h_palm"/></contact>
  <sensor><distance geom1="f" geom2="h_palm"/></sensor>
</mujoco>
)";

constexpr const char* kHand = R"(<mujoco model="a hand">
  <compiler meshdir="../parts/m"/>
  <asset><mesh name="p" file="l.obj" scale="0.05 0.05 0.05"/></asset>
  <worldbody><body name="palm" pos="0 0 0.3"><joint/><geom name="palm" type="mesh" mesh="p"/></body></worldbody>
</mujoco>
)";

constexpr const char* kUrdf = R"(<?xml version="1.0"?>
<robot name="made">
  <link name="base">
    <inertial><mass value="2"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
    <visual><geometry><mesh filename="meshes/l.obj" scale="0.1 0.1 0.1"/></geometry></visual>
    <collision name="solid">
      <origin xyz="0.1 0.2 0.3" rpy="0.4 0.5 0.6"/>
      <geometry><mesh scale='-0.1 0.1 0.1' filename='meshes/l.obj'/></geometry>
    </collision>
    <collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision>
  </link>
  <link name="arm">
    <inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
    <collision><geometry><mesh filename="package://made/meshes/torus.stl" scale="0.001 0.001 0.001"/></geometry></collision>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/>
    <child link="arm"/>
    <origin xyz="0 0 1" rpy="0 0 0"/>
    <axis xyz="1 0 0"/>
    <limit lower="-1" upper="1" effort="10" velocity="1"/>
  </joint>
</robot>
)";

void writeMeshesOf(const TemporaryFolder& folder) {
  fs::create_directory(folder.path() / "meshes");
  EXPECT_TRUE(writeObjObjects(folder.path() / "meshes" / "l.obj", {{"l", makeLShape()}}).ok());
  const std::string torus = formatBinaryStl(makeTorus(200.0, 60.0, 24, 12));  // [mm]
  EXPECT_TRUE(writeFileAtomically(folder.path() / "meshes" / "torus.stl", torus).ok());
}

}  // namespace

fs::path writeMadeMjcf(const TemporaryFolder& folder) {
  writeMeshesOf(folder);
  fs::create_directory(folder.path() / "parts");
  folder.write("parts/assets.xml", kAssets);
  folder.write("parts/leg.xml", kLeg);
  return folder.write("robot.xml", kMain);
}

fs::path writeAttachingMjcf(const TemporaryFolder& folder) {
  fs::create_directories(folder.path() / "parts" / "m");
  for (const char* name : {"top.obj", "parts/m/l.obj"}) {
    EXPECT_TRUE(writeObjObjects(folder.path() / name, {{"l", makeLShape()}}).ok());
  }
  folder.write("parts/arm.xml", kArm);
  folder.write("parts/hand.xml", kHand);
  return folder.write("robot.xml", kAttaching);
}

fs::path writeMadeUrdf(const TemporaryFolder& folder) {
  writeMeshesOf(folder);
  return folder.write("robot.urdf", kUrdf);
}

RobotExportOptions madeOptions(const fs::path& robot, const std::string& output) {
  setenv("XDG_CACHE_HOME", "/dev/null", 1);
  RobotExportOptions options;
  options.source.input = robot.string();
  options.output = robot.parent_path() / output;
  options.budget.vertices = 64;
  options.packages = {"made=" + robot.parent_path().string()};
  return options;
}

std::string mshOf(const TriMesh& mesh) {
  std::string bytes;
  for (const int count : {countOf(mesh.vertices), 0, 0, countOf(mesh.triangles)}) appendLittleEndian(count, bytes);
  for (const Vec3& p : mesh.vertices) {
    for (const double x : p) appendLittleEndian(static_cast<float>(x), bytes);
  }
  for (const Triangle& triangle : mesh.triangles) {
    for (const VertexIndex v : triangle) appendLittleEndian(v, bytes);
  }
  return bytes;
}

std::map<std::string, std::string> contentOf(const fs::path& folder) {
  std::map<std::string, std::string> content;
  for (const fs::directory_entry& each : fs::recursive_directory_iterator(folder)) {
    const std::string name = each.path().lexically_relative(folder).string();
    content[name] = each.is_regular_file() ? readFile(each.path()).value() : "";
  }
  return content;
}

}  // namespace lorica::test

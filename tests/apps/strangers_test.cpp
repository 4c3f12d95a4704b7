// What other people's files once gave without a word. The right values are those of the README beside the files.

#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace lorica::test {
namespace {

/// A command on one of the files; `said` is in what it prints.
struct Row {
  const char* file;
  std::vector<std::string> before;
  std::vector<std::string> after;
  int exitCode;
  std::vector<const char*> said;
};

TEST(Strangers, GetTheRightValueOrASentence) {
  LORICA_REQUIRE_DATASET(readme, "strangers/README.md");
  const std::filesystem::path folder = readme.parent_path();
  const std::vector<Row> rows = {
      {"kinect2_named_columns.csv", {"info"}, {}, 0, {"named-columns", "metres", "Y is up", "faces +Z"}},
      {"kinect1_named_columns.txt", {"info"}, {}, 0, {"named-columns", "metres", "Y is up", "faces +Z"}},
      {"azure_named_columns.csv", {"info"}, {}, 0, {"named-columns", "millimetres", "Y is down", "faces +Z"}},
      {"mediapipe_world.csv", {"info"}, {}, 0, {"MediaPipe's order", "metres", "Y is down", "faces +Z"}},
      {"azure_offline_processor.json", {"info"}, {}, 0, {"azure-json", "millimetres", "Y is down", "faces +Z"}},
      {"bones_along_x.bvh", {"info"}, {}, 0, {"rest pose: ", "Y is up", "faces +Z"}},
      {"bones_along_y.bvh", {"info"}, {}, 0, {"rest pose: ", "Y is up", "faces +Z"}},
      {"utf16.bvh", {"info"}, {}, 0, {"rest pose: the zero pose, a T-pose", "90 at 30.0"}},
      {"frames_nospace.bvh", {"info"}, {}, 0, {"rest pose: the zero pose, a T-pose", "90 at 30.0"}},
      {"wave.vrma", {"info"}, {}, 0, {"VRM animation 1.0", "any humanoid can perform it"}},
      {"vmc_doubles.pcap", {"info"}, {}, 0, {"159 at", "any humanoid can perform it"}},
      {"vmc_ok_zero_once.pcap", {"info"}, {}, 0, {"159 at"}},
      {"vmc_no_hips.pcap", {"info"}, {}, 0, {"missing bones stay at rest: leftUpperLeg"}},
      {"rigid_boxes.vrm",
       {"info"},
       {},
       0,
       {"a character", "1.850 m", "since its shells may lie in each other", ", 0 open edges"}},
      {"figure_mirrored.glb", {"info"}, {}, 0, {"1.450 m", "it faces +Z"}},
      {"figure_lying.glb", {"info"}, {}, 0, {"it lies, its head towards"}},
      {"figure_posed_nodes.glb", {"info"}, {}, 0, {"1.450 m", "its nodes are posed"}},
      {"line_continuation.obj", {"info"}, {}, 0, {"volume        1\n", "yes, it can be decomposed"}},
      {"ufbx_max_skin_6100_ascii.fbx", {"info"}, {}, 2, {"FBX 6.1 is too old: export it as FBX 7.x"}},
      {"round2/attach.xml",
       {"info"},
       {},
       2,
       {"a robot's description, whose meshes get hulls by `lorica export IN OUT`"}},
      {"round2/my_robot/urdf/bot.urdf", {"info"}, {}, 2, {"a robot's description"}},
      {"flat_quad.obj", {"decompose"}, {}, 0, {": 1 convex part\n", "1 thin wall of"}},
      {"trimesh_cubevc.glb", {"decompose"}, {"--parts", "16"}, 0, {": 1 convex part\n"}},
      {"convex_capsule.obj", {"decompose"}, {}, 0, {": 1 convex part\n"}},
      {"U_boxes.obj",
       {"decompose"},
       {"--parts", "8"},
       0,
       {": 3 convex parts", "volume 7, together 9", "0.0 %", "1.0000"}},
      {"chair_boxes.obj", {"decompose"}, {"--parts", "8"}, 0, {"volume 0.0449, together", "0.0 %", "1.0000"}},
      {"U_twice.obj", {"decompose"}, {"--parts", "8"}, 0, {"volume 7.02996, together", "0.0 %", "1.0000"}},
      {"round2/walk_swing_foot_points_down.bvh", {"info"}, {}, 0, {"the floor is y = 0, since soles come down to it"}},
      {"round2/walk_swing_foot_level.bvh", {"info"}, {}, 0, {"the floor is y = 0, since soles come down to it"}},
      {"round2/human_10_56_metres.glb", {"info"}, {}, 0, {"10.56 m", "it stays at 1 m per unit"}},
      {"round2/human_1_76_millimetres.glb", {"info"}, {}, 0, {"1.760 m", "assuming 1000 m per unit"}},
      {"round2/utf16.dae", {"info"}, {}, 0, {"a mesh", "volume        4\n", "(0, 0, -2) to (3, 1, "}},
      {"round2/flag_skinned_flat.glb", {"info"}, {}, 0, {"a character", "2.000 m", "1 thin wall of "}},
      {"round2/flag_skinned_flat.glb", {"decompose"}, {}, 0, {"1 thin wall of ", "keyframes"}},
      {"U_once.obj", {"decompose"}, {"--parts", "8"}, 0, {"7", "1.0000"}},
      {"round2/kinect_dump_header.csv", {"info"}, {}, 0, {"Kinect v2's order", "metres", "Y is up", "faces +Z"}},
      {"round2/mediapipe_frames.json", {"info"}, {}, 0, {"mediapipe-json", "metres", "Y is down", "90 at 30.0"}},
      {"round2/german_excel.csv", {"info"}, {}, 0, {"centimetres", "100.0 % seen", "90 at 30.0", "faces +Z"}},
      {"round2/walk.trc", {"info"}, {}, 0, {"joints (trc)", "1 m per unit", "Y is up", "90 at 30.0"}},
  };
  for (const Row& row : rows) {
    std::vector<std::string> words = row.before;
    words.push_back(folder / row.file);
    words.insert(words.end(), row.after.begin(), row.after.end());
    const CommandResult result = runLorica(words);
    EXPECT_EQ(result.exitCode, row.exitCode) << row.file << ": " << result.err;
    const std::string all = result.out + result.err;
    for (const char* text : row.said) {
      EXPECT_NE(all.find(text), std::string::npos) << row.file << ": no `" << text << "` in:\n" << all;
    }
  }
}

/// The numbers of a text, separated by commas or blanks.
std::vector<double> numbersIn(const std::string& text) {
  std::vector<double> numbers;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, text.find(',') == std::string::npos ? ' ' : ',');) {
    numbers.push_back(std::strtod(word.c_str(), nullptr));
  }
  return numbers;
}

std::vector<std::string> linesOf(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TEST(Strangers, BonesAlongAnyAxisPerformTheFilesOwnPositions) {
  LORICA_REQUIRE_DATASET(readme, "strangers/README.md");
  const TemporaryFolder folder;
  for (const char* name : {"bones_along_x.bvh", "bones_along_y.bvh"}) {
    const std::filesystem::path csv = folder.path() / "joints.csv";
    ASSERT_EQ(runLorica({"convert", "--force", readme.parent_path() / name, csv}).exitCode, 0);
    const std::vector<std::string> lines = linesOf(csv);
    ASSERT_GT(lines.size(), 31u);
    std::vector<std::string> columns;
    std::istringstream header(lines[0]);
    for (std::string column; std::getline(header, column, ',');) columns.push_back(column);
    const std::vector<double> row = numbersIn(lines[31]);  // frame 30
    const std::vector<std::pair<const char*, double>> expected = {
        {"head.y", 1.627},      {"left_shoulder.x", 0.16}, {"left_shoulder.y", 1.467},
        {"left_hand.x", 0.388}, {"left_hand.y", 0.988},    {"left_hand.z", 0.700},
        {"left_foot.x", 0.09},  {"left_foot.y", 0.208},    {"left_foot.z", 0.209}};
    for (const auto& [column, value] : expected) {
      const std::size_t at = std::ranges::find(columns, column) - columns.begin();
      ASSERT_LT(at, row.size()) << column;
      EXPECT_NEAR(row[at], value, 0.001) << name << " " << column;
    }
    std::filesystem::remove(csv);
  }
}

/// Joints in row 20, heights above the floor, and the way from the first row to the last [m].
TEST(Strangers, JointsAreWhereTheFilesHaveThem) {
  LORICA_REQUIRE_DATASET(readme, "strangers/round2/README.md");
  const TemporaryFolder folder;
  struct Joints {
    const char* file;
    double leftHand, rightHand, wayX, wayZ;
  };
  for (const Joints& expected : {Joints{"kinect_dump_header.csv", 1.933, 0.829, 0.0, 1.78},
                                 {"german_excel.csv", 1.933, 0.829, 0.0, 1.78},
                                 {"mediapipe_frames.json", 1.882, 0.824, 0.0, 0.0},
                                 {"walk.trc", 1.863, 0.899, 1.78, 0.0}}) {
    const std::filesystem::path csv = folder.path() / "joints.csv";
    const CommandResult made = runLorica({"convert", "--force", readme.parent_path() / expected.file, csv});
    ASSERT_EQ(made.exitCode, 0) << made.err;
    const std::vector<std::string> lines = linesOf(csv);
    ASSERT_EQ(lines.size(), 91u) << expected.file;
    std::vector<std::string> columns;
    std::istringstream header(lines[0]);
    for (std::string column; std::getline(header, column, ',');) columns.push_back(column);
    const auto at = [&](std::size_t row, const char* column) {
      return numbersIn(lines[row + 1]).at(std::ranges::find(columns, column) - columns.begin());
    };
    EXPECT_NEAR(at(20, "left_hand.y"), expected.leftHand, 0.001) << expected.file;
    EXPECT_NEAR(at(20, "right_hand.y"), expected.rightHand, 0.001) << expected.file;
    EXPECT_NEAR(at(89, "torso.x") - at(0, "torso.x"), expected.wayX, 0.001) << expected.file;
    EXPECT_NEAR(at(89, "torso.z") - at(0, "torso.z"), expected.wayZ, 0.001) << expected.file;
  }
}

/// Feet that hang at the armature, as rigs with inverse kinematics have them, are on the legs of a ragdoll.
TEST(Strangers, FeetHangOnTheLegsOfARagdoll) {
  LORICA_REQUIRE_DATASET(file, "strangers/round2/human_ik_feet.glb");
  const TemporaryFolder folder;
  const std::string out = folder.path() / "ragdoll.xml";
  const CommandResult result = runLorica({"export", file, out, "--per-bone"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  std::map<std::string, std::string> above;
  std::vector<std::string> open;
  for (const std::string& line : linesOf(out)) {
    if (const std::size_t at = line.find("<body name=\""); at != std::string::npos) {
      const std::string name = line.substr(at + 12, line.find('"', at + 12) - at - 12);
      above[name] = open.empty() ? "" : open.back();
      open.push_back(name);
    }
    if (line.find("</body>") != std::string::npos) open.pop_back();
  }
  EXPECT_EQ(above["LeftFoot"], "LeftLowerLeg");
  EXPECT_EQ(above["RightFoot"], "RightLowerLeg");
  EXPECT_EQ(std::count_if(above.begin(), above.end(), [](const auto& each) { return each.second.empty(); }), 1);
  EXPECT_EQ(above["Hips"], "");
}

/// Robots, whose new files lie beside theirs.
TEST(Strangers, RobotsAreDividedWhereverTheirFilesAre) {
  LORICA_REQUIRE_DATASET(readme, "strangers/round2/README.md");
  const TemporaryFolder folder;
  for (const char* name : {"L.obj", "attach.xml", "attachee.xml", "find_leftover.urdf", "my_robot/package.xml",
                           "my_robot/urdf/bot.urdf", "my_robot/meshes/L.obj"}) {
    std::filesystem::create_directories((folder.path() / name).parent_path());
    std::filesystem::copy_file(readme.parent_path() / name, folder.path() / name);
  }
  std::ifstream in(folder.path() / "my_robot/urdf/bot.urdf");
  std::string urdf(std::istreambuf_iterator<char>(in), {});
  for (const std::string package = "package://my_robot"; urdf.find(package) != std::string::npos;) {
    urdf.replace(urdf.find(package), package.size(), "..");
  }
  folder.write("my_robot/urdf/dots.urdf", urdf);
  struct Robot {
    const char* file;
    int exitCode;
    std::vector<const char*> said;
  };
  for (const Robot& robot :
       {Robot{"attach.xml", 0, {"2 files with shapes for 1 mesh\n", "p_part       2 "}},
        {"my_robot/urdf/bot.urdf", 0, {"3 files with shapes for 1 mesh\n", "base       2 "}},
        {"my_robot/urdf/dots.urdf", 0, {"3 files with shapes for 1 mesh\n", "base       2 "}},
        {"find_leftover.urdf", 2, {"has a substitution of xacro left: `xacro ", "> robot.urdf`"}}}) {
    const std::filesystem::path file = folder.path() / robot.file;
    const std::filesystem::path out = file.parent_path() / ("new_" + file.filename().string());
    const CommandResult result = runLorica({"export", file, out});
    EXPECT_EQ(result.exitCode, robot.exitCode) << robot.file << ": " << result.err;
    for (const char* text : robot.said) {
      EXPECT_NE((result.out + result.err).find(text), std::string::npos) << robot.file << ": no `" << text << "` in:\n"
                                                                         << result.out << result.err;
    }
  }
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "new_attach_attachee.xml"));
}

TEST(Strangers, AStreamWithoutHipsStands) {
  LORICA_REQUIRE_DATASET(readme, "strangers/README.md");
  const TemporaryFolder folder;
  for (const char* name : {"vmc_no_hips", "vmc_head_only"}) {
    const std::filesystem::path out = folder.path() / (std::string(name) + ".bvh");
    const std::filesystem::path packets = readme.parent_path() / (std::string(name) + ".pcap");
    ASSERT_EQ(runLorica({"record", "--force", out, packets, "--character", "mannequin"}).exitCode, 0) << name;
    const std::vector<std::string> lines = linesOf(out);
    const auto motion = std::ranges::find(lines, "MOTION");
    ASSERT_GT(lines.end() - motion, 60);
    const std::vector<double> frame = numbersIn(motion[60]);
    ASSERT_GT(frame.size(), 3u);
    EXPECT_NEAR(frame[1], 95.0, 0.5) << name;  // the hips' height [cm]
  }
}

/// What other files are taken to be: heights by themselves known, facing and unit looked at once.
TEST(FirstGuess, IsRightForTheSharedFiles) {
  LORICA_REQUIRE_DATASET(readme, "README.md");
  const TemporaryFolder folder;
  const std::string session = folder.path() / "walk.lsession";
  ASSERT_EQ(runLorica({"play", "walk", "--frames", "5", "--record", session}).exitCode, 0);
  const std::vector<std::pair<std::string, std::vector<const char*>>> rows = {
      {"characters/cesiumman/CesiumMan.glb", {"1.507 m", "it faces +Z"}},
      {"characters/godette/Godette_vrm_v4.vrm", {"1.495 m", "it faces +Z"}},
      {"characters/arnaud/arnaud.fbx", {"1.831 m", "0.01 m per unit", "it faces +Z"}},
      {"characters/greenman/greenman.glb", {"2.032 m", "it faces +Z"}},
      {"characters/kaykit/Mage.glb", {"2.716 m", "it faces +Z"}},
      {"characters/arnaud/walk.fbx", {"0.01 m per unit", "faces +Z at first"}},
      {"bvh/animated_drawings/jumping_jacks.bvh", {"(1.46 m)", "CMU", "faces +Z at first"}},
      {"bvh/animated_drawings/zombie.bvh", {"a unit of its own", "(1.7 m", "Z is up", "faces -Z at first"}},
      {"bvh/makehuman/walk1.bvh", {"decimetres", "(1.64 m)", "Z is up", "faces +Z at first"}},
      {"bvh/makehuman/tpose.bvh", {"decimetres", "(1.66 m)", "an A-pose", "faces +Z at first"}},
      {"joints/ui_prmd/m01_s01_e01_positions.txt", {"centimetres", "faces +Z at first"}},
      {"depth_real/cut_a1_s5.joints.csv", {"(1.80 m)", "faces +Z at first"}},
      {"depth_real/A_armchair3_a9s1.oni", {"the floor, which was found 1.36 m below the camera", "faces +Z at first"}},
      {session, {"joints as they were recorded", "faces +Z at first"}},
  };
  for (const auto& [file, said] : rows) {
    const CommandResult result = runLorica({"info", readme.parent_path() / file});
    EXPECT_EQ(result.exitCode, 0) << file << ": " << result.err;
    for (const char* text : said) {
      EXPECT_NE(result.out.find(text), std::string::npos) << file << ": no `" << text << "` in:\n" << result.out;
    }
  }
}

}  // namespace
}  // namespace lorica::test

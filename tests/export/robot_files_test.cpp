#include "export/robot_files.h"

#include "skinning/humanoid/joint_limits.h"
#include "tests/export/stick_figure.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <numbers>

namespace lorica {
namespace {

namespace fs = std::filesystem;

RigidModel stickModel() {
  const Character figure = test::stickFigure();
  return rigidModelOf(figure, test::collidersIn(figure, {0.0, 0.5}));
}

std::size_t countOf(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

TEST(RigidModel, OfAMeshHasItsMassAndInertia) {
  const TriMesh box = test::makeBox(Vec3(0.0, 0.0, 0.0), Vec3(1.0, 2.0, 3.0));
  const RigidModel model = rigidModelOf("a box", box, {{"part_0", box}});
  ASSERT_EQ(model.bodies.size(), 1U);
  const RigidBody& body = model.bodies.front();
  EXPECT_EQ(body.name, "a_box");
  EXPECT_NEAR(body.mass, 6000.0, 1e-9);
  EXPECT_NEAR((body.center - Vec3(0.5, 1.0, 1.5)).norm(), 0.0, 1e-12);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(body.inertia(axis, axis), 6000.0 / 12.0 * Vec3(4.0 + 9.0, 1.0 + 9.0, 1.0 + 4.0)[axis], 1e-6);
  }
}

TEST(RigidModel, OfACharacterHasItsMassInWaterAndTurnsAsTheHumanBonesDo) {
  const RigidModel model = stickModel();
  ASSERT_EQ(model.bodies.size(), 2U);
  EXPECT_NEAR(model.bodies[0].mass + model.bodies[1].mass, 1000.0 * 0.08, 1e-6);
  EXPECT_EQ(model.bodies[0].parent, -1);
  EXPECT_EQ(model.bodies[1].parent, 0);
  EXPECT_NEAR((model.bodies[1].origin - Vec3(0.0, 1.0, 0.0)).norm(), 0.0, 1e-12);
  EXPECT_TRUE(model.overlapping.empty());  // a body may overlap its parent
  const JointRange& spine = jointRange(HumanBone::kSpine);
  ASSERT_EQ(model.bodies[1].hinges.size(), 3U);
  EXPECT_EQ(model.bodies[1].hinges[0].axis, spine.firstAxis);
  EXPECT_EQ(model.bodies[1].hinges[0].max, spine.first.max);
  EXPECT_EQ(model.bodies[1].hinges[2].axis, spine.twistAxis);
  EXPECT_TRUE(model.bodies[0].hinges.empty());
}

TEST(RigidModel, UnknownJointsTurnThirtyDegreesAndAreTold) {
  Character figure = test::stickFigure();
  std::vector<Joint> joints(figure.skeleton.joints().begin(), figure.skeleton.joints().end());
  joints[1].bone.reset();
  joints[1].name = "lower";
  figure.skeleton = Skeleton::create(joints).value();
  const RigidModel model = rigidModelOf(figure, test::collidersIn(figure, {0.0}));
  ASSERT_EQ(model.bodies[1].hinges.size(), 3U);
  EXPECT_NEAR(model.bodies[1].hinges[1].max, std::numbers::pi / 6.0, 1e-12);
  EXPECT_EQ(model.bodies[1].name, "lower_2");
  ASSERT_EQ(model.notes.size(), 2U);
  EXPECT_TRUE(test::has(model.notes[0], "1 of the bones' names was"));
  EXPECT_TRUE(test::has(model.notes[1], "30 degrees"));
}

TEST(RobotFiles, HaveZUpAndFaceX) {
  EXPECT_EQ(zUp(Vec3(Vec3::UnitY())), Vec3(Vec3::UnitZ()));  // up
  EXPECT_EQ(zUp(Vec3(Vec3::UnitZ())), Vec3(Vec3::UnitX()));  // forward
  EXPECT_EQ(zUp(Vec3(Vec3::UnitX())), Vec3(Vec3::UnitY()));  // its left
  const Mat3 turned = zUp(Mat3(Vec3(1.0, 2.0, 3.0).asDiagonal()));
  EXPECT_EQ(Vec3(turned.diagonal()), Vec3(3.0, 1.0, 2.0));
}

TEST(RobotFiles, HaveWhatTheFormatsNeedForEachBone) {
  const std::string joints = formatMjcf(stickModel(), MjcfMotion::kJoints);
  const std::string mocap = formatMjcf(stickModel(), MjcfMotion::kMocap);
  const std::string urdf = formatUrdf(stickModel(), "m");  // with links between the hinges of a joint
  EXPECT_TRUE(test::has(joints, "<body name=\"upper\" pos=\"0 0 1\">"));
  struct Row {
    const std::string& text;
    const char* word;
    std::size_t count;
  };
  for (const auto& [text, word, count] : {Row{joints, "<body ", 2U},
                                          {joints, "<freejoint ", 1U},
                                          {joints, "<joint ", 3U},
                                          {joints, "<mesh ", 2U},
                                          {mocap, "mocap=\"true\"", 2U},
                                          {mocap, "joint", 0U},
                                          {urdf, "<link name=", 4U},
                                          {urdf, "type=\"revolute\"", 3U},
                                          {urdf, "filename=\"m/upper_hull_0.stl\"", 2U}}) {
    EXPECT_EQ(countOf(text, word), count) << word << " in " << text;
  }
}

TEST(RobotFiles, UrdfIsWrittenWithItsMeshesOrNotAtAll) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "stick.urdf";
  ASSERT_TRUE(writeUrdf(file, stickModel()).ok());
  EXPECT_TRUE(fs::exists(folder.path() / "stick_meshes" / "upper_hull_0.stl"));
  // Again, from another model: what only the earlier file named goes, what somebody else put there stays.
  RigidModel other = stickModel();
  other.bodies.back().hulls.back().name = "renamed_hull_0";
  const fs::path meshes = folder.path() / "stick_meshes";
  const std::ptrdiff_t before = std::distance(fs::directory_iterator(meshes), {});
  folder.write("stick_meshes/mine.stl", "mine");
  ASSERT_TRUE(writeUrdf(file, other).ok());
  EXPECT_TRUE(fs::exists(meshes / "mine.stl"));
  EXPECT_TRUE(fs::exists(meshes / "renamed_hull_0.stl"));
  EXPECT_EQ(std::distance(fs::directory_iterator(meshes), {}), before + 1);
  // A folder where the file should be: the meshes are taken back, but not a folder that was there.
  fs::create_directory(folder.path() / "taken.urdf");
  EXPECT_FALSE(writeUrdf(folder.path() / "taken.urdf", stickModel()).ok());
  EXPECT_FALSE(fs::exists(folder.path() / "taken_meshes"));
}

}  // namespace
}  // namespace lorica

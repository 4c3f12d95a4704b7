#include "session/scene_file.h"

#include "acd/decompose.h"
#include "capture/joint_csv.h"
#include "capture/synthetic_motion.h"
#include "geometry/files.h"
#include "session/pose_source.h"
#include "session/session.h"
#include "skinning/mannequin.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>

namespace lorica {
namespace {

std::filesystem::path scenesFolder() {
  return test::recordingsFolder().parent_path() / "scenes";
}

SceneFile shipped(const std::string& name) {
  Result<SceneFile> scene = readScene(scenesFolder() / (name + ".json"));
  EXPECT_TRUE(scene.ok()) << scene.error().message;
  return std::move(scene).value();
}

std::string sceneWith(const std::string& content) {
  return R"({"format": "lorica scene 1", )" + content + "}";
}

std::string errorOf(const std::string& text) {
  const Result<SceneFile> scene = parseScene(text, "s.json");
  return scene ? "none" : scene.error().message;
}

/// The mannequin in six parts, performing among a scene.
Session performance(SyntheticMotion motion, const SceneFile& scene) {
  static const Decomposition parts = [] {
    const Character character = makeMannequin();
    DecomposeSettings settings;
    settings.maxParts = 6;
    return decompose(character.mesh, {character.mesh.vertices, static_cast<int>(character.mesh.vertices.size())},
                     settings)
        .value();
  }();
  std::unique_ptr<PoseSource> source =
      makeJointPoseSource(makeMannequin().skeleton, makeRecordedSource(synthesizeMotion(motion))).value();
  return Session::create(makeMannequin(), parts, std::move(source), makeWorld(scene)).value();
}

void playToTheEnd(Session& session) {
  while (true) {
    const Result<bool> more = session.step();
    ASSERT_TRUE(more.ok()) << more.error().message;
    if (!*more) return;
    for (const Prop& prop : session.world().props()) ASSERT_TRUE(prop.worldFromProp.matrix().allFinite());
  }
}

TEST(SceneFile, EveryFieldIsRead) {
  const Result<SceneFile> scene = parseScene(sceneWith(R"("name": "all", "gravity": [0, -1.5, 0.5], "floor": false,
    "props": [
      {"shape": "box", "size": [0.2, 0.4, 0.6], "at": [1, 2, 3], "turn": [0, 90, 0], "mass": 2.5, "friction": 0.3,
       "restitution": 0.7, "color": "#ff8000", "velocity": [1, 0, -2]},
      {"shape": "sphere", "radius": 0.25, "at": [0, 1, 0]},
      {"shape": "capsule", "radius": 0.1, "height": 0.5, "at": [0, 2, 0]},
      {"shape": "cylinder", "radius": 0.1, "height": 0.1, "at": [0, 3, 0], "fixed": true,
       "repeat": {"count": 3, "step": [0.5, 0, 0]}}],
    "chains": [{"from": [0, 5, 0], "to": [0, 4, 0], "links": 4, "radius": 0.02, "hung": "both"}])"),
                                             "s.json");
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  EXPECT_EQ(scene->name, "all");
  EXPECT_EQ(scene->world.gravity, Vec3(0, -1.5, 0.5));
  EXPECT_FALSE(scene->world.floor);
  ASSERT_EQ(scene->props.size(), 3u + 3u + 4u);
  const Prop& box = scene->props[0];
  EXPECT_EQ(box.shape, PropShape::kBox);
  EXPECT_LT((box.halfExtents - Vec3(0.1, 0.2, 0.3)).norm(), 1e-12);
  EXPECT_LT((box.worldFromProp * Vec3(0, 0, 1) - Vec3(2, 2, 3)).norm(), 1e-12) << "a quarter turn takes z to x";
  EXPECT_EQ(box.mass, 2.5);
  EXPECT_EQ(box.friction, 0.3);
  EXPECT_EQ(box.restitution, 0.7);
  EXPECT_EQ(box.velocity, Vec3(1, 0, -2));
  EXPECT_NEAR(box.color.x(), 1.0, 1e-6);
  EXPECT_NEAR(box.color.y(), 0.2158605, 1e-6) << "sRGB 128 in linear light (IEC 61966-2-1)";
  EXPECT_EQ(scene->props[1].shape, PropShape::kSphere);
  EXPECT_EQ(scene->props[2].shape, PropShape::kCapsule);
  EXPECT_EQ(scene->props[2].halfExtents.y(), 0.25);
  EXPECT_EQ(scene->props[5].shape, PropShape::kCylinder);
  EXPECT_EQ(scene->props[5].mass, 0.0);
  EXPECT_LT((scene->props[5].worldFromProp.translation() - Vec3(1, 3, 0)).norm(), 1e-12);
  ASSERT_EQ(scene->links.size(), 5u) << "four upper ends and the last lower one";
  EXPECT_EQ(scene->links[0].b, kWorldItself);
  EXPECT_EQ(scene->links[4].b, kWorldItself);
  EXPECT_LT((scene->links[4].place - Vec3(0, 4, 0)).norm(), 1e-12);
}

TEST(SceneFile, WhatIsWrongIsNamed) {
  EXPECT_NE(errorOf("{").find("s.json: not JSON"), std::string::npos) << errorOf("{");
  EXPECT_EQ(errorOf("[]"), "s.json: the scene: found [], expected an object");
  EXPECT_EQ(errorOf("{}"), "s.json: format: found nothing, expected \"lorica scene 1\"");
  EXPECT_NE(errorOf(R"({"format": "lorica scene 9"})").find("\"lorica scene 9\""), std::string::npos);
  EXPECT_NE(errorOf(sceneWith(R"("prop": [])")).find("prop: found no such key"), std::string::npos);
  const auto ofProp = [](const std::string& prop) { return errorOf(sceneWith("\"props\": [" + prop + "]")); };
  EXPECT_EQ(ofProp("3"), "s.json: props[0]: found 3, expected an object");
  EXPECT_EQ(ofProp(R"({"at": [0, 0, 0]})"),
            "s.json: props[0].shape: found nothing, expected box, sphere, capsule or cylinder");
  EXPECT_EQ(ofProp(R"({"shape": "cone", "radius": 1, "at": [0, 0, 0]})"),
            "s.json: props[0].shape: found \"cone\", expected box, sphere, capsule or cylinder");
  EXPECT_EQ(ofProp(R"({"shape": "sphere", "radius": -1, "at": [0, 0, 0]})"),
            "s.json: props[0].radius: found -1, expected a number from 0.005 to 10");
  EXPECT_EQ(ofProp(R"({"shape": "sphere", "radius": 1, "at": [0, 0]})"),
            "s.json: props[0].at: found [0,0], expected three numbers from -50 to 50");
  EXPECT_EQ(ofProp(R"({"shape": "sphere", "radius": 1, "at": [0, 0, 0], "mass": 0})"),
            "s.json: props[0].mass: found 0, expected a number from 0.001 to 10000");
  EXPECT_EQ(ofProp(R"({"shape": "sphere", "radius": 1, "at": [0, 0, 0], "color": "red"})"),
            "s.json: props[0].color: found \"red\", expected a colour such as \"#d08020\"");
  EXPECT_NE(ofProp(R"({"shape": "capsule", "radius": 1, "height": 1, "at": [0, 0, 0]})").find("as high as it is wide"),
            std::string::npos);
  EXPECT_NE(ofProp(R"({"shape": "sphere", "radius": 1, "at": [0, 0, 0], "repeat": {"count": 1000000}})")
                .find("props[0].repeat.step: found nothing"),
            std::string::npos);
  EXPECT_NE(ofProp(R"({"shape": "sphere", "radius": 1, "at": [0, 0, 0], "repeat": {"count": 2000, "step": [0, 1, 0]}},
                      {"shape": "sphere", "radius": 1, "at": [0, 0, 0]})")
                .find("at most 2000"),
            std::string::npos);
  EXPECT_NE(
      errorOf(sceneWith(R"("chains": [{"from": [0, 1, 0], "to": [0, 1, 0], "links": 3}])")).find("chains[0].links"),
      std::string::npos);
  EXPECT_NE(errorOf(sceneWith(R"("props": [{"shape": "box", "size": [1, 1, 1], "at": [0, 0, 1e999]}])")).find("s.json"),
            std::string::npos);
}

TEST(SceneFile, EveryTruncatedPrefixFailsInASentence) {
  const Result<std::string> text = readFile(scenesFolder() / "bowling.json");
  ASSERT_TRUE(text.ok());
  const std::size_t end = text->find_last_of('}');
  for (std::size_t length = 0; length < end; length += 7) {
    const Result<SceneFile> scene = parseScene(std::string_view(*text).substr(0, length), "cut.json");
    ASSERT_FALSE(scene.ok()) << length;
    EXPECT_EQ(scene.error().message.rfind("cut.json: ", 0), 0u);
  }
}

TEST(ShippedScenes, StandStillUntilSomebodyComes) {
  for (const char* name : {"boxes", "bowling", "curtain"}) {
    const SceneFile scene = shipped(name);
    World world = makeWorld(scene);
    for (int i = 0; i < 90; ++i) world.step({}, 1.0 / 30.0);
    for (std::size_t p = 0; p < scene.props.size(); ++p) {
      const Vec3 moved = world.props()[p].worldFromProp.translation() - scene.props[p].worldFromProp.translation();
      EXPECT_LT(moved.norm(), 0.03) << name << ", prop " << p;
    }
  }
}

TEST(ShippedScenes, FistsAndFeetBreakTheWallOfBoxes) {
  Session session = performance(SyntheticMotion::kPunchAndKick, shipped("boxes"));
  const std::size_t count = session.world().props().size();
  std::vector<Vec3> before(count);
  for (std::size_t p = 0; p < count; ++p) before[p] = session.world().props()[p].worldFromProp.translation();
  playToTheEnd(session);
  int moved = 0;
  for (std::size_t p = 0; p < count; ++p) {
    moved += (session.world().props()[p].worldFromProp.translation() - before[p]).norm() > 0.2 ? 1 : 0;
  }
  EXPECT_GE(moved, 5);
}

TEST(ShippedScenes, AWalkersFootBowls) {
  const SceneFile scene = shipped("bowling");
  Session session = performance(SyntheticMotion::kWalk, scene);
  playToTheEnd(session);
  int fallen = 0;
  for (std::size_t p = 0; p < scene.props.size(); ++p) {
    if (scene.props[p].shape != PropShape::kCylinder || scene.props[p].mass == 0.0) continue;
    const Vec3 up = session.world().props()[p].worldFromProp.linear() * Vec3::UnitY();
    fallen += up.y() < 0.5 ? 1 : 0;
  }
  EXPECT_GE(fallen, 1) << "the ball lies at " << session.world().props()[0].worldFromProp.translation().transpose();
}

TEST(ShippedScenes, TheCurtainIsPartedAndHangsOnItsBarAfterwards) {
  const SceneFile scene = shipped("curtain");
  Session session = performance(SyntheticMotion::kPunchAndKick, scene);
  std::set<int> touched;
  double widestGap = 0.0;
  const auto gapOf = [&](const SceneFile::Link& link) {
    const auto placeOn = [&](int prop) -> Vec3 {
      if (prop == kWorldItself) return link.place;
      const auto p = static_cast<std::size_t>(prop);
      return session.world().props()[p].worldFromProp * (scene.props[p].worldFromProp.inverse() * link.place);
    };
    return (placeOn(link.a) - placeOn(link.b)).norm();
  };
  while (true) {
    const Result<bool> more = session.step();
    ASSERT_TRUE(more.ok());
    if (!*more) break;
    for (const Contact& contact : session.world().contacts()) touched.insert(contact.prop);
    for (const SceneFile::Link& link : scene.links) widestGap = std::max(widestGap, gapOf(link));
  }
  EXPECT_GE(touched.size(), 10u);
  EXPECT_LT(widestGap, 0.15) << "links may stretch where a fist takes them along, and never tear";
  for (const SceneFile::Link& link : scene.links) EXPECT_LT(gapOf(link), 0.02);
}

}  // namespace
}  // namespace lorica

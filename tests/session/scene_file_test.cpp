#include "session/scenes/scene_file.h"

#include "acd/decompose.h"
#include "capture/files/joint_csv.h"
#include "geometry/files.h"
#include "geometry/mesh_files.h"
#include "geometry/work_budgets.h"
#include "session/pose_source.h"
#include "session/session.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <functional>
#include <set>
#include <string>
#include <utility>

namespace lorica {
namespace {

std::filesystem::path scenesFolder() {
  return test::recordingsFolder() / "scenes";
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

/// The mannequin in six parts, performing in a scene.
Session performance(std::string_view motion, const SceneFile& scene) {
  static const Decomposition parts = [] {
    const Character character = makeMannequin();
    DecomposeSettings settings;
    settings.maxParts = 6;
    return decompose(character.mesh, {character.mesh.vertices, static_cast<int>(character.mesh.vertices.size())},
                     settings)
        .value();
  }();
  std::unique_ptr<PoseSource> source =
      makeJointPoseSource(makeMannequin().skeleton, makeRecordedSource(shippedFrames(motion))).value();
  return Session::create(makeMannequin(), parts, std::move(source), makeWorld(scene).value()).value();
}

void playToTheEnd(Session& session) {
  while (true) {
    const bool more = test::valueOf(session.step());
    if (!more) return;
    for (const Prop& prop : session.world().props()) ASSERT_TRUE(prop.worldFromProp.matrix().allFinite());
  }
}

TEST(SceneFile, EveryFieldIsRead) {
  const SceneFile scene =
      test::valueOf(parseScene(sceneWith(R"("name": "all", "gravity": [0, -1.5, 0.5], "floor": false,
    "props": [
      {"shape": "box", "size": [0.2, 0.4, 0.6], "at": [1, 2, 3], "turn": [0, 90, 0], "mass": 2.5, "friction": 0.3,
       "restitution": 0.7, "color": "#ff8000", "velocity": [1, 0, -2]},
      {"shape": "sphere", "radius": 0.25, "at": [0, 1, 0]},
      {"shape": "capsule", "radius": 0.1, "height": 0.5, "at": [0, 2, 0]},
      {"shape": "cylinder", "radius": 0.1, "height": 0.1, "at": [0, 3, 0], "fixed": true,
       "repeat": {"count": 3, "step": [0.5, 0, 0]}}],
    "chains": [{"from": [0, 5, 0], "to": [0, 4, 0], "links": 4, "radius": 0.02, "hung": "both"}])"),
                               "s.json"));
  EXPECT_EQ(scene.name, "all");
  EXPECT_EQ(scene.world.gravity, Vec3(0, -1.5, 0.5));
  EXPECT_FALSE(scene.world.floor);
  ASSERT_EQ(scene.props.size(), 3u + 3u + 4u);
  const Prop& box = scene.props[0];
  EXPECT_EQ(box.shape, PropShape::kBox);
  EXPECT_LT((box.halfExtents - Vec3(0.1, 0.2, 0.3)).norm(), 1e-12);
  EXPECT_LT((box.worldFromProp * Vec3(0, 0, 1) - Vec3(2, 2, 3)).norm(), 1e-12) << "a quarter turn takes z to x";
  EXPECT_EQ(box.mass, 2.5);
  EXPECT_EQ(box.friction, 0.3);
  EXPECT_EQ(box.restitution, 0.7);
  EXPECT_EQ(box.velocity, Vec3(1, 0, -2));
  EXPECT_NEAR(box.color.x(), 1.0, 1e-6);
  EXPECT_NEAR(box.color.y(), 0.2158605, 1e-6) << "sRGB 128 in linear light (IEC 61966-2-1)";
  EXPECT_EQ(scene.props[1].shape, PropShape::kSphere);
  EXPECT_EQ(scene.props[2].shape, PropShape::kCapsule);
  EXPECT_EQ(scene.props[2].halfExtents.y(), 0.25);
  EXPECT_EQ(scene.props[5].shape, PropShape::kCylinder);
  EXPECT_EQ(scene.props[5].mass, 0.0);
  EXPECT_LT((scene.props[5].worldFromProp.translation() - Vec3(1, 3, 0)).norm(), 1e-12);
  ASSERT_EQ(scene.links.size(), 5u) << "four upper ends and the last lower one";
  EXPECT_EQ(scene.links[0].b, kWorldItself);
  EXPECT_EQ(scene.links[4].b, kWorldItself);
  EXPECT_LT((scene.links[4].position - Vec3(0, 4, 0)).norm(), 1e-12);
}

TEST(SceneFile, WhatIsWrongIsNamed) {
  EXPECT_NE(errorOf("{").find("s.json: not JSON"), std::string::npos) << errorOf("{");
  EXPECT_LT(errorOf("{\"" + std::string(100'000, 'x')).size(), 300U) << "it quotes 40 characters";
  EXPECT_NE(errorOf("{\"" + std::string(100'000, 'x') + "\" = 1}").find("xxx...'; expected ':'"), std::string::npos);
  EXPECT_EQ(errorOf("[]"), "s.json: the scene: found [], expected an object");
  EXPECT_EQ(errorOf("{}"), "s.json: format: found nothing, expected \"lorica scene 1\"");
  EXPECT_NE(errorOf(R"({"format": "lorica scene 9"})").find("\"lorica scene 9\""), std::string::npos);
  EXPECT_NE(errorOf(sceneWith(R"("prop": [])")).find("prop: found no such key"), std::string::npos);
  const auto ofProp = [](const std::string& prop) { return errorOf(sceneWith("\"props\": [" + prop + "]")); };
  EXPECT_EQ(ofProp("3"), "s.json: props[0]: found 3, expected an object");
  EXPECT_EQ(ofProp(R"({"at": [0, 0, 0]})"),
            "s.json: props[0].shape: found nothing, expected box, sphere, capsule, cylinder or mesh");
  EXPECT_EQ(ofProp(R"({"shape": "cone", "radius": 1, "at": [0, 0, 0]})"),
            "s.json: props[0].shape: found \"cone\", expected box, sphere, capsule, cylinder or mesh");
  EXPECT_EQ(ofProp(R"({"shape": "sphere", "radius": -1, "at": [0, 0, 0]})"),
            "s.json: props[0].radius: found -1, expected a number from 0.005 to 10");
  EXPECT_EQ(ofProp(R"({"shape": "sphere", "radius": 1, "at": [0, 0]})"),
            "s.json: props[0].at: found [0,0], expected three numbers from -50 to 50");
  EXPECT_EQ(ofProp(R"({"shape": "sphere", "radius": 1, "at": [0, 0, 0], "mass": 0})"),
            "s.json: props[0].mass: found 0, expected a number from 0.001 to 10000");
  EXPECT_EQ(ofProp(R"({"shape": "sphere", "radius": 1, "at": [0, 0, 0], "color": "red"})"),
            "s.json: props[0].color: found \"red\", expected a colour such as \"#d08020\"");
  EXPECT_NE(ofProp(R"({"shape": "capsule", "radius": 1, "height": 1, "at": [0, 0, 0]})").find("twice the radius"),
            std::string::npos);
  EXPECT_NE(ofProp(R"({"shape": "sphere", "radius": 1, "at": [0, 0, 0], "repeat": {"count": 1000000}})")
                .find("props[0].repeat.step: found nothing"),
            std::string::npos);
  EXPECT_NE(ofProp(R"({"shape": "sphere", "radius": 1, "at": [0, 0, 0], "repeat": {"count": 2000, "step": [0, 1, 0]}},
                      {"shape": "sphere", "radius": 1, "at": [0, 0, 0]})")
                .find("at most 2000"),
            std::string::npos);
  EXPECT_EQ(ofProp(R"({"shape": "sphere", "radius": 1, "at": [0, 0, 0], "target": ""})"),
            "s.json: props[0].target: found \"\", expected a name of 1 to 40 bytes");
  EXPECT_EQ(ofProp(R"({"shape": "sphere", "radius": 1, "at": [0, 0, 0], "target": true})"),
            "s.json: props[0].target: found true, expected a string");
  EXPECT_EQ(ofProp(R"({"shape": "sphere", "radius": 1, "at": [0, 0, 0], "fixed": true, "target": "wall"})"),
            "s.json: props[0].target: found a fixed body, which the avatar passes through, expected one that moves");
  EXPECT_EQ(ofProp(R"({"shape": "sphere", "radius": 1, "at": [0, 0, 0], "repeat": {"count": 2, "step": [0, 0, 1],
                      "turn": 400}})"),
            "s.json: props[0].repeat.turn: found 400, expected a number from -360 to 360");
  EXPECT_EQ(errorOf(sceneWith(R"("chains": [{"from": [0, 1, 0], "to": [0, 1, 3], "links": 3, "sag": -1}])")),
            "s.json: chains[0].sag: found -1, expected a number from 0 to 20");
  EXPECT_NE(
      errorOf(sceneWith(R"("chains": [{"from": [0, 1, 0], "to": [0, 1, 0], "links": 3}])")).find("chains[0].links"),
      std::string::npos);
  EXPECT_NE(errorOf(sceneWith(R"("props": [{"shape": "box", "size": [1, 1, 1], "at": [0, 0, 1e999]}])")).find("s.json"),
            std::string::npos);
}

TEST(SceneFile, RowsBendAndChainsSagOrCarryPlanks) {
  const SceneFile scene = test::valueOf(parseScene(sceneWith(R"("props": [
      {"shape": "box", "size": [0.1, 0.2, 0.3], "at": [1, 0, 0], "turn": [0, 10, 0], "target": "row",
       "repeat": {"count": 4, "step": [0, 0, 1], "turn": 90}}],
    "chains": [{"from": [0, 2, 0], "to": [0, 2, 4], "links": 4, "radius": 0.02, "width": 0.5, "hung": "both"},
               {"from": [0, 1, 0], "to": [0, 1, 4], "links": 4, "radius": 0.02, "sag": 0.5, "target": "rope"},
               {"from": [9, 1, 0], "to": [9, 0, 0], "links": 1, "width": 0.3, "target": "row"}])"),
                                                   "s.json"));
  // Four copies around a square, each turned by a quarter more.
  const Vec3 corners[] = {{1, 0, 0}, {2, 0, 0}, {2, 0, -1}, {1, 0, -1}};
  for (std::size_t i = 0; i < 4; ++i) {
    const Isometry3& copy = scene.props[i].worldFromProp;
    EXPECT_LT((copy.translation() - corners[i]).norm(), 1e-12) << i;
    const double angle = (10.0 + 90.0 * static_cast<double>(i)) * M_PI / 180.0;
    EXPECT_LT((copy.linear() * Vec3::UnitZ() - Vec3(std::sin(angle), 0.0, std::cos(angle))).norm(), 1e-12) << i;
  }
  const Prop& plank = scene.props[4];
  EXPECT_EQ(plank.shape, PropShape::kBox);
  EXPECT_LT((plank.halfExtents - Vec3(0.25, 0.45, 0.02)).norm(), 1e-12) << "gaps of a tenth between planks";
  EXPECT_LT((plank.worldFromProp.linear() * Vec3::UnitY() - Vec3::UnitZ()).norm(), 1e-12);
  EXPECT_NEAR(std::abs((plank.worldFromProp.linear() * Vec3::UnitX()).x()), 1.0, 1e-12);
  ASSERT_EQ(scene.links.size(), 10u + 4u + 2u) << "planks have two joints, at their sides";
  EXPECT_NEAR((scene.links[0].position - scene.links[1].position).norm(), 0.5, 1e-12);
  EXPECT_LT((scene.links[12].position - Vec3(0.0, 0.5, 2.0)).norm(), 1e-12) << "the lowest point of the sag";
  ASSERT_EQ(scene.targets.size(), 2u);
  EXPECT_EQ(scene.targets[0].name, "row");
  EXPECT_EQ(scene.targets[0].props, (std::vector<int>{0, 1, 2, 3, 12}));
  EXPECT_EQ(scene.targets[1].props, (std::vector<int>{8, 9, 10, 11}));
}

TEST(SceneFile, EachShapeHasKeysOfItsOwn) {
  const auto ofProp = [](const std::string& prop) { return errorOf(sceneWith("\"props\": [" + prop + "]")); };
  // An unknown shape is reported before missing keys.
  EXPECT_EQ(ofProp(R"({"shape": "ball", "at": [0, 0, 0]})"),
            "s.json: props[0].shape: found \"ball\", expected box, sphere, capsule, cylinder or mesh");
  EXPECT_NE(ofProp(R"({"shape": "box", "size": [1, 1, 1], "radius": 1, "at": [0, 0, 0]})")
                .find("props[0].radius: found no such key, expected one of shape, size, at"),
            std::string::npos);
  EXPECT_NE(ofProp(R"({"shape": "sphere", "radius": 1, "file": "a.obj", "at": [0, 0, 0]})").find("no such key"),
            std::string::npos);
}

TEST(SceneFile, KeysThatStandTwiceAndDeepNestsAreRefused) {
  EXPECT_EQ(errorOf(sceneWith(R"("floor": true, "floor": false)")),
            "s.json: floor: found twice in one object, expected once");
  EXPECT_EQ(errorOf(sceneWith(R"("props": [{"shape": "sphere", "radius": 1, "at": [0, 1, 0]},
                                           {"shape": "sphere", "radius": 1, "radius": 2, "at": [0, 1, 0]}])")),
            "s.json: props[1].radius: found twice in one object, expected once");
  EXPECT_EQ(errorOf(sceneWith(R"("gravity": [0, -1, 0], "props": [{"at": [0, 0, 0], "at": [1, 1, 1]}])")),
            "s.json: props[0].at: found twice in one object, expected once");
  const auto nested = [](int levels) {
    return sceneWith("\"props\": " + std::string(levels, '[') + std::string(levels, ']'));
  };
  EXPECT_NE(errorOf(nested(20)).find("nested more than 16 levels deep"), std::string::npos);
  EXPECT_EQ(errorOf(nested(100000)), "s.json: its JSON nests deeper than 64 levels");
}

TEST(SceneFile, EveryTruncatedPrefixFailsInASentence) {
  const std::string text = test::valueOf(readFile(scenesFolder() / "bowling.json"));
  const std::size_t end = text.find_last_of('}');
  for (std::size_t length = 0; length < end; length += 7) {
    const Result<SceneFile> scene = parseScene(std::string_view(text).substr(0, length), "cut.json");
    ASSERT_FALSE(scene.ok()) << length;
    EXPECT_EQ(scene.error().message.rfind("cut.json: ", 0), 0u);
  }
}

/// A scene file of its own in a folder with a mesh.
class SceneMeshes : public testing::Test {
 protected:
  void put(const std::string& name, const TriMesh& mesh) {
    ASSERT_TRUE(writeObjObjects(folder_ / name, {{"mesh", mesh}}).ok());
  }
  [[nodiscard]] Result<SceneFile> read(const std::string& prop, const MeshDecomposer& decomposer = {}) const {
    const std::filesystem::path file = folder_ / "s.json";
    EXPECT_TRUE(writeFileAtomically(file, sceneWith("\"props\": [" + prop + "]")).ok());
    return readScene(file, decomposer);
  }
  [[nodiscard]] std::string errorOfProp(const std::string& prop) const {
    const Result<SceneFile> scene = read(prop);
    return scene ? "none" : scene.error().message;
  }

  void TearDown() override { std::filesystem::remove_all(folder_); }

  const std::filesystem::path folder_ = [] {
    std::string name = (std::filesystem::temp_directory_path() / "lorica_scene_XXXXXX").string();
    return std::filesystem::path(mkdtemp(name.data()));
  }();
};

TEST_F(SceneMeshes, AMeshIsItsHullOrItsPartsAboutTheMiddleOfItsBounds) {
  put("l.obj", test::makeLShape());  // 2 x 2 x 1, volume 3, hull 3.5
  const SceneFile scene = test::valueOf(read(
      R"({"shape": "mesh", "file": "l.obj", "scale": 0.1, "at": [0, 1, 0], "mass": 2},
         {"shape": "mesh", "file": "l.obj", "scale": 0.1, "parts": 4, "at": [1, 1, 0]},
         {"shape": "mesh", "file": "l.obj", "size": [0.4, 0.2, 0.3], "at": [2, 1, 0]},
         {"shape": "mesh", "file": "l.obj", "scale": 0.1, "parts": 4, "at": [3, 1, 0], "fixed": true})"));
  ASSERT_EQ(scene.props.size(), 4u);
  const Prop& hull = scene.props[0];
  EXPECT_EQ(hull.shape, PropShape::kMesh);
  ASSERT_EQ(hull.mesh->hulls.size(), 1u);
  EXPECT_NEAR(hull.mesh->hulls[0].volume, 3.5e-3, 1e-9);
  EXPECT_NEAR(hull.mesh->solid.volume, 3.5e-3, 1e-9) << "with one part, the mass is that of the hull";
  std::vector<double> sides = {hull.halfExtents.x(), hull.halfExtents.y(), hull.halfExtents.z()};
  std::sort(sides.begin(), sides.end());
  EXPECT_NEAR(sides[0], 0.05, 1e-9);
  EXPECT_NEAR(sides[2], 0.1, 1e-9);
  const Prop& parts = scene.props[1];
  EXPECT_GE(parts.mesh->hulls.size(), 2u);
  double volume = 0.0;
  for (const ConvexHull& part : parts.mesh->hulls) volume += part.volume;
  EXPECT_NEAR(volume, 3e-3, 1e-6) << "an L is two boxes";
  EXPECT_NEAR(parts.mesh->solid.volume, 3e-3, 1e-9);
  EXPECT_LT((scene.props[2].halfExtents - Vec3(0.2, 0.1, 0.15)).norm(), 1e-9);
  EXPECT_EQ(scene.props[3].mesh, parts.mesh) << "made once";
  for (const Prop& prop : scene.props) {
    const Aabb bounds = boundsOf(prop.mesh->shown.vertices);
    EXPECT_LT(bounds.center().norm(), 1e-12);
  }
  World world = makeWorld(scene).value();
  for (int i = 0; i < 30; ++i) world.step({}, 1.0 / 30.0);
}

TEST_F(SceneMeshes, WhatCannotBeAPropIsNamed) {
  put("box.obj", test::makeBox(Vec3::Zero(), Vec3::Constant(0.2)));
  TriMesh open = test::makeBox(Vec3::Zero(), Vec3::Constant(0.2));
  open.triangles.pop_back();
  put("open.obj", open);
  const std::string at = R"(, "at": [0, 1, 0]})";
  EXPECT_NE(errorOfProp(R"({"shape": "mesh")" + at).find("props[0].file: found nothing"), std::string::npos);
  EXPECT_NE(errorOfProp(R"({"shape": "mesh", "file": "none.obj")" + at).find("none.obj"), std::string::npos);
  EXPECT_NE(errorOfProp(R"({"shape": "mesh", "file": "box.obj", "parts": 0)" + at).find("from 1 to 32"),
            std::string::npos);
  EXPECT_NE(errorOfProp(R"({"shape": "mesh", "file": "box.obj", "scale": 1000)" + at).find("become 200 x 200 x 200 m"),
            std::string::npos);
  EXPECT_NE(
      errorOfProp(R"({"shape": "mesh", "file": "box.obj", "scale": 1, "size": [1, 1, 1])" + at).find("both scale and"),
      std::string::npos);
  EXPECT_NE(errorOfProp(R"({"shape": "mesh", "file": "open.obj", "parts": 4)" + at).find("open.obj"),
            std::string::npos);
  EXPECT_EQ(errorOfProp(R"({"shape": "mesh", "file": "open.obj")" + at), "none") << "its hull is closed";
}

TEST_F(SceneMeshes, DecomposingIsTheCallersAndCanBeCancelled) {
  put("l.obj", test::makeLShape());
  int calls = 0;
  const std::string twice = R"({"shape": "mesh", "file": "l.obj", "scale": 0.1, "parts": 4, "at": [0, 1, 0]},
                               {"shape": "mesh", "file": "l.obj", "scale": 0.1, "parts": 4, "at": [1, 1, 0]})";
  const Result<SceneFile> scene =
      read(twice, [&](const std::string& name, const TriMesh& mesh, int parts) -> Result<Decomposition> {
        ++calls;
        EXPECT_EQ(name, "l.obj");
        return decomposePropMesh(name, mesh, parts);
      });
  ASSERT_TRUE(scene.ok());
  EXPECT_EQ(calls, 1);
  const Result<SceneFile> cancelled = read(twice, [](const std::string&, const TriMesh&, int) -> Result<Decomposition> {
    return Error{ErrorCode::kCancelled, "cancelled"};
  });
  ASSERT_FALSE(cancelled.ok());
  EXPECT_EQ(cancelled.error().code, ErrorCode::kCancelled);
}

TEST(ShippedScenes, StandStillUntilSomebodyComes) {
  for (const char* name : {"boxes", "bowling", "curtain", "dominoes", "targets"}) {
    const SceneFile scene = shipped(name);
    World world = makeWorld(scene).value();
    for (int i = 0; i < 90; ++i) world.step({}, 1.0 / 30.0);
    for (std::size_t p = 0; p < scene.props.size(); ++p) {
      const Vec3 moved = world.props()[p].worldFromProp.translation() - scene.props[p].worldFromProp.translation();
      EXPECT_LT(moved.norm(), 0.03) << name << ", prop " << p;
    }
  }
}

TEST(ShippedScenes, WhatIsInThePoolFloats) {
  SceneFile scene = shipped("pool");
  scene.particles->settleSeconds = 0.2;
  World world = makeWorld(scene).value();
  for (int i = 0; i < 20; ++i) world.step({}, 1.0 / 30.0);
  for (const Prop& prop : world.props()) {
    EXPECT_TRUE(prop.mass == 0.0 || prop.worldFromProp.translation().y() > 0.35);
  }
  for (const Vec3f& p : world.particles()->positions()) EXPECT_LT(p.cwiseAbs().maxCoeff(), 1.3f);
}

TEST(ShippedScenes, TheFountainRisesAndWhatFloatsStaysInItsBasin) {
  SceneFile scene = shipped("fountain");
  scene.particles->settleSeconds = 0.2;
  World world = makeWorld(scene).value();
  for (int i = 0; i < 45; ++i) world.step({}, 1.0 / 30.0);
  const std::span<const Vec3f> drops = world.particles()->positions();
  EXPECT_TRUE(std::ranges::any_of(drops, [](const Vec3f& p) { return p.y() > 1.1f; }));
  int ducks = 0;
  for (const Prop& prop : world.props()) {
    if (prop.mass == 0.0) continue;
    const Vec3 at = prop.worldFromProp.translation();
    EXPECT_GT(at.y(), 0.2);
    EXPECT_LT(std::max(std::abs(at.x()), std::abs(at.z())), 0.95);
    ducks += prop.shape == PropShape::kMesh ? 1 : 0;
  }
  EXPECT_EQ(ducks, 2);
}

/// Grains lie where a foot has pressed no longer.
TEST(ShippedScenes, OnTheBeachFootprintsStay) {
  const SceneFile scene = shipped("beach");
  Session session = performance("walk", scene);
  const auto lowAt = [&](const Vec3& foot) {
    float top = 0.0f;
    for (const Vec3f& p : session.world().particles()->positions()) {
      if (std::hypot(p.x() - foot.x(), p.z() - foot.z()) < 0.02) top = std::max(top, p.y());
    }
    return top < 0.055f;  // of a bed of 8 cm
  };
  Vec3 print = Vec3::Zero();
  for (int i = 0; i < 60; ++i) {
    ASSERT_TRUE(session.step().value());
    if (i == 20) {
      double lowest = 1.0;
      for (const LivePart& part : session.avatar(0).partsInWorld()) {
        for (const Vec3& v : part.shape.vertices) {
          const Vec3 p = part.worldFromPart * v;
          if (p.y() < lowest) print = p;
          lowest = std::min(lowest, p.y());
        }
      }
      EXPECT_TRUE(lowAt(print)) << "the foot is there";
    }
  }
  for (const LivePart& part : session.avatar(0).partsInWorld()) {
    for (const Vec3& v : part.shape.vertices) EXPECT_GT((part.worldFromPart * v - print).norm(), 0.15);
  }
  EXPECT_TRUE(lowAt(print)) << "it has gone";
}

TEST(ShippedScenes, FistsAndFeetBreakTheWallOfBoxes) {
  Session session = performance("punch_and_kick", shipped("boxes"));
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

TEST(ShippedScenes, AKickBowls) {
  const SceneFile scene = shipped("bowling");
  Session session = performance("punch_and_kick", scene);
  playToTheEnd(session);
  int fallen = 0;
  for (std::size_t p = 0; p < scene.props.size(); ++p) {
    if (scene.props[p].shape != PropShape::kMesh) continue;
    const Vec3 up = session.world().props()[p].worldFromProp.linear() * Vec3::UnitY();
    fallen += up.y() < 0.5 ? 1 : 0;
  }
  EXPECT_GE(fallen, 7) << "the ball lies at " << session.world().props()[1].worldFromProp.translation().transpose();
}

TEST(ShippedScenes, TheCurtainIsPartedAndHangsOnItsBarAfterwards) {
  const SceneFile scene = shipped("curtain");
  Session session = performance("punch_and_kick", scene);
  std::set<int> touched;
  double widestGap = 0.0;
  const auto gapOf = [&](const SceneFile::Link& link) {
    const auto positionOn = [&](int prop) -> Vec3 {
      if (prop == kWorldItself) return link.position;
      const auto p = static_cast<std::size_t>(prop);
      return session.world().props()[p].worldFromProp * (scene.props[p].worldFromProp.inverse() * link.position);
    };
    return (positionOn(link.a) - positionOn(link.b)).norm();
  };
  while (true) {
    const bool more = test::valueOf(session.step());
    if (!more) break;
    for (const Contact& contact : session.world().contacts()) touched.insert(contact.prop);
    for (const SceneFile::Link& link : scene.links) widestGap = std::max(widestGap, gapOf(link));
  }
  EXPECT_GE(touched.size(), 10u);
  EXPECT_LT(widestGap, 0.15) << "links may stretch if a fist pulls them along, but never tear";
  for (const SceneFile::Link& link : scene.links) EXPECT_LT(gapOf(link), 0.02);
}

/// Each budget of work at its limit and one above it.
TEST(SceneFile, BudgetsAreTakenAtTheirLimitsAndRefusedAboveThem) {
  const test::TemporaryFolder folder;
  TriMesh three;  // tetrahedra beside each other: three convex parts
  for (int k = 0; k < 3; ++k) {
    for (const Vec3& p : test::makeTetrahedron().vertices) three.vertices.push_back(0.1 * p + Vec3(0.2 * k, 0, 0));
    for (const Triangle& t : test::makeTetrahedron().triangles) {
      three.triangles.push_back({t[0] + 4 * k, t[1] + 4 * k, t[2] + 4 * k});
    }
  }
  ASSERT_TRUE(writeObjObjects(folder.path() / "three.obj", {{"three", three}}));
  ASSERT_TRUE(writeObjObjects(folder.path() / "ball.obj", {{"ball", test::makeSphere(1.0, 7, 83)}}));
  const auto points = [&](std::size_t count) {
    std::string off = "OFF\n" + std::to_string(count) + " 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
    for (std::size_t i = 4; i < count; ++i) off += "0.1 0.1 0.1\n";
    const std::string name = std::to_string(count) + ".off";
    (void)folder.write(name, off + "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
    return R"("props": [{"shape": "mesh", "file": ")" + name + R"(", "at": [0, 1, 0]}])";
  };
  const auto listOf = [](std::size_t count, const auto& element) {
    std::string list;
    for (std::size_t i = 0; i < count; ++i) list += (i > 0 ? "," : "") + std::string(element(i));
    return "[" + list + "]";
  };
  const auto row = [](int height, std::size_t count) {
    return R"({"shape": "sphere", "radius": 0.01, "at": [-45, )" + std::to_string(height) +
           R"(, 0], "repeat": {"count": )" + std::to_string(count) + R"(, "step": [0.025, 0, 0]}})";
  };
  struct Case {
    const char* words;
    std::function<std::string(std::size_t)> scene;
    std::size_t most;
  };
  const Case cases[] = {
      {"more props",
       [&](std::size_t n) {  // two rows, since one may have as many as the scene
         return "\"props\": [" + row(0, n - 1) + "," + row(1, 1) + "]";
       },
       kMaxSceneProps},
      {"more sources",
       [&](std::size_t n) {
         return "\"grains\": {\"fill\": " +
                listOf(n, [](std::size_t) { return R"({"at": [0, 1, 0], "size": [0.1, 0.1, 0.1], "count": 1})"; }) +
                "}";
       },
       kMaxParticleSources},
      {"count",
       [&](std::size_t n) {
         return R"("grains": {"fill": [{"at": [0, 1, 0], "size": [0.1, 0.1, 0.1], "count": )" + std::to_string(n) +
                "}]}";
       },
       kMaxParticles},
      {"parts",
       [&](std::size_t n) {
         return R"("props": [{"shape": "mesh", "file": "three.obj", "at": [0, 1, 0], "parts": )" + std::to_string(n) +
                "}]";
       },
       kMaxPropParts},
      {"vertices", points, kMaxPropVertices},
      {"more meshes",
       [&](std::size_t n) {
         return "\"props\": " + listOf(n, [](std::size_t i) {
                  return R"({"shape": "mesh", "file": "three.obj", "scale": )" + std::to_string(1.0 + 0.01 * i) +
                         R"(, "at": [0, )" + std::to_string(0.7 * i) + ", 0]}";
                });
       },
       kMaxSceneMeshes},
      {"more convex parts",
       [&](std::size_t n) {  // three each, and one each
         return R"("props": [{"shape": "mesh", "file": "three.obj", "scale": 0.11, "parts": 3, "at": [-45, 1, 0], "repeat": {"count": )" +
                std::to_string((n - 1) / 3) + R"(, "step": [0.07, 0, 0]}}, )" +
                listOf((n - 1) % 3 + 1, [](std::size_t i) {
                  return R"({"shape": "mesh", "file": "three.obj", "at": [0, )" + std::to_string(3 + i) + ", 0]}";
                }).substr(1);
       },
       kMaxSceneHulls},
      {"more vertices of convex parts",
       [&](std::size_t n) {  // spheres of 500, and then one of 4
         return R"("props": [{"shape": "mesh", "file": "ball.obj", "size": [0.2, 0.2, 0.2], "at": [-45, 1, 0],
                              "repeat": {"count": )" +
                std::to_string(n / 500) + R"(, "step": [0.3, 0, 0]}})" +
                (n % 500 > 0 ? "," + points(4).substr(10) : std::string("]"));
       },
       kMaxSceneHullVertices},
      {"more pairs",
       [&](std::size_t n) {  // 200 bars that all overlap, and boxes that overlap their neighbours
         return R"("props": [{"shape": "box", "size": [20, 0.01, 0.01], "at": [-5, 0, 0], "turn": [0, 45, 45],
                              "repeat": {"count": 200, "step": [0.02, 0, 0]}},
                             {"shape": "box", "size": [1, 1, 1], "at": [-49, 40, 0], "repeat": {"count": )" +
                std::to_string(n - 199 * 200 / 2 + 1) + R"(, "step": [0.9, 0, 0]}}])";
       },
       kMaxSceneNearPairs}};
  for (const Case& c : cases) {
    for (const std::size_t more : {0U, 1U}) {
      const Result<SceneFile> scene = parseScene(sceneWith(c.scene(c.most + more)), "s.json", {folder.path()});
      EXPECT_EQ(scene.ok(), more == 0) << c.words << (scene ? "" : ": " + scene.error().message);
      if (more == 0 || scene) continue;
      EXPECT_NE(scene.error().message.find(c.words), std::string::npos) << scene.error().message;
    }
  }
}

}  // namespace
}  // namespace lorica

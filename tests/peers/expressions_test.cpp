#include "capture/files/joint_csv.h"
#include "session/pose_source.h"
#include "skinning/import/character_file.h"
#include "skinning/linear_blend.h"
#include "skinning/morphs/face.h"
#include "skinning/morphs/look_at.h"
#include "skinning/springs/spring_simulation.h"
#include "tests/peers/avatar_poses.h"
#include "tests/peers/bare_picture.h"
#include "tests/peers/peer.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lorica {
namespace {

using nlohmann::json;

// Faces as three.js and three-vrm make them: every expression moves the vertices to the same places and gives materials
// the same colours.

/// The vertices of the bind pose with some expressions, by name.
std::vector<Vec3> faceOf(const CharacterFile& file, const json& expressions) {
  Face face(file.morphs, file.expressions, file.lookAt);
  face.setBlinking(false);
  for (const auto& [name, weight] : expressions.items()) {
    face.set(findExpression(file.expressions, name).value(), weight.get<float>());
  }
  face.update({});
  Character moved = file.character;
  applyMorphs(file.morphs, face.targetWeights(), file.character.mesh.vertices, {}, moved.mesh.vertices, {});
  return test::posedVertices(moved, restPose(moved.skeleton));
}

TEST(PeerExpressions, VerticesAgreeForEachOfGodettesSeventeen) {
  LORICA_REQUIRE_DATASET(path, "characters/godette/Godette_vrm_v4.vrm");
  LORICA_REQUIRE_PEERS();
  const CharacterFile file = test::valueOf(readCharacterFile(path));
  ASSERT_EQ(file.expressions.list.size(), 17U);
  json shots = {{"picture", false}, {"vertices", true}};
  shots["shots"]["none"] = json::object();
  for (const Expression& expression : file.expressions.list) {
    for (const double weight : {0.4, 1.0}) {
      shots["shots"][expression.name + (weight == 1.0 ? "" : " partly")]["expressions"][expression.name] = weight;
    }
  }
  shots["shots"]["several"]["expressions"] = {{"angry", 0.7}, {"aa", 0.6}, {"blinkRight", 0.9}, {"lookLeft", 0.3}};

  const auto made = test::shootWithPeer(path, shots);
  ASSERT_EQ(made.size(), shots["shots"].size());
  double farthest = 0.0;
  int moving = 0;
  for (const auto& [name, shot] : made) {
    const std::vector<Vec3> ours = faceOf(file, shots["shots"][name].value("expressions", json::object()));
    // The face is the first mesh that both list; the others have no targets.
    const auto count = shot.facts.at("meshes").at(0).at("count").get<std::size_t>();
    ASSERT_LE(count, ours.size());
    double way = 0.0;
    double apart = 0.0;
    for (std::size_t v = 0; v < count; ++v) {
      apart = std::max(apart, (ours[v] - shot.vertices.at(v).cast<double>()).norm());
      way = std::max(way, (ours[v] - file.character.mesh.vertices[v]).norm());
    }
    EXPECT_LT(apart, 1e-4) << name;
    farthest = std::max(farthest, apart);
    moving += way > 1e-3 ? 1 : 0;
  }
  EXPECT_GE(moving, 28);
  std::printf("%zu faces, of which %d move a vertex by over 1 mm: within %.2g m\n", made.size(), moving, farthest);
}

/// Adds what an expression of VRM 0.x changes of a material. Colours are 0 or 1, because three-vrm takes them as linear
/// and Lorica as gamma-encoded, as Unity does. Shades are nowhere brighter than the lit colour, which Lorica forbids.
void addMaterialValue(json& document, const std::string& preset, const char* material, const char* property,
                      const json& target) {
  for (json& group : document["extensions"]["VRM"]["blendShapeMaster"]["blendShapeGroups"]) {
    if (group["presetName"] != preset) continue;
    group["materialValues"].push_back(
        {{"materialName", material}, {"propertyName", property}, {"targetValue", target}});
  }
}

TEST(PeerExpressions, ColoursAndTexturesAgreeOnAnEditedGodette) {
  LORICA_REQUIRE_DATASET(path, "characters/godette/Godette_vrm_v4.vrm");
  LORICA_REQUIRE_PEERS();
  LORICA_REQUIRE_STUDIO(studio, "");
  const test::TemporaryFolder folder;
  const std::filesystem::path edited = folder.path() / "edited.vrm";
  test::writeEdited(path, edited, [](json& document) {
    addMaterialValue(document, "joy", "Face", "_Color", {1, 0, 0, 1});
    addMaterialValue(document, "joy", "Face", "_ShadeColor", {1, 0, 0, 1});
    addMaterialValue(document, "angry", "Body", "_Color", {0, 1, 1, 1});
    addMaterialValue(document, "angry", "Body", "_ShadeColor", {0, 0, 1, 1});
    addMaterialValue(document, "sorrow", "Body", "_MainTex_ST", {1, 1, 0.25, 0.25});
    addMaterialValue(document, "sorrow", "Face", "_MainTex_ST", {2, 1, 0, 0});
  });
  CharacterFile file = test::valueOf(readCharacterFile(edited));
  MadeAvatar avatar = test::valueOf(makeAvatar(file.character, file.look));
  const test::Sitter sitter = {std::move(file), avatar.avatar};
  json shots = {{"eye", {0.6, 1.2, 2.4}}, {"target", {0, 0.75, 0}}, {"width", 400}, {"height", 400}};
  shots["shots"]["none"] = json::object();
  for (const char* name : {"happy", "angry", "sad"}) shots["shots"][name]["expressions"][name] = 1.0;
  shots["shots"]["half"]["expressions"] = {{"happy", 0.5}, {"sad", 0.5}};
  const auto made = test::shootWithPeer(edited, shots);
  ASSERT_EQ(made.size(), 5u);
  for (const auto& [name, shot] : made) {
    const test::MaskedPicture ours = test::drawBare(*studio, sitter, shot.facts["options"]);
    const test::Likeness like = test::likenessOf(ours, {shot.picture, shot.mask});
    const test::Likeness unlike = test::likenessOf(ours, {made.at("none").picture, made.at("none").mask});
    EXPECT_GE(like.silhouettes, 0.99) << name;
    EXPECT_LE(like.wrong, 0.03) << name;
    if (name != "none") {
      EXPECT_GT(unlike.wrong, 0.1) << name << " changes nothing";
    }
    std::printf("%s: %.2f %% wholly wrong; against no expression %.1f %%\n", name.c_str(), 100.0 * like.wrong,
                100.0 * unlike.wrong);
  }
}

// Eyes that look at something, as three-vrm turns them.

/// Targets around the head, with the head at rest and turned.
json gazeShots() {
  json shots = {{"picture", false}};
  shots["shots"]["rest"] = json::object();
  const std::array<Vec3, 7> targets = {Vec3(0.0, 1.1, 2.0), Vec3(1.5, 1.1, 1.5),  Vec3(-1.5, 1.1, 1.5),
                                       Vec3(0.3, 2.5, 1.0), Vec3(-0.2, 0.1, 1.0), Vec3(2.0, 0.4, -0.3),
                                       Vec3(-0.4, 1.4, 0.6)};
  for (std::size_t t = 0; t < targets.size(); ++t) {
    json shot = {{"lookAt", {targets[t].x(), targets[t].y(), targets[t].z()}}};
    shots["shots"]["target " + std::to_string(t)] = shot;
    shot["rotations"] = {{"head", {0.1, 0.25, -0.05, 0.96}}, {"hips", {0.0, 0.3, 0.05, 0.95}}};
    shots["shots"]["target " + std::to_string(t) + ", head turned"] = shot;
  }
  return shots;
}

struct Looking {
  Gaze gaze;
  std::vector<Affine3> worldFromModel;
};

Looking lookingAt(const CharacterFile& file, const json& shot) {
  const Character& character = file.character;
  const Pose pose = test::poseOf(character, shot);
  std::vector<Affine3> worldFromJoint(pose.size());
  computeWorldFromJoint(character.skeleton, pose, worldFromJoint);
  Looking looking;
  looking.gaze = gazeTowards(file.lookAt, worldFromJoint[file.lookAt.head], test::vectorOf(shot.at("lookAt")));
  looking.worldFromModel.resize(pose.size());
  computeWorldFromModel(character, worldFromJoint, looking.worldFromModel);
  turnEyes(character, file.lookAt, looking.gaze, looking.worldFromModel);
  return looking;
}

TEST(PeerGaze, ExpressionsThatLookHaveTheSameWeights) {
  LORICA_REQUIRE_DATASET(path, "characters/godette/Godette_vrm_v4.vrm");
  LORICA_REQUIRE_PEERS();
  const CharacterFile file = test::valueOf(readCharacterFile(path));
  ASSERT_EQ(file.lookAt.kind, LookAtKind::kExpression);
  const json shots = gazeShots();
  double largest = 0.0;
  for (const auto& [name, shot] : test::shootWithPeer(path, shots)) {
    if (name == "rest") continue;
    const GazeWeights ours = gazeWeights(file.lookAt, lookingAt(file, shots["shots"][name]).gaze);
    const json& theirs = shot.facts.at("expressionWeights");
    for (const auto& [expression, weight] :
         {std::pair("lookUp", ours.up), {"lookDown", ours.down}, {"lookLeft", ours.left}, {"lookRight", ours.right}}) {
      const double peer = theirs.at(expression).get<double>();
      EXPECT_NEAR(std::min(weight, 1.0F), peer, 1e-5) << name << ", " << expression;
      largest = std::max(largest, peer);
    }
  }
  EXPECT_EQ(largest, 1.0);
}

/// Godette has no eye bones, so two joints of her hair take their place; their axes are turned at rest.
TEST(PeerGaze, EyeBonesTurnAlikeOnAnEditedGodette) {
  LORICA_REQUIRE_DATASET(path, "characters/godette/Godette_vrm_v4.vrm");
  LORICA_REQUIRE_PEERS();
  constexpr std::array<int, 2> kEyes = {6, 8};
  const test::TemporaryFolder folder;
  const std::filesystem::path edited = folder.path() / "eyes.vrm";
  test::writeEdited(path, edited, [&](json& document) {
    json& vrm = document["extensions"]["VRM"];
    vrm["humanoid"]["humanBones"].push_back({{"bone", "leftEye"}, {"node", kEyes[0]}});
    vrm["humanoid"]["humanBones"].push_back({{"bone", "rightEye"}, {"node", kEyes[1]}});
    json& firstPerson = vrm["firstPerson"];
    firstPerson["lookAtTypeName"] = "Bone";
    firstPerson["lookAtHorizontalInner"] = {{"xRange", 60}, {"yRange", 12}};
    firstPerson["lookAtHorizontalOuter"] = {{"xRange", 80}, {"yRange", 20}};
    // three-vrm exchanges up and down, so they are equal.
    firstPerson["lookAtVerticalDown"] = {{"xRange", 50}, {"yRange", 15}};
    firstPerson["lookAtVerticalUp"] = {{"xRange", 50}, {"yRange", 15}};
  });
  const CharacterFile file = test::valueOf(readCharacterFile(edited));
  ASSERT_EQ(file.lookAt.kind, LookAtKind::kBone);
  const std::array<JointIndex, 2> eyes = {file.lookAt.leftEye, file.lookAt.rightEye};
  ASSERT_TRUE(eyes[0] != kNoJoint && eyes[1] != kNoJoint);

  const json shots = gazeShots();
  const auto made = test::shootWithPeer(edited, shots);
  ASSERT_EQ(made.size(), shots["shots"].size());
  const auto rotationOf = [&](const std::string& shot, std::size_t eye) {
    const json& q = made.at(shot).facts.at("nodeRotations").at(static_cast<std::size_t>(kEyes[eye]));
    return Quat(q.at(3), q.at(0), q.at(1), q.at(2)).normalized();
  };
  double apart = 0.0;
  double turned = 0.0;
  for (const auto& [name, shot] : made) {
    if (name == "rest") continue;
    const Looking ours = lookingAt(file, shots["shots"][name]);
    for (std::size_t eye = 0; eye < 2; ++eye) {
      const Quat theirs = rotationOf(name, eye) * rotationOf("rest", eye).conjugate();
      const double angle = Quat(ours.worldFromModel[eyes[eye]].linear()).angularDistance(theirs);
      EXPECT_LT(angle, 1e-5) << name << ", eye " << eye;
      apart = std::max(apart, angle);
      const Affine3& head = ours.worldFromModel[file.lookAt.head];
      turned = std::max(turned, Quat(head.linear()).angularDistance(Quat(ours.worldFromModel[eyes[eye]].linear())));
    }
  }
  EXPECT_GT(turned, 0.3);
  std::printf("%zu gazes turn the eyes by up to %.2f rad: within %.2g rad\n", made.size() - 1, turned, apart);
}

// Hair as three-vrm moves it: the same springs, the same poses, the same steps of 1/60 s.

constexpr int kSecond = 60;  // steps
constexpr int kHeld = 300;   // steps in the last pose, in which everything comes to rest

/// Rotation of a joint relative to the world, in the rest pose.
Quat restRotation(const Skeleton& skeleton, JointIndex joint) {
  Quat world = Quat::Identity();
  for (; joint != kNoJoint; joint = skeleton.joint(joint).parent) world = skeleton.joint(joint).rest.rotation * world;
  return world;
}

/// A pose as the peer's frames give it: VRM's normalised rotations, and how far the hips moved.
json frameOf(const Skeleton& skeleton, const Pose& pose, double seconds) {
  json frame = {{"dt", seconds}};
  for (JointIndex j = 0; j < skeleton.jointCount(); ++j) {
    const Joint& joint = skeleton.joint(j);
    if (!joint.bone) continue;
    const Quat parent = restRotation(skeleton, joint.parent);
    const Quat q = parent * pose[j].rotation * joint.rest.rotation.conjugate() * parent.conjugate();
    frame["rotations"][nameOf(*joint.bone)] = {q.x(), q.y(), q.z(), q.w()};
  }
  std::vector<Affine3> now(pose.size());
  std::vector<Affine3> rest(pose.size());
  computeWorldFromJoint(skeleton, pose, now);
  computeWorldFromJoint(skeleton, restPose(skeleton), rest);
  const JointIndex hips = skeleton.jointOf(HumanBone::kHips);
  const Vec3 moved = now[hips].translation() - rest[hips].translation();
  frame["hips"] = {moved.x(), moved.y(), moved.z()};
  return frame;
}

JointIndex jointNamed(const Skeleton& skeleton, const std::string& name) {
  for (JointIndex j = 0; j < skeleton.jointCount(); ++j) {
    if (skeleton.joint(j).name == name) return j;
  }
  return kNoJoint;
}

TEST(PeerSprings, GodettesHairFollowsTheSamePaths) {
  LORICA_REQUIRE_DATASET(path, "characters/godette/Godette_vrm_v4.vrm");
  LORICA_REQUIRE_PEERS();
  const Result<CharacterFile> file = readCharacterFile(path);
  ASSERT_TRUE(file.ok()) << file.error().message;
  const Character& character = file.value().character;
  const Skeleton& skeleton = character.skeleton;
  const auto recording = readJointCsv(test::recordingsFolder() / "walk.csv").value();
  const SkeletalMotion walk = perform(character, recording).value();

  SpringSimulation springs = SpringSimulation::create(skeleton, file.value().springs).value();
  json shots = {{"picture", false}, {"vertices", false}};
  json& frames = shots["shots"]["walk"]["frames"] = json::array();
  std::vector<std::vector<Affine3>> ours;
  Pose pose(static_cast<std::size_t>(skeleton.jointCount()));
  double swing = 0.0;  // of the hair in the first second [rad]
  const int walked = static_cast<int>((walk.times.back() - walk.times.front()) / kSpringStepSeconds);
  for (int step = 0; step <= walked + kHeld; ++step) {
    poseAt(walk, walk.times.front() + std::min(step, walked) * kSpringStepSeconds, pose);
    frames.push_back(frameOf(skeleton, pose, step == 0 ? 0.0 : kSpringStepSeconds));
    springs.advance(pose, step == 0 ? 0.0 : kSpringStepSeconds);
    computeWorldFromJoint(skeleton, pose, ours.emplace_back(pose.size()));
    for (const SpringJoint& spring : springs.joints()) {
      if (step > kSecond) continue;
      swing = std::max(swing, pose[spring.joint].rotation.angularDistance(skeleton.joint(spring.joint).rest.rotation));
    }
  }

  const auto made = test::shootWithPeer(path, shots);
  ASSERT_EQ(made.size(), 1U);
  const json& theirs = made.at("walk").facts.at("frames");
  const json& names = made.at("walk").facts.at("nodeNames");
  ASSERT_EQ(theirs.size(), ours.size());
  double inFirstSecond = 0.0;
  double inWholeWalk = 0.0;
  double settled = 0.0;
  double body = 0.0;
  int compared = 0;
  for (std::size_t node = 0; node < names.size(); ++node) {
    const JointIndex joint = jointNamed(skeleton, names[node].get<std::string>());
    if (joint == kNoJoint) continue;
    const bool swings = std::any_of(springs.joints().begin(), springs.joints().end(),
                                    [&](const SpringJoint& spring) { return spring.joint == joint; });
    compared += swings ? 1 : 0;
    for (std::size_t f = 0; f < ours.size(); ++f) {
      const double apart = (ours[f][joint].translation() - test::vectorOf(theirs[f].at(node))).norm();
      if (!swings) body = std::max(body, apart);
      if (swings && f <= kSecond) inFirstSecond = std::max(inFirstSecond, apart);
      if (swings) inWholeWalk = std::max(inWholeWalk, apart);
      if (swings && f + 1 == ours.size()) settled = std::max(settled, apart);
    }
  }
  EXPECT_EQ(compared, 16);
  EXPECT_GT(swing, 0.05) << "the hair hardly swings";
  EXPECT_LT(body, 1e-4) << "the bodies differ";
  EXPECT_LT(inFirstSecond, 5e-3);
  EXPECT_LT(inWholeWalk, 5e-3);
  EXPECT_LT(settled, 5e-3);
  std::printf(
      "hair swings by up to %.2f rad; joints within %.2g mm over the first second, %.2g mm over the whole walk, "
      "%.2g mm settled; the body within %.2g mm\n",
      swing, 1e3 * inFirstSecond, 1e3 * inWholeWalk, 1e3 * settled, 1e3 * body);
}

// Bones and vertices where three.js has them: units, axes, bind pose, humanoid rotations and skinning agree.

class PeerPositions : public testing::TestWithParam<const char*> {};

/// Primitives that share their vertices, which the file has once and the peer repeats, are counted once.
std::vector<Vec3> withoutRepeats(const test::PeerShot& shot) {
  std::vector<Vec3> kept;
  std::size_t begin = 0;
  int node = -1, count = -1;
  for (const json& mesh : shot.facts.at("meshes")) {
    const bool repeated = mesh.at("node") == node && mesh.at("count") == count &&
                          std::equal(shot.vertices.begin() + begin, shot.vertices.begin() + begin + count,
                                     shot.vertices.begin() + begin - count);
    node = mesh.at("node");
    count = mesh.at("count");
    if (!repeated) {
      for (int i = 0; i < count; ++i) kept.emplace_back(shot.vertices.at(begin + i).cast<double>());
    }
    begin += count;
  }
  return kept;
}

TEST_P(PeerPositions, AgreeInEveryPose) {
  json shots = test::readShots(GetParam());
  LORICA_REQUIRE_DATASET(path, shots.at("character").get<std::string>());
  LORICA_REQUIRE_PEERS();
  const Result<CharacterFile> file = readCharacterFile(path);
  ASSERT_TRUE(file.ok()) << file.error().message;
  const Character& character = file.value().character;
  EXPECT_DOUBLE_EQ(file.value().metresPerUnit, shots.value("metresPerUnit", 1.0));
  for (auto it = shots["shots"].begin(); it != shots["shots"].end();) {
    it = it->contains("expressions") ? shots["shots"].erase(it) : std::next(it);
  }
  shots["picture"] = false;
  shots["vertices"] = true;

  for (const auto& [name, shot] : test::shootWithPeer(path, shots)) {
    const Pose pose = test::poseOf(character, shots["shots"][name]);
    const std::vector<Vec3> ours = test::posedVertices(character, pose);
    const std::vector<Vec3> theirs = withoutRepeats(shot);
    ASSERT_EQ(ours.size(), theirs.size()) << name;
    double farthest = 0.0;
    for (std::size_t i = 0; i < ours.size(); ++i) farthest = std::max(farthest, (ours[i] - theirs[i]).norm());
    std::vector<Affine3> worldFromJoint(pose.size());
    computeWorldFromJoint(character.skeleton, pose, worldFromJoint);
    double farthestJoint = 0.0;
    for (const auto& [bone, position] : shot.facts["joints"].items()) {
      const std::optional<HumanBone> known = humanBoneNamed(bone);
      if (!known) continue;  // eyes and jaw, which Lorica does not move
      const JointIndex j = character.skeleton.jointOf(*known);
      ASSERT_NE(j, kNoJoint) << bone;
      farthestJoint = std::max(farthestJoint, (worldFromJoint[j].translation() - test::vectorOf(position)).norm());
    }
    EXPECT_LT(farthest, 1e-5 * std::max(character.height, 1.0)) << name;  // the peer's vertices are floats
    EXPECT_LT(farthestJoint, 1e-5) << name;
    std::printf("%s %s: vertices within %.2g m, joints within %.2g m\n", GetParam(), name.c_str(), farthest,
                farthestJoint);
  }
}

INSTANTIATE_TEST_SUITE_P(, PeerPositions,
                         testing::Values("godette", "cesiumman", "fox", "greenman", "barbarian", "mage", "robot"),
                         [](const auto& each) { return std::string(each.param); });

}  // namespace
}  // namespace lorica

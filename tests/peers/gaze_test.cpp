// Eyes that look at something, as three-vrm turns them.
#include "skinning/linear_blend.h"
#include "skinning/morphs/look_at.h"
#include "tests/peers/avatar_poses.h"
#include "tests/peers/peer.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lorica {
namespace {

using nlohmann::json;

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
  const Result<CharacterFile> file = readCharacterFile(path);
  ASSERT_TRUE(file.ok()) << file.error().message;
  ASSERT_EQ(file->lookAt.kind, LookAtKind::kExpression);
  const json shots = gazeShots();
  double largest = 0.0;
  for (const auto& [name, shot] : test::shootWithPeer(path, shots)) {
    if (name == "rest") continue;
    const GazeWeights ours = gazeWeights(file->lookAt, lookingAt(*file, shots["shots"][name]).gaze);
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
  const Result<CharacterFile> file = readCharacterFile(edited);
  ASSERT_TRUE(file.ok()) << file.error().message;
  ASSERT_EQ(file->lookAt.kind, LookAtKind::kBone);
  const std::array<JointIndex, 2> eyes = {file->lookAt.leftEye, file->lookAt.rightEye};
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
    const Looking ours = lookingAt(*file, shots["shots"][name]);
    for (std::size_t eye = 0; eye < 2; ++eye) {
      const Quat theirs = rotationOf(name, eye) * rotationOf("rest", eye).conjugate();
      const double angle = Quat(ours.worldFromModel[eyes[eye]].linear()).angularDistance(theirs);
      EXPECT_LT(angle, 1e-5) << name << ", eye " << eye;
      apart = std::max(apart, angle);
      const Affine3& head = ours.worldFromModel[file->lookAt.head];
      turned = std::max(turned, Quat(head.linear()).angularDistance(Quat(ours.worldFromModel[eyes[eye]].linear())));
    }
  }
  EXPECT_GT(turned, 0.3);
  std::printf("%zu gazes turn the eyes by up to %.2f rad: within %.2g rad\n", made.size() - 1, turned, apart);
}

}  // namespace
}  // namespace lorica

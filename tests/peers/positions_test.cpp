// Bones and vertices where three.js has them: units, axes, bind pose, humanoid rotations and skinning agree.
#include "tests/peers/avatar_poses.h"
#include "tests/peers/peer.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

using nlohmann::json;

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

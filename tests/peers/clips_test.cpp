// Clips on somebody's character, as other programs for glTF have them.
#include "tests/peers/animated.h"
#include "tests/peers/peer.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class PeerClips : public testing::TestWithParam<test::Animated> {};

/// What gltf-validator calls errors, by code.
std::multiset<std::string> errorsOf(const json& issues) {
  std::multiset<std::string> codes;
  for (const json& issue : issues) {
    if (issue.at("severity") == 0) codes.insert(issue.at("code").get<std::string>());
  }
  return codes;
}

TEST_P(PeerClips, HaveNoFaultsThatTheCharacterDoesNotHave) {
  LORICA_REQUIRE_PEERS();
  if (!test::available(GetParam())) GTEST_SKIP() << GetParam().character << " is absent";
  const std::optional<test::Performance> performance = test::performanceOf(GetParam());
  ASSERT_TRUE(performance);
  const test::TemporaryFolder folder;
  fs::create_directory(folder.path() / "files");
  ASSERT_TRUE(test::writeGlb(folder.path() / "files" / "clip.glb", GetParam(), *performance).ok());
  const bool compared = performance->keepsFile();
  if (compared) fs::copy_file(test::dataset(GetParam().character), folder.path() / "files" / "hero.glb");
  const fs::path out = folder.path() / "report.json";
  ASSERT_TRUE(test::runPeer("validate.mjs", {(folder.path() / "files").string(), out.string()}));
  std::ifstream stream(out);
  const json report = json::parse(stream);
  EXPECT_EQ(errorsOf(report.at("clip.glb")), compared ? errorsOf(report.at("hero.glb")) : std::multiset<std::string>());
}

TEST_P(PeerClips, MoveEveryJointInThreeAsInLorica) {
  LORICA_REQUIRE_PEERS();
  if (!test::available(GetParam())) GTEST_SKIP() << GetParam().character << " is absent";
  const std::optional<test::Performance> performance = test::performanceOf(GetParam());
  ASSERT_TRUE(performance);
  const SkeletalMotion& motion = performance->motion;
  const test::TemporaryFolder folder;
  const fs::path clip = folder.path() / "clip.glb";
  ASSERT_TRUE(test::writeGlb(clip, GetParam(), *performance).ok());

  json shots = {{"picture", false}};
  shots["metresPerUnit"] = performance->keepsFile() ? performance->file->metresPerUnit : 1.0;
  std::map<std::string, int> frameOf;
  for (int i = 0; i < 4; ++i) {
    const int frame = i * (motion.frameCount() - 1) / 3;
    const std::string name = "frame" + std::to_string(i);
    frameOf[name] = frame;
    shots["shots"][name]["clip"] = motion.times[frame] - motion.times.front();
  }
  double farthest = 0.0;
  std::vector<Affine3> worldFromJoint(motion.skeleton.joints().size());
  const std::map<std::string, test::PeerShot> made = test::shootWithPeer(clip, shots);
  ASSERT_EQ(made.size(), frameOf.size());
  for (const auto& [name, shot] : made) {
    computeWorldFromJoint(motion.skeleton, motion.pose(frameOf[name]), worldFromJoint);
    for (JointIndex j = 0; j < motion.skeleton.jointCount(); ++j) {
      // Whole characters have a node for each joint, in this order, without the first of a file.
      const int node = performance->keepsFile() ? performance->file->nodeOfJoint[j] : j - (performance->file ? 1 : 0);
      if (node < 0) continue;
      const Vec3 there = test::vectorOf(shot.facts.at("nodes").at(static_cast<std::size_t>(node)));
      farthest = std::max(farthest, (worldFromJoint[j].translation() - there).norm());
    }
  }
  EXPECT_LT(farthest, 1e-5);  // three.js has floats
  std::printf("%s: joints within %.2g mm in three.js\n", GetParam().name, 1e3 * farthest);
}

INSTANTIATE_TEST_SUITE_P(, PeerClips, testing::ValuesIn(test::kAnimated),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace lorica

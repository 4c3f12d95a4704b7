#include "tests/peers/blender.h"
#include "capture/files/bvh_file.h"
#include "skinning/clip_files/own_motion.h"
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

// Clips on somebody's character, as Blender opens them: every joint is where Lorica has it.

constexpr double kTolerance = 1e-3;  // [m]

/// The distance from a joint to Blender's nearest of its name.
double distanceTo(const test::BlenderJoints& joints, const std::string& fullName, const Vec3& position) {
  const std::string name = fullName.substr(0, 63);
  double nearest = std::numeric_limits<double>::infinity();
  for (auto it = joints.lower_bound(name); it != joints.end() && it->first.starts_with(name); ++it) {
    const std::string_view rest = std::string_view(it->first).substr(name.size());
    const bool numbered =
        rest.size() == 4 && rest.front() == '.' && rest.find_first_not_of("0123456789", 1) == rest.npos;
    if (rest.empty() || numbered) nearest = std::min(nearest, (it->second - position).norm());
  }
  return nearest;
}

/// The farthest joint of any compared frame [m].
double farthestJoint(const SkeletalMotion& motion, const std::vector<int>& frames,
                     const std::vector<test::BlenderJoints>& blenders, double metresPerUnit) {
  double farthest = 0.0;
  std::vector<Affine3> worldFromJoint(motion.skeleton.joints().size());
  for (std::size_t f = 0; f < frames.size(); ++f) {
    computeWorldFromJoint(motion.skeleton, motion.pose(frames[f]), worldFromJoint);
    for (JointIndex j = 0; j < motion.skeleton.jointCount(); ++j) {
      const std::string& name = motion.skeleton.joint(j).name;
      const double distance = metresPerUnit * distanceTo(blenders[f], name, worldFromJoint[j].translation());
      EXPECT_LE(distance, kTolerance) << "frame " << frames[f] << ", joint " << name;
      farthest = std::max(farthest, distance);
    }
  }
  return farthest;
}

class Blender : public testing::TestWithParam<test::Animated> {};

TEST_P(Blender, HasEveryJointWhereLoricaHasIt) {
  if (const std::string missing = test::missingForBlender(); !missing.empty()) GTEST_SKIP() << missing;
  if (!test::available(GetParam())) GTEST_SKIP() << GetParam().character << " is absent";
  const std::optional<test::Performance> performance = test::performanceOf(GetParam());
  ASSERT_TRUE(performance);
  const SkeletalMotion& motion = performance->motion;
  const std::optional<CharacterFile>& file = performance->file;

  const test::TemporaryFolder folder;
  const fs::path glb = folder.path() / "clip.glb";
  const fs::path bvh = folder.path() / "clip.bvh";
  const SkeletalMotion inBvh = file ? withoutCopies(inMetres(*file, motion)) : motion;
  const SkeletalMotion inGlb = performance->keepsFile() ? inFileUnits(*file, motion).motion
                               : file                   ? inMetres(*file, motion).motion
                                                        : motion;
  ASSERT_TRUE(test::writeGlb(glb, GetParam(), *performance).ok());
  ASSERT_TRUE(writeBvh(bvh, inBvh).ok());

  std::vector<int> frames;
  std::vector<double> times, numbers;
  for (int i = 0; i < 6; ++i) {
    frames.push_back(i * (motion.frameCount() - 1) / 5);
    times.push_back(motion.times[frames.back()] - motion.times.front());
    numbers.push_back(frames.back());
  }
  const std::vector<std::vector<test::BlenderJoints>> opened = test::openWithBlender({{glb, times}, {bvh, numbers}});
  ASSERT_EQ(opened.size(), 2U);
  const double ofGlb = farthestJoint(inGlb, frames, opened[0], performance->keepsFile() ? file->metresPerUnit : 1.0);
  const double ofBvh = farthestJoint(inBvh, frames, opened[1], 1.0);
  std::printf("%s: %d joints within %.2g mm in the .glb, %.2g mm in the .bvh\n", GetParam().name,
              inBvh.skeleton.jointCount(), 1e3 * ofGlb, 1e3 * ofBvh);
}

INSTANTIATE_TEST_SUITE_P(, Blender, testing::ValuesIn(test::kAnimated),
                         [](const auto& each) { return std::string(each.param.name); });

// Clips on somebody's character, as other programs for glTF have them.

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

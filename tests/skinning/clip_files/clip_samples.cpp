#include "tests/skinning/clip_files/clip_samples.h"

#include "geometry/files.h"
#include "skinning/import/gltf_parts.h"
#include "skinning/linear_blend.h"
#include "tests/skinning/random_pose.h"

#include <gtest/gtest.h>

#include <map>

namespace lorica::test {

SkeletalMotion randomMotion(const CharacterFile& file, int frames, unsigned seed) {
  std::mt19937 random(seed);
  const Skeleton& skeleton = file.character.skeleton;
  SkeletalMotion motion{"random", skeleton, {}, {}};
  double time = 5.0;
  for (int f = 0; f < frames; ++f) {
    motion.times.push_back(time);
    time += uniform(random, 0.01, 0.05);
    Pose pose = restPose(skeleton);
    for (JointIndex j = 0; j < skeleton.jointCount(); ++j) {
      const Quat rotation = randomRotation(random);
      const Vec3 shift = randomVector(random, 0.5);
      if (file.nodeOfJoint[j] == -1) continue;
      pose[j].rotation = rotation;
      if (skeleton.joint(j).parent == 0) pose[j].translation += shift / file.metresPerUnit;
    }
    motion.poses.insert(motion.poses.end(), pose.begin(), pose.end());
  }
  return motion;
}

namespace {

std::vector<Vec3> verticesOf(const Character& character, const Pose& pose, std::vector<Affine3>& worldFromJoint) {
  worldFromJoint.resize(pose.size());
  computeWorldFromJoint(character.skeleton, pose, worldFromJoint);
  std::vector<Affine3> skinning(pose.size());
  for (std::size_t j = 0; j < pose.size(); ++j) skinning[j] = worldFromJoint[j] * character.jointFromModel[j];
  std::vector<Vec3> vertices;
  for (std::size_t v = 0; v < character.mesh.vertices.size(); ++v) {
    Vec3 sum = Vec3::Zero();
    for (std::uint32_t i = character.influenceBegin[v]; i < character.influenceBegin[v + 1]; ++i) {
      const Influence& influence = character.influences[i];
      sum += influence.weight * (skinning[influence.joint] * character.mesh.vertices[v]);
    }
    vertices.push_back(sum);
  }
  return vertices;
}

}  // namespace

double farthestFrom(const CharacterFile& read, const Character& character, const SkeletalMotion& motion) {
  EXPECT_FALSE(read.clips.empty());
  EXPECT_EQ(read.character.mesh.vertices.size(), character.mesh.vertices.size());
  if (testing::Test::HasFailure()) return std::numeric_limits<double>::infinity();
  double farthest = 0.0;
  std::vector<Affine3> here, there;
  for (int f = 0; f < motion.frameCount(); ++f) {
    const std::span<const JointTransform> pose = motion.pose(f);
    const std::vector<Vec3> expected = verticesOf(character, Pose(pose.begin(), pose.end()), here);
    Pose sampled = restPose(read.character.skeleton);
    sampleClip(read.clips.front(), static_cast<float>(motion.times[f] - motion.times.front()), sampled);
    const std::vector<Vec3> found = verticesOf(read.character, sampled, there);
    for (std::size_t v = 0; v < expected.size(); ++v) farthest = std::max(farthest, (expected[v] - found[v]).norm());
    std::multimap<std::string, Vec3> joints;
    for (JointIndex j = 0; j < read.character.skeleton.jointCount(); ++j) {
      joints.emplace(read.character.skeleton.joint(j).name, there[j].translation());
    }
    for (JointIndex j = 1; j < character.skeleton.jointCount(); ++j) {
      double nearest = std::numeric_limits<double>::infinity();
      const auto [begin, end] = joints.equal_range(character.skeleton.joint(j).name);
      for (auto it = begin; it != end; ++it) nearest = std::min(nearest, (it->second - here[j].translation()).norm());
      farthest = std::max(farthest, nearest);
    }
  }
  return farthest;
}

nlohmann::json documentOf(const std::filesystem::path& glb) {
  const std::string bytes = readFile(glb).value();
  const Result<GltfParts> parts = splitGltf(std::as_bytes(std::span(bytes)), glb.string());
  EXPECT_TRUE(parts.ok());
  return nlohmann::json::parse(parts->json);
}

}  // namespace lorica::test

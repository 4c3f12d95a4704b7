#include "tests/skinning/import/agreement.h"

#include "skinning/import/file_scene.h"
#include "skinning/linear_blend.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lorica::test {

std::vector<Vec3> posedVertices(const CharacterFile& file, int clip, double time) {
  const Character& character = file.character;
  Pose pose = restPose(character.skeleton);
  if (clip >= 0) sampleClip(file.clips[clip], time, pose);
  return posedVertices(file, pose);
}

std::vector<Vec3> posedVertices(const CharacterFile& file, const Pose& pose) {
  const Character& character = file.character;
  std::vector<Affine3> transforms(pose.size());
  computeWorldFromJoint(character.skeleton, pose, transforms);
  computeWorldFromModel(character, transforms, transforms);
  std::vector<Vec3> posed(character.mesh.vertices.size());
  skinLinearBlend(character, transforms, posed);
  return posed;
}

Pose savedPose(const CharacterFile& file, const nlohmann::json& nodes) {
  Pose pose = restPose(file.character.skeleton);
  for (std::size_t j = 0; j < pose.size(); ++j) {
    const int index = file.nodeOfJoint[j];
    const JointIndex parent = file.character.skeleton.joint(j).parent;
    const bool sheared = parent > 0 && file.nodeOfJoint[parent] == -1;
    if (index == -1) continue;
    const nlohmann::json& node = nodes[index];
    FileNode saved;
    const auto numbers = [&](const char* key, std::vector<double> otherwise) {
      return node.contains(key) ? node[key].get<std::vector<double>>() : otherwise;
    };
    if (node.contains("matrix")) {
      const std::vector<double> matrix = numbers("matrix", {});
      setMatrix(saved, Affine3(Eigen::Matrix<double, 3, 4>(Eigen::Map<const Mat4>(matrix.data()).topRows<3>())));
    } else {
      saved.local.translation = Eigen::Map<const Vec3>(numbers("translation", {0.0, 0.0, 0.0}).data());
      saved.local.scale = Eigen::Map<const Vec3>(numbers("scale", {1.0, 1.0, 1.0}).data());
      saved.local.rotation.coeffs() =
          Eigen::Map<const Eigen::Vector4d>(numbers("rotation", {0.0, 0.0, 0.0, 1.0}).data());
      saved.local.rotation.normalize();
    }
    pose[sheared ? parent : static_cast<JointIndex>(j)] = saved.local;
    if (!sheared) continue;
    pose[j] = {};
    pose[j].rotation = saved.inner.value_or(Quat::Identity());
  }
  return pose;
}

double farthestFromTruth(const CharacterFile& file, const GltfTruth& truth, int clip, double time) {
  const std::vector<GltfTruth::Corners> expected = truth.triangles(clip, time, !file.character.shapes.empty());
  const std::vector<Vec3> posed =
      clip >= 0 ? posedVertices(file, clip, time) : posedVertices(file, savedPose(file, truth.document()["nodes"]));
  const std::vector<Triangle>& triangles = file.character.mesh.triangles;
  EXPECT_EQ(triangles.size(), expected.size());
  if (triangles.size() != expected.size()) return 1e300;
  // VRM 0.x faces the other way.
  const double turn = file.format == "VRM 0.x" ? -1.0 : 1.0;
  const auto distance = [&](VertexIndex v, const Vec3& p) {
    const Vec3 metres = file.metresPerUnit * Vec3(turn * p.x(), p.y(), turn * p.z());
    return (posed[v] - metres).norm();
  };
  double farthest = 0.0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    const double straight = std::max(distance(b, expected[t][1]), distance(c, expected[t][2]));
    const double swapped = std::max(distance(c, expected[t][1]), distance(b, expected[t][2]));
    farthest = std::max({farthest, distance(a, expected[t][0]), std::min(straight, swapped)});
  }
  return farthest;
}

}  // namespace lorica::test

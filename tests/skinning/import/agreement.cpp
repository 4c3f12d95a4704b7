#include "tests/skinning/import/agreement.h"

#include "skinning/linear_blend.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lorica::test {

std::vector<Vec3> posedVertices(const CharacterFile& file, int clip, double time) {
  const Character& character = file.character;
  Pose pose = restPose(character.skeleton);
  if (clip >= 0) sampleClip(file.clips[clip], time, pose);
  std::vector<Affine3> transforms(pose.size());
  computeWorldFromJoint(character.skeleton, pose, transforms);
  computeWorldFromModel(character, transforms, transforms);
  std::vector<Vec3> posed(character.mesh.vertices.size());
  skinLinearBlend(character, transforms, posed);
  return posed;
}

double farthestFromTruth(const CharacterFile& file, const GltfTruth& truth, int clip, double time) {
  const std::vector<GltfTruth::Corners> expected = truth.triangles(clip, time);
  const std::vector<Vec3> posed = posedVertices(file, clip, time);
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

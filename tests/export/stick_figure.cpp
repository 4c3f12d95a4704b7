#include "tests/export/stick_figure.h"

#include "skinning/linear_blend.h"

#include <algorithm>

namespace lorica::test {
namespace {
constexpr int kRings = 21;

double upperWeightAt(double y) {
  return std::clamp((y - 0.8) / 0.4, 0.0, 1.0);
}

}  // namespace

Character stickFigure() {
  Character figure;
  figure.name = "stick";
  figure.height = 2.0;
  Joint lower{"lower", kNoJoint, {}, HumanBone::kHips};
  Joint upper{"upper", 0, {Vec3(0.0, 1.0, 0.0)}, HumanBone::kSpine};
  figure.skeleton = Skeleton::create({lower, upper}).value();
  figure.jointFromModel = {Affine3::Identity(), Affine3(Eigen::Translation3d(0.0, -1.0, 0.0))};
  figure.influenceBegin = {0};
  for (int ring = 0; ring < kRings; ++ring) {
    const double y = 0.1 * ring;
    for (const auto& [x, z] : {std::pair(-0.1, -0.1), {-0.1, 0.1}, {0.1, 0.1}, {0.1, -0.1}}) {
      figure.mesh.vertices.emplace_back(x, y, z);
      const double weight = upperWeightAt(y);
      if (weight < 1.0) figure.influences.push_back({0, 1.0 - weight});
      if (weight > 0.0) figure.influences.push_back({1, weight});
      figure.influenceBegin.push_back(static_cast<std::uint32_t>(figure.influences.size()));
    }
  }
  std::vector<Triangle>& triangles = figure.mesh.triangles;
  const auto quad = [&](int a, int b, int c, int d) {
    triangles.push_back({a, b, c});
    triangles.push_back({a, c, d});
  };
  for (int ring = 0; ring + 1 < kRings; ++ring) {
    for (int side = 0; side < 4; ++side) {
      const int a = 4 * ring + side;
      const int b = 4 * ring + (side + 1) % 4;
      quad(a, b, b + 4, a + 4);
    }
  }
  quad(0, 3, 2, 1);
  const int top = 4 * (kRings - 1);
  quad(top, top + 1, top + 2, top + 3);
  return figure;
}

Decomposition onePart(const Character& character) {
  Decomposition one;
  one.vertexCount = static_cast<int>(character.mesh.vertices.size());
  one.triangleCount = static_cast<int>(character.mesh.triangles.size());
  Part part;
  part.triangles = character.mesh.triangles;
  for (std::size_t t = 0; t < part.triangles.size(); ++t) part.sourceTriangle.push_back(static_cast<std::int32_t>(t));
  for (PointIndex p = 0; p < one.vertexCount; ++p) part.points.push_back(p);
  one.parts.push_back(std::move(part));
  return one;
}

std::vector<RigidCollider> collidersIn(const Character& character, const std::vector<double>& angles) {
  const std::vector<Affine3> poses = bentPoses(character, angles);
  return makeRigidColliders(character, onePart(character), {poses, 2}, {}).value();
}

std::vector<Affine3> bentPoses(const Character& character, const std::vector<double>& angles) {
  std::vector<Affine3> poses;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    Pose pose = restPose(character.skeleton);
    pose[0].translation = Vec3(0.3 * static_cast<double>(i), 0.1, -0.2);
    pose[0].rotation = Quat(Eigen::AngleAxisd(0.7 * static_cast<double>(i), Vec3::UnitY()));
    pose[1].rotation = Quat(Eigen::AngleAxisd(angles[i], Vec3::UnitX()));
    std::vector<Affine3> bones(pose.size());
    computeWorldFromJoint(character.skeleton, pose, bones);
    computeWorldFromModel(character, bones, bones);
    poses.insert(poses.end(), bones.begin(), bones.end());
  }
  return poses;
}

}  // namespace lorica::test

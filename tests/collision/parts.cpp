#include "tests/collision/parts.h"

#include "acd/decompose.h"
#include "acd/transfer.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/meshes.h"

#include <algorithm>

namespace lorica::test {

Dancer::Dancer() : character(makeMannequin()), worldFromModel(character.jointFromModel.size(), Affine3::Identity()) {
  const PoseView bindPose{character.mesh.vertices, static_cast<int>(character.mesh.vertices.size())};
  Result<Decomposition> made = decompose(character.mesh, bindPose, {.maxParts = 8});
  LORICA_CHECK(made.ok(), "cutting the mannequin must succeed");
  decomposition = std::move(made).value();
}

void Dancer::dance(std::mt19937_64& random, double max) {
  Pose pose = restPose(character.skeleton);
  for (JointTransform& joint : pose) {
    const Vec3 turn = uniformVec3(random, -1.0, 1.0);
    joint.rotation = Quat(Eigen::AngleAxisd(max * turn.norm(), turn.normalized())) * joint.rotation;
  }
  pose[0].translation += uniformVec3(random, -5.0, 5.0);
  computeWorldFromJoint(character.skeleton, pose, worldFromModel);
  computeWorldFromModel(character, worldFromModel, worldFromModel);
}

std::vector<Vec3> Dancer::points() const {
  std::vector<Vec3> all(static_cast<std::size_t>(decomposition.pointCount()));
  const auto posed = std::span(all).first(character.mesh.vertices.size());
  skinLinearBlend(character, worldFromModel, posed);
  transfer(decomposition, posed, all);
  return all;
}

void reshape(LivePart& part, std::span<const Vec3> corners) {
  std::swap(part.previousVertices, part.shape.vertices);
  part.shape = convexHull(corners);
  part.radius = 0.0;
  for (const Vec3& v : part.shape.vertices) part.radius = std::max(part.radius, v.norm());
  part.reshaped = true;
}

void reshapeToBox(LivePart& part, const Vec3& halfExtents) {
  reshape(part, makeBox(-halfExtents, halfExtents).vertices);
}

LivePart makeBoxPart(const Vec3& halfExtents, const Isometry3& worldFromPart) {
  LivePart part;
  part.worldFromPart = worldFromPart;
  part.previousWorldFromPart = worldFromPart;
  reshapeToBox(part, halfExtents);
  return part;
}

void moveTo(LivePart& part, const Isometry3& worldFromPart) {
  part.previousWorldFromPart = part.worldFromPart;
  part.worldFromPart = worldFromPart;
}

Isometry3 at(double x, double y, double z) {
  Isometry3 pose = Isometry3::Identity();
  pose.translation() = Vec3(x, y, z);
  return pose;
}

double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1.0p-53;
}

Vec3 uniformVec3(std::mt19937_64& random, double low, double high) {
  const double x = uniform(random, low, high);
  const double y = uniform(random, low, high);
  const double z = uniform(random, low, high);
  return {x, y, z};
}

Quat uniformRotation(std::mt19937_64& random) {
  while (true) {
    const Vec3 xyz = uniformVec3(random, -1.0, 1.0);
    const Eigen::Vector4d q(xyz.x(), xyz.y(), xyz.z(), uniform(random, -1.0, 1.0));
    if (q.norm() > 0.1 && q.norm() < 1.0) return Quat(q.normalized());
  }
}

}  // namespace lorica::test

#include "tests/collision/parts.h"

#include "tests/support/meshes.h"

#include <algorithm>

namespace lorica::test {

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

#include "tests/collision/parts.h"

#include "tests/support/meshes.h"

namespace lorica::test {

void reshape(LivePart& part, std::span<const Vec3> corners) {
  std::vector<Vec3> world(corners.begin(), corners.end());
  for (Vec3& p : world) p = part.worldFromPart * p;
  part.hull = convexHull(world);
  part.residual.resize(part.hull.vertices.size());
  const Isometry3 partFromWorld = part.worldFromPart.inverse();
  for (std::size_t v = 0; v < part.residual.size(); ++v) part.residual[v] = partFromWorld * part.hull.vertices[v];
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
  for (std::size_t v = 0; v < part.residual.size(); ++v) part.hull.vertices[v] = worldFromPart * part.residual[v];
}

Isometry3 at(double x, double y, double z) {
  Isometry3 place = Isometry3::Identity();
  place.translation() = Vec3(x, y, z);
  return place;
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

#include "collision/world/prop.h"

#include "geometry/result.h"

#include <utility>

namespace lorica {

double boundingRadius(const Prop& prop) {
  switch (prop.shape) {
    case PropShape::kBox:
    case PropShape::kMesh:
      break;
    case PropShape::kSphere:
      return prop.halfExtents.x();
    case PropShape::kCapsule:
      return prop.halfExtents.y();
    case PropShape::kCylinder:
      return prop.halfExtents.head<2>().norm();
  }
  return prop.halfExtents.norm();
}

Prop meshProp(std::shared_ptr<const PropMeshShape> mesh) {
  LORICA_CHECK(mesh != nullptr && !mesh->hulls.empty(), "a mesh prop needs hulls");
  Vec3 half = Vec3::Zero();
  for (const ConvexHull& hull : mesh->hulls) {
    for (const Vec3& v : hull.vertices) half = half.cwiseMax(v.cwiseAbs());
  }
  Prop prop;
  prop.shape = PropShape::kMesh;
  prop.halfExtents = half;
  prop.mesh = std::move(mesh);
  return prop;
}

}  // namespace lorica

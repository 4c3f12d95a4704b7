#include "viewer/prop_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lorica {

PropMesh makeBevelledBox() {
  PropMesh mesh;
  // Each face is a grid of 4 x 4 vertices; the middle four have the face's normal, the rim is shared bevel:
  //   normals along one side: 45 degrees outward, straight, straight, 45 degrees outward
  constexpr std::array<float, 4> kTilt = {-1, 0, 0, 1};
  constexpr std::array<float, 4> kCorner = {-1, -1, 1, 1};
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
      const int u = (axis + 1) % 3;
      const int v = (axis + 2) % 3;
      for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
          PropMesh::Vertex vertex;
          vertex.corner[axis] = side;
          vertex.corner[u] = kCorner[i];
          vertex.corner[v] = kCorner[j];
          vertex.normal[axis] = side;
          vertex.normal[u] = kTilt[i];
          vertex.normal[v] = kTilt[j];
          vertex.normal.normalize();
          mesh.vertices.push_back(vertex);
        }
      }
      for (std::uint32_t i = 0; i < 3; ++i) {
        for (std::uint32_t j = 0; j < 3; ++j) {
          const std::uint32_t a = base + i * 4 + j, b = a + 4, c = b + 1, d = a + 1;
          if (side > 0) {
            mesh.indices.insert(mesh.indices.end(), {a, b, c, a, c, d});
          } else {
            mesh.indices.insert(mesh.indices.end(), {a, c, b, a, d, c});
          }
        }
      }
    }
  }
  return mesh;
}

PropMesh makePropSphere() {
  constexpr std::uint32_t kRings = 14, kSegments = 24;
  PropMesh mesh;
  for (std::uint32_t i = 0; i <= kRings; ++i) {
    const double theta = std::numbers::pi * i / kRings;
    for (std::uint32_t j = 0; j < kSegments; ++j) {
      const double phi = 2.0 * std::numbers::pi * j / kSegments;
      mesh.vertices.push_back(
          {Vec3f::Zero(),
           Vec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)).cast<float>()});
    }
  }
  for (std::uint32_t i = 0; i < kRings; ++i) {
    for (std::uint32_t j = 0; j < kSegments; ++j) {
      const std::uint32_t a = i * kSegments + j, b = i * kSegments + (j + 1) % kSegments;
      const std::uint32_t c = a + kSegments, d = b + kSegments;
      if (i > 0) mesh.indices.insert(mesh.indices.end(), {a, b, d});
      if (i + 1 < kRings) mesh.indices.insert(mesh.indices.end(), {a, d, c});
    }
  }
  return mesh;
}

void makePropInstances(std::span<const Prop> props, PropShape shape, std::vector<PropInstance>& instances) {
  instances.clear();
  for (const Prop& prop : props) {
    if (prop.shape != shape || !prop.worldFromProp.matrix().allFinite() || !prop.halfExtents.allFinite()) continue;
    PropInstance instance;
    const Eigen::Matrix4f m = prop.worldFromProp.matrix().cast<float>();
    instance.x = m.col(0).head<3>();
    instance.y = m.col(1).head<3>();
    instance.z = m.col(2).head<3>();
    instance.origin = m.col(3).head<3>();
    instance.color = prop.color;
    if (shape == PropShape::kBox) {
      instance.bevel = static_cast<float>(std::min(0.12 * prop.halfExtents.minCoeff(), 0.015));
      instance.extents = prop.halfExtents.cast<float>().array() - instance.bevel;
    } else {
      instance.bevel = static_cast<float>(prop.halfExtents.x());
      instance.extents = Vec3f::Zero();
    }
    instances.push_back(instance);
  }
}

}  // namespace lorica

#include "viewer/renderer/prop_mesh.h"

#include "viewer/renderer/picture_area.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace lorica {
namespace {

constexpr double kCreaseCosine = 0.766;  // of 40 degrees

PropMesh makeBevelledBox() {
  PropMesh mesh;
  // Each face is a grid of 4 x 4 vertices; the middle four have the face's normal, the others form the bevel:
  //   normals along one side: 45 degrees outward, straight, straight, 45 degrees outward
  constexpr std::array<float, 4> kTilt = {-1, 0, 0, 1};
  constexpr std::array<float, 4> kCorner = {-1, -1, 1, 1};
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      const std::uint32_t base = mesh.vertices.size();
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

constexpr std::uint32_t kSegments = 24;

/// Connects rings of kSegments vertices each, from top to bottom.
void joinRings(PropMesh& mesh, std::uint32_t ringCount) {
  for (std::uint32_t i = 0; i + 1 < ringCount; ++i) {
    for (std::uint32_t j = 0; j < kSegments; ++j) {
      const std::uint32_t a = i * kSegments + j, b = i * kSegments + (j + 1) % kSegments;
      const std::uint32_t c = a + kSegments, d = b + kSegments;
      if (i > 0) mesh.indices.insert(mesh.indices.end(), {a, b, d});
      if (i + 2 < ringCount) mesh.indices.insert(mesh.indices.end(), {a, d, c});
    }
  }
}

Vec3f around(std::uint32_t segment, double sine, double cosine) {
  const double phi = 2.0 * std::numbers::pi * segment / kSegments;
  return Vec3(sine * std::cos(phi), cosine, sine * std::sin(phi)).cast<float>();
}

constexpr int kHalfSphere = 7;  // steps from a pole to the equator

/// Rings from one latitude to another, counted from the upper pole. @param y  coordinate of the corners [half extents]
void addRings(PropMesh& mesh, int from, int to, float y) {
  for (int i = from; i <= to; ++i) {
    const double theta = 0.5 * std::numbers::pi * i / kHalfSphere;
    for (std::uint32_t j = 0; j < kSegments; ++j) {
      mesh.vertices.push_back({Vec3f(0.0f, y, 0.0f), around(j, std::sin(theta), std::cos(theta))});
    }
  }
}

PropMesh makePropSphere() {
  PropMesh mesh;
  addRings(mesh, 0, 2 * kHalfSphere, 0.0f);
  joinRings(mesh, 2 * kHalfSphere + 1);
  return mesh;
}

PropMesh makePropCapsule() {
  PropMesh mesh;
  addRings(mesh, 0, kHalfSphere, 1.0f);
  addRings(mesh, kHalfSphere, 2 * kHalfSphere, -1.0f);
  joinRings(mesh, 2 * kHalfSphere + 2);
  return mesh;
}

PropMesh makePropCylinder() {
  struct Ring {
    double radius, height;  // of the corner, in half extents
    double tilt;            // of the normal: 0 up, pi / 2 outwards, pi down
  };
  // Centres and rims of the lids, then the bevels, then the sides.
  constexpr double kQuarter = 0.25 * std::numbers::pi;
  constexpr std::array<Ring, 8> kRings = {{{0.0, 1.0, 0.0},
                                           {1.0, 1.0, 0.0},
                                           {1.0, 1.0, kQuarter},
                                           {1.0, 1.0, 2.0 * kQuarter},
                                           {1.0, -1.0, 2.0 * kQuarter},
                                           {1.0, -1.0, 3.0 * kQuarter},
                                           {1.0, -1.0, 4.0 * kQuarter},
                                           {0.0, -1.0, 4.0 * kQuarter}}};
  PropMesh mesh;
  for (const Ring& ring : kRings) {
    for (std::uint32_t j = 0; j < kSegments; ++j) {
      mesh.vertices.push_back(
          {around(j, ring.radius, ring.height), around(j, std::sin(ring.tilt), std::cos(ring.tilt))});
    }
  }
  joinRings(mesh, kRings.size());
  return mesh;
}

}  // namespace

PropMesh makePropMesh(PropShape shape) {
  switch (shape) {
    case PropShape::kBox:
      return makeBevelledBox();
    case PropShape::kSphere:
      return makePropSphere();
    case PropShape::kCapsule:
      return makePropCapsule();
    case PropShape::kCylinder:
      return makePropCylinder();
    case PropShape::kMesh:
      break;  // each has its own mesh
  }
  return {};
}

float UnhiddenView::opacityOf(const Prop& prop) const {
  constexpr float kThin = 0.2f;
  if (!subject) return 1.0f;
  const double radius = boundingRadius(prop);
  const Vec3 size = subject->max - subject->min, from = prop.worldFromProp.translation() - eye;
  const auto [forward, right, up] = axesOf(Camera{eye, subject->center()});
  const double far = (subject->center() - eye).norm(), depth = from.dot(forward);
  // What is larger than the subject is not in front of it but around it.
  if (radius > size.norm() || depth <= 0.0 || depth >= far) return 1.0f;
  const double share = depth / far;
  const bool beside = std::abs(from.dot(right)) > 0.5 * share * std::hypot(size.x(), size.z()) + radius ||
                      std::abs(from.dot(up)) > 0.5 * share * size.norm() + radius;
  return beside ? 1.0f : kThin;
}

void makePropInstances(std::span<const Prop> props, PropShape shape, std::vector<PropInstance>& instances,
                       const UnhiddenView& view) {
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
    instance.opacity = view.opacityOf(prop);
    Vec3 half = prop.halfExtents;
    if (shape == PropShape::kCylinder) half.z() = half.x();
    instance.bevel = std::min(0.12 * half.minCoeff(), 0.015);
    if (shape == PropShape::kSphere || shape == PropShape::kCapsule) instance.bevel = half.x();
    if (shape == PropShape::kSphere) half = Vec3::Constant(half.x());
    if (shape == PropShape::kCapsule) half = Vec3(half.x(), half.y(), half.x());
    instance.extents = (half.cast<float>().array() - instance.bevel).max(0.0f);
    instances.push_back(instance);
  }
}

PropMesh makeCreasedMesh(const TriMesh& mesh) {
  // The normal of each triangle, with a length of twice its area, and the triangles around each vertex in one list.
  std::vector<Vec3> area(mesh.triangles.size());
  std::vector<Vec3> unit(mesh.triangles.size());
  std::vector<std::size_t> begin(mesh.vertices.size() + 1, 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    area[t] = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
    unit[t] = area[t].stableNormalized();
    for (const VertexIndex v : mesh.triangles[t]) ++begin[static_cast<std::size_t>(v) + 1];
  }
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) begin[v + 1] += begin[v];
  std::vector<std::size_t> around(begin.back());
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const VertexIndex v : mesh.triangles[t]) around[next[v]++] = t;
  }

  PropMesh drawn;
  drawn.vertices.reserve(3 * mesh.triangles.size());
  drawn.indices.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!area[t].allFinite()) continue;
    for (const VertexIndex v : mesh.triangles[t]) {
      Vec3 normal = Vec3::Zero();
      for (std::size_t k = begin[v]; k < begin[static_cast<std::size_t>(v) + 1]; ++k) {
        if (unit[around[k]].dot(unit[t]) >= kCreaseCosine) normal += area[around[k]];
      }
      drawn.indices.push_back(drawn.vertices.size());
      drawn.vertices.push_back({mesh.vertices[v].cast<float>(), normal.stableNormalized().cast<float>()});
    }
  }
  return drawn;
}

}  // namespace lorica

#include "tests/support/meshes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace lorica::test {

TriMesh makeVoxelSurface(const std::set<Voxel>& voxels) {
  TriMesh mesh;
  std::map<Voxel, VertexIndex> vertexAt;
  const auto vertex = [&](const Voxel& corner) {
    const auto [entry, isNew] = vertexAt.try_emplace(corner, static_cast<VertexIndex>(mesh.vertices.size()));
    if (isNew) mesh.vertices.emplace_back(corner[0], corner[1], corner[2]);
    return entry->second;
  };
  for (const Voxel& cube : voxels) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const int side : {0, 1}) {
        Voxel beyond = cube;
        beyond[axis] += side == 0 ? -1 : 1;
        if (voxels.contains(beyond)) continue;
        // Counter-clockwise seen along the negative axis; reversed on the lower side.
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        std::array<VertexIndex, 4> quad{};
        const std::array<std::array<int, 2>, 4> around = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
        for (std::size_t i = 0; i < 4; ++i) {
          Voxel corner = cube;
          corner[axis] += side;
          corner[u] += around[i][0];
          corner[v] += around[i][1];
          quad[side == 1 ? i : 3 - i] = vertex(corner);
        }
        mesh.triangles.push_back({quad[0], quad[1], quad[2]});
        mesh.triangles.push_back({quad[0], quad[2], quad[3]});
      }
    }
  }
  return mesh;
}

TriMesh makeBox(const Vec3& min, const Vec3& max) {
  TriMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back((i & 1) ? max.x() : min.x(), (i & 2) ? max.y() : min.y(), (i & 4) ? max.z() : min.z());
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

TriMesh makeTetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

TriMesh makeLShape() {
  //  5---4
  //  |   |        the profile in xy, counter-clockwise; extruded from z = 0 to z = 1
  //  |   3---2    vertex 3 = (1, 1) is the concave corner
  //  |       |
  //  0-------1
  const std::array<std::array<double, 2>, 6> profile = {{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}};
  TriMesh mesh;
  for (double z : {0.0, 1.0}) {
    for (const auto& p : profile) mesh.vertices.emplace_back(p[0], p[1], z);
  }
  const std::array<Triangle, 4> cap = {{{0, 1, 3}, {1, 2, 3}, {0, 3, 5}, {3, 4, 5}}};
  for (const Triangle& t : cap) {
    mesh.triangles.push_back({t[0], t[2], t[1]});
    mesh.triangles.push_back({t[0] + 6, t[1] + 6, t[2] + 6});
  }
  for (int i = 0; i < 6; ++i) {
    const int j = (i + 1) % 6;
    mesh.triangles.push_back({i, j, j + 6});
    mesh.triangles.push_back({i, j + 6, i + 6});
  }
  return mesh;
}

TriMesh makeTorus(double majorRadius, double minorRadius, int majorSegments, int minorSegments) {
  TriMesh mesh;
  for (int i = 0; i < majorSegments; ++i) {
    const double u = 2.0 * std::numbers::pi * i / majorSegments;
    for (int j = 0; j < minorSegments; ++j) {
      const double v = 2.0 * std::numbers::pi * j / minorSegments;
      const double r = majorRadius + minorRadius * std::cos(v);
      mesh.vertices.emplace_back(r * std::cos(u), minorRadius * std::sin(v), r * std::sin(u));
    }
  }
  const auto at = [&](int i, int j) { return (i % majorSegments) * minorSegments + j % minorSegments; };
  for (int i = 0; i < majorSegments; ++i) {
    for (int j = 0; j < minorSegments; ++j) {
      mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
    }
  }
  return mesh;
}

TriMesh makeSphere(double radius, int rings, int segments) {
  TriMesh mesh;
  mesh.vertices.emplace_back(0, radius, 0);
  for (int i = 1; i < rings; ++i) {
    const double theta = std::numbers::pi * i / rings;
    for (int j = 0; j < segments; ++j) {
      const double phi = 2.0 * std::numbers::pi * j / segments;
      mesh.vertices.emplace_back(radius * std::sin(theta) * std::cos(phi), radius * std::cos(theta),
                                 radius * std::sin(theta) * std::sin(phi));
    }
  }
  mesh.vertices.emplace_back(0, -radius, 0);
  const int south = static_cast<int>(mesh.vertices.size()) - 1;
  const auto at = [&](int ring, int j) { return 1 + (ring - 1) * segments + j % segments; };
  for (int j = 0; j < segments; ++j) {
    mesh.triangles.push_back({0, at(1, j + 1), at(1, j)});
    mesh.triangles.push_back({south, at(rings - 1, j), at(rings - 1, j + 1)});
    for (int i = 1; i + 1 < rings; ++i) {
      mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
    }
  }
  return mesh;
}

TriMesh makeHollowBox() {
  return joined(makeBox({0, 0, 0}, {3, 3, 3}), insideOut(makeBox({1, 1, 1}, {2, 2, 2})));
}

TriMesh insideOut(TriMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

TriMesh shifted(TriMesh mesh, const Vec3& by) {
  for (Vec3& v : mesh.vertices) v += by;
  return mesh;
}

TriMesh divided(TriMesh mesh, int times) {
  for (; times > 0; --times) {
    std::map<std::pair<VertexIndex, VertexIndex>, VertexIndex> middles;
    const auto middle = [&](VertexIndex a, VertexIndex b) {
      const auto [entry, isNew] =
          middles.try_emplace(std::minmax(a, b), static_cast<VertexIndex>(mesh.vertices.size()));
      if (isNew) mesh.vertices.emplace_back(0.5 * (mesh.vertices[a] + mesh.vertices[b]));
      return entry->second;
    };
    std::vector<Triangle> quarters;
    for (const auto& [a, b, c] : mesh.triangles) {
      const VertexIndex ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      quarters.insert(quarters.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(quarters);
  }
  return mesh;
}

TriMesh joined(const TriMesh& a, const TriMesh& b) {
  TriMesh mesh = a;
  const auto shift = static_cast<VertexIndex>(a.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const Triangle& t : b.triangles) mesh.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  return mesh;
}

}  // namespace lorica::test

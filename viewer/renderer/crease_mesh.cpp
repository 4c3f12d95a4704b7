#include "viewer/renderer/crease_mesh.h"

#include <cstddef>

namespace lorica {
namespace {

constexpr double kCreaseCosine = 0.766;  // of 40 degrees

const Vec3& at(const TriMesh& mesh, VertexIndex i) {
  return mesh.vertices[i];
}

}  // namespace

PropMesh makeCreasedMesh(const TriMesh& mesh) {
  // The normal of each triangle, with a length of twice its area, and the triangles around each vertex in one list.
  std::vector<Vec3> area(mesh.triangles.size());
  std::vector<Vec3> unit(mesh.triangles.size());
  std::vector<std::size_t> begin(mesh.vertices.size() + 1, 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    area[t] = (at(mesh, b) - at(mesh, a)).cross(at(mesh, c) - at(mesh, a));
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
      drawn.vertices.push_back({at(mesh, v).cast<float>(), normal.stableNormalized().cast<float>()});
    }
  }
  return drawn;
}

}  // namespace lorica

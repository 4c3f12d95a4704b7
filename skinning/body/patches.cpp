#include "skinning/body/patches.h"

#include "geometry/mesh_pieces.h"

#include <cmath>
#include <numbers>

namespace lorica {
namespace {

// An open patch is inside out if it bulges inward by more than this fraction of the volume of a ball of equal area.
constexpr double kPlain = 0.05;

double areaOf(const TriMesh& mesh, const Triangle& t) {
  const Vec3& a = mesh.vertices[t[0]];
  return 0.5 * (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm();
}

}  // namespace

Patches orientPatches(TriMesh& mesh) {
  const MeshPieces pieces = findPieces(mesh);
  const std::vector<std::vector<std::int32_t>>& members = pieces.members;
  Patches result;
  result.openEdges = pieces.openEdges;
  result.nonManifoldEdges = pieces.nonManifoldEdges;
  result.patchOfTriangle = pieces.pieceOfTriangle;
  result.turnedTriangles = pieces.turned;
  for (std::size_t p = 0; p < members.size(); ++p) {
    Patch& patch = result.patches.emplace_back();
    for (const std::int32_t t : members[p]) patch.area += areaOf(mesh, mesh.triangles[t]);
    patch.open = pieces.open[p];
  }
  mesh.triangles = pieces.triangles;

  for (std::size_t p = 0; p < result.patches.size(); ++p) {
    const Patch& patch = result.patches[p];
    Vec3 center = Vec3::Zero();
    for (const std::int32_t t : members[p]) {
      const Triangle& corners = mesh.triangles[t];
      const double share = patch.area > 0.0 ? areaOf(mesh, corners) / (3.0 * patch.area) : 0.0;
      for (const VertexIndex v : corners) center += share * mesh.vertices[v];
    }
    double volume = 0.0;
    for (const std::int32_t t : members[p]) {
      const Triangle& c = mesh.triangles[t];
      const Vec3 a = mesh.vertices[c[0]] - center;
      const Vec3 b = mesh.vertices[c[1]] - center;
      volume += a.dot(b.cross(mesh.vertices[c[2]] - center)) / 6.0;
    }
    const double ball = patch.area * std::sqrt(patch.area) / (6.0 * std::sqrt(std::numbers::pi));
    if (volume >= (patch.open ? -kPlain * ball : 0.0)) continue;
    ++result.turnedPatches;
    for (const std::int32_t t : members[p]) {
      std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    }
  }
  return result;
}

}  // namespace lorica

#include "skinning/body/patches.h"

#include "geometry/edge_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lorica {
namespace {

// An open patch is inside out if it bulges inward by more than this fraction of the volume of a ball of equal area.
constexpr double kPlain = 0.05;

struct Neighbour {
  std::int32_t triangle = 0;
  bool agrees = true;  ///< traverses the shared edge in the opposite direction, as it should
};

struct Edges {
  std::vector<std::vector<Neighbour>> neighbours;  ///< of each triangle
  std::vector<std::int32_t> open;                  ///< the triangle of each edge with only one
  std::size_t nonManifold = 0;
};

Edges edgesOf(const TriMesh& mesh) {
  Edges edges;
  edges.neighbours.resize(mesh.triangles.size());
  EdgeTable(mesh.vertices.size(), mesh.triangles).forEachEdge([&](VertexIndex, std::span<const Side> sides) {
    if (sides.size() == 1) {
      edges.open.push_back(sides[0].triangle);
    } else if (sides.size() == 2) {
      const bool agrees = sides[0].ascending != sides[1].ascending;
      edges.neighbours[sides[0].triangle].push_back({sides[1].triangle, agrees});
      edges.neighbours[sides[1].triangle].push_back({sides[0].triangle, agrees});
    } else {
      ++edges.nonManifold;
    }
  });
  return edges;
}

double areaOf(const TriMesh& mesh, const Triangle& t) {
  const Vec3& a = mesh.vertices[t[0]];
  return 0.5 * (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm();
}

}  // namespace

Patches orientPatches(TriMesh& mesh) {
  const Edges edges = edgesOf(mesh);
  Patches result;
  result.openEdges = edges.open.size();
  result.nonManifoldEdges = edges.nonManifold;
  result.patchOfTriangle.assign(mesh.triangles.size(), -1);

  // Traverse each patch from its first triangle; its orientation is that of most of its area.
  std::vector<bool> turned(mesh.triangles.size(), false);
  std::vector<std::vector<std::int32_t>> members;
  for (std::size_t start = 0; start < mesh.triangles.size(); ++start) {
    if (result.patchOfTriangle[start] >= 0) continue;
    const auto number = static_cast<std::int32_t>(members.size());
    std::vector<std::int32_t> walk{static_cast<std::int32_t>(start)};
    result.patchOfTriangle[start] = number;
    Patch patch;
    double turnedArea = 0.0;
    for (std::size_t next = 0; next < walk.size(); ++next) {
      const auto t = static_cast<std::size_t>(walk[next]);
      const double area = areaOf(mesh, mesh.triangles[t]);
      patch.area += area;
      if (turned[t]) turnedArea += area;
      for (const Neighbour& n : edges.neighbours[t]) {
        const auto other = static_cast<std::size_t>(n.triangle);
        if (result.patchOfTriangle[other] >= 0) continue;
        result.patchOfTriangle[other] = number;
        turned[other] = turned[t] != !n.agrees;
        walk.push_back(n.triangle);
      }
    }
    const bool other = turnedArea > 0.5 * patch.area;
    for (const std::int32_t t : walk) {
      turned[t] = turned[t] != other;
      if (!turned[t]) continue;
      ++result.turnedTriangles;
      std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    }
    result.patches.push_back(patch);
    members.push_back(std::move(walk));
  }
  for (const std::int32_t t : edges.open) {
    result.patches[result.patchOfTriangle[static_cast<std::size_t>(t)]].open = true;
  }

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

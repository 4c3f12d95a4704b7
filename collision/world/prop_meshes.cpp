#include "collision/world/prop_meshes.h"

#include "acd/decompose.h"
#include "acd/transfer.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/mass_properties.h"
#include "geometry/mesh_files.h"
#include "geometry/mesh_repair.h"
#include "geometry/work_budgets.h"

#include <utility>

namespace lorica {
namespace {

/// The mesh in metres, with the centre of its bounds at the origin; unused vertices are dropped.
Result<TriMesh> inMetres(const TriMesh& mesh, const PropMeshRequest& request) {
  const std::string name = request.file.string();
  if (mesh.triangles.empty()) return badMesh("{}: found no triangles, expected one or more", name);
  const Aabb bounds = surfaceBounds(mesh);
  const Vec3 extent = bounds.max - bounds.min;
  Vec3 scale = Vec3::Constant(request.scale);
  if (!request.size.isZero()) scale = request.size.cwiseQuotient(extent);
  const Vec3 size = scale.cwiseProduct(extent);
  if (!(size.allFinite() && size.minCoeff() >= 0.999 * kSmallestProp && size.maxCoeff() <= 1.001 * kLargestProp)) {
    return badMesh(
        "{}: {:.4g} x {:.4g} x {:.4g} units become {:.4g} x {:.4g} x {:.4g} m, expected sides from {:g} to {:g} m",
        name, extent.x(), extent.y(), extent.z(), size.x(), size.y(), size.z(), kSmallestProp, kLargestProp);
  }
  TriMesh result;
  std::vector<VertexIndex> newIndex(mesh.vertices.size(), -1);
  result.triangles.reserve(mesh.triangles.size());
  for (const Triangle& triangle : mesh.triangles) {
    Triangle& t = result.triangles.emplace_back(triangle);
    for (VertexIndex& v : t) {
      VertexIndex& index = newIndex[v];
      if (index < 0) {
        index = result.vertices.size();
        const Vec3& position = mesh.vertices[v];
        result.vertices.emplace_back((position - bounds.center()).cwiseProduct(scale));
      }
      v = index;
    }
  }
  return result;
}

}  // namespace

Result<Decomposition> decomposePropMesh(const std::string& name, const TriMesh& mesh, int parts) {
  DecomposeSettings settings;
  settings.maxParts = parts;
  settings.rigid = true;
  return prefixed(name, decompose(mesh, {mesh.vertices, countOf(mesh.vertices)}, settings));
}

Result<std::shared_ptr<const PropMeshShape>> readPropMesh(const PropMeshRequest& request,
                                                          const MeshDecomposer& decomposer) {
  const std::string name = request.file.string();
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(request.file, error);
  if (request.limited && !error && bytes > kMaxPropMeshBytes) {
    return badMesh("{}: {} bytes, expected at most {}", name, bytes, kMaxPropMeshBytes);
  }
  LORICA_TRY(const TriMesh read, readMesh(request.file, NamedBy::kFile));
  if (request.limited && read.vertices.size() > kMaxPropVertices) {
    return badMesh("{}: {} vertices, expected at most {}", name, read.vertices.size(), kMaxPropVertices);
  }
  LORICA_TRY(TriMesh mesh, inMetres(read, request));

  auto shape = std::make_shared<PropMeshShape>();
  if (request.parts == 1) {
    ConvexHull hull = convexHull(mesh.vertices);
    if (hull.degenerate()) return badMesh("{}: the mesh is flat, expected one with a volume", name);
    shape->solid = massProperties(hull.vertices, hull.triangles);
    shape->hulls.push_back(std::move(hull));
    shape->shown = std::move(mesh);
    return std::shared_ptr<const PropMeshShape>(std::move(shape));
  }
  if (!checkClosedTwoManifold(mesh)) {
    Result<MeshRepair> repaired = repairClosedMesh(mesh);
    if (!repaired) {
      return badMesh("{}: {}; use \"parts\": 1 to get the convex hull of any mesh", name, repaired.error().message);
    }
    mesh = std::move(repaired->mesh);
  }
  LORICA_TRY(const Decomposition parts, decomposer(request.file.filename().string(), mesh, request.parts));
  std::vector<Vec3> points(parts.pointCount());
  transfer(parts, mesh.vertices, points);
  for (ConvexHull& hull : partHulls(parts, points)) {
    if (!hull.degenerate()) shape->hulls.push_back(std::move(hull));
  }
  if (shape->hulls.empty()) return badMesh("{}: all parts are flat, expected a mesh with a volume", name);
  shape->solid = massProperties(mesh.vertices, mesh.triangles);
  shape->shown = std::move(mesh);
  return std::shared_ptr<const PropMeshShape>(std::move(shape));
}

}  // namespace lorica

#include "skinning/body/mesh_body.h"

#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/mesh_repair.h"
#include "skinning/body/level_set.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

namespace lorica {
namespace {

constexpr double kRounding = 1e-12;  // of the longest side
constexpr double kFlat = 1e-9;       // of the longest side

/// The mesh as a character with one joint, which moves all of it.
Result<Character> rigidCharacter(TriMesh mesh) {
  LORICA_TRY(Skeleton skeleton, Skeleton::create({{"mesh", kNoJoint, {}, std::nullopt}}));
  Character character;
  character.name = "mesh";
  character.skeleton = std::move(skeleton);
  character.jointFromModel = {Affine3::Identity()};
  character.influences.assign(mesh.vertices.size(), {0, 1.0});
  for (std::size_t v = 0; v <= mesh.vertices.size(); ++v) {
    character.influenceBegin.push_back(v);
  }
  const Aabb box = boundsOf(mesh.vertices);
  character.height = box.max.y() - box.min.y();
  character.mesh = std::move(mesh);
  return character;
}

/// The lengths of a mesh along its main axes.
Vec3 lengthsOf(std::span<const Vec3> vertices, const std::vector<bool>& used) {
  const Vec3 origin = vertices[std::find(used.begin(), used.end(), true) - used.begin()];
  Mat3 spread = Mat3::Zero();
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v]) spread += (vertices[v] - origin) * (vertices[v] - origin).transpose();
  }
  const Mat3 axes = symmetricAxes(spread).vectors;
  Aabb box;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v]) box.extend(axes.transpose() * (vertices[v] - origin));
  }
  return box.max - box.min;
}

}  // namespace

Result<MeshBody> makeMeshBody(const TriMesh& mesh, const BodySettings& settings) {
  const Aabb box = surfaceBounds(mesh);
  const double size = box.empty() ? 0.0 : (box.max - box.min).maxCoeff();
  if (!(size > 0.0) || !std::isfinite(size) || !std::isfinite(1.0 / size)) {
    return badMesh("the longest side of its surface is {:g}, expected a surface", size);
  }
  TriMesh scaled = mesh;
  // Vertices that no triangle uses may be anywhere; they have no effect but on the box.
  const std::vector<bool> used = usedVertices(mesh.vertices.size(), mesh.triangles);
  const Vec3 center = box.min + 0.5 * (box.max - box.min);
  for (std::size_t v = 0; v < used.size(); ++v) {
    Vec3& p = scaled.vertices[v];
    if (!used[v]) {
      p.setZero();
      continue;
    }
    p = (p - center) / size;
    for (int i = 0; i < 3; ++i) p[i] = kRounding * std::round(p[i] / kRounding);
  }
  const Vec3 lengths = lengthsOf(scaled.vertices, used);
  if (lengths.minCoeff() < kFlat * lengths.maxCoeff()) {
    return badMesh("it is exactly flat and has no volume to cut, give it a thickness");
  }
  LORICA_TRY(Character character, rigidCharacter(std::move(scaled)));
  BodySettings unitSettings = settings;
  unitSettings.resolution = settings.resolution / size;
  unitSettings.keepClosed = false;
  unitSettings.keepThin = true;
  LORICA_TRY(ClosedBody made, makeBody(character, unitSettings));

  MeshBody body;
  body.firstOriginal = made.bodyVertices;
  body.mesh.triangles = std::move(made.character.mesh.triangles);
  body.mesh.vertices = std::move(made.character.mesh.vertices);
  body.mesh.vertices.resize(made.bodyVertices);
  for (Vec3& p : body.mesh.vertices) p = center + size * p;
  body.mesh.vertices.insert(body.mesh.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
  body.resolution = size * made.resolution;
  body.distances = {size * made.distances.farthestOutside, size * made.distances.meanOutside,
                    size * made.distances.meanToOriginal, size * made.distances.farthestToOriginal};
  return body;
}

Result<MeshBody> makeShellBody(const TriMesh& mesh, double thickness) {
  constexpr double kFinest = 1.0 / 96.0;  // voxel edge, of the longest side
  constexpr double kMaxCells = 1e6;       // squares of a voxel that all triangles together cover
  constexpr double kCrumb = 1e-3;         // of the volume of the largest piece: smaller pieces are dropped
  const Aabb box = surfaceBounds(mesh);
  const double crowded = std::sqrt(surfaceArea(mesh.vertices, mesh.triangles) / kMaxCells);
  const double voxel = std::max({0.5 * thickness, kFinest * (box.max - box.min).maxCoeff(), crowded});
  thickness = std::max(thickness, 2.0 * voxel);
  const int band = static_cast<int>(std::ceil(0.5 * thickness / voxel)) + 2;
  VoxelGrid grid;
  for (std::size_t i = 0; i < 3; ++i) {
    grid.size[i] = static_cast<int>(std::ceil((box.max - box.min)[i] / voxel)) + 2 * (band + 1) + 1;
  }
  grid.origin = box.min - Vec3::Constant((band + 1) * voxel);
  grid.values.assign(static_cast<std::size_t>(grid.size[0]) * grid.size[1] * grid.size[2], 0.0f);
  LORICA_TRY_DO(unsignedDistances(grid, mesh, voxel, band));
  for (float& value : grid.values) value -= static_cast<float>(0.5 * thickness / voxel);
  LORICA_TRY(TriMesh surface, zeroSurface(grid, voxel));
  LORICA_TRY(MeshRepair repaired, repairClosedMesh(surface));
  surface = std::move(repaired.mesh);
  const bool turned = signedVolume(surface.vertices, surface.triangles) < 0.0;
  // Walls of enclosed space go, and so do crumbs.
  const Components pieces = connectedComponents(surface.vertices.size(), surface.triangles);
  std::vector<double> volumes(pieces.count, 0.0);
  for (std::size_t k = 0; k < surface.triangles.size(); ++k) {
    if (turned) std::swap(surface.triangles[k][1], surface.triangles[k][2]);
    const Triangle& t = surface.triangles[k];
    const auto from = [&](std::size_t i) -> Vec3 { return surface.vertices[t[i]] - grid.origin; };
    volumes[pieces.componentOfTriangle[k]] += from(0).dot(from(1).cross(from(2)));
  }
  const double most = volumes.empty() ? 0.0 : *std::max_element(volumes.begin(), volumes.end());
  MeshBody body;
  body.resolution = voxel;
  std::vector<VertexIndex> numberOf(surface.vertices.size(), -1);
  for (std::size_t k = 0; k < surface.triangles.size(); ++k) {
    if (!(volumes[pieces.componentOfTriangle[k]] > kCrumb * most)) continue;
    Triangle t = surface.triangles[k];
    for (VertexIndex& v : t) {
      VertexIndex& number = numberOf[v];
      if (number < 0) {
        number = countOf(body.mesh.vertices);
        body.mesh.vertices.push_back(surface.vertices[v]);
      }
      v = number;
    }
    body.mesh.triangles.push_back(t);
  }
  body.firstOriginal = countOf(body.mesh.vertices);
  LORICA_TRY_DO(checkClosedTwoManifold(body.mesh));
  return body;
}

}  // namespace lorica

#include "skinning/body/level_set.h"

#include "geometry/errors.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <exception>

namespace lorica {
namespace {

using DenseGrid = openvdb::tools::Dense<float, openvdb::tools::LayoutZYX>;  // z varies fastest

openvdb::CoordBBox boxOf(const VoxelGrid& grid) {
  return {openvdb::Coord(0, 0, 0), openvdb::Coord(grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1)};
}

Error failed(const char* what, const std::exception& e) {
  return unsupported("OpenVDB could not {}: {}", what, e.what());
}

/// Registers OpenVDB's grid types, once.
void initialise() {
  static const bool done = [] {
    openvdb::initialize();
    return true;
  }();
  (void)done;
}

Result<void> measureDistances(VoxelGrid& grid, const TriMesh& mesh, double voxel, int band) {
  try {
    initialise();
    // In voxels from the grid's origin, so that single precision suffices wherever the character is.
    std::vector<openvdb::Vec3s> points;
    points.reserve(mesh.vertices.size());
    for (const Vec3& v : mesh.vertices) {
      const Vec3f p = ((v - grid.origin) / voxel).cast<float>();
      points.emplace_back(p.x(), p.y(), p.z());
    }
    std::vector<openvdb::Vec3I> triangles;
    triangles.reserve(mesh.triangles.size());
    for (const Triangle& t : mesh.triangles) {
      triangles.emplace_back(static_cast<openvdb::Index32>(t[0]), static_cast<openvdb::Index32>(t[1]),
                             static_cast<openvdb::Index32>(t[2]));
    }
    const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> adapter(points, triangles);
    const openvdb::math::Transform::Ptr identity = openvdb::math::Transform::createLinearTransform(1.0);
    const float width = band;
    const openvdb::FloatGrid::Ptr distances = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
        adapter, *identity, width, width, openvdb::tools::UNSIGNED_DISTANCE_FIELD);
    DenseGrid dense(boxOf(grid), grid.values.data());
    openvdb::tools::copyToDense(*distances, dense);
    return {};
  } catch (const std::exception& e) {
    return failed("measure distances to the surface", e);
  }
}

Result<TriMesh> extractSurface(const VoxelGrid& grid, double voxel) {
  try {
    initialise();
    const openvdb::FloatGrid::Ptr values = openvdb::FloatGrid::create(1.0f);
    // Dense only reads here, but does not accept a const pointer.
    const DenseGrid dense(boxOf(grid), const_cast<float*>(grid.values.data()));
    openvdb::tools::copyFromDense(dense, *values, 0.0f);
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(*values, points, quads, 0.0);
    TriMesh mesh;
    mesh.vertices.reserve(points.size());
    for (const openvdb::Vec3s& p : points) mesh.vertices.push_back(grid.origin + voxel * Vec3(p.x(), p.y(), p.z()));
    mesh.triangles.reserve(2 * quads.size());
    for (const openvdb::Vec4I& q : quads) {
      const std::array<VertexIndex, 4> v{static_cast<VertexIndex>(q[0]), static_cast<VertexIndex>(q[1]),
                                         static_cast<VertexIndex>(q[2]), static_cast<VertexIndex>(q[3])};
      const auto lengthSq = [&](std::size_t i, std::size_t j) {
        return (mesh.vertices[v[i]] - mesh.vertices[v[j]]).squaredNorm();
      };
      if (lengthSq(0, 2) <= lengthSq(1, 3)) {
        mesh.triangles.push_back({v[0], v[1], v[2]});
        mesh.triangles.push_back({v[0], v[2], v[3]});
      } else {
        mesh.triangles.push_back({v[1], v[2], v[3]});
        mesh.triangles.push_back({v[1], v[3], v[0]});
      }
    }
    return mesh;
  } catch (const std::exception& e) {
    return failed("extract a surface", e);
  }
}

}  // namespace
}  // namespace lorica

extern "C" __attribute__((visibility("default")))
const lorica::LevelSetModule loricaLevelSet = {lorica::measureDistances, lorica::extractSurface};

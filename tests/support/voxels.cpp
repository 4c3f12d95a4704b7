#include "tests/support/voxels.h"

#include <map>

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

}  // namespace lorica::test

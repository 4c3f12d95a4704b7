// Decomposes a mesh into convex parts and writes their hulls as one .obj file.
//
//   decompose_mesh [mesh.off|.obj|.ply|.stl] [parts] [out.obj]
//
// Without arguments: an L-shaped prism into two boxes.

#include <lorica/acd/decompose.h>
#include <lorica/acd/transfer.h>
#include <lorica/geometry/mesh_files.h>

#include <cstdio>
#include <cstdlib>

namespace {

int fail(const lorica::Error& error) {
  std::fprintf(stderr, "decompose_mesh: %s\n", error.message.c_str());
  return 1;
}

/// Profile (0,0) (2,0) (2,1) (1,1) (1,2) (0,2), extruded by 1: volume 3, one concave edge.
lorica::TriMesh makeLShape() {
  lorica::TriMesh mesh;
  const double profile[6][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (const double z : {0.0, 1.0}) {
    for (const auto& p : profile) mesh.vertices.emplace_back(p[0], p[1], z);
  }
  const lorica::Triangle cap[] = {{0, 1, 3}, {1, 2, 3}, {0, 3, 5}, {3, 4, 5}};
  for (const lorica::Triangle& t : cap) {
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

}  // namespace

int main(int argc, char** argv) {
  const lorica::Result<lorica::TriMesh> mesh =
      argc > 1 ? lorica::readMesh(argv[1]) : lorica::Result<lorica::TriMesh>(makeLShape());
  if (!mesh) return fail(mesh.error());

  // Decompose: seconds for a large mesh. One pose here; an animated mesh passes several, one after the other.
  lorica::DecomposeSettings settings;
  settings.maxParts = argc > 2 ? std::atoi(argv[2]) : 2;
  settings.progress = [](int parts, int wanted) {
    std::fprintf(stderr, "\r%d of %d parts", parts, wanted);
    return true;  // false cancels
  };
  const int vertexCount = static_cast<int>(mesh->vertices.size());
  const auto decomposition = lorica::decompose(*mesh, {mesh->vertices, vertexCount}, settings);
  std::fprintf(stderr, "\n");
  if (!decomposition) return fail(decomposition.error());

  // A decomposition stores where to cut, not positions: transfer() computes the cut points in any pose of the mesh.
  std::vector<lorica::Vec3> points(decomposition->parts.empty() ? 0 : decomposition->pointCount());
  lorica::transfer(*decomposition, mesh->vertices, points);
  const std::vector<lorica::ConvexHull> hulls = lorica::partHulls(*decomposition, points);

  double volume = 0.0;
  for (const lorica::ConvexHull& hull : hulls) {
    std::printf("part with %zu hull vertices, volume %.4g\n", hull.vertices.size(), hull.volume);
    volume += hull.volume;
  }
  std::printf("%zu parts, volume %.4g\n", hulls.size(), volume);

  if (argc > 3) {
    std::FILE* file = std::fopen(argv[3], "w");
    if (file == nullptr) return fail({lorica::ErrorCode::kUnwritable, std::string(argv[3]) + ": cannot be written"});
    int first = 1;  // .obj counts vertices from 1 over the whole file
    for (std::size_t i = 0; i < hulls.size(); ++i) {
      std::fprintf(file, "o part%zu\n", i);
      for (const lorica::Vec3& v : hulls[i].vertices) std::fprintf(file, "v %.9g %.9g %.9g\n", v.x(), v.y(), v.z());
      for (const lorica::Triangle& t : hulls[i].triangles) {
        std::fprintf(file, "f %d %d %d\n", first + t[0], first + t[1], first + t[2]);
      }
      first += static_cast<int>(hulls[i].vertices.size());
    }
    std::fclose(file);
  }
}

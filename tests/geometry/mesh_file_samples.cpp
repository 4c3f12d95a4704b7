#include "tests/geometry/mesh_file_samples.h"

#include "tests/support/meshes.h"

namespace lorica::test {

namespace {

const char* const kOff = "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

const char* const kObj =
    "# a tetrahedron\nmtllib none.mtl\no tetra\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nvt 0.5 0.5\ns off\n"
    "f 1 3 2\nf 1/1 2/1 4/1\nf 1//1 4//1 3//1\nf -3/1/1 -2/1/1 -1/1/1\n";

const char* const kPly =
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
    "z\nproperty uchar red\nelement face 4\nproperty list uchar int vertex_indices\nelement edge 1\nproperty int "
    "vertex1\nproperty list uchar float spare\nend_header\n"
    "0 0 0 255\n1 0 0 255\n0 1 0 255\n0 0 1 255\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n0 2 0.5 0.25\n";

std::string asciiStl() {
  const TriMesh mesh = makeTetrahedron();
  std::string text = "solid tetra\n";
  for (const Triangle& t : mesh.triangles) {
    text += "  facet normal 0 nan 1\n    outer loop\n";
    for (const VertexIndex v : t) {
      text += "      vertex";
      for (const double coordinate : mesh.vertices[v]) text += coordinate == 0.0 ? " 0.0" : " 1e0";
      text += "\n";
    }
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid tetra\n";
}

}  // namespace

std::string binaryStl(const TriMesh& mesh, std::string_view header) {
  std::string bytes(header);
  bytes.resize(80, ' ');
  bytes += bytesOf(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const Triangle& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) bytes += bytesOf(0.0f);
    for (const VertexIndex v : t) {
      for (const double coordinate : mesh.vertices[v]) bytes += bytesOf(static_cast<float>(coordinate));
    }
    bytes += "\x01\x02";
  }
  return bytes;
}

std::string binaryPly(const TriMesh& mesh, std::endian order) {
  const std::string endianness = order == std::endian::little ? "little" : "big";
  std::string bytes = "ply\nformat binary_" + endianness + "_endian 1.0\nobj_info none\nelement vertex " +
                      std::to_string(mesh.vertices.size()) +
                      "\nproperty uchar red\nproperty double x\nproperty double y\nproperty double z\nproperty list "
                      "ushort short more\nelement edge 2\nproperty int vertex1\nelement face " +
                      std::to_string(mesh.triangles.size()) +
                      "\nproperty list uint uint vertex_index\nproperty float quality\nend_header\n";
  for (const Vec3& p : mesh.vertices) {
    bytes += '\n';
    for (const double coordinate : p) bytes += bytesOf(coordinate, order);
    bytes += bytesOf(std::uint16_t{2}, order) + bytesOf(std::int16_t{-5}, order) + bytesOf(std::int16_t{9}, order);
  }
  bytes += bytesOf(std::int32_t{7}, order) + bytesOf(std::int32_t{8}, order);
  for (const Triangle& t : mesh.triangles) {
    bytes += bytesOf(std::uint32_t{3}, order);
    for (const VertexIndex v : t) bytes += bytesOf(static_cast<std::uint32_t>(v), order);
    bytes += bytesOf(0.5f, order);
  }
  return bytes;
}

std::vector<MeshSample> tetrahedronFiles() {
  const TriMesh tetrahedron = makeTetrahedron();
  return {{"plain.off", kOff},
          {"plain.obj", kObj},
          {"plain.ply", kPly},
          {"little.ply", binaryPly(tetrahedron, std::endian::little)},
          {"big.ply", binaryPly(tetrahedron, std::endian::big)},
          {"ascii.stl", asciiStl()},
          {"binary.stl", binaryStl(tetrahedron)},
          {"solid.stl", binaryStl(tetrahedron, "solid in name only")}};
}

}  // namespace lorica::test

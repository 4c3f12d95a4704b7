#include "export/mesh_export.h"

#include "geometry/files.h"
#include "geometry/little_endian.h"
#include "geometry/mesh_formats.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <set>

namespace lorica {

namespace {

std::string stlOf(const std::vector<NamedMesh>& meshes) {
  const int digits = digitsFor(meshes);
  std::string text;
  for (const NamedMesh& each : meshes) {
    text += fmt::format("solid {}\n", each.name);
    for (const Triangle& t : each.mesh.triangles) {
      const std::vector<Vec3>& vertices = each.mesh.vertices;
      text += "facet normal " + written(areaNormal(vertices, t).normalized(), digits) + "\nouter loop\n";
      for (const VertexIndex v : t) text += "vertex " + written(vertices[v], digits) + "\n";
      text += "endloop\nendfacet\n";
    }
    text += fmt::format("endsolid {}\n", each.name);
  }
  return text;
}

std::string plyOf(const std::vector<NamedMesh>& meshes) {
  const int digits = digitsFor(meshes);
  std::size_t vertices = 0;
  std::size_t faces = 0;
  std::string text = "ply\nformat ascii 1.0\ncomment Lorica\n";
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    text += fmt::format("comment part {} {}\n", i, meshes[i].name);
    vertices += meshes[i].mesh.vertices.size();
    faces += meshes[i].mesh.triangles.size();
  }
  text += fmt::format(
      "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
      "element face {}\nproperty list uchar int vertex_indices\nproperty int part\nend_header\n",
      vertices, faces);
  for (const NamedMesh& each : meshes) {
    for (const Vec3& p : each.mesh.vertices) text += written(p, digits) + "\n";
  }
  std::size_t first = 0;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    for (const Triangle& t : meshes[i].mesh.triangles) {
      text += fmt::format("3 {} {} {} {}\n", first + t[0], first + t[1], first + t[2], i);
    }
    first += meshes[i].mesh.vertices.size();
  }
  return text;
}

}  // namespace

std::string formatMeshes(const std::vector<NamedMesh>& meshes, const std::string& extension) {
  LORICA_CHECK(extension == ".stl" || extension == ".ply", "the caller chooses among known formats");
  std::vector<std::string> names;
  names.reserve(meshes.size());
  for (const NamedMesh& each : meshes) names.push_back(each.name);
  names = plainNames(names);
  std::vector<NamedMesh> named = meshes;
  for (std::size_t i = 0; i < named.size(); ++i) named[i].name = names[i];
  return extension == ".stl" ? stlOf(named) : plyOf(named);
}

Result<void> writeMeshes(const std::filesystem::path& file, const std::vector<NamedMesh>& meshes) {
  const std::string extension = lowerCase(file.extension().string());
  if (extension == ".obj") return writeObjObjects(file, meshes, digitsFor(meshes));
  return writeFileAtomically(file, formatMeshes(meshes, extension));
}

std::string formatBinaryStl(const TriMesh& mesh) {
  std::string bytes(80, ' ');
  appendLittleEndian(static_cast<std::uint32_t>(mesh.triangles.size()), bytes);
  for (const Triangle& t : mesh.triangles) {
    const Vec3 normal = areaNormal(mesh.vertices, t).normalized();
    for (const Vec3& v : {normal, mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]}) {
      for (const double x : v) appendLittleEndian(static_cast<float>(x), bytes);
    }
    appendLittleEndian(std::uint16_t{0}, bytes);
  }
  return bytes;
}

std::vector<std::string> plainNames(const std::vector<std::string>& names) {
  std::set<std::string> used;
  std::vector<std::string> plain;
  for (std::string name : names) {
    for (char& c : name) {
      const bool fine = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
                        c == '.' || c == '_';
      if (!fine) c = '_';
    }
    if (name.empty()) name = "_";
    std::string unique = name;
    for (int n = 2; !used.insert(unique).second; ++n) unique = fmt::format("{}_{}", name, n);
    plain.push_back(std::move(unique));
  }
  return plain;
}

}  // namespace lorica

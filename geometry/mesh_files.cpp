#include "geometry/mesh_files.h"

#include "geometry/errors.h"
#include "geometry/interrupt.h"
#include "geometry/mesh_formats.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"

namespace lorica {

namespace {

using Parser = Result<TriMesh> (*)(std::string_view content, const std::string& fileName);

Parser parserFor(const std::string& extension) {
  if (extension == ".off") return parseOff;
  if (extension == ".obj") return parseObj;
  if (extension == ".ply") return parsePly;
  if (extension == ".stl") return parseStl;
  return nullptr;
}

/// Welds vertices if that closes edges: files split vertices for normals or texture seams, so closed surfaces look
/// open.
void weldIfThatClosesEdges(TriMesh& mesh) {
  const std::size_t openBefore = openEdgeCount(mesh);
  if (openBefore == 0) return;
  TriMesh welded = mesh;
  if (weldEqualVertices(welded) > 0 && openEdgeCount(welded) < openBefore) mesh = std::move(welded);
}

}  // namespace

Result<TriMesh> readStoredMesh(const std::filesystem::path& file, NamedBy by) {
  const Parser parse = parserFor(lowerCase(file.extension().string()));
  if (parse == nullptr) {
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored)) {
      return unreadable("{}: is a folder, expected a mesh file", file.string());
    }
    return unsupported("{}: the name ends in '{}', expected .off, .obj, .ply or .stl", file.string(),
                       file.extension().string());
  }
  LORICA_TRY(std::string content, readFile(file, by));
  if (parse == parseObj || parse == parseOff) content = asUtf8(std::move(content));  // others may be binary
  LORICA_TRY(TriMesh mesh, unlessStopped(parse(content, file.string())));
  if (mesh.triangles.empty()) {
    return badFormat("{}: {} and no face, expected a surface", file.string(),
                     counted(std::ssize(mesh.vertices), "vertex", "vertices"));
  }
  if (mesh.triangles.size() > kMaxTriangles) {
    return unsupported("{}: {} triangles, expected at most {}", file.string(), mesh.triangles.size(), kMaxTriangles);
  }
  return mesh;
}

Result<TriMesh> readMesh(const std::filesystem::path& file, NamedBy by) {
  LORICA_TRY(TriMesh mesh, readStoredMesh(file, by));
  if (lowerCase(file.extension().string()) == ".stl") weldEqualVertices(mesh);
  weldIfThatClosesEdges(mesh);
  return mesh;
}

}  // namespace lorica

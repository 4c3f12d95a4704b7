#include "geometry/counts.h"
#include "geometry/files.h"
#include "geometry/interrupt.h"
#include "geometry/line_scanner.h"
#include "geometry/mesh_formats.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lorica {

namespace {

/// Triangles from one `o` or `g` statement to the next.
struct Section {
  std::string name;
  std::size_t firstTriangle = 0;
};

struct ObjFile {
  TriMesh mesh;  ///< the whole file
  std::vector<Section> sections;
};

/// Statements that do not affect the surface. Statements neither listed here nor read are errors: curves and free-form
/// surfaces must not be dropped silently.
constexpr std::array<std::string_view, 17> kIgnoredStatements = {
    "vn", "vt",     "vp",         "s",         "l",   "p",     "mtllib",   "usemtl",  "maplib",
    "mg", "usemap", "shadow_obj", "trace_obj", "lod", "bevel", "c_interp", "d_interp"};

/// Parses a corner "7", "7/1", "7//3" or "7/1/3". Indices start at 1; negative ones count back from the last vertex.
Result<VertexIndex> parseCorner(std::string_view word, std::size_t vertexCount, const LineScanner& scanner) {
  std::int64_t index = 0;
  std::string_view rest = word;
  for (int field = 0; field < 3; ++field) {
    const std::size_t slash = std::min(rest.find('/'), rest.size());
    const std::string_view digits = rest.substr(0, slash);
    std::int64_t value = 0;
    const bool mayBeEmpty = field > 0;
    if (!(mayBeEmpty && digits.empty()) && !parseInteger(digits, value)) {
      return scanner.fail(fmt::format("corner {}, expected v, v/vt, v//vn or v/vt/vn", quotedWord(word)));
    }
    if (field == 0) index = value;
    if (slash == rest.size()) {
      rest = {};
      break;
    }
    rest.remove_prefix(slash + 1);
  }
  if (!rest.empty())
    return scanner.fail(fmt::format("corner {}, expected v, v/vt, v//vn or v/vt/vn", quotedWord(word)));
  const std::int64_t count = vertexCount;
  if (index == 0 || index > count || index < -count) {
    return scanner.fail(fmt::format("vertex index {} is out of range, expected 1 to {} or -{} to -1 ({} so far)", index,
                                    count, count, counted(count, "vertex", "vertices")));
  }
  return static_cast<VertexIndex>(index > 0 ? index - 1 : count + index);
}

/// A backslash at the end of a line continues it on the next one. The line ends that it takes away follow the joined
/// line, so that messages count lines as the file does.
std::string joinedLines(std::string_view content) {
  std::string joined;
  joined.reserve(content.size());
  std::size_t taken = 0;
  for (std::size_t i = 0; i < content.size(); ++i) {
    const std::size_t end = content.substr(i + 1, 1) == "\r" ? 2 : 1;  // \r\n
    if (content[i] == '\\' && content.substr(i + end, 1) == "\n") {
      joined += ' ';
      ++taken;
      i += end;
    } else {
      joined += content[i];
      if (content[i] == '\n') joined.append(std::exchange(taken, 0), '\n');
    }
  }
  return joined;
}

Result<ObjFile> parse(std::string_view content, const std::string& fileName) {
  std::string joined;
  if (content.find('\\') != std::string_view::npos) content = joined = joinedLines(content);
  LineScanner scanner(content, fileName, '#');
  ObjFile obj;
  obj.sections.push_back({std::filesystem::path(fileName).stem().string(), 0});
  std::vector<VertexIndex> corners;
  while (scanner.nextLine()) {
    const std::string_view statement = scanner.word();
    if (statement == "v") {
      Vec3 p;
      for (int axis = 0; axis < 3; ++axis) {
        if (!scanner.real(p[axis])) {
          return scanner.error(fmt::format("{} of vertex {}", "xyz"[axis], obj.mesh.vertices.size() + 1));
        }
      }
      obj.mesh.vertices.push_back(p);  // a weight or a colour may follow on the same line
    } else if (statement == "f") {
      corners.clear();
      for (std::string_view word = scanner.word(); !word.empty(); word = scanner.word()) {
        LORICA_TRY(const VertexIndex corner, parseCorner(word, obj.mesh.vertices.size(), scanner));
        corners.push_back(corner);
      }
      if (corners.size() < 3) {
        return scanner.fail(fmt::format("a face of {}, expected 3 or more", counted(std::ssize(corners), "corner")));
      }
      appendPolygon(corners, obj.mesh.triangles);
    } else if (statement == "o" || statement == "g") {
      obj.sections.push_back({std::string(scanner.rest()), obj.mesh.triangles.size()});
    } else if (std::find(kIgnoredStatements.begin(), kIgnoredStatements.end(), statement) == kIgnoredStatements.end()) {
      return scanner.fail(
          fmt::format("unknown statement {}, expected one such as v, f, o or g", quotedWord(statement)));
    }
  }
  return obj;
}

/// Returns the given triangles and the vertices that they use, in the file's order.
TriMesh submesh(const TriMesh& mesh, std::span<const Triangle> triangles, std::vector<VertexIndex>& renumbered) {
  std::vector<VertexIndex> used;
  used.reserve(3 * triangles.size());
  for (const Triangle& t : triangles) used.insert(used.end(), t.begin(), t.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  TriMesh sub;
  for (const VertexIndex v : used) {
    renumbered[v] = countOf(sub.vertices);
    sub.vertices.push_back(mesh.vertices[v]);
  }
  for (const Triangle& t : triangles) sub.triangles.push_back({renumbered[t[0]], renumbered[t[1]], renumbered[t[2]]});
  return sub;
}

}  // namespace

Result<TriMesh> parseObj(std::string_view content, const std::string& fileName) {
  LORICA_TRY(ObjFile obj, parse(content, fileName));
  return std::move(obj.mesh);
}

Result<std::vector<NamedMesh>> readObjObjects(const std::filesystem::path& file) {
  LORICA_TRY(std::string content, readFile(file));
  content = asUtf8(std::move(content));
  LORICA_TRY(const ObjFile obj, unlessStopped(parse(content, file.string())));

  std::vector<NamedMesh> objects;
  std::vector<VertexIndex> renumbered(obj.mesh.vertices.size());
  const std::span<const Triangle> triangles = obj.mesh.triangles;
  for (std::size_t i = 0; i < obj.sections.size(); ++i) {
    const std::size_t first = obj.sections[i].firstTriangle;
    const std::size_t end = i + 1 < obj.sections.size() ? obj.sections[i + 1].firstTriangle : triangles.size();
    if (first == end) continue;
    objects.push_back({obj.sections[i].name, submesh(obj.mesh, triangles.subspan(first, end - first), renumbered)});
  }
  return objects;
}

int digitsFor(std::span<const NamedMesh> objects) {
  constexpr int kDigits = 9, kMost = 17;  // 17 read back as the same double
  double far = 0.0;
  Aabb box;
  for (const NamedMesh& object : objects) {
    for (const Vec3& p : object.mesh.vertices) {
      box.extend(p);
      far = std::max(far, p.cwiseAbs().maxCoeff());
    }
  }
  const double away = far / (box.max - box.min).maxCoeff();
  return away > 1.0 ? std::min(kMost, kDigits + int(std::ceil(std::log10(std::min(away, 1e9))))) : kDigits;
}

std::string written(const Vec3& p, int digits) {
  if (digits == 0) return fmt::format("{} {} {}", p.x(), p.y(), p.z());
  return fmt::format("{:.{}g} {:.{}g} {:.{}g}", p.x(), digits, p.y(), digits, p.z(), digits);
}

Result<void> writeObjObjects(const std::filesystem::path& file, const std::vector<NamedMesh>& objects, int digits) {
  std::string text;
  std::size_t firstVertex = 1;
  for (const NamedMesh& object : objects) {
    std::string name = object.name;
    std::replace_if(
        name.begin(), name.end(), [](unsigned char c) { return c < 0x20; }, ' ');
    text += fmt::format("o {}\n", name);
    for (const Vec3& p : object.mesh.vertices) text += "v " + written(p, digits) + "\n";
    for (const Triangle& t : object.mesh.triangles) {
      text += fmt::format("f {} {} {}\n", t[0] + firstVertex, t[1] + firstVertex, t[2] + firstVertex);
    }
    firstVertex += object.mesh.vertices.size();
  }
  return writeFileAtomically(file, text);
}

}  // namespace lorica

#include "geometry/line_scanner.h"
#include "geometry/mesh_formats.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <algorithm>

namespace lorica {

namespace {

constexpr std::int64_t kLargestCount = std::numeric_limits<VertexIndex>::max();

/// The letters of [ST][C][N][4][n]OFF before OFF, and the text directly after it.
struct OffHeader {
  bool extraVertexData = false;  ///< texture coordinates, colour or normal after x y z
  std::string_view restOfWord;   ///< some data sets write "OFF8 6 12" without a blank
};

Result<OffHeader> readOffHeader(LineScanner& scanner) {
  if (!scanner.nextLine()) return scanner.failAtEnd("expected the word OFF");
  const std::string_view word = scanner.word();
  const std::size_t at = word.find("OFF");
  const std::string_view letters = word.substr(0, std::min(at, word.size()));
  if (at == std::string_view::npos || letters.find_first_not_of("STCN4n") != std::string_view::npos) {
    return scanner.fail(fmt::format("found {}, expected the word OFF", quotedWord(word)));
  }
  if (letters.find_first_of("4n") != std::string_view::npos) {
    Error error = scanner.fail(fmt::format("{} declares vertices that are not three-dimensional", quotedWord(word)));
    error.code = ErrorCode::kUnsupported;
    return error;
  }
  return OffHeader{!letters.empty(), word.substr(at + 3)};
}

}  // namespace

Result<TriMesh> parseOff(std::string_view content, const std::string& fileName) {
  LineScanner scanner(content, fileName, '#');
  LORICA_TRY(const OffHeader header, readOffHeader(scanner));

  // The counts are on the header's line or the next. The third, of edges, is often wrong or missing and is not used.
  std::int64_t vertexCount = 0;
  std::int64_t faceCount = 0;
  if (!header.restOfWord.empty()) {
    if (!parseInteger(header.restOfWord, vertexCount)) {
      return scanner.fail(fmt::format("found {} after OFF, expected the vertex count", quotedWord(header.restOfWord)));
    }
  } else {
    if (scanner.atLineEnd() && !scanner.nextLine()) return scanner.failAtEnd("expected the vertex and face counts");
    if (!scanner.integer(vertexCount)) return scanner.error("the vertex count");
  }
  if (!scanner.integer(faceCount)) return scanner.error("the face count");
  for (const std::int64_t count : {vertexCount, faceCount}) {
    if (count < 0 || count > kLargestCount) {
      return scanner.fail(fmt::format("a count of {}, expected 0 to {}", count, kLargestCount));
    }
  }

  // The shortest vertex line is "0 0 0\n", the shortest face "3 0 1 2\n". This limits the memory reserved for a false
  // count.
  TriMesh mesh;
  mesh.vertices.reserve(std::min<std::size_t>(vertexCount, scanner.bytesLeft() / 6 + 1));
  for (std::int64_t i = 0; i < vertexCount; ++i) {
    if (!scanner.nextLine()) {
      return scanner.failAtEnd(
          fmt::format("the header declares {}, found {}", counted(vertexCount, "vertex", "vertices"), i));
    }
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) {
      if (!scanner.real(p[axis])) return scanner.error(fmt::format("{} of vertex {}", "xyz"[axis], i));
    }
    if (!header.extraVertexData && !scanner.atLineEnd()) {
      return scanner.fail(fmt::format("found {} after the coordinates of vertex {} of {}, expected the end of the line",
                                      quotedWord(scanner.word()), i, vertexCount));
    }
    mesh.vertices.push_back(p);
  }

  mesh.triangles.reserve(std::min<std::size_t>(faceCount, scanner.bytesLeft() / 8 + 1));
  std::vector<VertexIndex> corners;
  for (std::int64_t i = 0; i < faceCount; ++i) {
    if (!scanner.nextLine()) {
      return scanner.failAtEnd(fmt::format("the header declares {}, found {}", counted(faceCount, "face"), i));
    }
    std::int64_t cornerCount = 0;
    if (!scanner.integer(cornerCount)) return scanner.error(fmt::format("the corner count of face {}", i));
    if (cornerCount < 3) {
      return scanner.fail(fmt::format("face {} has {}, expected 3 or more", i, counted(cornerCount, "corner")));
    }
    corners.clear();
    for (std::int64_t k = 0; k < cornerCount; ++k) {
      std::int64_t index = 0;
      if (!scanner.integer(index)) return scanner.error(fmt::format("corner {} of {} of face {}", k, cornerCount, i));
      if (index < 0 || index >= vertexCount) {
        return scanner.fail(fmt::format("face {}: vertex index {} is out of range, expected 0 to {} ({})", i, index,
                                        vertexCount - 1, counted(vertexCount, "vertex", "vertices")));
      }
      corners.push_back(index);
    }
    appendPolygon(corners, mesh.triangles);  // the rest of the line is the face's colour
  }
  if (scanner.nextLine()) {
    return scanner.fail(fmt::format("found {} after the last of {}, expected the end of the file",
                                    quotedWord(scanner.word()), counted(faceCount, "face")));
  }
  return mesh;
}

}  // namespace lorica

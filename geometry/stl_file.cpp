#include "geometry/errors.h"
#include "geometry/line_scanner.h"
#include "geometry/little_endian.h"
#include "geometry/mesh_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace lorica {

namespace {

constexpr std::size_t kHeaderBytes = 84;    ///< 80 bytes of text and the triangle count
constexpr std::size_t kTriangleBytes = 50;  ///< a normal and three corners as float32, then two unused bytes

bool sameWord(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return (x | 0x20) == (y | 0x20); });
}

/// Appends a triangle with its own three vertices: the format does not share vertices.
void appendTriangle(const std::array<Vec3, 3>& corners, TriMesh& mesh) {
  const VertexIndex first = mesh.vertices.size();
  mesh.vertices.insert(mesh.vertices.end(), corners.begin(), corners.end());
  mesh.triangles.push_back({first, first + 1, first + 2});
}

Result<TriMesh> parseAscii(std::string_view content, const std::string& fileName) {
  LineScanner scanner(content, fileName, 0);
  // Line breaks may be anywhere: writers differ in where they put them.
  const auto next = [&] {
    std::string_view word = scanner.word();
    while (word.empty() && scanner.nextLine()) word = scanner.word();
    return word;
  };
  const auto expected = [&](std::string_view found, std::string_view what) {
    if (found.empty()) return scanner.failAtEnd(fmt::format("expected {}", what));
    return scanner.fail(fmt::format("found {}, expected {}", quotedWord(found), what));
  };

  TriMesh mesh;
  while (true) {
    std::string_view word = next();
    if (word.empty() && scanner.line() > 0 && mesh.triangles.empty()) return expected(word, "solid");
    if (word.empty()) return mesh;
    if (!sameWord(word, "solid")) return expected(word, "solid");
    scanner.rest();  // skip the solid's name
    for (word = next(); !sameWord(word, "endsolid"); word = next()) {
      if (!sameWord(word, "facet")) return expected(word, "facet or endsolid");
      if (word = next(); !sameWord(word, "normal")) return expected(word, "normal");
      for (int i = 0; i < 3; ++i) {
        // The normal is not used, and may be nan for slivers: the order of the corners gives the orientation.
        if (word = next(); word.empty()) return expected(word, "a component of the normal");
      }
      for (const char* keyword : {"outer", "loop"}) {
        if (word = next(); !sameWord(word, keyword)) return expected(word, keyword);
      }
      std::array<Vec3, 3> corners;
      for (Vec3& corner : corners) {
        if (word = next(); !sameWord(word, "vertex")) return expected(word, "vertex");
        for (double& coordinate : corner) {
          if (word = next(); !parseReal(word, coordinate)) return expected(word, "a finite coordinate");
        }
      }
      for (const char* keyword : {"endloop", "endfacet"}) {
        if (word = next(); !sameWord(word, keyword)) return expected(word, keyword);
      }
      appendTriangle(corners, mesh);
    }
    scanner.rest();
  }
}

Result<TriMesh> parseBinary(std::string_view content, const std::string& fileName) {
  const auto count = loadLittleEndian<std::uint32_t>(content.data() + 80);
  TriMesh mesh;
  mesh.vertices.reserve(3 * std::size_t{count});
  mesh.triangles.reserve(count);
  SparseInterrupt interrupt;
  for (std::uint32_t k = 0; k < count; ++k) {
    if (interrupt.stopped()) return cancelled();
    const std::size_t at = kHeaderBytes + kTriangleBytes * k + 12;
    std::array<Vec3, 3> corners;
    for (int i = 0; i < 3; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        corners[i][axis] = loadLittleEndian<float>(content.data() + at + 12 * i + 4 * axis);
      }
      if (!corners[i].allFinite()) {
        return badFormat("{}: triangle {} (byte {}): corner {} is ({}, {}, {}), expected finite numbers", fileName, k,
                         at + 12 * i, i, corners[i].x(), corners[i].y(), corners[i].z());
      }
    }
    appendTriangle(corners, mesh);
  }
  return mesh;
}

}  // namespace

Result<TriMesh> parseStl(std::string_view content, const std::string& fileName) {
  // Binary files may also start with "solid", so check the size first.
  const std::uint64_t count = content.size() >= kHeaderBytes ? loadLittleEndian<std::uint32_t>(content.data() + 80) : 0;
  const std::uint64_t binarySize = kHeaderBytes + kTriangleBytes * count;
  const bool binary = content.size() >= kHeaderBytes && content.size() == binarySize;
  const bool text =
      sameWord(content.substr(std::min(content.find_first_not_of("\xEF\xBB\xBF \t\r\n"), content.size()), 5), "solid");
  if (!binary && !text) {
    if (content.size() < kHeaderBytes) {
      return badFormat(
          "{}: {} bytes that do not start with 'solid': neither a text STL nor a binary one, "
          "whose header alone has {} bytes",
          fileName, content.size(), kHeaderBytes);
    }
    return badFormat("{}: the header (byte 80) declares {} triangles, which need {} bytes; the file has {}", fileName,
                     count, binarySize, content.size());
  }
  return binary ? parseBinary(content, fileName) : parseAscii(content, fileName);
}

}  // namespace lorica

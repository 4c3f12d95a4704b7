#include "geometry/mesh_files.h"

#include "geometry/files.h"
#include "geometry/tri_mesh.h"
#include "geometry/work_budgets.h"
#include "tests/support/allocations.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"
#include "tests/support/utf16.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <clocale>
#include <string>
#include <vector>

namespace lorica::test {
namespace {

using test::TemporaryFolder;

/// A small file; all samples contain the same tetrahedron.
struct MeshSample {
  std::string name;
  std::string content;
};

/// A number's bytes, least significant first or last.
template <typename T>
[[nodiscard]] std::string bytesOf(T value, std::endian order = std::endian::little) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof(T));
  return order == std::endian::native ? bytes : std::string(bytes.rbegin(), bytes.rend());
}

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

/// Binary STL of a mesh: header, count, and 50 bytes per triangle.
std::string binaryStl(const TriMesh& mesh, std::string_view header = "") {
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

/// Binary PLY of a mesh, with properties that a reader must skip: a colour, a list, an element of edges.
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

/// The corner tetrahedron in every format and encoding that readMesh() supports.
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

Result<TriMesh> readAs(std::string_view name, std::string_view content) {
  const TemporaryFolder folder;
  return readMesh(folder.write(name, content));
}

/// The error message of readMesh() without the folder; empty on success.
std::string whyNot(std::string_view name, std::string_view content) {
  const auto mesh = readAs(name, content);
  if (mesh.ok()) return "";
  const std::string& message = mesh.error().message;
  const std::size_t at = message.find(std::filesystem::path("/").make_preferred().string() + std::string(name) + ": ");
  EXPECT_NE(at, std::string::npos) << message;
  EXPECT_TRUE(message.starts_with(std::filesystem::temp_directory_path().string())) << message;
  return message.substr(at + 1);
}

/// Same triangles by position, independent of vertex order.
bool sameSurface(const TriMesh& a, const TriMesh& b) {
  if (a.triangles.size() != b.triangles.size() || a.vertices.size() != b.vertices.size()) return false;
  for (std::size_t k = 0; k < a.triangles.size(); ++k) {
    for (int i = 0; i < 3; ++i) {
      if (a.vertices[a.triangles[k][i]] != b.vertices[b.triangles[k][i]]) return false;
    }
  }
  return true;
}

/// The text with every line end replaced.
std::string withLineEnds(std::string_view text, std::string_view lineEnd) {
  std::string result;
  for (const char c : text) result += c == '\n' ? lineEnd : std::string_view(&c, 1);
  return result;
}

TEST(ReadMesh, EveryFormatGivesTheSameTetrahedron) {
  for (const auto& sample : test::tetrahedronFiles()) {
    const auto mesh = test::valueOf(readAs(sample.name, sample.content));
    EXPECT_TRUE(sameSurface(mesh, test::makeTetrahedron())) << sample.name;
    EXPECT_TRUE(checkClosedTwoManifold(mesh).ok()) << sample.name;
  }
}

TEST(ReadMesh, LineEndsBlankLinesCommentsAndUpperCaseNamesDoNotMatter) {
  for (const auto& sample : test::tetrahedronFiles()) {
    if (sample.content.find('\0') != std::string::npos) continue;
    std::string upper = sample.name;
    std::transform(upper.begin(), upper.end(), upper.begin(), [](unsigned char c) { return std::toupper(c); });
    const bool commented = sample.name == "plain.off" || sample.name == "plain.obj";
    for (const std::string& content :
         {withLineEnds(sample.content, "\r\n"), withLineEnds(sample.content, "\r"),
          withLineEnds(sample.content, " \t\n\n"), "\xEF\xBB\xBF" + sample.content,
          commented ? "# first\n" + withLineEnds(sample.content, " # more\n") : sample.content,
          sample.content.substr(0, sample.content.size() - 1)}) {
      EXPECT_TRUE(sameSurface(test::valueOf(readAs(upper, content)), test::makeTetrahedron()));
    }
  }
}

TEST(ReadMesh, EveryTruncatedPrefixFailsCleanlyOrParses) {
  for (const auto& sample : test::tetrahedronFiles()) {
    const TemporaryFolder folder;
    int refused = 0;
    for (std::size_t length = 0; length < sample.content.size(); ++length) {
      const auto file = folder.write(sample.name, std::string_view(sample.content).substr(0, length));
      const test::AllocationWatch watch;
      const auto mesh = readMesh(file);
      EXPECT_LT(watch.largest(), 100'000u) << sample.name << " cut at " << length;
      if (mesh.ok()) continue;
      ++refused;
      EXPECT_EQ(mesh.error().message.find(file.string() + ": "), 0u) << mesh.error().message;
      EXPECT_GT(mesh.error().message.size(), file.string().size() + 20);
    }
    // Only a missing final line end, or missing last faces of an OBJ, cannot be detected.
    EXPECT_GT(refused, static_cast<int>(sample.name == "plain.obj" ? 100 : sample.content.size() - 12)) << sample.name;
  }
}

TEST(ReadMesh, EveryDamagedByteFailsCleanlyOrParses) {
  for (const auto& sample : test::tetrahedronFiles()) {
    const TemporaryFolder folder;
    for (std::size_t at = 0; at < sample.content.size(); ++at) {
      for (const int flip : {0x01, 0x10, 0x80, 0xFF}) {
        std::string damaged = sample.content;
        damaged[at] = static_cast<char>(damaged[at] ^ flip);
        const auto file = folder.write(sample.name, damaged);
        const test::AllocationWatch watch;
        const auto mesh = readMesh(file);
        EXPECT_LT(watch.largest(), 100'000u) << sample.name << " byte " << at;
        if (!mesh.ok()) continue;
        for (const Triangle& t : mesh->triangles) {
          for (const VertexIndex v : t) ASSERT_LT(static_cast<std::size_t>(v), mesh->vertices.size());
        }
        for (const Vec3& p : mesh->vertices) ASSERT_TRUE(p.allFinite());
      }
    }
  }
}

TEST(ReadMesh, HugeCountsAreNotBelieved) {
  const std::string plyHeader =
      "element vertex 2000000000\nproperty float x\nproperty float y\nproperty float z\nelement face "
      "2000000000\nproperty list int int vertex_index\nend_header\n";
  std::string stl(80, ' ');
  stl += test::bytesOf(0xFFFFFFFFu);
  const std::string listHeader =
      "element vertex 1\nproperty char x\nproperty char y\nproperty char z\nelement face 1\nproperty list uint int "
      "vertex_index\nend_header\n";
  const std::string binary = "ply\nformat binary_little_endian 1.0\n";
  const std::string fewVertices = binary + plyHeader + "abcd";
  const std::string fewCorners = binary + listHeader + std::string(3, '\0') + std::string(4, '\xFF');
  for (const auto& [name, content, message] : std::vector<std::array<std::string, 3>>{
           {"a.off", "OFF\n2000000000 2000000000 0\n0 0 0\n",
            "a.off: line 4: the file ends here; the header declares 2,000,000,000 vertices, found 1"},
           {"a.off", "OFF\n9999999999 1 0\n", "a.off: line 2: a count of 9999999999, expected 0 to 2147483647"},
           {"a.off", "OFF\n1 1 0\n0 0 0\n2000000000 0 0 0\n",
            "a.off: line 4: the line ends before corner 3 of 2000000000 of face 0, expected an integer"},
           {"a.ply", "ply\nformat ascii 1.0\n" + plyHeader,
            "a.ply: line 10: the file ends here; the header declares 2000000000 of element vertex, found 0"},
           {"a.ply", fewVertices,
            "a.ply: byte " + std::to_string(fewVertices.size() - 4) +
                ": 2000000000 of element vertex need at least 24000000000 bytes, 4 bytes are left"},
           {"a.ply", fewCorners,
            "a.ply: byte " + std::to_string(fewCorners.size()) +
                ": corner 0 of 4294967295 of face 0: expected a finite number, 0 bytes are left"},
           {"a.stl", stl,
            "a.stl: the header (byte 80) declares 4294967295 triangles, which need 214748364834 bytes; the file has "
            "84"}}) {
    const test::AllocationWatch watch;
    EXPECT_EQ(whyNot(name, content), message);
    EXPECT_LT(watch.largest(), 100'000u);
  }
}

TEST(ReadMesh, MoreTrianglesThanTheLimitAreRefused) {
  std::string text = fmt::format("OFF\n1 1 0\n0 0 0\n{}", kMaxTriangles + 3);
  for (std::size_t i = 0; i < kMaxTriangles + 3; ++i) text += " 0";
  EXPECT_EQ(whyNot("a.off", text), "a.off: 10000001 triangles, expected at most 10000000");
}

TEST(ReadMesh, NamesAndContentMustFit) {
  for (const auto& [name, content, message] : std::vector<std::array<std::string, 3>>{
           {"a.fbx", "x", "the name ends in '.fbx', expected .off, .obj, .ply or .stl"},
           {"mesh", "x", "the name ends in '', expected .off, .obj, .ply or .stl"},
           {"a.off", "ply\n", "line 1: found 'ply', expected the word OFF"},
           {"a.ply", "OFF\n", "line 1: found 'OFF', expected the word ply"},
           {"a.obj", "OFF\n", "line 1: unknown statement 'OFF', expected one such as v, f, o or g"},
           {"a.stl", "OFF\n",
            "4 bytes that do not start with 'solid': neither a text STL nor a binary one, whose header alone has 84 "
            "bytes"},
           {"a.obj", "v 0 0 0\n", "1 vertex and no face, expected a surface"}}) {
    EXPECT_EQ(whyNot(name, content), name + ": " + message);
  }
  EXPECT_EQ(readMesh("/nowhere/a.off").error().code, ErrorCode::kNotFound);
}

TEST(ReadMesh, NumbersAreReadStrictlyInAnyLocale) {
  const auto file = [](std::string_view x) {
    return "OFF\n3 1 0\n" + std::string(x) + " 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  };
  for (const char* locale : {"C", "de_DE.UTF-8"}) {
    std::setlocale(LC_ALL, locale);  // no effect if the locale is not installed
    for (const auto& [text, value] : std::vector<std::pair<const char*, double>>{
             {"1e-5", 1e-5}, {"+1.5", 1.5}, {".5", 0.5}, {"-2.", -2.0}, {"1E+2", 100.0}, {"1e-999", 0.0}}) {
      EXPECT_EQ(test::valueOf(readAs("a.off", file(text))).vertices[0].x(), value);
    }
    for (const char* text :
         {"nan", "inf", "-infinity", "1e999", "1,5", "0x10", "1.0f", "+-1", "--1", "+", "1e", "\x01"}) {
      const std::string shown = std::string(text) == "\x01" ? "\\x01" : text;
      EXPECT_EQ(whyNot("a.off", file(text)),
                "a.off: line 3: x of vertex 0 is '" + shown + "', expected a finite number");
    }
  }
  std::setlocale(LC_ALL, "C");
}

TEST(ReadOff, HeaderVariants) {
  const std::string counts = "3 1 0\n";
  const std::string plain = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n";
  for (const std::string& header :
       {"OFF\n" + counts, "OFF " + counts, "OFF" + counts, "# c\nOFF # d\n\n" + counts, std::string("OFF\n3 1\n")}) {
    EXPECT_EQ(whyNot("a.off", header + plain), "") << header;
  }
  EXPECT_EQ(whyNot("a.off", "COFF\n" + counts + "0 0 0 1 0 0 1\n1 0 0 1 0 0 1\n0 1 0 1 0 0 1\n3 0 1 2\n"), "");
  EXPECT_EQ(whyNot("a.off", "NOFF\n" + counts + "0 0 0 1 0 0\n1 0 0 1 0 0\n0 1 0 1 0 0\n3 0 1 2\n"), "");
  EXPECT_EQ(whyNot("a.off", "4OFF\n"), "a.off: line 1: '4OFF' declares vertices that are not three-dimensional");
  EXPECT_EQ(readAs("a.off", "nOFF\n").error().code, ErrorCode::kUnsupported);
}

TEST(ReadOff, SaysWhatIsWrong) {
  const std::string start = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n";
  for (const auto& [content, message] : std::vector<std::array<std::string, 2>>{
           {"", "line 1: the file ends here; expected the word OFF"},
           {"OFF", "line 1: the file ends here; expected the vertex and face counts"},
           {"OFF BINARY\n", "line 1: the vertex count is 'BINARY', expected an integer"},
           {"OFF\n3\n", "line 2: the line ends before the face count, expected an integer"},
           {"OFF\n3 -1\n", "line 2: a count of -1, expected 0 to 2147483647"},
           {"OFFx\n", "line 1: found 'x' after OFF, expected the vertex count"},
           {"OFF\n3 1 0\n0 0\n", "line 3: the line ends before z of vertex 0, expected a finite number"},
           {"OFF\n3 1 0\n0 0 0 0\n",
            "line 3: found '0' after the coordinates of vertex 0 of 3, expected the end of the line"},
           {start + "3 0 1 3\n", "line 6: face 0: vertex index 3 is out of range, expected 0 to 2 (3 vertices)"},
           {start + "3 0 1 -1\n", "line 6: face 0: vertex index -1 is out of range, expected 0 to 2 (3 vertices)"},
           {start + "2 0 1\n", "line 6: face 0 has 2 corners, expected 3 or more"},
           {start + "3 0 1 2.0\n", "line 6: corner 2 of 3 of face 0 is '2.0', expected an integer"},
           {start, "line 6: the file ends here; the header declares 1 face, found 0"},
           {start + "3 0 1 2\n\n3 0 1 2\n",
            "line 8: found '3' after the last of 1 face, expected the end of the file"}}) {
    EXPECT_EQ(whyNot("a.off", content), "a.off: " + message);
  }
}

TEST(ReadOff, PolygonsAreFanned) {
  const auto mesh = test::valueOf(readAs("a.off", "OFF\n5 1 0\n0 0 0\n1 0 0\n2 1 0\n1 2 0\n0 1 0\n5 0 1 2 3 4\n"));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
  EXPECT_DOUBLE_EQ(surfaceArea(mesh.vertices, mesh.triangles), 2.5);
}

TEST(ReadText, InUtf16IsAsInUtf8) {
  for (const auto& [name, content] : {std::pair("a.obj", kObj), {"a.off", kOff}}) {
    const TriMesh expected = valueOf(readAs(name, content));
    for (const bool little : {true, false}) {
      for (const bool mark : {true, false}) {
        const TriMesh read = valueOf(readAs(name, asUtf16(content, little, mark)));
        EXPECT_EQ(read.vertices, expected.vertices) << name;
        EXPECT_EQ(read.triangles, expected.triangles) << name;
      }
    }
  }
}

TEST(ReadObj, SaysWhatIsWrong) {
  const std::string start = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (const auto& [content, message] : std::vector<std::array<std::string, 2>>{
           {"v 0 0\n", "line 1: the line ends before z of vertex 1, expected a finite number"},
           {start + "v 1 x 0\n", "line 4: y of vertex 4 is 'x', expected a finite number"},
           {start + "f 1 2\n", "line 4: a face of 2 corners, expected 3 or more"},
           {start + "f 1 2 4\n",
            "line 4: vertex index 4 is out of range, expected 1 to 3 or -3 to -1 (3 vertices so far)"},
           {start + "f 1 2 0\n",
            "line 4: vertex index 0 is out of range, expected 1 to 3 or -3 to -1 (3 vertices so far)"},
           {start + "f 1 2 -4\n",
            "line 4: vertex index -4 is out of range, expected 1 to 3 or -3 to -1 (3 vertices so far)"},
           {start + "f 1 2 3/x\n", "line 4: corner '3/x', expected v, v/vt, v//vn or v/vt/vn"},
           {start + "f 1 2 /3\n", "line 4: corner '/3', expected v, v/vt, v//vn or v/vt/vn"},
           {start + "f 1 2 3/1/1/1\n", "line 4: corner '3/1/1/1', expected v, v/vt, v//vn or v/vt/vn"},
           {start + "curv 0 1 2\n", "line 4: unknown statement 'curv', expected one such as v, f, o or g"}}) {
    EXPECT_EQ(whyNot("a.obj", content), "a.obj: " + message);
  }
}

TEST(ReadObj, ABackslashContinuesALine) {
  const TriMesh expected = test::makeTetrahedron();
  std::string text = "v 0 0 0\nv 1 \\\n 0 0\nv 0 1 0\nv 0 0 \\\r\n1\nf 1 3 2\nf 1 \\\n2 \\\n4\nf 1 4 3\nf 2 3 4\n";
  const TriMesh mesh = test::valueOf(readAs("a.obj", text));
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_NEAR(signedVolume(mesh.vertices, mesh.triangles), signedVolume(expected.vertices, expected.triangles), 1e-12);
  // Lines are counted as in the file.
  EXPECT_EQ(whyNot("a.obj", text + "f 1 2\n"), "a.obj: line 13: a face of 2 corners, expected 3 or more");
}

TEST(ReadObj, SplitVerticesAreWeldedWhereThatClosesTheSurface) {
  std::string split;
  for (const Triangle& t : test::makeTetrahedron().triangles) {
    for (const VertexIndex v : t) {
      const Vec3 p = test::makeTetrahedron().vertices[v];
      split += "v " + std::to_string(p.x()) + " " + std::to_string(p.y()) + " " + std::to_string(p.z()) + "\n";
    }
    split += "f -3 -2 -1\n";
  }
  const auto mesh = test::valueOf(readAs("a.obj", split));
  EXPECT_EQ(mesh.vertices.size(), 4u);
  EXPECT_TRUE(checkClosedTwoManifold(mesh).ok());

  // Already closed: two boxes that touch at a corner keep their own vertices.
  const TemporaryFolder folder;
  const auto file = folder.path() / "touching.obj";
  const TriMesh touching = test::joined(test::makeBox({0, 0, 0}, {1, 1, 1}), test::makeBox({1, 1, 1}, {2, 2, 2}));
  ASSERT_TRUE(writeObjObjects(file, {{"touching", touching}}).ok());
  EXPECT_EQ(readMesh(file)->vertices.size(), 16u);
}

TEST(ReadStl, SaysWhatIsWrong) {
  const std::string facet = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n";
  for (const auto& [content, message] : std::vector<std::array<std::string, 2>>{
           {"solid a\n", "line 2: the file ends here; expected facet or endsolid"},
           {"solid\nface", "line 2: found 'face', expected facet or endsolid"},
           {facet + "vertex 0 inf 0\n", "line 6: found 'inf', expected a finite coordinate"},
           {facet + "endloop\n", "line 6: found 'endloop', expected vertex"},
           {"solid\nendsolid\nmore", "line 3: found 'more', expected solid"}}) {
    EXPECT_EQ(whyNot("a.stl", content), "a.stl: " + message);
  }
  TriMesh bad = test::makeTetrahedron();
  bad.vertices[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(whyNot("a.stl", test::binaryStl(bad)),
            "a.stl: triangle 1 (byte 170): corner 2 is (0, nan, 1), expected finite numbers");
}

std::string repeated(const std::string& line, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += fmt::format(fmt::runtime(line), i);
  return text;
}

TEST(ReadPly, SaysWhatIsWrong) {
  const std::string vertex = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string face = "element face 1\nproperty list uchar int vertex_indices\n";
  const std::string text = "ply\nformat ascii 1.0\n";
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
  for (const auto& [content, message] : std::vector<std::array<std::string, 2>>{
           {"ply\n", "line 2: the file ends here; expected end_header"},
           {"ply\nformat text 1.0\n",
            "line 2: format 'text', expected ascii, binary_little_endian or binary_big_endian"},
           {"ply\n" + vertex + face + "end_header\n", "line 8: the header has no format line"},
           {text + "property float x\n", "line 3: a property before the first element"},
           {text + "element vertex many\n", "line 3: the count of 'vertex' is 'many', expected an integer"},
           {text + "element vertex -3\n", "line 3: element vertex has a count of -3, expected 0 to 2147483647"},
           {text + "element vertex 3\nproperty real x\n", "line 4: found 'real', expected a type such as float or int"},
           {text + "element vertex 3\nproperty list float int x\n",
            "line 4: found 'float' as the type of a list's count, expected an integer type such as uchar"},
           {text + vertex + "element vertex 3\n", "line 7: a second element vertex"},
           {text + repeated("element e{} 0\n", 101), "line 103: more than 100 elements"},
           {text + vertex + repeated("property int p{}\n", 1000),
            "line 1004: more than 1000 properties of one element"},
           {text + "colour\n", "line 3: found 'colour' in the header, expected element, property or end_header"},
           {text + vertex + "end_header\n",
            "line 7: the header has no element face: triangle strips and point clouds are not supported"},
           {text + face + "end_header\n", "line 5: the header has no element vertex"},
           {text + "element vertex 3\nproperty float x\n" + face + "end_header\n",
            "line 7: element vertex has 0 properties y, expected one number"},
           {text + vertex + "element face 1\nproperty int vertex_index\nend_header\n",
            "line 9: element face has 1 properties vertex_indices or vertex_index, expected one list of integers"},
           {text + vertex + face + "end_header\n0 0 0\n1 nan 0\n",
            "line 11: y of vertex 1 is 'nan', expected a finite number"},
           {text + vertex + face + "end_header\n0 0 0 0\n",
            "line 10: found '0' after vertex 0, expected the end of the line"},
           {text + vertex + face + "end_header\n" + points + "3 0 1 3\n",
            "line 13: face 0: vertex index 3 is out of range, expected 0 to 2 (3 vertices)"},
           {text + vertex + face + "end_header\n" + points + "2 0 1\n",
            "line 13: face 0 has 2 corners, expected 3 or more"},
           {text + vertex + face + "end_header\n" + points + "3 0 1 2\n9\n",
            "line 14: found '9' after the last element, expected the end of the file"}}) {
    EXPECT_EQ(whyNot("a.ply", content), "a.ply: " + message);
  }
  const std::string little = test::binaryPly(test::makeTetrahedron(), std::endian::little);
  EXPECT_EQ(whyNot("a.ply", little + "xy"),
            "a.ply: byte " + std::to_string(little.size()) +
                ": 2 bytes are left after the last element, expected the end of the file");
}

TEST(ObjObjects, RoundTripIsExact) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "parts.obj";
  TriMesh odd = test::makeTetrahedron();
  odd.vertices[1] = {1.0 / 3.0, 1e-300, -1.7976931348623157e308};
  odd.vertices[2] = {5e-324, 0.1, -0.0};
  const std::vector<NamedMesh> objects = {
      {"first part", test::makeBox({0, 0, 0}, {1, 1, 1})}, {"second", odd}, {"third", test::makeTorus(2, 0.5, 7, 5)}};
  ASSERT_TRUE(writeObjObjects(file, objects).ok());
  const auto read = test::valueOf(readObjObjects(file));
  ASSERT_EQ(read.size(), objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    EXPECT_EQ(read[i].name, objects[i].name);
    EXPECT_EQ(read[i].mesh.vertices, objects[i].mesh.vertices);
    EXPECT_EQ(read[i].mesh.triangles, objects[i].mesh.triangles);
  }
  EXPECT_EQ(test::valueOf(readMesh(file)).vertices.size(), 8u + 4u + 35u);
}

TEST(ObjObjects, StatementsWithoutFacesAreDroppedAndSharedVerticesCopied) {
  const TemporaryFolder folder;
  const auto file =
      folder.write("shared.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\no empty\ng left\nf 2 3 4\ng\nf 4 3 1\n");
  const auto read = test::valueOf(readObjObjects(file));
  ASSERT_EQ(read.size(), 3u);
  EXPECT_EQ(read[0].name, "shared");
  EXPECT_EQ(read[1].name, "left");
  EXPECT_EQ(read[2].name, "");
  EXPECT_EQ(read[1].mesh.vertices, (std::vector<Vec3>{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_EQ(read[2].mesh.triangles, (std::vector<Triangle>{{2, 1, 0}}));
  EXPECT_EQ(readObjObjects("/nowhere/a.obj").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(writeObjObjects("/nowhere/a.obj", {}).error().code, ErrorCode::kUnwritable);
}

}  // namespace
}  // namespace lorica::test

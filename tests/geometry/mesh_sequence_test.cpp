#include "geometry/arrays/mesh_sequence.h"

#include "geometry/arrays/array_file.h"
#include "geometry/little_endian.h"
#include "geometry/mesh_files.h"
#include "geometry/new_file.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using test::errorOf;
using test::expectAll;
using test::TemporaryFolder;
using test::valueOf;

/// A mesh that swims: no two of its points move alike.
TriMesh inFrame(const TriMesh& mesh, int frame) {
  return test::moved(mesh, [&](const Vec3& p) -> Vec3 {
    return p + 0.1 * Vec3(std::sin(p.z() + 0.3 * frame), std::cos(2.0 * p.x() + 0.2 * frame), 0.01 * frame);
  });
}

/// The same surface with points, triangles and corners in another order.
TriMesh shuffled(const TriMesh& mesh, std::mt19937& random) {
  std::vector<VertexIndex> place(mesh.vertices.size());
  std::iota(place.begin(), place.end(), 0);
  std::ranges::shuffle(place, random);
  TriMesh other = mesh;
  for (std::size_t v = 0; v < place.size(); ++v) other.vertices[place[v]] = mesh.vertices[v];
  for (Triangle& t : other.triangles) {
    for (VertexIndex& v : t) v = place[v];
    std::rotate(t.begin(), t.begin() + random() % 3, t.end());
  }
  std::ranges::shuffle(other.triangles, random);
  return other;
}

std::string floats(const std::vector<Vec3>& points, std::endian order) {
  std::string bytes;
  for (const Vec3& p : points) {
    for (const double x : p) {
      std::string raw;
      appendLittleEndian(static_cast<float>(x), raw);
      if (order == std::endian::big) std::ranges::reverse(raw);
      bytes += raw;
    }
  }
  return bytes;
}

std::string whole(std::int32_t number, std::endian order) {
  std::string raw;
  appendLittleEndian(number, raw);
  if (order == std::endian::big) std::ranges::reverse(raw);
  return raw;
}

/// Points that floats hold exactly.
TriMesh rounded(TriMesh mesh) {
  return test::moved(std::move(mesh), [](const Vec3& p) -> Vec3 { return p.cast<float>().cast<double>(); });
}

NamedArray arrayOf(const std::string& name, const std::string& type, std::vector<std::size_t> shape,
                   std::string bytes) {
  return {name, type, std::move(shape), std::move(bytes)};
}

void expectFrames(const MeshSequence& sequence, const TriMesh& mesh, int frames) {
  EXPECT_EQ(sequence.triangles, mesh.triangles);
  ASSERT_EQ(sequence.frameCount(), frames);
  for (int f = 0; f < frames; ++f) {
    const TriMesh expected = rounded(inFrame(mesh, f));
    EXPECT_TRUE(std::ranges::equal(sequence.frame(f), expected.vertices)) << f;
  }
}

TEST(MeshSequence, FoldersPatternsAndListsAreReadInTheOrderOfTheirNumbers) {
  for (const char* ending : {".obj", ".OBJ"}) {
    const TemporaryFolder folder;
    const TriMesh mesh = test::makeSphere(1.0, 5, 7);
    std::vector<fs::path> files;
    for (int f = 0; f < 12; ++f) {
      files.push_back(folder.path() / fmt::format("take{}_x{}", f + 3, ending));
      ASSERT_TRUE(writeObjObjects(files.back(), {{"mesh", rounded(inFrame(mesh, f))}}).ok());
    }
    folder.write("notes.txt", "not a frame");
    folder.write(".hidden.obj", "not one either");
    const MeshSequence whole = valueOf(readMeshSequence(folder.path().string()));
    EXPECT_EQ(whole.name, folder.path().filename().string());
    EXPECT_EQ(whole.files.front(), files.front().filename());
    EXPECT_EQ(whole.files.back(), files.back().filename());
    EXPECT_TRUE(whole.notes.empty());
    expectFrames(whole, mesh, 12);
    EXPECT_EQ(valueOf(readMeshSequence(folder.path().string() + "/")).positions, whole.positions);
    const std::string all = (folder.path() / fmt::format("take*{}", ending)).string();
    ASSERT_TRUE(namesSequence(all));
    expectFrames(valueOf(readMeshSequence(all)), mesh, 12);
    expectFrames(valueOf(readMeshSequence("list", files)), mesh, 12);
    EXPECT_EQ(valueOf(readMeshSequence((folder.path() / "take1?_x*").string())).frameCount(), 5);  // 10 to 14
    int told = 0;
    EXPECT_EQ(errorOf(readMeshSequence(all, [&](int, int) { return ++told < 0; })).code, ErrorCode::kCancelled);
  }
}

TEST(MeshSequence, AnotherOrderOfPointsOrTrianglesIsMended) {
  std::mt19937 random(7);
  const TriMesh torus = test::makeTorus(1.0, 0.3, 24, 12), sphere = test::makeSphere(0.2, 6, 9);
  const TriMesh pair = test::joined(test::makeBox({-1, -1, -1}, {1, 1, 1}), test::makeBox({2, 0, 0}, {3, 1, 1}));
  for (const TriMesh& mesh : {torus, sphere, pair, test::joined(torus, sphere), test::makeLShape()}) {
    const TemporaryFolder folder;
    for (int f = 0; f < 6; ++f) {
      const TriMesh frame = rounded(inFrame(mesh, f));
      ASSERT_TRUE(writeObjObjects(folder.path() / fmt::format("{}.obj", f),
                                  {{"mesh", f % 2 == 0 ? frame : shuffled(frame, random)}})
                      .ok());
    }
    const MeshSequence sequence = valueOf(readMeshSequence(folder.path().string()));
    expectFrames(sequence, mesh, 6);
    ASSERT_EQ(sequence.notes.size(), 1u);
    EXPECT_EQ(sequence.notes[0], "3 frames had the points or triangles of 0.obj in another order");
  }
}

TEST(MeshSequence, OtherMeshesAreNamed) {
  const TriMesh mesh = test::makeSphere(1.0, 6, 8);
  TriMesh turned = mesh;
  std::swap(turned.triangles[10][0], turned.triangles[10][1]);
  TriMesh fewer = mesh;
  fewer.triangles.pop_back();
  for (const auto& [other, words] :
       {std::pair(turned, "c2.obj: its triangles join other points than those of c1.obj"),
        std::pair(fewer, "c2.obj: 42 points and 79 triangles, expected 42 and 80 as in c1.obj"),
        std::pair(test::makeSphere(1.0, 8, 6), "c2.obj: 44 points and 84 triangles, expected 42 and 80")}) {
    const TemporaryFolder folder;
    ASSERT_TRUE(writeObjObjects(folder.path() / "c1.obj", {{"mesh", mesh}}).ok());
    ASSERT_TRUE(writeObjObjects(folder.path() / "c2.obj", {{"mesh", other}}).ok());
    ASSERT_TRUE(writeObjObjects(folder.path() / "c10.obj", {{"mesh", fewer}}).ok());
    EXPECT_TRUE(test::has(errorOf(readMeshSequence(folder.path().string())).message, words));
  }
}

TEST(MeshSequence, CachesAndArraysHaveThePointsOfTheirMesh) {
  const TriMesh mesh = rounded(test::makeTorus(1.0, 0.25, 9, 5));
  const int frames = 7;
  const int points = static_cast<int>(mesh.vertices.size());
  std::vector<Vec3> all;
  for (int f = 0; f < frames; ++f) {
    const TriMesh frame = rounded(inFrame(mesh, f));
    all.insert(all.end(), frame.vertices.begin(), frame.vertices.end());
  }
  const TemporaryFolder folder;
  const fs::path path = folder.path();
  const std::string little = floats(all, std::endian::little);
  int written = 0;
  const auto write = [&](const char* ending, const std::string& bytes, bool alone = false) {
    const std::string stem = fmt::format("ring{}", ++written);
    if (!alone) {
      EXPECT_TRUE(writeObjObjects(path / (stem + ".obj"), {{"ring", mesh}}).ok());
    }
    return folder.write(stem + ending, bytes).string();
  };
  const auto le = [](std::int32_t number) { return whole(number, std::endian::little); };
  const auto be = [](std::int32_t number) { return whole(number, std::endian::big); };
  std::string start;
  for (const float f : {0.0f, 1.0f}) appendLittleEndian(f, start);
  const std::string head = std::string("POINTCACHE2\0", 12) + le(1) + le(points) + start + le(frames);
  expectFrames(valueOf(readMeshSequence(write(".pc2", head + little))), mesh, frames);
  std::string times;
  for (int f = 0; f < frames; ++f) times += floats({Vec3::Zero()}, std::endian::big).substr(0, 4);
  const std::string mdd = be(frames) + be(points) + times + floats(all, std::endian::big);
  expectFrames(valueOf(readMeshSequence(write(".mdd", mdd))), mesh, frames);

  std::string faces;
  for (const Triangle& t : mesh.triangles) {
    for (const VertexIndex v : t) faces += le(v);
  }
  const std::size_t k = frames, n = points, m = mesh.triangles.size();
  std::string rate;
  appendLittleEndian(24.0, rate);
  const NamedArray vertices = arrayOf("my_points", "<f4", {k, n, 3}, little),
                   triangles = arrayOf("tri", "<i4", {m, 3}, faces), fps = arrayOf("fps", "<f8", {}, rate);
  const auto archive = [&](const char* name, const std::vector<NamedArray>& arrays) {
    auto file = valueOf(NewFile::create(path / name));
    EXPECT_TRUE(writeArrays(arrays, *file).ok() && file->finish().ok());
    return (path / name).string();
  };
  const MeshSequence read = valueOf(readMeshSequence(archive("a.npz", {vertices, triangles, fps})));
  expectFrames(read, mesh, frames);
  EXPECT_EQ(read.framesPerSecond, 24.0);
  EXPECT_EQ(read.name, "a.npz");
  // Of several that could be meant, the usual names tell.
  const NamedArray normals = arrayOf("normals", "<f4", {k, n, 3}, little);
  EXPECT_TRUE(test::has(errorOf(readMeshSequence(archive("b.npz", {vertices, normals, triangles}))).message,
                        "my_points (7, 45, 3), normals (7, 45, 3), tri (90, 3), expected one array of points"));
  const NamedArray named = arrayOf("Vertices", "<f4", {k, n, 3}, little);
  expectFrames(valueOf(readMeshSequence(archive("c.npz", {normals, named, triangles}))), mesh, frames);

  // What is damaged is named.
  NamedArray outside = triangles;
  outside.bytes.replace(4, 4, le(points));
  const std::string nan = little.substr(0, little.size() - 8) + std::string("\0\0\xc0\x7f", 4) + little.substr(0, 4);
  for (const auto& [file, words] : std::vector<std::pair<std::string, std::string>>{
           {archive("d.npz", {vertices, outside}), "triangle 0: found point 45, expected 0 to 44"},
           {archive("e.npz", {vertices}), "expected one array of whole numbers (triangles, 3)"},
           {write(".pc2", head + little.substr(4)), "found 3776 bytes of points, expected 3780 for 7 frames of 45"},
           {write(".pc2", head + nan), "frame 6, point 44: found ("},
           {write(".pc2", "POINTCACHE2"), "does not begin as a point cache does"},
           {write(".pc2", head.substr(0, 16) + le(points - 1) + head.substr(20) + little), "expected 3696 for"},
           {write(".pc2", head.substr(0, 28) + le(2'000'000'000) + little), "at most 20,000,000 points"},
           {write(".pc2", head.substr(0, 28) + le(-1) + little), "found 0 frames of 45 points"},
           {write(".mdd", mdd.substr(0, 20)), "ends before the times of 7 frames"},
           {write(".mdd", be(frames) + be(points - 1) + times +
                              floats({all.begin(), all.begin() + (points - 1) * frames}, std::endian::big)),
            "44 points in a frame, expected 45 as in ring"},
           {write(".mdd", mdd, true), "has points alone, expected their mesh beside it"},
           {(path / "cloth.abc").string(), "Alembic is not read: open it in Blender"},
           {(path / "scene.usdc").string(), "USD is not read"},
           {(path / "none*.obj").string(), "no mesh has such a name"}}) {
    EXPECT_TRUE(namesSequence(file)) << file;
    EXPECT_TRUE(test::has(errorOf(readMeshSequence(file)).message, words));
  }
}

/// Files split points at seams. Those that part later stay two.
TEST(MeshSequence, PointsThatAreEqualInEveryFrameAreOne) {
  const TriMesh mesh = rounded(test::makeSphere(1.0, 5, 6));
  for (const bool parts : {false, true}) {
    MeshSequence sequence;
    for (int f = 0; f < 4; ++f) {
      const TriMesh frame = inFrame(mesh, f);
      VertexIndex next = 0;
      for (const Triangle& t : frame.triangles) {
        for (const VertexIndex v : t) sequence.positions.push_back(frame.vertices[v]);
        if (f == 0) sequence.triangles.push_back({next, next + 1, next + 2});
        next += 3;
      }
      sequence.vertexCount = next;
    }
    if (parts) sequence.positions.back() += Vec3(0.0, 0.0, 1.0);
    const MeshSequence welded = valueOf(checkedSequence(sequence));
    EXPECT_EQ(welded.triangles.size(), mesh.triangles.size());
    EXPECT_EQ(welded.vertexCount, static_cast<int>(mesh.vertices.size()) + (parts ? 1 : 0));
    EXPECT_EQ(openEdgeCount({std::vector<Vec3>(welded.vertexCount), welded.triangles}), parts ? 4u : 0u);
    for (int f = 0; f < 4; ++f) {
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (int c = 0; c < 3; ++c) {
          EXPECT_EQ(welded.frame(f)[welded.triangles[t][c]], sequence.frame(f)[3 * t + c]);
        }
      }
    }
  }
}

}  // namespace
}  // namespace lorica

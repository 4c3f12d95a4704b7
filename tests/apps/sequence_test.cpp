#include "geometry/arrays/array_file.h"
#include "geometry/arrays/mesh_sequence.h"
#include "geometry/convex_hull.h"
#include "geometry/little_endian.h"
#include "geometry/mesh_files.h"
#include "geometry/new_file.h"
#include "skinning/import/character_file.h"
#include "tests/apps/mesh_text.h"
#include "tests/apps/refusals.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

/// A ring that swims: a wave runs around it, and its tube breathes.
TriMesh swimming(int frame, double wave = 0.4) {
  return moved(makeTorus(1.0, 0.25, 24, 10), [&](const Vec3& p) -> Vec3 {
    const double angle = std::atan2(p.z(), p.x());
    return Vec3(p.x(), p.y() * (1.0 + 0.2 * std::sin(0.5 * frame)), p.z()) +
           wave * std::sin(2.0 * angle + 0.5 * frame) * Vec3::UnitY();
  });
}

/// Frames in a folder. @return the folder
fs::path writeFrames(const TemporaryFolder& folder, const std::string& name, int frames,
                     const std::function<TriMesh(int)>& meshOf) {
  fs::create_directory(folder.path() / name);
  for (int f = 0; f < frames; ++f) (void)writeObj(folder, fmt::format("{}/ring_{}.obj", name, f + 8), meshOf(f));
  return folder.path() / name;
}

/// The same frames as arrays.
std::string writeArchive(const TemporaryFolder& folder, const std::string& name, int frames,
                         const std::function<TriMesh(int)>& meshOf) {
  NamedArray vertices{"vertices", "<f8", {}, {}}, faces{"faces", "<i4", {}, {}};
  const TriMesh first = meshOf(0);
  vertices.shape = {static_cast<std::size_t>(frames), first.vertices.size(), 3};
  faces.shape = {first.triangles.size(), 3};
  for (int f = 0; f < frames; ++f) {
    for (const Vec3& p : meshOf(f).vertices) {
      for (const double x : p) appendLittleEndian(x, vertices.bytes);
    }
  }
  for (const Triangle& t : first.triangles) {
    for (const VertexIndex v : t) appendLittleEndian(v, faces.bytes);
  }
  auto file = valueOf(NewFile::create(folder.path() / name));
  EXPECT_TRUE(writeArrays(std::vector{vertices, faces}, *file).ok() && file->finish().ok());
  return folder.path() / name;
}

/// The hulls of a .npz that the command wrote: of each frame, of each part.
std::vector<std::vector<TriMesh>> hullsIn(const fs::path& file) {
  std::map<std::string, NamedArray> arrays;
  for (NamedArray& array : valueOf(readArrays(file))) arrays.emplace(array.name, std::move(array));
  const auto numbers = [&](const char* name) { return valueOf(numbersOf(arrays.at(name))); };
  const std::vector<double> vertices = numbers("vertices"), faces = numbers("faces"),
                            vertexCounts = numbers("vertex_counts"), faceCounts = numbers("face_counts");
  const std::vector<std::size_t> shape = arrays.at("vertex_counts").shape;
  std::vector<std::vector<TriMesh>> hulls(shape[0], std::vector<TriMesh>(shape[1]));
  std::size_t vertex = 0, face = 0, index = 0;
  for (std::vector<TriMesh>& frame : hulls) {
    for (TriMesh& hull : frame) {
      for (int v = 0; v < vertexCounts[index]; ++v, vertex += 3) hull.vertices.emplace_back(&vertices[vertex]);
      for (int t = 0; t < faceCounts[index]; ++t, face += 3) {
        const auto corner = [&](std::size_t c) { return static_cast<VertexIndex>(faces[face + c]); };
        hull.triangles.push_back({corner(0), corner(1), corner(2)});
      }
      ++index;
    }
  }
  return hulls;
}

/// How far a point is outside of all hulls.
double outside(const std::vector<TriMesh>& hulls, const Vec3& p) {
  double nearest = 1e9;
  for (const TriMesh& hull : hulls) {
    double farthest = -1e9;
    for (const Triangle& t : hull.triangles) {
      const Vec3 normal = areaNormal(hull.vertices, t);
      if (normal.norm() < 1e-9) continue;  // a sliver between others
      farthest = std::max(farthest, normal.dot(p - hull.vertices[t[0]]) / normal.norm());
    }
    nearest = std::min(nearest, farthest);
  }
  return nearest;
}

constexpr int kFrames = 20;

TEST(Sequence, AFolderAndArraysGiveTheSamePartsAndHullsThatHoldEveryFrame) {
  const TemporaryFolder folder;
  const auto ring = [](int f) { return swimming(f); };
  const fs::path frames = writeFrames(folder, "frames", kFrames, ring);
  const fs::path out = folder.path() / "hulls.npz", csv = folder.path() / "frames.csv";
  const nlohmann::json json = jsonOf({"decompose", frames, "--parts", "7", "--export-frames", out, "--csv", csv});
  EXPECT_EQ(json["parts"], 7);
  EXPECT_EQ(json["frames"], kFrames);
  EXPECT_EQ(json["unseenFrames"].get<int>() + json["keyframes"].get<int>(), kFrames);
  EXPECT_LT(json["unseenError"].get<double>(), 0.5);
  const std::string archive = writeArchive(folder, "ring.npz", kFrames, ring);
  EXPECT_EQ(jsonOf({"decompose", archive, "--parts", "7", "--threads", "1"})["hash"], json["hash"]);
  std::vector<std::string> listed = {"decompose"};
  for (int f = 0; f < kFrames; ++f) listed.push_back(frames / fmt::format("ring_{}.obj", f + 8));
  listed.insert(listed.end(), {"--parts", "7"});
  EXPECT_EQ(jsonOf(listed)["hash"], json["hash"]);

  const std::vector<std::vector<TriMesh>> hulls = hullsIn(out);
  ASSERT_EQ(hulls.size(), static_cast<std::size_t>(kFrames));
  double sum = 0.0;
  for (int f = 0; f < kFrames; ++f) {
    ASSERT_EQ(hulls[f].size(), 7u);
    const TriMesh mesh = swimming(f);
    double volume = 0.0;
    for (const TriMesh& hull : hulls[f]) volume += signedVolume(hull.vertices, hull.triangles);
    for (const Vec3& p : mesh.vertices) EXPECT_LT(outside(hulls[f], p), 1e-6) << f;
    const double own = signedVolume(mesh.vertices, mesh.triangles);
    EXPECT_NEAR(json["frameHullVolumes"][f].get<double>(), volume, 1e-6);
    EXPECT_NEAR(json["frameMeshVolumes"][f].get<double>(), own, 1e-6);
    EXPECT_NEAR(json["frameErrors"][f].get<double>(), volume / own - 1.0, 1e-5);
    EXPECT_NEAR(json["frameScores"][f].get<double>(), own / volume, 1e-5);
    sum += volume / own - 1.0;
  }
  EXPECT_NEAR(json["frameError"].get<double>(), sum / kFrames, 1e-5);
  const std::string table = valueOf(readFile(csv));
  EXPECT_EQ(std::ranges::count(table, '\n'), kFrames + 1);
  EXPECT_TRUE(table.starts_with("frame,time,mesh_volume,hull_volume,error,score\n0,0,")) << table.substr(0, 80);
}

TEST(Sequence, HullsOfFramesAreTheSameInEveryFormat) {
  const TemporaryFolder folder;
  const fs::path frames = writeFrames(folder, "frames", 6, [](int f) { return swimming(f); });
  std::map<std::string, nlohmann::json> told;
  for (const char* ending : {"npz", "obj", "pc2", "glb"}) {
    told[ending] = jsonOf({"decompose", frames, "--parts", "5", "--keyframes", "2", "--export-frames",
                           folder.path() / fmt::format("hulls.{}", ending)});
  }
  const std::vector<std::vector<TriMesh>> hulls = hullsIn(folder.path() / "hulls.npz");
  const MeshSequence cache = valueOf(readMeshSequence((folder.path() / "hulls.pc2").string()));
  std::vector<std::size_t> counts;  // of the points of each part, whether the first frame uses them or not
  std::istringstream fixed(valueOf(readFile(folder.path() / "hulls.obj")));
  for (std::string line; std::getline(fixed, line);) {
    if (line.starts_with("o ")) counts.push_back(0);
    if (line.starts_with("v ")) ++counts.back();
  }
  ASSERT_EQ(cache.frameCount(), 6);
  ASSERT_EQ(counts.size(), 5u);
  for (int f = 0; f < 6; ++f) {
    const std::vector<NamedMesh> objects =
        valueOf(readObjObjects(folder.path() / fmt::format("hulls_{:04}.obj", f + 1)));
    ASSERT_EQ(objects.size(), 5u);
    std::size_t at = 0;
    for (std::size_t p = 0; p < 5; ++p) {
      const double volume = signedVolume(hulls[f][p].vertices, hulls[f][p].triangles);
      EXPECT_NEAR(signedVolume(objects[p].mesh.vertices, objects[p].mesh.triangles), volume, 1e-9);
      EXPECT_NEAR(convexHull(cache.frame(f).subspan(at, counts[p])).volume, volume, 1e-5);
      at += counts[p];
    }
  }
  // As the command reads it again: the same parts, which move.
  EXPECT_TRUE(told["glb"]["exportFrames"].is_string());
  const CharacterFile played = valueOf(readCharacterFile(folder.path() / "hulls.glb"));
  EXPECT_EQ(played.meshes, 5);
  ASSERT_EQ(played.clips.size(), 1u);
  EXPECT_NEAR(played.clips[0].seconds, 5.0 / 30.0, 1e-6);
}

TEST(Sequence, WhatMovesRigidlyIsMovedByNodes) {
  const TemporaryFolder folder;
  const auto tumbling = [](int f) {
    const Isometry3 turn = Eigen::Translation3d(0.1 * f, 0.0, 0.0) * Eigen::AngleAxisd(0.3 * f, Vec3::UnitZ());
    return moved(makeLShape(), [&](const Vec3& p) -> Vec3 { return turn * p; });
  };
  const fs::path frames = writeFrames(folder, "l", 8, tumbling);
  const CommandResult result =
      runLorica({"decompose", frames, "--exact", "--export-frames", folder.path() / "l.glb", "--keyframes", "3"});
  EXPECT_EQ(result.exitCode, 0) << result.err;
  EXPECT_TRUE(has(result.out, "2 parts moved by a node, 0 by morph targets"));
}

TEST(Sequence, PartsOfOneAreUsedOnAnotherWithTheSameTriangles) {
  const TemporaryFolder folder;
  const fs::path one = writeFrames(folder, "one", 8, [](int f) { return swimming(f); }),
                 other = writeFrames(folder, "other", 8, [](int f) { return swimming(2 * f, 0.15); }),
                 box = writeFrames(folder, "box", 3, [](int f) { return makeBox(Vec3::Zero(), Vec3(1, 1, 1 + f)); });
  const fs::path parts = folder.path() / "one.lorica";
  const nlohmann::json made = jsonOf({"decompose", one, "--parts", "6", "-o", parts});
  const nlohmann::json carried = jsonOf({"decompose", other, "--decomposition", parts});
  const nlohmann::json own = jsonOf({"decompose", other, "--parts", "6"});
  EXPECT_EQ(carried["hash"], made["hash"]);
  EXPECT_NE(own["hash"], made["hash"]);
  EXPECT_NEAR(carried["errorAnew"].get<double>(), own["error"].get<double>(), 1e-12);
  EXPECT_GT(carried["error"].get<double>(), 0.0);
  expectRefused(runLorica({"decompose", box, "--decomposition", parts}), {"one.lorica"});
}

TEST(Sequence, EveryFrameIsScored) {
  const TemporaryFolder folder;
  const fs::path frames = writeFrames(folder, "frames", 6, [](int f) { return swimming(f); });
  const fs::path parts = folder.path() / "ring.lorica", csv = folder.path() / "scores.csv";
  const nlohmann::json made = jsonOf({"decompose", frames, "--parts", "6", "--keyframes", "2", "-o", parts,
                                      "--export-frames", folder.path() / "hulls.obj"});
  const nlohmann::json own = jsonOf({"score", frames, parts, "--csv", csv});
  const nlohmann::json others = jsonOf({"score", frames, folder.path() / "hulls_*.obj"});
  EXPECT_EQ(own["frames"], 6);
  EXPECT_EQ(own["parts"], 6);
  for (int f = 0; f < 6; ++f) {
    EXPECT_NEAR(own["score17PerFrame"][f].get<double>(),
                made["frameMeshVolumes"][f].get<double>() / made["frameHullVolumes"][f].get<double>(), 1e-9);
    EXPECT_NEAR(own["score16PerFrame"][f].get<double>(), own["score17PerFrame"][f].get<double>(), 0.01)
        << "hulls cover";
    EXPECT_NEAR(others["score17PerFrame"][f].get<double>(), own["score17PerFrame"][f].get<double>(), 1e-9);
  }
  const std::string table = valueOf(readFile(csv));
  EXPECT_EQ(std::ranges::count(table, '\n'), 7);
  EXPECT_EQ(jsonOf({"score", frames, parts, "--every", "4"})["frames"], 2);
  fs::remove(folder.path() / "hulls_0003.obj");
  expectRefused(runLorica({"score", frames, folder.path() / "hulls_*.obj"}),
                {"5 files, expected 6, one for each frame"});
  expectRefused(runLorica({"score", frames / "ring_8.obj", folder.path() / "hulls_0001.obj", "--every", "2"}),
                {"--every"});
}

TEST(Sequence, IsPlayedAndDescribed) {
  const TemporaryFolder folder;
  const fs::path frames = writeFrames(folder, "frames", 12, [](int f) { return swimming(f); });
  const CommandResult info = runLorica({"info", frames});
  EXPECT_EQ(info.exitCode, 0) << info.err;
  EXPECT_TRUE(has(info.out, "mesh sequence"));
  const nlohmann::json played = jsonOf({"play", frames, "--headless"});
  EXPECT_GE(played["frames"].get<int>(), 12);
  const fs::path picture = folder.path() / "ring.png";
  const CommandResult drawn = runLorica({"snapshot", frames, "--at", "0.2", "-o", picture});
  EXPECT_EQ(drawn.exitCode, 0) << drawn.err;
  EXPECT_TRUE(fs::exists(picture));
}

TEST(Sequence, WhatCannotBeDoneIsSaid) {
  const TemporaryFolder folder;
  const fs::path frames = writeFrames(folder, "frames", 3, [](int f) { return swimming(f); });
  const std::string box = writeObj(folder, "box.obj", makeBox(Vec3::Zero(), Vec3::Ones()));
  const std::string first = frames / "ring_8.obj";
  expectRefused(folder, {"decompose", first, box},
                {"box.obj: 8 points and 12 triangles", "several files are one mesh"});
  expectRefused(folder, {"decompose", "frames", "--export-frames", "x.gif"}, {"expected .obj, .npz, .pc2 or .glb"});
  expectRefused(folder, {"decompose", "box.obj", "--csv", "x.csv"}, {"--csv is for what moves"});
  expectRefused(folder, {"decompose", "frames", "--hull-vertices", "16", "--csv", "x.csv"}, {"exact"});
  expectRefused(folder, {"decompose", "frames", "--keyframes", "4"}, {"at most 3"});
  expectRefused(folder, {"decompose", "frames/*.ply"}, {"no mesh has such a name"});
  expectRefused(folder, {"decompose", "dance.usda"}, {"USD is not read"});
  for (const char* out : {"x.glb", "x.xml", "x.urdf"}) {
    expectRefused(folder, {"export", "frames", out}, {"whose hulls bend", "decompose frames --export-frames"});
  }
}

}  // namespace
}  // namespace lorica::test

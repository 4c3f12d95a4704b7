#include "acd/decomposition_file.h"

#include "acd/decompose.h"
#include "geometry/files.h"
#include "geometry/little_endian.h"
#include "tests/support/allocations.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace lorica {
namespace {

using test::TemporaryFolder;

/// Two parts of an L-shape, made by hand, with an artificial cut point; without optional content.
DecompositionFile sampleWithoutLevels() {
  DecompositionFile content;
  content.source = "l-shape.off";
  content.meshHash = topologyHash(test::makeLShape());
  content.meanError = 0.125;
  content.errorPerKeyframe = {0.0, 0.25};
  Decomposition& d = content.decomposition;
  d.vertexCount = 12;
  d.triangleCount = 20;
  d.cutPoints = {{3, 0, 0.25}, {12, 9, 1.0}};
  d.splitFrom = {0};
  d.parts.resize(2);
  d.parts[0] = {{{0, 1, 12}, {1, 13, 12}, {13, 0, 12}}, {0, 19, -1}, {0, 1, 12, 13}};
  d.parts[1] = {{{11, 2, 3}}, {7}, {2, 3, 11}};
  return content;
}

/// The same with levels of detail and bones.
DecompositionFile sampleWithoutTraining() {
  DecompositionFile content = sampleWithoutLevels();
  content.detailLevels = {{0.5, 0.75, 10}, {0.125, 0.25, 14}};
  content.bonesOfPart = {{{"hips", 0.75}, {"spine", 0.25}}, {{"spine", 1.0}}};
  return content;
}

/// The same with everything that a file can contain.
DecompositionFile sample() {
  DecompositionFile content = sampleWithoutTraining();
  content.training = TrainingRange{};
  content.training->probes = {13, 0, 3};
  content.training->keyframeCount = 2;
  content.training->positions = {{0, 0, 1}, {0, 0.5, -1}, {0, -0.5, 0}, {0.25, 0, 1}, {-0.25, 0.5, -1}, {0, -0.5, 0}};
  content.training->knownDistance = 0.125;
  content.cover = HullCover{};
  content.cover->tolerance = 0.01;
  content.cover->maxHullVertices = 64;
  content.cover->points = {{{12, {0.0, 0.5, -0.25}}, {0, {0, 0, 0}}, {12, {1e-3, 0, 0}}}, {{3, {0, 0, 0}}}};
  content.cover->sampledPoses = 2000;
  content.cover->heldOutPoses = 500;
  content.cover->growth = 0.6;
  content.cover->sampledShortfall = 0.004;
  content.cover->heldOutShortfall = 0.0;
  return content;
}

void expectEqual(const TrainingRange& a, const TrainingRange& b) {
  EXPECT_EQ(a.probes, b.probes);
  EXPECT_EQ(a.keyframeCount, b.keyframeCount);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.knownDistance, b.knownDistance);
}

void expectEqual(const HullCover& a, const HullCover& b) {
  EXPECT_EQ(a.tolerance, b.tolerance);
  EXPECT_EQ(a.maxHullVertices, b.maxHullVertices);
  EXPECT_EQ(a.sampledPoses, b.sampledPoses);
  EXPECT_EQ(a.heldOutPoses, b.heldOutPoses);
  EXPECT_EQ(a.growth, b.growth);
  EXPECT_EQ(a.sampledShortfall, b.sampledShortfall);
  EXPECT_EQ(a.heldOutShortfall, b.heldOutShortfall);
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    ASSERT_EQ(a.points[i].size(), b.points[i].size());
    for (std::size_t k = 0; k < a.points[i].size(); ++k) {
      EXPECT_EQ(a.points[i][k].point, b.points[i][k].point);
      EXPECT_EQ(a.points[i][k].outward, b.points[i][k].outward);
    }
  }
}

void expectEqual(const DecompositionFile& a, const DecompositionFile& b) {
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.meshHash, b.meshHash);
  EXPECT_EQ(a.meanError, b.meanError);
  EXPECT_EQ(a.errorPerKeyframe, b.errorPerKeyframe);
  const Decomposition& c = a.decomposition;
  const Decomposition& d = b.decomposition;
  EXPECT_EQ(c.vertexCount, d.vertexCount);
  EXPECT_EQ(c.triangleCount, d.triangleCount);
  ASSERT_EQ(c.cutPoints.size(), d.cutPoints.size());
  for (std::size_t i = 0; i < c.cutPoints.size(); ++i) {
    EXPECT_EQ(c.cutPoints[i].first, d.cutPoints[i].first);
    EXPECT_EQ(c.cutPoints[i].second, d.cutPoints[i].second);
    EXPECT_EQ(c.cutPoints[i].lambda, d.cutPoints[i].lambda);
  }
  EXPECT_EQ(c.splitFrom, d.splitFrom);
  ASSERT_EQ(c.parts.size(), d.parts.size());
  for (std::size_t i = 0; i < c.parts.size(); ++i) {
    EXPECT_EQ(c.parts[i].triangles, d.parts[i].triangles);
    EXPECT_EQ(c.parts[i].sourceTriangle, d.parts[i].sourceTriangle);
    EXPECT_EQ(c.parts[i].points, d.parts[i].points);
  }
  EXPECT_EQ(hashOf(c), hashOf(d));
  ASSERT_EQ(a.detailLevels.size(), b.detailLevels.size());
  for (std::size_t i = 0; i < a.detailLevels.size(); ++i) {
    EXPECT_EQ(a.detailLevels[i].meanError, b.detailLevels[i].meanError);
    EXPECT_EQ(a.detailLevels[i].worstError, b.detailLevels[i].worstError);
    EXPECT_EQ(a.detailLevels[i].hullVertices, b.detailLevels[i].hullVertices);
  }
  ASSERT_EQ(a.bonesOfPart.size(), b.bonesOfPart.size());
  for (std::size_t i = 0; i < a.bonesOfPart.size(); ++i) {
    ASSERT_EQ(a.bonesOfPart[i].size(), b.bonesOfPart[i].size());
    for (std::size_t k = 0; k < a.bonesOfPart[i].size(); ++k) {
      EXPECT_EQ(a.bonesOfPart[i][k].bone, b.bonesOfPart[i][k].bone);
      EXPECT_EQ(a.bonesOfPart[i][k].share, b.bonesOfPart[i][k].share);
    }
  }
  ASSERT_EQ(a.training.has_value(), b.training.has_value());
  if (a.training) expectEqual(*a.training, *b.training);
  ASSERT_EQ(a.cover.has_value(), b.cover.has_value());
  if (a.cover) expectEqual(*a.cover, *b.cover);
}

std::filesystem::path keptFile() {
  return test::recordingsFolder().parent_path() / "tests" / "data" / "decomposition.lorica";
}

/// The bytes of a file with the header corrected for a payload that a test has changed.
std::string resealed(std::string bytes) {
  const std::string payload = bytes.substr(28);
  const auto version = loadLittleEndian<std::uint32_t>(bytes.data() + 8);
  bytes.resize(12);
  appendLittleEndian(static_cast<std::uint64_t>(payload.size()), bytes);
  appendLittleEndian(contentHash(payload, version), bytes);
  return bytes + payload;
}

/// Bytes as written.
std::string bytesOf(const DecompositionFile& content) {
  const TemporaryFolder folder;
  EXPECT_TRUE(writeDecomposition(folder.path() / "a.lorica", content).ok());
  return *readFile(folder.path() / "a.lorica");
}
std::string sampleBytes() {
  return bytesOf(sample());
}

/// The error message of readDecomposition() without the folder; empty on success.
std::string whyNot(const std::string& bytes) {
  static const TemporaryFolder folder;
  const test::AllocationWatch watch;
  const auto read = readDecomposition(folder.write("a.lorica", bytes));
  EXPECT_LT(watch.largest(), 100'000u);
  if (read.ok()) return "";
  return read.error().message.substr(folder.path().string().size() + 1);
}

TEST(HashOf, EveryFieldCounts) {
  const Decomposition original = sample().decomposition;
  std::vector<Decomposition> changed(12, original);
  changed[0].vertexCount++;
  changed[1].triangleCount++;
  changed[2].cutPoints[1].first--;
  changed[3].cutPoints[1].second--;
  changed[4].cutPoints[0].lambda = std::nextafter(0.25, 1.0);
  changed[5].splitFrom[0]++;
  changed[6].parts[1].triangles[0][2]--;
  changed[7].parts[0].sourceTriangle[2] = 0;
  changed[8].parts[0].points.pop_back();
  std::swap(changed[9].parts[0], changed[9].parts[1]);
  changed[10].parts.pop_back();
  changed[11].cutPoints.pop_back();
  std::vector<std::uint64_t> hashes = {hashOf(original), hashOf(Decomposition{})};
  for (const Decomposition& d : changed) hashes.push_back(hashOf(d));
  std::sort(hashes.begin(), hashes.end());
  EXPECT_EQ(std::unique(hashes.begin(), hashes.end()), hashes.end());
  EXPECT_EQ(hashOf(sample().decomposition), hashOf(original));
}

TEST(TopologyHash, PositionsDoNotCountButTrianglesAndVertexCountDo) {
  TriMesh mesh = test::makeLShape();
  const std::uint64_t hash = topologyHash(mesh);
  for (Vec3& p : mesh.vertices) p *= 2.0;
  EXPECT_EQ(topologyHash(mesh), hash);
  mesh.vertices.emplace_back(0, 0, 0);
  EXPECT_NE(topologyHash(mesh), hash);
  mesh.vertices.pop_back();
  std::swap(mesh.triangles[0], mesh.triangles[1]);
  EXPECT_NE(topologyHash(mesh), hash);
}

TEST(DecompositionFile, RoundTripIsExact) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.lorica";
  ASSERT_TRUE(writeDecomposition(file, sample()).ok());
  const auto read = readDecomposition(file);
  ASSERT_TRUE(read.ok()) << read.error().message;
  expectEqual(*read, sample());
}

TEST(DecompositionFile, WhatIsNotKnownStaysSo) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.lorica";
  ASSERT_TRUE(writeDecomposition(file, sampleWithoutLevels()).ok());
  const auto read = readDecomposition(file);
  ASSERT_TRUE(read.ok()) << read.error().message;
  expectEqual(*read, sampleWithoutLevels());
}

TEST(DecompositionFile, CoverPointsThatStayOnTheSurfaceTakeOneOrTwoBytesEach) {
  const TriMesh torus = test::makeTorus(2.0, 0.5, 60, 40);
  DecompositionFile content;
  Decomposition& d = content.decomposition;
  d.vertexCount = static_cast<int>(torus.vertices.size());
  d.triangleCount = static_cast<int>(torus.triangles.size());
  d.parts.resize(1);
  d.parts[0].triangles = torus.triangles;
  d.parts[0].sourceTriangle.assign(torus.triangles.size(), 0);
  for (PointIndex p = 0; p < d.vertexCount; ++p) d.parts[0].points.push_back(p);
  const TemporaryFolder folder;
  const auto sizeOf = [&] {
    const auto file = folder.path() / "torus.lorica";
    EXPECT_TRUE(writeDecomposition(file, content).ok());
    const auto read = readDecomposition(file);
    EXPECT_TRUE(read.ok());
    expectEqual(*read, content);
    return std::filesystem::file_size(file);
  };
  const std::uintmax_t without = sizeOf();
  content.cover = HullCover{};
  content.cover->points.resize(1);
  for (PointIndex p = 0; p < d.vertexCount; p += 3) content.cover->points[0].push_back({p, Vec3::Zero()});
  const std::size_t count = content.cover->points[0].size();
  EXPECT_LE(sizeOf(), without + 64 + count + (count + 3) / 4);
  content.cover->points[0].back().outward.x() = 0.001;
  EXPECT_GT(sizeOf(), without + 24 * count);
}

TEST(DecompositionFile, RealDecompositionSurvives) {
  const TriMesh torus = test::makeTorus(2.0, 0.5, 24, 12);
  const PoseView pose{torus.vertices, static_cast<int>(torus.vertices.size())};
  DecomposeSettings settings;
  settings.maxParts = 6;
  const auto decomposition = decompose(torus, pose, settings);
  ASSERT_TRUE(decomposition.ok()) << decomposition.error().message;
  const DecompositionFile content{*decomposition,
                                  "torus",
                                  topologyHash(torus),
                                  0.5,
                                  {0.5},
                                  detailLevels(*decomposition, torus, pose, hullsOfParts(*decomposition, pose)),
                                  {}};
  const TemporaryFolder folder;
  const auto written = writeDecomposition(folder.path() / "torus.lorica", content);
  ASSERT_TRUE(written.ok()) << written.error().message;
  const auto read = readDecomposition(folder.path() / "torus.lorica");
  ASSERT_TRUE(read.ok()) << read.error().message;
  expectEqual(*read, content);
  // Compact: without packing it would be 16 bytes per triangle and 16 per cut point.
  std::size_t unpacked = 16 * decomposition->cutPoints.size();
  for (const Part& part : decomposition->parts) unpacked += 16 * part.triangles.size();
  EXPECT_LT(std::filesystem::file_size(folder.path() / "torus.lorica"), unpacked / 2);
}

TEST(DecompositionFile, PointsBeyond65536Survive) {
  // One part with the whole mesh: packed numbers of one to three bytes.
  const TriMesh torus = test::makeTorus(2.0, 0.5, 300, 230);
  DecompositionFile content;
  Decomposition& d = content.decomposition;
  d.vertexCount = static_cast<int>(torus.vertices.size());
  d.triangleCount = static_cast<int>(torus.triangles.size());
  d.parts.resize(1);
  d.parts[0].triangles = torus.triangles;
  for (int i = d.triangleCount - 1; i >= 0; --i) d.parts[0].sourceTriangle.push_back(i);
  for (PointIndex p = 0; p < d.vertexCount; ++p) d.parts[0].points.push_back(p);
  const TemporaryFolder folder;
  ASSERT_TRUE(writeDecomposition(folder.path() / "torus.lorica", content).ok());
  const auto read = readDecomposition(folder.path() / "torus.lorica");
  ASSERT_TRUE(read.ok()) << read.error().message;
  expectEqual(*read, content);
}

/// The same with vertices in the cover that belong to no part.
DecompositionFile sampleWithAttachedVertices() {
  DecompositionFile content = sample();
  content.cover->points[0].push_back({5, {0.0, 0.0, 0.125}});
  content.cover->points[1].push_back({10, {0, 0, 0}});
  return content;
}

TEST(DecompositionFile, TheKeptFileIsReadAndWrittenByteForByte) {
  const auto read = readDecomposition(keptFile());
  ASSERT_TRUE(read.ok()) << read.error().message;
  expectEqual(*read, sampleWithAttachedVertices());
  EXPECT_EQ(hexDigits(hashOf(read->decomposition)), "2020c6e2fc966fc6");
  // Different bytes for the same content would require a new format version.
  EXPECT_EQ(bytesOf(sampleWithAttachedVertices()), *readFile(keptFile()));
}

/// Checks the properties of a training range that code relies on after reading.
void expectUsable(const TrainingRange& training, const Decomposition& d) {
  ASSERT_TRUE(!training.probes.empty() && training.probes.size() <= kMaxProbes);
  const std::set<PointIndex> probes(training.probes.begin(), training.probes.end());
  ASSERT_EQ(probes.size(), training.probes.size());
  ASSERT_TRUE(*probes.begin() >= 0 && *probes.rbegin() < d.pointCount());
  ASSERT_GE(training.keyframeCount, 1);
  ASSERT_EQ(training.positions.size(), static_cast<std::size_t>(training.keyframeCount) * training.probes.size());
  for (const Vec3& p : training.positions) ASSERT_TRUE(p.allFinite());
  ASSERT_TRUE(std::isfinite(training.knownDistance) && training.knownDistance >= 0.0);
}

/// Checks the properties of a cover that code relies on after reading.
void expectUsable(const HullCover& cover, const Decomposition& d) {
  for (const double value : {cover.tolerance, cover.growth, cover.sampledShortfall, cover.heldOutShortfall}) {
    ASSERT_TRUE(std::isfinite(value) && value >= 0.0);
  }
  ASSERT_TRUE(cover.maxHullVertices >= 0 && cover.sampledPoses >= 0 && cover.heldOutPoses >= 0);
  ASSERT_EQ(cover.points.size(), d.parts.size());
  for (std::size_t i = 0; i < d.parts.size(); ++i) {
    const std::vector<PointIndex>& own = d.parts[i].points;
    for (const CoverPoint& point : cover.points[i]) {
      const bool ofNone = std::none_of(d.parts.begin(), d.parts.end(), [&](const Part& part) {
        return std::binary_search(part.points.begin(), part.points.end(), point.point);
      });
      ASSERT_TRUE(std::binary_search(own.begin(), own.end(), point.point) ||
                  (ofNone && point.point >= 0 && point.point < d.vertexCount));
      ASSERT_TRUE(point.outward.allFinite());
    }
  }
}

class KeptFile : public testing::Test {
 protected:
  const std::string bytes = *readFile(keptFile());
};

TEST_F(KeptFile, EveryDamagedByteIsRefused) {
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const int flip : {0x01, 0x80, 0xFF}) {
      std::string damaged = bytes;
      damaged[at] = static_cast<char>(damaged[at] ^ flip);
      EXPECT_NE(whyNot(damaged), "") << "byte " << at;
    }
  }
}

TEST_F(KeptFile, EveryTruncatedPrefixAndEveryExtensionIsRefused) {
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_NE(whyNot(bytes.substr(0, length)), "") << length;
    // Even if the header is made consistent.
    if (length >= 28) {
      EXPECT_NE(whyNot(resealed(bytes.substr(0, length))).find("a.lorica: byte "), std::string::npos);
    }
  }
  EXPECT_NE(whyNot(bytes + '\0'), "");
  EXPECT_EQ(whyNot(resealed(bytes + "xyz")),
            "a.lorica: byte " + std::to_string(bytes.size()) + ": 3 bytes are left after the end");
}

TEST_F(KeptFile, DamageUnderAFittingChecksumIsRefusedOrHarmless) {
  const TemporaryFolder folder;
  for (std::size_t at = 28; at < bytes.size(); ++at) {
    for (const int flip : {0x01, 0x80, 0xFF}) {
      std::string damaged = bytes;
      damaged[at] = static_cast<char>(damaged[at] ^ flip);
      const auto file = folder.write("a.lorica", resealed(damaged));
      const test::AllocationWatch watch;
      const auto read = readDecomposition(file);
      EXPECT_LT(watch.largest(), 100'000u);
      if (!read.ok()) continue;
      const Decomposition& d = read->decomposition;
      ASSERT_EQ(d.parts.size(), d.splitFrom.size() + 1);
      for (std::size_t i = 0; i < d.cutPoints.size(); ++i) {
        ASSERT_LT(std::max(d.cutPoints[i].first, d.cutPoints[i].second), d.vertexCount + static_cast<int>(i));
        ASSERT_GE(std::min(d.cutPoints[i].first, d.cutPoints[i].second), 0);
        ASSERT_TRUE(d.cutPoints[i].lambda >= 0.0 && d.cutPoints[i].lambda <= 1.0);
      }
      for (const Part& part : d.parts) {
        ASSERT_EQ(part.sourceTriangle.size(), part.triangles.size());
        for (const PointIndex p : part.points) ASSERT_TRUE(p >= 0 && p < d.pointCount());
        for (const std::int32_t s : part.sourceTriangle) ASSERT_TRUE(s >= -1 && s < d.triangleCount);
        std::set<PointIndex> used;
        for (const Triangle& t : part.triangles) used.insert(t.begin(), t.end());
        ASSERT_EQ(part.points, std::vector<PointIndex>(used.begin(), used.end()));
      }
      for (std::size_t i = 0; i < d.splitFrom.size(); ++i) {
        ASSERT_TRUE(d.splitFrom[i] >= 0 && d.splitFrom[i] <= static_cast<int>(i));
      }
      ASSERT_TRUE(read->detailLevels.empty() || read->detailLevels.size() == d.parts.size());
      for (const DetailLevel& level : read->detailLevels) {
        ASSERT_TRUE(std::isfinite(level.meanError) && std::isfinite(level.worstError) && level.hullVertices >= 0);
      }
      ASSERT_TRUE(read->bonesOfPart.empty() || read->bonesOfPart.size() == d.parts.size());
      if (read->training) expectUsable(*read->training, d);
      if (read->cover) expectUsable(*read->cover, d);
    }
  }
}

/// The bytes with one value replaced and the checksum corrected.
template <typename T>
std::string changedAt(const std::string& bytes, std::size_t at, T value) {
  std::string changed = bytes.substr(0, at);
  appendLittleEndian(value, changed);
  return resealed(changed + bytes.substr(changed.size()));
}

TEST(DecompositionFile, SaysWhatIsWrong) {
  const std::string bytes = bytesOf(sampleWithoutTraining());
  // Offsets by docs/LORICA_FILE.md, "l-shape.off" takes 11 bytes:
  //    87 cut points: count, 91 ends (4 packed in 5 bytes), 96 lambdas
  //   112 splits: count, 116 the split
  //   120 parts: count, 124 triangles, 128 points, 132 points (4 in 5 bytes), 137 corners (9 in 12), 149 sources
  //       (3 in 4), 153 the second part
  //   171 levels: count, 175 first level
  //   215 bones: count, 219 "hips", 227 "spine", 236 parts with bones, 240 two bones, 244 the first one
  const auto with = [&](std::size_t at, auto value) { return changedAt(bytes, at, value); };
  using Byte = std::uint8_t;
  std::string newer = bytes;
  newer[8] = 2;
  EXPECT_EQ(whyNot("ply\n"), "a.lorica: not a .lorica file: its first 8 bytes are not LORICA, CR, LF");
  EXPECT_EQ(whyNot(bytes.substr(0, 20)), "a.lorica: ends at byte 20 within the header of 28 bytes");
  EXPECT_EQ(whyNot(newer), "a.lorica: byte 8: found format version 2, expected 1");
  EXPECT_EQ(whyNot(bytes.substr(0, bytes.size() - 5)),
            "a.lorica: byte 12: announces 258 bytes after the header, 253 are there");
  EXPECT_EQ(whyNot(with(28, std::uint32_t{4000000000u})),
            "a.lorica: byte 28: the length of the source's name is 4000000000, which needs 4000000000 bytes or more; "
            "254 are left");
  EXPECT_EQ(whyNot(with(51, std::numeric_limits<double>::infinity())),
            "a.lorica: byte 51: the mean error is inf, expected a finite number");
  EXPECT_EQ(whyNot(with(79, std::int32_t{-1})),
            "a.lorica: byte 79: the mesh's vertex count is -1, expected 0 to 2147483647");
  EXPECT_EQ(whyNot(with(87, std::uint32_t{0x40000000u})),
            "a.lorica: byte 87: the number of cut points is 1073741824, which needs 10737418240 bytes or more; 195 are "
            "left");
  EXPECT_EQ(whyNot(with(92, Byte{24})),
            "a.lorica: byte 91: cut point 0 lies between points 12 and 9, expected 0 to 11 for both");
  EXPECT_EQ(whyNot(with(96, 1.5)), "a.lorica: byte 96: lambda of cut point 0 is 1.5, expected 0 to 1");
  EXPECT_EQ(whyNot(with(96, std::nan(""))), "a.lorica: byte 96: lambda of cut point 0 is nan, expected 0 to 1");
  EXPECT_EQ(whyNot(with(116, std::int32_t{1})),
            "a.lorica: byte 116: the part that a split divides is 1, expected 0 to 0");
  EXPECT_EQ(whyNot(with(120, std::uint32_t{3})), "a.lorica: byte 120: 3 parts after 1 splits, expected 2");
  EXPECT_EQ(whyNot(with(136, Byte{1})), "a.lorica: byte 132: the last point of part 0 is 14, expected 3 to 13");
  EXPECT_EQ(whyNot(with(139, Byte{4})),
            "a.lorica: byte 137: expected the corners of a part: 9 packed numbers, which do not fit the 149 bytes that "
            "are left");
  EXPECT_EQ(whyNot(with(142, Byte{6})),
            "a.lorica: byte 137: triangle 0 of part 0 has corners 0, 1 and 4, expected 0 to 3");
  EXPECT_EQ(whyNot(with(168, Byte{0})), "a.lorica: byte 165: part 1 lists point 3, which none of its triangles uses");
  EXPECT_EQ(whyNot(with(151, Byte{40})),
            "a.lorica: byte 149: triangle 1 of part 0 comes from triangle 20, expected -1 to 19");
  EXPECT_EQ(whyNot(with(150, Byte{3})),
            "a.lorica: byte 149: triangle 0 of part 0 comes from triangle -2, expected -1 to 19");
  EXPECT_EQ(whyNot(with(171, std::uint32_t{1})), "a.lorica: byte 171: 1 levels of detail of 2 parts, expected 0 or 2");
  EXPECT_EQ(whyNot(with(236, std::uint32_t{1})), "a.lorica: byte 236: 1 parts with bones, expected 0 or 2");
  EXPECT_EQ(whyNot(with(244, std::int32_t{2})), "a.lorica: byte 244: a bone is 2, expected 0 to 1");
  EXPECT_EQ(whyNot(with(260, 0.8)), "a.lorica: byte 260: a bone's share is 0.8, expected above 0 and at most 0.75");
  EXPECT_EQ(readDecomposition("/nowhere/a.lorica").error().code, ErrorCode::kNotFound);
}

TEST(DecompositionFile, SaysWhatIsWrongWithATrainingRange) {
  const std::string bytes = sampleBytes();
  // Offsets: version 2 takes 284 bytes of the same content. 284 whether known, 285 probes, 289 packed (3 in 4 bytes),
  // 293 known distance, 301 keyframes, 305 positions, 449 the cover
  using Byte = std::uint8_t;
  const auto why = [&](std::size_t at, auto value) { return whyNot(changedAt(bytes, at, value)); };
  EXPECT_EQ(why(284, Byte{2}), "a.lorica: byte 284: whether the training is known is 2, expected 0 or 1");
  EXPECT_EQ(why(285, std::uint32_t{0}), "a.lorica: byte 285: 0 probes, expected 1 to 128");
  EXPECT_EQ(why(285, std::uint32_t{129}), "a.lorica: byte 285: 129 probes, expected 1 to 128");
  EXPECT_EQ(why(290, Byte{28}), "a.lorica: byte 289: probe 0 is point 14, expected 0 to 13");
  EXPECT_EQ(why(290, Byte{1}), "a.lorica: byte 289: probe 0 is point 4294967295, expected 0 to 13");
  EXPECT_EQ(why(292, Byte{0}), "a.lorica: byte 289: point 0 is a probe twice, expected each once");
  EXPECT_EQ(why(293, -1.0), "a.lorica: byte 293: the known distance is -1, expected 0 or more");
  EXPECT_EQ(why(301, std::uint32_t{0}), "a.lorica: byte 301: 0 training keyframes, expected 1 or more");
  EXPECT_EQ(why(301, std::uint32_t{1000000}).substr(0, 95),
            "a.lorica: byte 301: the number of training keyframes is 1000000, which needs 72000000 bytes or ");
  EXPECT_EQ(why(305 + 40, std::numeric_limits<double>::infinity()),
            "a.lorica: byte 345: a probe's position is inf, expected a finite number");
}

TEST(DecompositionFile, SaysWhatIsWrongWithACover) {
  DecompositionFile content = sample();
  content.training.reset();
  const std::string bytes = bytesOf(content);
  // Offsets: version 2 takes 284 bytes of the same content, the training a byte. 285 whether known, 286 tolerance, 294
  // bound, 298 sampled, 302 held out, 306 growth, 314 and 322 shortfalls, 330 parts; 334 points of part 0, 338 packed
  // (3 in 4 bytes), 342 whether displaced, 343 displacements; 415 points of part 1, 419 packed (1 in 2), 421 whether
  // displaced
  using Byte = std::uint8_t;
  const auto why = [&](std::size_t at, auto value) { return whyNot(changedAt(bytes, at, value)); };
  EXPECT_EQ(why(285, Byte{2}), "a.lorica: byte 285: whether the cover is known is 2, expected 0 or 1");
  EXPECT_EQ(why(286, -0.5), "a.lorica: byte 286: the tolerance of the cover is -0.5, expected 0 or more");
  EXPECT_EQ(why(286, std::nan("")), "a.lorica: byte 286: the tolerance of the cover is nan, expected a finite number");
  EXPECT_EQ(why(294, std::int32_t{-1}),
            "a.lorica: byte 294: the bound on a hull's vertices is -1, expected 0 to 2147483647");
  EXPECT_EQ(why(298, std::int32_t{-1}),
            "a.lorica: byte 298: the number of sampled poses is -1, expected 0 to 2147483647");
  EXPECT_EQ(why(302, std::int32_t{-1}),
            "a.lorica: byte 302: the number of poses held out is -1, expected 0 to 2147483647");
  EXPECT_EQ(why(306, std::numeric_limits<double>::infinity()),
            "a.lorica: byte 306: the growth of the cover is inf, expected a finite number");
  EXPECT_EQ(why(314, -1.0), "a.lorica: byte 314: the shortfall in the sampled poses is -1, expected 0 or more");
  EXPECT_EQ(why(322, -1.0), "a.lorica: byte 322: the shortfall in the poses held out is -1, expected 0 or more");
  EXPECT_EQ(why(330, std::uint32_t{1}), "a.lorica: byte 330: 1 parts with cover points, expected 2");
  EXPECT_EQ(why(339, Byte{8}),
            "a.lorica: byte 338: cover point 0 of part 0 is vertex 0, expected one of the part or of no part");
  EXPECT_EQ(why(339, Byte{1}),
            "a.lorica: byte 338: cover point 0 of part 0 is the part's point 4294967295, expected 0 to 15");
  EXPECT_EQ(why(342, Byte{3}), "a.lorica: byte 342: whether a part's cover points are displaced is 3, expected 0 or 1");
  EXPECT_EQ(why(351, std::nan("")),
            "a.lorica: byte 351: a displacement of a cover point is nan, expected a finite number");
  EXPECT_EQ(why(415, std::uint32_t{4000000000u}).substr(0, 84),
            "a.lorica: byte 415: the number of a part's cover points is 4000000000, which needs 4");
}

TEST(DecompositionFile, WhatCouldNotBeReadIsNotWritten) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.lorica";
  DecompositionFile content = sample();
  content.decomposition.cutPoints[0].first = 13;
  auto written = writeDecomposition(file, content);
  ASSERT_FALSE(written.ok());
  EXPECT_EQ(written.error().code, ErrorCode::kInvalidArgument);
  content = sample();
  content.decomposition.parts[0].points.pop_back();
  EXPECT_FALSE(writeDecomposition(file, content).ok());
  content = sample();
  content.decomposition.parts[0].sourceTriangle.pop_back();
  EXPECT_FALSE(writeDecomposition(file, content).ok());
  content = sample();
  content.detailLevels.pop_back();
  EXPECT_FALSE(writeDecomposition(file, content).ok());
  content = sample();
  std::swap(content.bonesOfPart[0][0], content.bonesOfPart[0][1]);
  EXPECT_FALSE(writeDecomposition(file, content).ok());
  content = sample();
  content.training->positions.pop_back();
  written = writeDecomposition(file, content);
  ASSERT_FALSE(written.ok());
  EXPECT_EQ(written.error().message.substr(folder.path().string().size() + 1),
            "a.lorica: not written: 5 positions of 3 probes in 2 keyframes");
  content = sample();
  content.training->probes[1] = 14;
  EXPECT_FALSE(writeDecomposition(file, content).ok());
  content = sample();
  content.training = TrainingRange{};
  EXPECT_FALSE(writeDecomposition(file, content).ok());
  content = sample();
  content.cover->points.pop_back();
  EXPECT_FALSE(writeDecomposition(file, content).ok());
  content = sample();
  content.cover->points.emplace_back();
  EXPECT_FALSE(writeDecomposition(file, content).ok());
  content = sample();
  content.cover->points[0][1].point = 2;  // of the other part
  written = writeDecomposition(file, content);
  ASSERT_FALSE(written.ok());
  EXPECT_NE(written.error().message.find("cover point 1 of part 0 is vertex 2, expected one of the part or of no part"),
            std::string::npos)
      << written.error().message;
  for (const PointIndex wrong : {-1, 12, 14}) {
    content.cover->points[1][0].point = wrong;
    EXPECT_FALSE(writeDecomposition(file, content).ok()) << wrong;
  }
  content = sample();
  content.cover->points[1][0].outward.y() = std::nan("");
  EXPECT_FALSE(writeDecomposition(file, content).ok());
  content = sample();
  content.cover->heldOutShortfall = -1e-9;
  EXPECT_FALSE(writeDecomposition(file, content).ok());
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_EQ(writeDecomposition("/nowhere/a.lorica", sample()).error().code, ErrorCode::kUnwritable);
}

}  // namespace
}  // namespace lorica

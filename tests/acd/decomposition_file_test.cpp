#include "acd/decomposition_file.h"

#include "acd/level_of_detail.h"
#include "geometry/files.h"
#include "geometry/little_endian.h"
#include "tests/acd/parts.h"
#include "tests/support/allocations.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"
#include "tests/support/same.h"
#include "tests/support/value_of.h"

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
  content.training = {
      .probes = {13, 0, 3},
      .keyframeCount = 2,
      .positions = {{0, 0, 1}, {0, 0.5, -1}, {0, -0.5, 0}, {0.25, 0, 1}, {-0.25, 0.5, -1}, {0, -0.5, 0}},
      .knownDistance = 0.125};
  content.cover = {.tolerance = 0.01,
                   .maxHullVertices = 64,
                   .points = {{{12, {0.0, 0.5, -0.25}}, {0, {0, 0, 0}}, {12, {1e-3, 0, 0}}}, {{3, {0, 0, 0}}}},
                   .sampledPoses = 2000,
                   .heldOutPoses = 500,
                   .growth = 0.6,
                   .sampledShortfall = 0.004,
                   .heldOutShortfall = 0.0};
  return content;
}

void expectEqual(const DecompositionFile& a, const DecompositionFile& b) {
  using File = DecompositionFile;
  test::expectSame(a, b, &File::source, &File::meshHash, &File::meanError, &File::errorPerKeyframe);
  const Decomposition &c = a.decomposition, &d = b.decomposition;
  test::expectSame(c, d, &Decomposition::vertexCount, &Decomposition::triangleCount, &Decomposition::splitFrom);
  test::expectSame(c.cutPoints, d.cutPoints, &CutPoint::first, &CutPoint::second, &CutPoint::lambda);
  test::expectSame(c.parts, d.parts, &Part::triangles, &Part::sourceTriangle, &Part::points);
  EXPECT_EQ(hashOf(c), hashOf(d));
  using Level = DetailLevel;
  test::expectSame(a.detailLevels, b.detailLevels, &Level::meanError, &Level::worstError, &Level::hullVertices);
  ASSERT_EQ(a.bonesOfPart.size(), b.bonesOfPart.size());
  for (std::size_t i = 0; i < a.bonesOfPart.size(); ++i) {
    test::expectSame(a.bonesOfPart[i], b.bonesOfPart[i], &BoneShare::bone, &BoneShare::share);
  }
  ASSERT_EQ(a.training.has_value(), b.training.has_value());
  using Range = TrainingRange;
  if (a.training) {
    test::expectSame(*a.training, *b.training, &Range::probes, &Range::keyframeCount, &Range::positions,
                     &Range::knownDistance);
  }
  ASSERT_EQ(a.cover.has_value(), b.cover.has_value());
  if (!a.cover) return;
  using Cover = HullCover;
  test::expectSame(*a.cover, *b.cover, &Cover::tolerance, &Cover::maxHullVertices, &Cover::sampledPoses,
                   &Cover::heldOutPoses, &Cover::growth, &Cover::sampledShortfall, &Cover::heldOutShortfall);
  ASSERT_EQ(a.cover->points.size(), b.cover->points.size());
  for (std::size_t i = 0; i < a.cover->points.size(); ++i) {
    test::expectSame(a.cover->points[i], b.cover->points[i], &CoverPoint::point, &CoverPoint::outward);
  }
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

/// The bytes of a file with this content. Reading them gives the content again.
std::string bytesOf(const DecompositionFile& content) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.lorica";
  const auto written = writeDecomposition(file, content);
  EXPECT_TRUE(written.ok()) << written.error().message;
  const auto read = readDecomposition(file);
  EXPECT_TRUE(read.ok()) << read.error().message;
  expectEqual(*read, content);
  return *readFile(file);
}

/// A mesh as a single part.
DecompositionFile wholeOf(const TriMesh& mesh) {
  DecompositionFile content;
  content.decomposition.vertexCount = countOf(mesh.vertices);
  content.decomposition.triangleCount = countOf(mesh.triangles);
  content.decomposition.parts = {test::wholeOf(mesh)};
  return content;
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

TEST(DecompositionFile, RoundTripIsExactWithAndWithoutOptionalContent) {
  bytesOf(sample());
  bytesOf(sampleWithoutLevels());
}

TEST(DecompositionFile, CoverPointsThatStayOnTheSurfaceTakeOneOrTwoBytesEach) {
  DecompositionFile content = wholeOf(test::makeTorus(2.0, 0.5, 60, 40));
  const std::size_t without = bytesOf(content).size();
  content.cover = HullCover{};
  std::vector<CoverPoint>& points = content.cover->points.emplace_back();
  for (PointIndex p = 0; p < content.decomposition.vertexCount; p += 3) points.push_back({p, Vec3::Zero()});
  const std::size_t count = points.size();
  EXPECT_LE(bytesOf(content).size(), without + 64 + count + (count + 3) / 4);
  points.back().outward.x() = 0.001;
  EXPECT_GT(bytesOf(content).size(), without + 24 * count);
}

TEST(DecompositionFile, RealDecompositionSurvives) {
  const TriMesh torus = test::makeTorus(2.0, 0.5, 24, 12);
  const PoseView pose = test::poseOf(torus);
  const Decomposition d = test::decomposed(torus, {.maxParts = 6});
  const std::string bytes =
      bytesOf({d, "torus", topologyHash(torus), 0.5, {0.5}, detailLevels(d, torus, pose, hullsOfParts(d, pose)), {}});
  // Compact: without packing it would be 16 bytes per triangle and 16 per cut point.
  std::size_t unpacked = 16 * d.cutPoints.size();
  for (const Part& part : d.parts) unpacked += 16 * part.triangles.size();
  EXPECT_LT(bytes.size(), unpacked / 2);
}

TEST(DecompositionFile, PointsBeyond65536Survive) {
  // Packed numbers of one to three bytes.
  DecompositionFile content = wholeOf(test::makeTorus(2.0, 0.5, 300, 230));
  std::ranges::reverse(content.decomposition.parts[0].sourceTriangle);
  bytesOf(content);
}

/// The same with vertices in the cover that belong to no part.
DecompositionFile sampleWithAttachedVertices() {
  DecompositionFile content = sample();
  content.cover->points[0].push_back({5, {0.0, 0.0, 0.125}});
  content.cover->points[1].push_back({10, {0, 0, 0}});
  return content;
}

TEST(DecompositionFile, TheKeptFileIsReadAndWrittenByteForByte) {
  const auto read = test::valueOf(readDecomposition(keptFile()));
  expectEqual(read, sampleWithAttachedVertices());
  EXPECT_EQ(hexDigits(hashOf(read.decomposition)), "2020c6e2fc966fc6");
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

struct KeptFile : testing::Test {
  const std::string bytes = *readFile(keptFile());

  /// Calls `check` with every copy that has one byte damaged, from a byte on.
  void forEveryDamage(std::size_t from, const std::function<void(const std::string&)>& check) const {
    for (std::size_t at = from; at < bytes.size(); ++at) {
      SCOPED_TRACE(at);
      for (const int flip : {0x01, 0x80, 0xFF}) {
        std::string damaged = bytes;
        damaged[at] = static_cast<char>(damaged[at] ^ flip);
        check(damaged);
      }
    }
  }
};

TEST_F(KeptFile, EveryDamagedByteIsRefused) {
  forEveryDamage(0, [](const std::string& damaged) { EXPECT_NE(whyNot(damaged), ""); });
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

void expectUsable(const DecompositionFile& content) {
  const Decomposition& d = content.decomposition;
  ASSERT_EQ(d.parts.size(), d.splitFrom.size() + 1);
  for (int i = 0; i < countOf(d.cutPoints); ++i) {
    const auto& [first, second, lambda] = d.cutPoints[i];
    ASSERT_LT(std::max(first, second), d.vertexCount + i);
    ASSERT_GE(std::min(first, second), 0);
    ASSERT_TRUE(lambda >= 0.0 && lambda <= 1.0);
  }
  for (const Part& part : d.parts) {
    ASSERT_EQ(part.sourceTriangle.size(), part.triangles.size());
    for (const PointIndex p : part.points) ASSERT_TRUE(p >= 0 && p < d.pointCount());
    for (const std::int32_t s : part.sourceTriangle) ASSERT_TRUE(s >= -1 && s < d.triangleCount);
    ASSERT_EQ(part.points, pointsUsedBy(part.triangles));
  }
  for (int i = 0; i < countOf(d.splitFrom); ++i) ASSERT_TRUE(d.splitFrom[i] >= 0 && d.splitFrom[i] <= i);
  ASSERT_TRUE(content.detailLevels.empty() || content.detailLevels.size() == d.parts.size());
  for (const DetailLevel& level : content.detailLevels) {
    ASSERT_TRUE(std::isfinite(level.meanError) && std::isfinite(level.worstError) && level.hullVertices >= 0);
  }
  ASSERT_TRUE(content.bonesOfPart.empty() || content.bonesOfPart.size() == d.parts.size());
  if (content.training) expectUsable(*content.training, d);
  if (content.cover) expectUsable(*content.cover, d);
}

TEST_F(KeptFile, DamageUnderAFittingChecksumIsRefusedOrHarmless) {
  const TemporaryFolder folder;
  forEveryDamage(28, [&](const std::string& damaged) {
    const auto file = folder.write("a.lorica", resealed(damaged));
    const test::AllocationWatch watch;
    const auto read = readDecomposition(file);
    EXPECT_LT(watch.largest(), 100'000u);
    if (read.ok()) expectUsable(*read);
  });
}

/// A value written over the bytes of a file, and the start of the message that refuses it.
struct WrongValue {
  std::size_t at;
  std::string value;
  std::string message;
};

template <typename T>
std::string le(T value) {
  std::string bytes;
  appendLittleEndian(value, bytes);
  return bytes;
}
std::string byte(std::uint8_t value) {
  return le(value);
}
std::string u32(std::uint32_t value) {
  return le(value);
}

void expectRefused(const std::string& bytes, const std::vector<WrongValue>& rows) {
  for (const auto& [at, value, message] : rows) {
    SCOPED_TRACE(message);
    std::string changed = bytes;
    changed.replace(at, value.size(), value);
    // "..." stands for a number that is not checked.
    const std::string why = whyNot(resealed(changed)), expected = "a.lorica: byte " + message;
    const bool cut = expected.ends_with("...");
    EXPECT_EQ(cut ? why.substr(0, expected.size() - 3) + "..." : why, expected);
  }
}

constexpr double kInf = std::numeric_limits<double>::infinity();
const double kNan = std::nan("");

TEST(DecompositionFile, SaysWhatIsWrong) {
  const std::string bytes = bytesOf(sampleWithoutTraining());
  std::string newer = bytes;
  newer[8] = 2;
  EXPECT_EQ(whyNot("ply\n"), "a.lorica: not a .lorica file: its first 8 bytes are not LORICA, CR, LF");
  EXPECT_EQ(whyNot(bytes.substr(0, 20)), "a.lorica: ends at byte 20 within the header of 28 bytes");
  EXPECT_EQ(whyNot(newer), "a.lorica: byte 8: found format version 2, expected 1");
  EXPECT_EQ(whyNot(bytes.substr(0, bytes.size() - 5)),
            "a.lorica: byte 12: announces 258 bytes after the header, 253 are there");
  EXPECT_EQ(readDecomposition("/nowhere/a.lorica").error().code, ErrorCode::kNotFound);
  // Offsets by docs/LORICA_FILE.md, "l-shape.off" takes 11 bytes:
  //    87 cut points: count, 91 ends (4 packed in 5 bytes), 96 lambdas
  //   112 splits: count, 116 the split
  //   120 parts: count, 124 triangles, 128 points, 132 points (4 in 5 bytes), 137 corners (9 in 12), 149 sources
  //       (3 in 4), 153 the second part
  //   171 levels: count, 175 first level
  //   215 bones: count, 219 "hips", 227 "spine", 236 parts with bones, 240 two bones, 244 the first one
  expectRefused(
      bytes, {{28, u32(4000000000u),
               "28: the length of the source's name is 4000000000, which needs 4000000000 bytes or more; 254 are left"},
              {51, le(kInf), "51: the mean error is inf, expected a finite number"},
              {79, le(-1), "79: the mesh's vertex count is -1, expected 0 to 2147483647"},
              {87, u32(0x40000000u),
               "87: the number of cut points is 1073741824, which needs 10737418240 bytes or more; 195 are left"},
              {92, byte(24), "91: cut point 0 lies between points 12 and 9, expected 0 to 11 for both"},
              {96, le(1.5), "96: lambda of cut point 0 is 1.5, expected 0 to 1"},
              {96, le(kNan), "96: lambda of cut point 0 is nan, expected 0 to 1"},
              {116, le(1), "116: the part that a split divides is 1, expected 0 to 0"},
              {120, u32(3), "120: 3 parts after 1 splits, expected 2"},
              {136, byte(1), "132: the last point of part 0 is 14, expected 3 to 13"},
              {139, byte(4),
               "137: expected the corners of a part: 9 packed numbers, which do not fit the 149 bytes that are left"},
              {142, byte(6), "137: triangle 0 of part 0 has corners 0, 1 and 4, expected 0 to 3"},
              {168, byte(0), "165: part 1 lists point 3, which none of its triangles uses"},
              {151, byte(40), "149: triangle 1 of part 0 comes from triangle 20, expected -1 to 19"},
              {150, byte(3), "149: triangle 0 of part 0 comes from triangle -2, expected -1 to 19"},
              {171, u32(1), "171: 1 levels of detail of 2 parts, expected 0 or 2"},
              {236, u32(1), "236: 1 parts with bones, expected 0 or 2"},
              {244, le(2), "244: a bone is 2, expected 0 to 1"},
              {260, le(0.8), "260: a bone's share is 0.8, expected above 0 and at most 0.75"}});
}

TEST(DecompositionFile, SaysWhatIsWrongWithATrainingRange) {
  // Offsets: version 2 takes 284 bytes of the same content. 284 whether known, 285 probes, 289 packed (3 in 4 bytes),
  // 293 known distance, 301 keyframes, 305 positions, 449 the cover
  expectRefused(
      bytesOf(sample()),
      {{284, byte(2), "284: whether the training is known is 2, expected 0 or 1"},
       {285, u32(0), "285: 0 probes, expected 1 to 128"},
       {285, u32(129), "285: 129 probes, expected 1 to 128"},
       {290, byte(28), "289: probe 0 is point 14, expected 0 to 13"},
       {290, byte(1), "289: probe 0 is point 4294967295, expected 0 to 13"},
       {292, byte(0), "289: point 0 is a probe twice, expected each once"},
       {293, le(-1.0), "293: the known distance is -1, expected 0 or more"},
       {301, u32(0), "301: 0 training keyframes, expected 1 or more"},
       {301, u32(1000000), "301: the number of training keyframes is 1000000, which needs 72000000 bytes or ..."},
       {305 + 40, le(kInf), "345: a probe's position is inf, expected a finite number"}});
}

TEST(DecompositionFile, SaysWhatIsWrongWithACover) {
  DecompositionFile content = sample();
  content.training.reset();
  // Offsets: version 2 takes 284 bytes of the same content, the training a byte. 285 whether known, 286 tolerance, 294
  // bound, 298 sampled, 302 held out, 306 growth, 314 and 322 shortfalls, 330 parts; 334 points of part 0, 338 packed
  // (3 in 4 bytes), 342 whether displaced, 343 displacements; 415 points of part 1, 419 packed (1 in 2), 421 whether
  // displaced
  expectRefused(bytesOf(content),
                {{285, byte(2), "285: whether the cover is known is 2, expected 0 or 1"},
                 {286, le(-0.5), "286: the tolerance of the cover is -0.5, expected 0 or more"},
                 {286, le(kNan), "286: the tolerance of the cover is nan, expected a finite number"},
                 {294, le(-1), "294: the bound on a hull's vertices is -1, expected 0 to 2147483647"},
                 {298, le(-1), "298: the number of sampled poses is -1, expected 0 to 2147483647"},
                 {302, le(-1), "302: the number of poses held out is -1, expected 0 to 2147483647"},
                 {306, le(kInf), "306: the growth of the cover is inf, expected a finite number"},
                 {314, le(-1.0), "314: the shortfall in the sampled poses is -1, expected 0 or more"},
                 {322, le(-1.0), "322: the shortfall in the poses held out is -1, expected 0 or more"},
                 {330, u32(1), "330: 1 parts with cover points, expected 2"},
                 {339, byte(8), "338: cover point 0 of part 0 is vertex 0, expected one of the part or of no part"},
                 {339, byte(1), "338: cover point 0 of part 0 is the part's point 4294967295, expected 0 to 15"},
                 {342, byte(3), "342: whether a part's cover points are displaced is 3, expected 0 or 1"},
                 {351, le(kNan), "351: a displacement of a cover point is nan, expected a finite number"},
                 {415, u32(4000000000u), "415: the number of a part's cover points is 4000000000, which needs 4..."}});
}

TEST(DecompositionFile, WhatCouldNotBeReadIsNotWritten) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.lorica";
  struct Row {
    const char* what;
    void (*damage)(DecompositionFile&);
    std::string message = "";
  };
  using File = DecompositionFile;
  const char* const cover = "cover point 1 of part 0 is vertex 2, expected one of the part or of no part";
  for (const Row& row : std::initializer_list<Row>{
           {"a cut point's end", [](File& f) { f.decomposition.cutPoints[0].first = 13; }},
           {"a part's points", [](File& f) { f.decomposition.parts[0].points.pop_back(); }},
           {"a part's sources", [](File& f) { f.decomposition.parts[0].sourceTriangle.pop_back(); }},
           {"levels", [](File& f) { f.detailLevels.pop_back(); }},
           {"order of bones", [](File& f) { std::swap(f.bonesOfPart[0][0], f.bonesOfPart[0][1]); }},
           {"positions of probes", [](File& f) { f.training->positions.pop_back(); },
            "a.lorica: not written: 5 positions of 3 probes in 2 keyframes"},
           {"a probe", [](File& f) { f.training->probes[1] = 14; }},
           {"an empty training range", [](File& f) { f.training = TrainingRange{}; }},
           {"a cover of fewer parts", [](File& f) { f.cover->points.pop_back(); }},
           {"a cover of more parts", [](File& f) { f.cover->points.emplace_back(); }},
           {"a cover point of the other part", [](File& f) { f.cover->points[0][1].point = 2; }, cover},
           {"cover point -1", [](File& f) { f.cover->points[1][0].point = -1; }},
           {"cover point 12", [](File& f) { f.cover->points[1][0].point = 12; }},
           {"cover point 14", [](File& f) { f.cover->points[1][0].point = 14; }},
           {"a displacement", [](File& f) { f.cover->points[1][0].outward.y() = kNan; }},
           {"a shortfall", [](File& f) { f.cover->heldOutShortfall = -1e-9; }}}) {
    SCOPED_TRACE(row.what);
    File content = sample();
    row.damage(content);
    const auto written = writeDecomposition(file, content);
    ASSERT_FALSE(written.ok());
    EXPECT_EQ(written.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(written.error().message.find(row.message), std::string::npos) << written.error().message;
  }
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_EQ(writeDecomposition("/nowhere/a.lorica", sample()).error().code, ErrorCode::kUnwritable);
}

}  // namespace
}  // namespace lorica

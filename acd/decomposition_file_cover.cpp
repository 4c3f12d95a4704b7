#include "acd/decomposition_file_cover.h"

#include "acd/packed_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <span>

namespace lorica {
namespace {

constexpr std::int64_t kLargestCoverIndex = std::numeric_limits<std::int32_t>::max();
constexpr std::size_t kCoverPartBytes = 4 + 1;
constexpr std::size_t kPackedBytes = 1;  // a packed number takes one or more
constexpr std::size_t kVectorBytes = 3 * 8;

void appendCount(std::size_t count, std::string& payload) {
  appendLittleEndian(static_cast<std::uint32_t>(count), payload);
}

void appendVector(const Vec3& v, std::string& payload) {
  for (int axis = 0; axis < 3; ++axis) appendLittleEndian(v[axis], payload);
}

Vec3 takeVector(ByteReader& reader, const char* what) {
  Vec3 v;
  for (int axis = 0; axis < 3; ++axis) v[axis] = reader.takeFinite(what);
  return v;
}

/// A length or a tolerance.
double takeDistance(ByteReader& reader, const char* what) {
  const double value = reader.takeFinite(what);
  if (value < 0.0) {
    reader.fail(reader.offset() - 8, fmt::format("{} is {}, expected 0 or more", what, value));
  }
  return value;
}

/// 1 before what is known, 0 in place of what is not.
bool takeKnown(ByteReader& reader, const char* what) {
  const auto known = reader.take<std::uint8_t>(what);
  if (known > 1) reader.fail(reader.offset() - 1, fmt::format("{} is {}, expected 0 or 1", what, known));
  return reader.ok() && known == 1;
}

// ---- Training range ----

void appendTraining(const TrainingRange& training, std::string& payload) {
  appendCount(training.probes.size(), payload);
  std::vector<std::uint32_t> differences;
  differences.reserve(training.probes.size());
  std::uint32_t before = 0;
  for (const PointIndex probe : training.probes) {
    differences.push_back(zigzag(static_cast<std::uint32_t>(probe) - before));
    before = probe;
  }
  appendPacked(differences, payload);
  appendLittleEndian(training.knownDistance, payload);
  appendCount(training.keyframeCount, payload);
  for (const Vec3& p : training.positions) appendVector(p, payload);
}

void takeProbes(ByteReader& reader, int pointCount, std::vector<PointIndex>& probes) {
  const std::size_t count = reader.takeCount("the number of probes", kPackedBytes);
  if (reader.ok() && (count == 0 || count > kMaxProbes)) {
    reader.fail(reader.offset() - 4, fmt::format("{} probes, expected 1 to {}", count, kMaxProbes));
  }
  if (!reader.ok()) return;
  const std::size_t begin = reader.offset();
  std::vector<std::uint32_t> differences(count);
  takePacked(reader, "the probes", differences);
  probes.resize(count);
  std::uint32_t probe = 0;
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    probe += unzigzag(differences[i]);
    if (probe >= static_cast<std::uint32_t>(pointCount)) {
      reader.fail(begin, fmt::format("probe {} is point {}, expected 0 to {}", i, probe, pointCount - 1));
    }
    probes[i] = probe;
  }
  std::vector<PointIndex> sorted = probes;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) reader.fail(begin, fmt::format("point {} is a probe twice, expected each once", *twice));
}

TrainingRange takeTraining(ByteReader& reader, int pointCount) {
  TrainingRange training;
  takeProbes(reader, pointCount, training.probes);
  training.knownDistance = takeDistance(reader, "the known distance");
  const std::size_t count = reader.takeCount("the number of training keyframes",
                                             std::max<std::size_t>(training.probes.size(), 1) * kVectorBytes);
  if (count == 0) reader.fail(reader.offset() - 4, "0 training keyframes, expected 1 or more");
  if (!reader.ok()) return training;
  training.keyframeCount = count;
  training.positions.resize(count * training.probes.size());
  for (Vec3& p : training.positions) p = takeVector(reader, "a probe's position");
  return training;
}

// ---- Hull cover ----

/// Where each point stands in the part's list; past its end stand all vertices of the mesh, for those that no part has.
/// What is neither is past that end, too, and reading back refuses it.
void appendCoverPoints(std::span<const CoverPoint> points, const Part& part, int vertexCount, std::string& payload) {
  appendCount(points.size(), payload);
  std::vector<std::uint32_t> positions;
  positions.reserve(points.size());
  std::uint32_t before = 0;
  bool displaced = false;
  for (const CoverPoint& point : points) {
    const auto found = std::lower_bound(part.points.begin(), part.points.end(), point.point);
    const bool isThere = found != part.points.end() && *found == point.point;
    const PointIndex beside = point.point >= 0 && point.point < vertexCount ? point.point : vertexCount;
    const auto position = isThere ? static_cast<std::uint32_t>(found - part.points.begin())
                                  : static_cast<std::uint32_t>(part.points.size()) + static_cast<std::uint32_t>(beside);
    positions.push_back(zigzag(position - before));
    before = position;
    displaced = displaced || point.outward != Vec3::Zero();
  }
  appendPacked(positions, payload);
  appendLittleEndian(static_cast<std::uint8_t>(displaced ? 1 : 0), payload);
  if (!displaced) return;
  for (const CoverPoint& point : points) appendVector(point.outward, payload);
}

void appendCover(const HullCover& cover, const Decomposition& decomposition, std::string& payload) {
  const std::span<const Part> parts = decomposition.parts;
  appendLittleEndian(cover.tolerance, payload);
  appendLittleEndian(cover.maxHullVertices, payload);
  appendLittleEndian(cover.sampledPoses, payload);
  appendLittleEndian(cover.heldOutPoses, payload);
  appendLittleEndian(cover.growth, payload);
  appendLittleEndian(cover.sampledShortfall, payload);
  appendLittleEndian(cover.heldOutShortfall, payload);
  appendCount(cover.points.size(), payload);
  for (std::size_t i = 0; i < std::min(cover.points.size(), parts.size()); ++i) {
    appendCoverPoints(cover.points[i], parts[i], decomposition.vertexCount, payload);
  }
}

bool isInAPart(PointIndex point, std::span<const Part> parts) {
  return std::any_of(parts.begin(), parts.end(), [point](const Part& part) {
    return std::binary_search(part.points.begin(), part.points.end(), point);
  });
}

/// @param vertexCount  of the mesh, whose vertices are numbered after the part's points
std::vector<CoverPoint> takeCoverPoints(ByteReader& reader, std::size_t index, std::span<const Part> parts,
                                        std::size_t vertexCount) {
  const Part& part = parts[index];
  const std::size_t count = reader.takeCount("the number of a part's cover points", kPackedBytes);
  const std::size_t begin = reader.offset();
  std::vector<std::uint32_t> positions(count);
  takePacked(reader, "the cover points of a part", positions);
  std::vector<CoverPoint> points(reader.ok() ? count : 0);
  std::uint32_t position = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    position += unzigzag(positions[i]);
    if (position >= part.points.size() + vertexCount) {
      reader.fail(begin, fmt::format("cover point {} of part {} is the part's point {}, expected 0 to {}", i, index,
                                     position, part.points.size() + vertexCount - 1));
      return {};
    }
    if (position < part.points.size()) {
      points[i].point = part.points[position];
      continue;
    }
    points[i].point = position - part.points.size();
    if (isInAPart(points[i].point, parts)) {
      reader.fail(begin, fmt::format("cover point {} of part {} is vertex {}, expected one of the part or of no part",
                                     i, index, points[i].point));
      return {};
    }
  }
  if (!takeKnown(reader, "whether a part's cover points are displaced")) return points;
  for (CoverPoint& point : points) point.outward = takeVector(reader, "a displacement of a cover point");
  return points;
}

HullCover takeCover(ByteReader& reader, const Decomposition& decomposition) {
  const std::span<const Part> parts = decomposition.parts;
  HullCover cover;
  cover.tolerance = takeDistance(reader, "the tolerance of the cover");
  cover.maxHullVertices = reader.takeIndex("the bound on a hull's vertices", 0, kLargestCoverIndex + 1);
  cover.sampledPoses = reader.takeIndex("the number of sampled poses", 0, kLargestCoverIndex + 1);
  cover.heldOutPoses = reader.takeIndex("the number of poses held out", 0, kLargestCoverIndex + 1);
  cover.growth = takeDistance(reader, "the growth of the cover");
  cover.sampledShortfall = takeDistance(reader, "the shortfall in the sampled poses");
  cover.heldOutShortfall = takeDistance(reader, "the shortfall in the poses held out");
  const std::size_t count = reader.takeCount("the number of parts with cover points", kCoverPartBytes);
  if (reader.ok() && count != parts.size()) {
    reader.fail(reader.offset() - 4, fmt::format("{} parts with cover points, expected {}", count, parts.size()));
  }
  if (!reader.ok()) return cover;
  cover.points.reserve(count);
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    cover.points.push_back(takeCoverPoints(reader, i, parts, decomposition.vertexCount));
  }
  return cover;
}

}  // namespace

void appendTrainingAndCover(const DecompositionFile& content, std::string& payload) {
  appendLittleEndian(static_cast<std::uint8_t>(content.training ? 1 : 0), payload);
  if (content.training) appendTraining(*content.training, payload);
  appendLittleEndian(static_cast<std::uint8_t>(content.cover ? 1 : 0), payload);
  if (content.cover) appendCover(*content.cover, content.decomposition, payload);
}

void takeTrainingAndCover(ByteReader& reader, DecompositionFile& content) {
  if (takeKnown(reader, "whether the training is known")) {
    content.training = takeTraining(reader, content.decomposition.pointCount());
  }
  if (takeKnown(reader, "whether the cover is known")) {
    content.cover = takeCover(reader, content.decomposition);
  }
}

}  // namespace lorica

#include "acd/decomposition_file_version1.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace lorica {
namespace {

constexpr std::int64_t kLargestIndex = std::numeric_limits<std::int32_t>::max();
constexpr std::size_t kCutPointBytes = 4 + 4 + 8;
constexpr std::size_t kTriangleBytes = 3 * 4 + 4;

/// The points that triangles use, ascending. `seen` is scratch: one entry for each point, all 0 before and after, or
/// empty where there are so many points that this would be the larger part of the work.
std::vector<PointIndex> pointsOf(const std::vector<Triangle>& triangles, std::vector<char>& seen) {
  std::vector<PointIndex> points;
  for (const Triangle& t : triangles) {
    for (const PointIndex p : t) {
      if (!seen.empty() && seen[p]) continue;
      if (!seen.empty()) seen[p] = 1;
      points.push_back(p);
    }
  }
  if (!seen.empty()) {
    for (const PointIndex p : points) seen[p] = 0;
  }
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

void takeCutPoints(ByteReader& reader, Decomposition& decomposition) {
  const std::size_t count = reader.takeCount("the number of cut points", kCutPointBytes);
  if (decomposition.vertexCount + static_cast<std::int64_t>(count) > kLargestIndex) {
    reader.fail(reader.offset() - 4, fmt::format("{} vertices and {} cut points are more than an index can name",
                                                 decomposition.vertexCount, count));
    return;
  }
  decomposition.cutPoints.reserve(count);
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    const std::int64_t older = decomposition.vertexCount + static_cast<std::int64_t>(i);
    CutPoint point;
    point.first = reader.takeIndex("a cut point's first end (an older point)", 0, older);
    point.second = reader.takeIndex("a cut point's second end (an older point)", 0, older);
    point.lambda = reader.take<double>("a cut point's lambda");
    if (!(point.lambda >= 0.0 && point.lambda <= 1.0)) {
      reader.fail(reader.offset() - 8, fmt::format("lambda of cut point {} is {}, expected 0 to 1", i, point.lambda));
    }
    decomposition.cutPoints.push_back(point);
  }
}

void takeSplits(ByteReader& reader, Decomposition& decomposition) {
  const std::size_t count = reader.takeCount("the number of splits", 4);
  decomposition.splitFrom.reserve(count);
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    decomposition.splitFrom.push_back(
        reader.takeIndex("the part that a split divides", 0, static_cast<std::int64_t>(i) + 1));
  }
}

void takeParts(ByteReader& reader, Decomposition& decomposition) {
  const std::size_t count = reader.takeCount("the number of parts", 4);
  if (reader.ok() && count != decomposition.splitFrom.size() + 1) {
    reader.fail(reader.offset() - 4, fmt::format("{} parts after {} splits, expected {}", count,
                                                 decomposition.splitFrom.size(), decomposition.splitFrom.size() + 1));
  }
  if (!reader.ok()) return;
  // The vertex count is a number that nothing in the file backs: it must not decide how much is allocated.
  const auto pointCount = static_cast<std::size_t>(decomposition.pointCount());
  std::vector<char> seen(pointCount < 4 * reader.left() ? pointCount : 0, 0);
  decomposition.parts.reserve(count);
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    Part part;
    const std::size_t triangleCount = reader.takeCount("the number of a part's triangles", kTriangleBytes);
    part.triangles.reserve(triangleCount);
    part.sourceTriangle.reserve(triangleCount);
    for (std::size_t k = 0; k < triangleCount && reader.ok(); ++k) {
      Triangle t;
      for (PointIndex& p : t) p = reader.takeIndex("a corner of a part", 0, decomposition.pointCount());
      part.triangles.push_back(t);
    }
    for (std::size_t k = 0; k < triangleCount && reader.ok(); ++k) {
      part.sourceTriangle.push_back(reader.takeIndex("a source triangle", -1, decomposition.triangleCount));
    }
    if (!reader.ok()) return;
    part.points = pointsOf(part.triangles, seen);
    decomposition.parts.push_back(std::move(part));
  }
}

}  // namespace

void takeDescription(ByteReader& reader, DecompositionFile& content) {
  content.source = reader.takeText(reader.takeCount("the length of the source's name", 1));
  content.meshHash = reader.take<std::uint64_t>("the mesh's hash");
  content.meanError = reader.takeFinite("the mean error");
  const std::size_t keyframeCount = reader.takeCount("the number of keyframe errors", 8);
  content.errorPerKeyframe.reserve(keyframeCount);
  for (std::size_t k = 0; k < keyframeCount && reader.ok(); ++k) {
    content.errorPerKeyframe.push_back(reader.takeFinite("a keyframe's error"));
  }
  content.decomposition.vertexCount = reader.takeIndex("the mesh's vertex count", 0, kLargestIndex + 1);
  content.decomposition.triangleCount = reader.takeIndex("the mesh's triangle count", 0, kLargestIndex + 1);
}

DecompositionFile takeVersion1(ByteReader& reader) {
  DecompositionFile content;
  takeDescription(reader, content);
  takeCutPoints(reader, content.decomposition);
  takeSplits(reader, content.decomposition);
  takeParts(reader, content.decomposition);
  return content;
}

}  // namespace lorica

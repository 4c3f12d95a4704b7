#include "acd/decomposition.h"

#include "geometry/files.h"
#include "geometry/little_endian.h"

namespace lorica {

std::uint64_t hashOf(const Decomposition& decomposition) {
  std::size_t size = 64 + 16 * decomposition.cutPoints.size() + 4 * decomposition.splitFrom.size();
  for (const Part& part : decomposition.parts) size += 24 + 16 * part.triangles.size() + 4 * part.points.size();

  // Field by field: structs have padding, and machines differ in byte order.
  std::string bytes;
  bytes.reserve(size);
  const auto add = [&](auto value) { appendLittleEndian(value, bytes); };
  // A length before each list, so that different lists cannot give the same bytes.
  const auto addLength = [&](std::size_t length) { add(std::uint64_t{length}); };
  add(decomposition.vertexCount);
  add(decomposition.triangleCount);
  addLength(decomposition.cutPoints.size());
  for (const CutPoint& point : decomposition.cutPoints) {
    add(point.first);
    add(point.second);
    add(point.lambda);
  }
  addLength(decomposition.splitFrom.size());
  for (const PartIndex from : decomposition.splitFrom) add(from);
  addLength(decomposition.parts.size());
  for (const Part& part : decomposition.parts) {
    addLength(part.triangles.size());
    for (const Triangle& t : part.triangles) {
      for (const PointIndex p : t) add(p);
    }
    addLength(part.sourceTriangle.size());
    for (const std::int32_t source : part.sourceTriangle) add(source);
    addLength(part.points.size());
    for (const PointIndex p : part.points) add(p);
  }
  return contentHash(bytes);
}

}  // namespace lorica

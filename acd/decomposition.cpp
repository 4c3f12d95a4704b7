#include "acd/decomposition.h"

#include "geometry/files.h"
#include "geometry/little_endian.h"

namespace lorica {

namespace {

/// Serializes the content field by field: structs have padding, and machines differ in byte order.
class HashedBytes {
 public:
  explicit HashedBytes(std::size_t expected) { bytes_.reserve(expected); }
  void add(std::int32_t value) { appendLittleEndian(value, bytes_); }
  void add(double value) { appendLittleEndian(value, bytes_); }
  /// A length before each list, so that different lists cannot give the same bytes.
  void addLength(std::size_t length) { appendLittleEndian(std::uint64_t{length}, bytes_); }
  [[nodiscard]] std::uint64_t hash() const { return contentHash(bytes_); }

 private:
  std::string bytes_;
};

}  // namespace

std::uint64_t hashOf(const Decomposition& decomposition) {
  std::size_t size = 64 + 16 * decomposition.cutPoints.size() + 4 * decomposition.splitFrom.size();
  for (const Part& part : decomposition.parts) size += 24 + 16 * part.triangles.size() + 4 * part.points.size();

  HashedBytes bytes(size);
  bytes.add(decomposition.vertexCount);
  bytes.add(decomposition.triangleCount);
  bytes.addLength(decomposition.cutPoints.size());
  for (const CutPoint& point : decomposition.cutPoints) {
    bytes.add(point.first);
    bytes.add(point.second);
    bytes.add(point.lambda);
  }
  bytes.addLength(decomposition.splitFrom.size());
  for (const PartIndex from : decomposition.splitFrom) bytes.add(from);
  bytes.addLength(decomposition.parts.size());
  for (const Part& part : decomposition.parts) {
    bytes.addLength(part.triangles.size());
    for (const Triangle& t : part.triangles) {
      for (const PointIndex p : t) bytes.add(p);
    }
    bytes.addLength(part.sourceTriangle.size());
    for (const std::int32_t source : part.sourceTriangle) bytes.add(source);
    bytes.addLength(part.points.size());
    for (const PointIndex p : part.points) bytes.add(p);
  }
  return bytes.hash();
}

}  // namespace lorica

#include "acd/decomposition_file.h"

#include "geometry/files.h"
#include "geometry/little_endian.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace lorica {

namespace {

// docs/LORICA_FILE.md describes the layout. A change of it raises kVersion, and older versions stay readable.
constexpr std::string_view kMagic = "LORICA\r\n";  // the line end betrays a transfer in text mode
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kHeaderBytes = 28;
constexpr std::int64_t kLargestIndex = std::numeric_limits<std::int32_t>::max();

constexpr std::size_t kCutPointBytes = 4 + 4 + 8;
constexpr std::size_t kTriangleBytes = 3 * 4 + 4;

/// Takes numbers from the bytes one after the other. After the first failure everything is 0, and error() tells.
class Reader {
 public:
  Reader(std::string_view bytes, std::size_t offset, std::string fileName)
      : bytes_(bytes), offset_(offset), fileName_(std::move(fileName)) {}

  template <typename T>
  T take(const char* what) {
    if (error_) return T{};
    if (left() < sizeof(T)) {
      fail(offset_, fmt::format("expected {} ({} bytes), {} bytes are left", what, sizeof(T), left()));
      return T{};
    }
    const T value = loadLittleEndian<T>(bytes_.data() + offset_);
    offset_ += sizeof(T);
    return value;
  }

  double takeFinite(const char* what) {
    const auto value = take<double>(what);
    if (!std::isfinite(value)) fail(offset_ - 8, fmt::format("{} is {}, expected a finite number", what, value));
    return value;
  }

  std::int32_t takeIndex(const char* what, std::int64_t least, std::int64_t end) {
    const auto value = take<std::int32_t>(what);
    if (value < least || value >= end) {
      fail(offset_ - 4, fmt::format("{} is {}, expected {} to {}", what, value, least, end - 1));
    }
    return value;
  }

  /// Length of a list, which must fit into what is left: nothing is allocated on the word of a damaged number.
  std::size_t takeCount(const char* what, std::size_t bytesEach) {
    const auto count = take<std::uint32_t>(what);
    if (count > left() / bytesEach || count > kLargestIndex) {
      fail(offset_ - 4, fmt::format("{} is {}, which needs {} bytes or more; {} are left", what, count,
                                    static_cast<std::uint64_t>(count) * bytesEach, left()));
    }
    return error_ ? 0 : count;
  }

  std::string takeText(std::size_t length) {
    std::string text(bytes_.substr(offset_, length));
    offset_ += length;
    return text;
  }

  void fail(std::size_t at, std::string_view message) {
    if (!error_) error_ = Error{ErrorCode::kBadFormat, fmt::format("{}: byte {}: {}", fileName_, at, message)};
  }

  [[nodiscard]] bool ok() const { return !error_; }
  [[nodiscard]] const Error& error() const { return *error_; }
  [[nodiscard]] std::size_t offset() const { return offset_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - offset_; }

 private:
  std::string_view bytes_;
  std::size_t offset_;
  std::string fileName_;
  std::optional<Error> error_;
};

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

void takeCutPoints(Reader& reader, Decomposition& decomposition) {
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

void takeSplits(Reader& reader, Decomposition& decomposition) {
  const std::size_t count = reader.takeCount("the number of splits", 4);
  decomposition.splitFrom.reserve(count);
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    decomposition.splitFrom.push_back(
        reader.takeIndex("the part that a split divides", 0, static_cast<std::int64_t>(i) + 1));
  }
}

void takeParts(Reader& reader, Decomposition& decomposition) {
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

std::string encode(const DecompositionFile& content) {
  const Decomposition& decomposition = content.decomposition;
  std::string payload;
  const auto put = [&](auto value) { appendLittleEndian(value, payload); };
  const auto putCount = [&](std::size_t count) { put(static_cast<std::uint32_t>(count)); };

  putCount(content.source.size());
  payload += content.source;
  put(content.meshHash);
  put(content.meanError);
  putCount(content.errorPerKeyframe.size());
  for (const double error : content.errorPerKeyframe) put(error);

  put(static_cast<std::int32_t>(decomposition.vertexCount));
  put(static_cast<std::int32_t>(decomposition.triangleCount));
  putCount(decomposition.cutPoints.size());
  for (const CutPoint& point : decomposition.cutPoints) {
    put(point.first);
    put(point.second);
    put(point.lambda);
  }
  putCount(decomposition.splitFrom.size());
  for (const PartIndex from : decomposition.splitFrom) put(from);
  putCount(decomposition.parts.size());
  for (const Part& part : decomposition.parts) {
    putCount(part.triangles.size());
    for (const Triangle& t : part.triangles) {
      for (const PointIndex p : t) put(p);
    }
    for (const std::int32_t source : part.sourceTriangle) put(source);
  }

  std::string bytes(kMagic);
  appendLittleEndian(kVersion, bytes);
  appendLittleEndian(static_cast<std::uint64_t>(payload.size()), bytes);
  appendLittleEndian(contentHash(payload, kVersion), bytes);
  return bytes + payload;
}

Result<DecompositionFile> decode(std::string_view bytes, const std::string& fileName) {
  const auto refused = [&](ErrorCode code, std::string_view message) {
    return Error{code, fmt::format("{}: {}", fileName, message)};
  };
  if (bytes.substr(0, kMagic.size()) != kMagic) {
    return refused(ErrorCode::kBadFormat, "not a .lorica file: its first 8 bytes are not LORICA, CR, LF");
  }
  if (bytes.size() < kHeaderBytes) {
    return refused(ErrorCode::kBadFormat,
                   fmt::format("ends at byte {} within the header of {} bytes", bytes.size(), kHeaderBytes));
  }
  const auto version = loadLittleEndian<std::uint32_t>(bytes.data() + 8);
  if (version > kVersion) {
    return refused(ErrorCode::kUnsupported,
                   fmt::format("has format version {}; this Lorica reads versions 1 to {}, a newer one wrote the file",
                               version, kVersion));
  }
  if (version == 0) return refused(ErrorCode::kBadFormat, "byte 8: format version 0, expected 1 or more");
  const auto payloadBytes = loadLittleEndian<std::uint64_t>(bytes.data() + 12);
  const std::string_view payload = bytes.substr(kHeaderBytes);
  if (payload.size() != payloadBytes) {
    return refused(ErrorCode::kBadFormat, fmt::format("byte 12: announces {} bytes after the header, {} are there",
                                                      payloadBytes, payload.size()));
  }
  const auto expected = loadLittleEndian<std::uint64_t>(bytes.data() + 20);
  const std::uint64_t found = contentHash(payload, version);
  if (found != expected) {
    return refused(ErrorCode::kBadFormat, fmt::format("damaged: the checksum is {}, expected {} (byte 20)",
                                                      hexDigits(found), hexDigits(expected)));
  }

  Reader reader(bytes, kHeaderBytes, fileName);
  DecompositionFile content;
  content.source = reader.takeText(reader.takeCount("the length of the source's name", 1));
  content.meshHash = reader.take<std::uint64_t>("the mesh's hash");
  content.meanError = reader.takeFinite("the mean error");
  const std::size_t keyframeCount = reader.takeCount("the number of keyframe errors", 8);
  for (std::size_t k = 0; k < keyframeCount && reader.ok(); ++k) {
    content.errorPerKeyframe.push_back(reader.takeFinite("a keyframe's error"));
  }
  content.decomposition.vertexCount = reader.takeIndex("the mesh's vertex count", 0, kLargestIndex + 1);
  content.decomposition.triangleCount = reader.takeIndex("the mesh's triangle count", 0, kLargestIndex + 1);
  takeCutPoints(reader, content.decomposition);
  takeSplits(reader, content.decomposition);
  takeParts(reader, content.decomposition);
  if (reader.ok() && reader.left() > 0) {
    reader.fail(reader.offset(), fmt::format("{} bytes are left after the last part", reader.left()));
  }
  if (!reader.ok()) return reader.error();
  return content;
}

}  // namespace

std::uint64_t topologyHash(const TriMesh& mesh) {
  std::string bytes;
  bytes.reserve(8 + 12 * mesh.triangles.size());
  appendLittleEndian(static_cast<std::uint64_t>(mesh.vertices.size()), bytes);
  for (const Triangle& t : mesh.triangles) {
    for (const VertexIndex v : t) appendLittleEndian(v, bytes);
  }
  return contentHash(bytes);
}

Result<void> writeDecomposition(const std::filesystem::path& file, const DecompositionFile& content) {
  // Reading back costs a millisecond, and a file that nobody can read later would cost the whole decomposition.
  const std::string bytes = encode(content);
  const Result<DecompositionFile> again = decode(bytes, file.string());
  if (!again)
    return Error{ErrorCode::kInvalidArgument, "not written, for it could not be read: " + again.error().message};
  if (hashOf(again->decomposition) != hashOf(content.decomposition)) {
    return Error{
        ErrorCode::kInvalidArgument,
        fmt::format("{}: not written: a part's points or source triangles do not fit its triangles", file.string())};
  }
  return writeFileAtomically(file, bytes);
}

Result<DecompositionFile> readDecomposition(const std::filesystem::path& file) {
  const Result<std::string> bytes = readFile(file);
  if (!bytes) return bytes.error();
  return decode(*bytes, file.string());
}

}  // namespace lorica

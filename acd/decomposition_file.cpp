#include "acd/decomposition_file.h"

#include "acd/decomposition_file_cover.h"
#include "acd/packed_numbers.h"
#include "geometry/byte_reader.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/interrupt.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace lorica {

namespace {

// docs/LORICA_FILE.md describes the layout. Any change of it raises kVersion.
constexpr std::string_view kMagic = "LORICA\r\n";  // the line end betrays a transfer in text mode
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kHeaderBytes = 28;
constexpr std::int64_t kLargestIndex = std::numeric_limits<std::int32_t>::max();

// The smallest size of an entry: a packed number is a byte and a quarter of a control byte.
constexpr std::size_t kCutPointBytes = 8 + 2;
constexpr std::size_t kTriangleBytes = 4 + 1;
constexpr std::size_t kDetailLevelBytes = 8 + 8 + 4;
constexpr std::size_t kBoneShareBytes = 4 + 8;

// ---- Writing ----

std::uint32_t bits(std::int32_t value) {
  return value;
}

/// The points that triangles use, ascending.
std::vector<PointIndex> pointsOf(const std::vector<Triangle>& triangles) {
  std::vector<PointIndex> points;
  points.reserve(3 * triangles.size());
  for (const Triangle& t : triangles) points.insert(points.end(), t.begin(), t.end());
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

class Writer {
 public:
  template <typename T>
  void put(T value) {
    appendLittleEndian(value, payload_);
  }
  void putCount(std::size_t count) { put(static_cast<std::uint32_t>(count)); }
  void putText(std::string_view text) {
    putCount(text.size());
    payload_ += text;
  }
  void putPacked(std::span<const std::uint32_t> values) { appendPacked(values, payload_); }

  void putCutPoints(std::span<const CutPoint> cutPoints) {
    putCount(cutPoints.size());
    std::vector<std::uint32_t> ends;
    ends.reserve(2 * cutPoints.size());
    std::uint32_t before = 0;
    for (const CutPoint& point : cutPoints) {
      ends.push_back(zigzag(bits(point.first) - before));
      ends.push_back(zigzag(bits(point.second) - bits(point.first)));
      before = bits(point.first);
    }
    putPacked(ends);
    for (const CutPoint& point : cutPoints) put(point.lambda);
  }

  void putPart(const Part& part) {
    // From the triangles and not from the part's own list, which may be wrong: reading back tells.
    const std::vector<PointIndex> points = pointsOf(part.triangles);
    putCount(part.triangles.size());
    putCount(points.size());
    std::vector<std::uint32_t> values;
    values.reserve(3 * part.triangles.size());
    std::uint32_t next = 0;
    for (const PointIndex p : points) {
      values.push_back(bits(p) - next);
      next = bits(p) + 1;
    }
    putPacked(values);

    values.clear();
    const auto numberOf = [&points](PointIndex p) {
      return static_cast<std::uint32_t>(std::lower_bound(points.begin(), points.end(), p) - points.begin());
    };
    std::uint32_t firstBefore = 0;
    for (const Triangle& t : part.triangles) {
      const std::uint32_t first = numberOf(t[0]), second = numberOf(t[1]), third = numberOf(t[2]);
      values.insert(values.end(), {zigzag(first - firstBefore), zigzag(second - first), zigzag(third - second)});
      firstBefore = first;
    }
    putPacked(values);

    values.assign(part.triangles.size(), 0);
    std::uint32_t before = 0;
    for (std::size_t i = 0; i < std::min(values.size(), part.sourceTriangle.size()); ++i) {
      values[i] = zigzag(bits(part.sourceTriangle[i]) - before);
      before = bits(part.sourceTriangle[i]);
    }
    putPacked(values);
  }

  void putDetailLevels(std::span<const DetailLevel> detailLevels) {
    putCount(detailLevels.size());
    for (const DetailLevel& level : detailLevels) {
      put(level.meanError);
      put(level.worstError);
      put(level.hullVertices);
    }
  }

  void putBones(std::span<const std::vector<BoneShare>> bonesOfPart) {
    std::vector<std::string> names;
    for (const std::vector<BoneShare>& bones : bonesOfPart) {
      for (const BoneShare& bone : bones) names.push_back(bone.bone);
    }
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    putCount(names.size());
    for (const std::string& name : names) putText(name);
    putCount(bonesOfPart.size());
    for (const std::vector<BoneShare>& bones : bonesOfPart) {
      putCount(bones.size());
      for (const BoneShare& bone : bones) {
        put(static_cast<std::int32_t>(std::lower_bound(names.begin(), names.end(), bone.bone) - names.begin()));
        put(bone.share);
      }
    }
  }

  void putTrainingAndCover(const DecompositionFile& content) { appendTrainingAndCover(content, payload_); }

  [[nodiscard]] std::string file() const {
    std::string bytes(kMagic);
    bytes.reserve(kHeaderBytes + payload_.size());
    appendLittleEndian(kVersion, bytes);
    appendLittleEndian(std::uint64_t{payload_.size()}, bytes);
    appendLittleEndian(contentHash(payload_, kVersion), bytes);
    return bytes + payload_;
  }

 private:
  std::string payload_;
};

std::string encode(const DecompositionFile& content) {
  const Decomposition& decomposition = content.decomposition;
  Writer writer;
  writer.putText(content.source);
  writer.put(content.meshHash);
  writer.put(content.meanError);
  writer.putCount(content.errorPerKeyframe.size());
  for (const double error : content.errorPerKeyframe) writer.put(error);
  writer.put(decomposition.vertexCount);
  writer.put(decomposition.triangleCount);
  writer.putCutPoints(decomposition.cutPoints);
  writer.putCount(decomposition.splitFrom.size());
  for (const PartIndex from : decomposition.splitFrom) writer.put(from);
  writer.putCount(decomposition.parts.size());
  for (const Part& part : decomposition.parts) writer.putPart(part);
  writer.putDetailLevels(content.detailLevels);
  writer.putBones(content.bonesOfPart);
  writer.putTrainingAndCover(content);
  return writer.file();
}

// ---- Reading ----

/// Memory for what is unpacked before it is made into parts.
using Scratch = std::vector<std::uint32_t>;

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

void takeCutPoints(ByteReader& reader, Decomposition& decomposition, Scratch& ends) {
  const std::size_t count = reader.takeCount("the number of cut points", kCutPointBytes);
  if (decomposition.vertexCount + static_cast<std::int64_t>(count) > kLargestIndex) {
    reader.fail(reader.offset() - 4, fmt::format("{} vertices and {} cut points are more than an index can name",
                                                 decomposition.vertexCount, count));
    return;
  }
  const std::size_t begin = reader.offset();
  ends.resize(2 * count);
  takePacked(reader, "the ends of the cut points", ends);
  decomposition.cutPoints.resize(reader.ok() ? count : 0);
  std::uint32_t before = 0;
  for (std::size_t i = 0; i < decomposition.cutPoints.size(); ++i) {
    CutPoint& point = decomposition.cutPoints[i];
    const std::uint32_t first = before + unzigzag(ends[2 * i]);
    const std::uint32_t second = first + unzigzag(ends[2 * i + 1]);
    const std::uint32_t older = bits(decomposition.vertexCount) + static_cast<std::uint32_t>(i);
    if (first >= older || second >= older) {
      reader.fail(begin, fmt::format("cut point {} lies between points {} and {}, expected 0 to {} for both", i, first,
                                     second, std::int64_t{older} - 1));
      return;
    }
    point.first = first;
    point.second = second;
    point.lambda = reader.take<double>("a cut point's lambda");
    if (!(point.lambda >= 0.0 && point.lambda <= 1.0)) {
      reader.fail(reader.offset() - 8, fmt::format("lambda of cut point {} is {}, expected 0 to 1", i, point.lambda));
      return;
    }
    before = first;
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

/// Points in ascending order, each stored as how many numbers were skipped since the one before.
void takePoints(ByteReader& reader, std::size_t index, int pointCount, Scratch& values, Part& part) {
  const std::size_t begin = reader.offset();
  values.resize(part.points.size());
  takePacked(reader, "the points of a part", values);
  std::uint64_t next = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::uint64_t p = next + values[i];
    part.points[i] = p;
    next = p + 1;
  }
  if (next > static_cast<std::uint64_t>(pointCount)) {
    reader.fail(begin, fmt::format("the last point of part {} is {}, expected {} to {}", index, next - 1,
                                   part.points.size() - 1, pointCount - 1));
  }
}

/// Corners number the part's own points, and use each of them.
void takeTriangles(ByteReader& reader, std::size_t index, Scratch& values, Part& part) {
  const std::size_t begin = reader.offset();
  values.resize(3 * part.triangles.size());
  takePacked(reader, "the corners of a part", values);
  if (!reader.ok()) return;
  std::vector<std::uint8_t> usedPoints(part.points.size(), 0);
  // Spans, taken once: storing a byte may alias anything, and every begin() would be read again.
  const std::span<std::uint8_t> used = usedPoints;
  const std::span<const std::uint32_t> differences = values;
  const std::span<const PointIndex> points = part.points;
  const std::span<Triangle> triangles = part.triangles;
  const std::uint32_t end = used.size();
  std::uint32_t first = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    first += unzigzag(differences[3 * i]);
    const std::uint32_t second = first + unzigzag(differences[3 * i + 1]);
    const std::uint32_t third = second + unzigzag(differences[3 * i + 2]);
    if (first >= end || second >= end || third >= end) {
      reader.fail(begin, fmt::format("triangle {} of part {} has corners {}, {} and {}, expected 0 to {}", i, index,
                                     first, second, third, static_cast<std::int64_t>(end) - 1));
      return;
    }
    used[first] = used[second] = used[third] = 1;
    triangles[i] = {points[first], points[second], points[third]};
  }
  const auto unused = std::find(used.begin(), used.end(), 0);
  if (unused != used.end()) {
    reader.fail(begin, fmt::format("part {} lists point {}, which none of its triangles uses", index,
                                   part.points[unused - used.begin()]));
  }
}

void takeSources(ByteReader& reader, std::size_t index, int triangleCount, Scratch& values, Part& part) {
  const std::size_t begin = reader.offset();
  values.resize(part.sourceTriangle.size());
  takePacked(reader, "the source triangles of a part", values);
  std::uint32_t source = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    source += unzigzag(values[i]);
    part.sourceTriangle[i] = source;
    // One more turns -1, a cap, into 0, and what would be negative into a number beyond any.
    if (source + 1 > bits(triangleCount)) {
      reader.fail(begin, fmt::format("triangle {} of part {} comes from triangle {}, expected -1 to {}", i, index,
                                     part.sourceTriangle[i], triangleCount - 1));
      return;
    }
  }
}

void takeParts(ByteReader& reader, Decomposition& decomposition, Scratch& values) {
  const std::size_t count = reader.takeCount("the number of parts", 8);
  if (reader.ok() && count != decomposition.splitFrom.size() + 1) {
    reader.fail(reader.offset() - 4, fmt::format("{} parts after {} splits, expected {}", count,
                                                 decomposition.splitFrom.size(), decomposition.splitFrom.size() + 1));
  }
  if (!reader.ok()) return;
  decomposition.parts.resize(count);
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    Part& part = decomposition.parts[i];
    const std::size_t triangleCount = reader.takeCount("the number of a part's triangles", kTriangleBytes);
    const std::size_t pointCount = reader.takeCount("the number of a part's points", 1);
    if (!reader.ok()) return;
    part.triangles.resize(triangleCount);
    part.sourceTriangle.resize(triangleCount);
    part.points.resize(pointCount);
    takePoints(reader, i, decomposition.pointCount(), values, part);
    takeTriangles(reader, i, values, part);
    takeSources(reader, i, decomposition.triangleCount, values, part);
  }
}

void takeDetailLevels(ByteReader& reader, DecompositionFile& content) {
  const std::size_t count = reader.takeCount("the number of levels of detail", kDetailLevelBytes);
  const std::size_t parts = content.decomposition.parts.size();
  if (reader.ok() && count != 0 && count != parts) {
    reader.fail(reader.offset() - 4,
                fmt::format("{} levels of detail of {} parts, expected 0 or {}", count, parts, parts));
  }
  content.detailLevels.reserve(reader.ok() ? count : 0);
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    DetailLevel level;
    level.meanError = reader.takeFinite("the mean error of a level of detail");
    level.worstError = reader.takeFinite("the worst error of a level of detail");
    level.hullVertices = reader.takeIndex("the number of hull vertices of a level of detail", 0, kLargestIndex + 1);
    content.detailLevels.push_back(level);
  }
}

void takeBones(ByteReader& reader, DecompositionFile& content) {
  std::vector<std::string> names(reader.takeCount("the number of bones", 4));
  for (std::string& name : names) name = reader.takeText(reader.takeCount("the length of a bone's name", 1));
  const std::size_t count = reader.takeCount("the number of parts with bones", 4);
  const std::size_t parts = content.decomposition.parts.size();
  if (reader.ok() && count != 0 && count != parts) {
    reader.fail(reader.offset() - 4, fmt::format("{} parts with bones, expected 0 or {}", count, parts));
  }
  content.bonesOfPart.resize(reader.ok() ? count : 0);
  for (std::vector<BoneShare>& bones : content.bonesOfPart) {
    const std::size_t boneCount = reader.takeCount("the number of bones that move a part", kBoneShareBytes);
    bones.reserve(boneCount);
    double largest = 1.0;
    for (std::size_t i = 0; i < boneCount && reader.ok(); ++i) {
      const auto bone = reader.takeIndex("a bone", 0, std::ssize(names));
      const auto share = reader.take<double>("a bone's share");
      if (!(share > 0.0 && share <= largest)) {
        reader.fail(reader.offset() - 8,
                    fmt::format("a bone's share is {}, expected above 0 and at most {}", share, largest));
      }
      if (!reader.ok()) return;
      bones.push_back({names[bone], share});
      largest = share;
    }
  }
}

DecompositionFile takeContent(ByteReader& reader) {
  DecompositionFile content;
  Scratch scratch;
  takeDescription(reader, content);
  takeCutPoints(reader, content.decomposition, scratch);
  takeSplits(reader, content.decomposition);
  takeParts(reader, content.decomposition, scratch);
  takeDetailLevels(reader, content);
  takeBones(reader, content);
  takeTrainingAndCover(reader, content);
  return content;
}

}  // namespace

std::uint64_t topologyHash(const TriMesh& mesh) {
  std::string bytes;
  bytes.reserve(8 + 12 * mesh.triangles.size());
  appendLittleEndian(std::uint64_t{mesh.vertices.size()}, bytes);
  for (const Triangle& t : mesh.triangles) {
    for (const VertexIndex v : t) appendLittleEndian(v, bytes);
  }
  return contentHash(bytes);
}

Result<DecompositionFile> parseDecomposition(std::string_view bytes, const std::string& name) {
  const auto refused = [&](ErrorCode code, std::string_view message) {
    return Error{code, fmt::format("{}: {}", name, message)};
  };
  if (bytes.substr(0, kMagic.size()) != kMagic) {
    return refused(ErrorCode::kBadFormat, "not a .lorica file: its first 8 bytes are not LORICA, CR, LF");
  }
  if (bytes.size() < kHeaderBytes) {
    return refused(ErrorCode::kBadFormat,
                   fmt::format("ends at byte {} within the header of {} bytes", bytes.size(), kHeaderBytes));
  }
  const auto version = loadLittleEndian<std::uint32_t>(bytes.data() + 8);
  if (version != kVersion) {
    return refused(ErrorCode::kUnsupported,
                   fmt::format("byte 8: found format version {}, expected {}", version, kVersion));
  }
  const auto payloadBytes = loadLittleEndian<std::uint64_t>(bytes.data() + 12);
  const std::string_view payload = bytes.substr(kHeaderBytes);
  if (payload.size() != payloadBytes) {
    return refused(ErrorCode::kBadFormat, fmt::format("byte 12: announces {} bytes after the header, {} are there",
                                                      payloadBytes, payload.size()));
  }
  const auto expected = loadLittleEndian<std::uint64_t>(bytes.data() + 20);
  const std::uint64_t found = contentHash(payload, kVersion);
  if (found != expected) {
    return refused(ErrorCode::kBadFormat, fmt::format("damaged: the checksum is {}, expected {} (byte 20)",
                                                      hexDigits(found), hexDigits(expected)));
  }

  ByteReader reader(bytes, kHeaderBytes, name);
  DecompositionFile content = takeContent(reader);
  if (reader.ok() && reader.left() > 0) {
    reader.fail(reader.offset(), fmt::format("{} bytes are left after the end", reader.left()));
  }
  if (!reader.ok()) return reader.error();
  return content;
}

Result<std::string> formatDecomposition(const DecompositionFile& content, const std::string& name) {
  if (const std::optional<TrainingRange>& training = content.training) {
    const std::size_t expected = training->keyframeCount * training->probes.size();
    if (training->positions.size() != expected) {
      return invalidArgument("{}: not written: {} positions of {} probes in {} keyframes", name,
                             training->positions.size(), training->probes.size(), training->keyframeCount);
    }
  }
  // Reading back costs a millisecond, and a file that nobody can read later would cost the whole decomposition.
  std::string bytes = encode(content);
  const Result<DecompositionFile> again = parseDecomposition(bytes, name);
  if (!again) return invalidArgument("not written, for it could not be read: " + again.error().message);
  if (hashOf(again->decomposition) != hashOf(content.decomposition)) {
    return invalidArgument("{}: not written: a part's points or source triangles do not fit its triangles", name);
  }
  return bytes;
}

Result<void> writeDecomposition(const std::filesystem::path& file, const DecompositionFile& content) {
  LORICA_TRY(const std::string bytes, formatDecomposition(content, file.string()));
  return writeFileAtomically(file, bytes);
}

Result<DecompositionFile> readDecomposition(const std::filesystem::path& file) {
  LORICA_TRY(const std::string bytes, readFile(file));
  return unlessStopped(parseDecomposition(bytes, file.string()));
}

}  // namespace lorica

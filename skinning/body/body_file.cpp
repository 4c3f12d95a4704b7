#include "skinning/body/body_file.h"

#include "geometry/byte_reader.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "skinning/body/body_assembly.h"

#include <fmt/format.h>

#include <limits>
#include <vector>

namespace lorica {

namespace {

// Little-endian: magic, version, checksum of the rest, then what takeBody() reads.
constexpr std::string_view kMagic = "LORBODY\n";
constexpr std::size_t kHeaderBytes = 8 + 4 + 8;
constexpr std::size_t kVertexBytes = 3 * 8 + 1;
constexpr std::size_t kTriangleBytes = 3 * 4;
constexpr int kMaxInfluences = 8;
constexpr std::int64_t kLargest = std::numeric_limits<std::int32_t>::max();

template <typename T>
void put(T value, std::string& bytes) {
  appendLittleEndian(value, bytes);
}

/// The numbers of a body that do not depend on its surface.
template <typename Body, typename Visit>
void eachCount(Body& body, const Visit& visit) {
  visit(body.shells);
  visit(body.openEdges);
  visit(body.nonManifoldEdges);
  visit(body.onlySheets);
}
template <typename Body, typename Visit>
void eachLength(Body& body, const Visit& visit) {
  visit(body.resolution);
  visit(body.distances.farthestOutside);
  visit(body.distances.meanOutside);
  visit(body.distances.meanToOriginal);
  visit(body.distances.farthestToOriginal);
}

void takeFigures(ByteReader& reader, ClosedBody& body) {
  eachCount(body, [&](auto& count) { count = reader.takeIndex("a count", 0, kLargest); });
  eachLength(body, [&](double& length) {
    length = reader.takeFinite("a length");
    if (length < 0.0) reader.fail(reader.offset() - 8, fmt::format("a length is {}, expected 0 or more", length));
  });
  const std::size_t notes = reader.takeCount("the number of notes", 4);
  for (std::size_t n = 0; n < notes && reader.ok(); ++n) {
    body.notes.push_back(reader.takeText(reader.takeCount("the length of a note", 1)));
  }
}

/// @param near  where vertices may be
TriMesh takeSurface(ByteReader& reader, const Aabb& near) {
  TriMesh surface;
  surface.vertices.resize(reader.takeCount("the number of vertices", kVertexBytes));
  for (Vec3& p : surface.vertices) {
    for (double& coordinate : p) coordinate = reader.takeFinite("a coordinate");
    if (!reader.ok()) return surface;
    if ((p.array() < near.min.array()).any() || (p.array() > near.max.array()).any()) {
      reader.fail(reader.offset() - 24,
                  fmt::format("a vertex is at ({:.4g}, {:.4g}, {:.4g}), far from the character", p.x(), p.y(), p.z()));
    }
  }
  surface.triangles.resize(reader.takeCount("the number of triangles", kTriangleBytes));
  for (Triangle& triangle : surface.triangles) {
    for (VertexIndex& v : triangle) v = reader.takeIndex("a corner", 0, std::ssize(surface.vertices));
  }
  if (!reader.ok()) return surface;
  if (const Result<void> closed = checkClosedTwoManifold(surface); !closed) {
    reader.fail(reader.offset(), closed.error().message);
  }
  return surface;
}

std::vector<std::vector<Influence>> takeWeights(ByteReader& reader, std::size_t vertexCount, int jointCount) {
  std::vector<std::vector<Influence>> weights(vertexCount);
  for (std::vector<Influence>& list : weights) {
    const int count = reader.take<std::uint8_t>("the number of a vertex's weights");
    if (count < 1 || count > kMaxInfluences) {
      reader.fail(reader.offset() - 1, fmt::format("a vertex has {} weights, expected 1 to {}", count, kMaxInfluences));
    }
    for (int i = 0; i < count && reader.ok(); ++i) {
      const JointIndex joint = reader.takeIndex("a joint", 0, jointCount);
      list.push_back({joint, reader.takeFinite("a weight")});
    }
    if (!reader.ok()) break;
  }
  return weights;
}

/// The character's box, larger on all sides by its longest side: no body is near the end of it.
Aabb surroundingsOf(const Character& character) {
  Aabb box = boundsOf(character.mesh.vertices);
  if (box.empty()) return box;
  const double margin = (box.max - box.min).maxCoeff();
  box.min.array() -= margin;
  box.max.array() += margin;
  return box;
}

}  // namespace

std::string encodeBody(const ClosedBody& body, std::uint64_t key) {
  LORICA_CHECK(body.made && body.reachedVertices == 0, "other bodies are quick to make");
  const Character& character = body.character;
  std::string payload;
  put(key, payload);
  eachCount(body, [&](int count) { put(count, payload); });
  eachLength(body, [&](double length) { put(length, payload); });
  put(static_cast<std::uint32_t>(body.notes.size()), payload);
  for (const std::string& note : body.notes) {
    put(static_cast<std::uint32_t>(note.size()), payload);
    payload += note;
  }
  const std::size_t vertexCount = body.bodyVertices;
  put(static_cast<std::uint32_t>(vertexCount), payload);
  for (std::size_t v = 0; v < vertexCount; ++v) {
    for (const double coordinate : character.mesh.vertices[v]) put(coordinate, payload);
  }
  put(static_cast<std::uint32_t>(character.mesh.triangles.size()), payload);
  for (const Triangle& triangle : character.mesh.triangles) {
    for (const VertexIndex v : triangle) put(v, payload);
  }
  for (std::size_t v = 0; v < vertexCount; ++v) {
    const std::uint32_t begin = character.influenceBegin[v];
    const std::uint32_t end = character.influenceBegin[v + 1];
    put(static_cast<std::uint8_t>(end - begin), payload);
    for (std::uint32_t i = begin; i < end; ++i) {
      put(character.influences[i].joint, payload);
      put(character.influences[i].weight, payload);
    }
  }
  std::string bytes(kMagic);
  put(kBodyVersion, bytes);
  put(contentHash(payload, kBodyVersion), bytes);
  return bytes + payload;
}

Result<ClosedBody> decodeBody(std::string_view bytes, const Character& character, std::uint64_t key,
                              const std::string& name) {
  ByteReader reader(bytes, 0, name);
  if (bytes.size() < kHeaderBytes || !bytes.starts_with(kMagic)) {
    return badFormat(name + ": not a body: its first bytes are not LORBODY");
  }
  reader.skip(kMagic.size());
  if (const auto version = reader.take<std::uint32_t>("the version"); version != kBodyVersion) {
    reader.fail(reader.offset() - 4, fmt::format("found version {}, expected {}", version, kBodyVersion));
  }
  if (reader.take<std::uint64_t>("the checksum") != contentHash(bytes.substr(kHeaderBytes), kBodyVersion)) {
    reader.fail(reader.offset() - 8, "damaged: the checksum is wrong");
  }
  if (reader.take<std::uint64_t>("the key") != key) {
    reader.fail(reader.offset() - 8, "made from another character or with other settings");
  }
  ClosedBody body;
  body.made = true;
  takeFigures(reader, body);
  const TriMesh surface = takeSurface(reader, surroundingsOf(character));
  const std::vector<std::vector<Influence>> weights =
      takeWeights(reader, surface.vertices.size(), character.skeleton.jointCount());
  if (reader.ok() && reader.left() > 0) {
    reader.fail(reader.offset(), fmt::format("{} bytes are left after the end", reader.left()));
  }
  if (!reader.ok()) return reader.error();
  body.bodyVertices = countOf(weights);
  body.character = assembleBody(character, surface, weights);
  if (const Result<void> sound = checkCharacter(body.character); !sound) {
    return badFormat(name + ": " + sound.error().message);
  }
  return body;
}

}  // namespace lorica

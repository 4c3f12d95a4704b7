// Bytes of bodies: bit for bit the same, and whatever is wrong with them is refused.

#include "skinning/body/body_file.h"

#include "geometry/files.h"
#include "geometry/little_endian.h"
#include "geometry/random_numbers.h"
#include "tests/skinning/body/hard_characters.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <memory>

namespace lorica {
namespace {

constexpr std::uint64_t kKey = 0x1234;
constexpr std::size_t kHeaderBytes = 20;

/// A box without a lid, on two joints, and its body.
struct OpenBox {
  Character character;
  ClosedBody body;

  OpenBox() {
    character = test::bonesAt({{"root", kNoJoint, Vec3::Zero()}, {"lid", 0, Vec3(0.0, 1.0, 0.0)}});
    TriMesh box = test::makeBox(Vec3(-0.5, 0.0, -0.5), Vec3(0.5, 1.0, 0.5));
    box.triangles.pop_back();
    test::add(character, box, 0);
    test::add(character, test::makeBox(Vec3(-0.2, 0.9, -0.2), Vec3(0.2, 1.4, 0.2)), 1);
    character = test::finished(std::move(character));
    body = makeBody(character).value();
  }
};
const OpenBox& openBox() {
  static const OpenBox made;
  return made;
}

/// Decodes from a buffer of exactly the size, so that a sanitizer notices reads beyond it.
Result<ClosedBody> decoded(std::string_view bytes, std::uint64_t key = kKey) {
  const std::unique_ptr<char[]> exact(new char[bytes.size()]);
  std::copy(bytes.begin(), bytes.end(), exact.get());
  return decodeBody({exact.get(), bytes.size()}, openBox().character, key, "entry");
}

/// With a checksum that is right whatever the bytes are.
std::string sealed(std::string bytes) {
  const std::uint64_t sum = contentHash(std::string_view(bytes).substr(kHeaderBytes), kBodyVersion);
  std::string digits;
  appendLittleEndian(sum, digits);
  return bytes.replace(12, 8, digits);
}

template <typename T>
std::string with(std::string bytes, std::size_t at, T value) {
  std::string digits;
  appendLittleEndian(value, digits);
  return sealed(bytes.replace(at, sizeof(T), digits));
}

void expectSame(const ClosedBody& a, const ClosedBody& b) {
  EXPECT_EQ(a.character.name, b.character.name);
  EXPECT_EQ(a.character.mesh.vertices, b.character.mesh.vertices);
  EXPECT_EQ(a.character.mesh.triangles, b.character.mesh.triangles);
  EXPECT_EQ(a.character.shown, b.character.shown);
  EXPECT_EQ(a.character.influenceBegin, b.character.influenceBegin);
  ASSERT_EQ(a.character.influences.size(), b.character.influences.size());
  for (std::size_t i = 0; i < a.character.influences.size(); ++i) {
    EXPECT_EQ(a.character.influences[i].joint, b.character.influences[i].joint);
    EXPECT_EQ(a.character.influences[i].weight, b.character.influences[i].weight);
  }
  EXPECT_EQ(a.character.height, b.character.height);
  EXPECT_EQ(a.character.skeleton.jointCount(), b.character.skeleton.jointCount());
  EXPECT_EQ(a.made, b.made);
  EXPECT_EQ(a.bodyVertices, b.bodyVertices);
  EXPECT_EQ(a.reachedVertices, b.reachedVertices);
  EXPECT_EQ(a.resolution, b.resolution);
  EXPECT_EQ(a.shells, b.shells);
  EXPECT_EQ(a.openEdges, b.openEdges);
  EXPECT_EQ(a.nonManifoldEdges, b.nonManifoldEdges);
  EXPECT_EQ(a.distances.farthestOutside, b.distances.farthestOutside);
  EXPECT_EQ(a.distances.meanOutside, b.distances.meanOutside);
  EXPECT_EQ(a.distances.meanToOriginal, b.distances.meanToOriginal);
  EXPECT_EQ(a.distances.farthestToOriginal, b.distances.farthestToOriginal);
  EXPECT_EQ(a.notes, b.notes);
}

TEST(BodyFile, ABodyComesBackBitForBit) {
  ASSERT_TRUE(openBox().body.made);
  ASSERT_FALSE(openBox().body.notes.empty());
  const std::string bytes = encodeBody(openBox().body, kKey);
  const Result<ClosedBody> again = decoded(bytes);
  ASSERT_TRUE(again.ok()) << again.error().message;
  expectSame(*again, openBox().body);
  EXPECT_EQ(encodeBody(*again, kKey), bytes);

  const Character torn = test::tornMannequin(40);
  const ClosedBody made = makeBody(torn).value();
  expectSame(decodeBody(encodeBody(made, 7), torn, 7, "entry").value(), made);
}

TEST(BodyFile, EveryPrefixIsRefused) {
  const std::string bytes = encodeBody(openBox().body, kKey);
  const std::string_view whole = bytes;
  for (std::size_t length = 0; length < bytes.size(); length += length < 400 ? 1 : 97) {
    EXPECT_FALSE(decoded(whole.substr(0, length)).ok()) << length;
    if (length >= kHeaderBytes) {
      EXPECT_FALSE(decoded(sealed(bytes.substr(0, length))).ok()) << length << " sealed";
    }
  }
  EXPECT_FALSE(decoded(sealed(bytes + "x")).ok());
}

TEST(BodyFile, AnotherKeyVersionOrByteIsRefused) {
  const std::string bytes = encodeBody(openBox().body, kKey);
  EXPECT_FALSE(decoded(bytes, kKey + 1).ok());
  EXPECT_FALSE(decoded(with(bytes, 8, kBodyVersion + 1)).ok());
  RandomNumbers random(1);
  for (int i = 0; i < 200; ++i) {
    std::string damaged = bytes;
    const std::size_t at = random.bits() % damaged.size();
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    EXPECT_FALSE(decoded(damaged).ok()) << at;
  }
}

TEST(BodyFile, WhatIsWrongDespiteARightChecksumIsASentence) {
  const std::string bytes = encodeBody(openBox().body, kKey);
  const auto sentence = [](const std::string& changed) {
    const Result<ClosedBody> read = decoded(changed);
    return read ? std::string("none") : read.error().message;
  };
  const auto expectSentence = [&](const std::string& changed, const std::string& fragment) {
    const std::string found = sentence(changed);
    EXPECT_NE(found.find(fragment), std::string::npos) << "no `" << fragment << "` in: " << found;
  };
  // Where the lists begin: key, 3 counts, 5 lengths, the notes.
  std::size_t vertices = kHeaderBytes + 8 + 3 * 4 + 5 * 8 + 4;
  for (const std::string& note : openBox().body.notes) vertices += 4 + note.size();
  const auto vertexCount = static_cast<std::size_t>(openBox().body.bodyVertices);
  const std::size_t triangles = vertices + 4 + 24 * vertexCount;
  const std::size_t weights = triangles + 4 + 12 * openBox().body.character.mesh.triangles.size();
  const double nan = std::numeric_limits<double>::quiet_NaN();

  expectSentence(with(bytes, kHeaderBytes + 8, std::int32_t{-1}), "a count is -1");
  expectSentence(with(bytes, kHeaderBytes + 20, -1.0), "a length is -1");
  expectSentence(with(bytes, vertices, std::uint32_t{0x7fffffff}), "the number of vertices is 2147483647");
  expectSentence(with(bytes, vertices + 4, nan), "a coordinate is nan");
  expectSentence(with(bytes, vertices + 4, 1e30), "far from the character");
  expectSentence(with(bytes, triangles, std::uint32_t{0xffffffff}), "the number of triangles is 4294967295");
  expectSentence(with(bytes, triangles + 4, std::int32_t{-1}), "a corner is -1");
  expectSentence(with(bytes, triangles + 4, static_cast<std::int32_t>(vertexCount)), "a corner is");
  expectSentence(with(bytes, weights, std::uint8_t{0}), "a vertex has 0 weights");
  expectSentence(with(bytes, weights, std::uint8_t{9}), "a vertex has 9 weights");
  expectSentence(with(bytes, weights + 1, std::int32_t{2}), "a joint is 2, expected 0 to 1");
  expectSentence(with(bytes, weights + 5, nan), "a weight is nan");
  expectSentence(with(bytes, weights + 5, 0.25), "sum to");
  // The corners of one triangle turned: its edges run the same way as its neighbours'.
  const std::string first = bytes.substr(triangles + 4, 4);
  std::string turned = bytes;
  turned.replace(triangles + 4, 4, bytes.substr(triangles + 8, 4)).replace(triangles + 8, 4, first);
  EXPECT_NE(sentence(sealed(turned)), "none");
}

}  // namespace
}  // namespace lorica

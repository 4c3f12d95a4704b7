#include "geometry/files.h"
#include "geometry/little_endian.h"
#include "geometry/random_numbers.h"
#include "geometry/triangle_tree.h"
#include "skinning/body/body_file.h"
#include "skinning/body/closed_body.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/skinning/body/hard_characters.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

namespace lorica {
namespace {

// The mannequin with holes, open shells, flipped shells and a cape: the resulting body must be the mannequin.

std::span<const Influence> influencesOf(const Character& character, std::size_t v) {
  return std::span(character.influences)
      .subspan(character.influenceBegin[v], character.influenceBegin[v + 1] - character.influenceBegin[v]);
}

double weightOf(std::span<const Influence> influences, JointIndex joint) {
  double sum = 0.0;
  for (const Influence& i : influences) sum += i.joint == joint ? i.weight : 0.0;
  return sum;
}

/// Checks that the body of a degraded mannequin is the mannequin.
void expectMannequin(const Character& spoilt, double volumeShare) {
  const Character truth = makeMannequin();
  const ClosedBody made = test::valueOf(makeBody(spoilt));
  const ClosedBody& body = made;
  EXPECT_TRUE(checkClosedTwoManifold(body.character.mesh).ok());
  EXPECT_TRUE(checkCharacter(body.character).ok());
  EXPECT_TRUE(body.made);
  EXPECT_GE(body.bodyVertices, 5000);
  EXPECT_LE(body.bodyVertices, 15000);
  EXPECT_EQ(body.character.shown.size(), spoilt.mesh.triangles.size());
  EXPECT_EQ(connectedComponents(body.character.mesh.vertices.size(), body.character.mesh.triangles).count, 1);
  EXPECT_NEAR(signedVolume(body.character.mesh.vertices, body.character.mesh.triangles) /
                  signedVolume(truth.mesh.vertices, truth.mesh.triangles),
              1.0, volumeShare);

  // Compared with the intact mannequin, not the degraded one: distances both ways, and weights.
  const TriangleTree tree(truth.mesh.vertices, truth.mesh.triangles);
  double sumDistance = 0.0;
  double farthest = 0.0;
  double sumDifference = 0.0;
  const JointIndex leftThigh = truth.skeleton.jointOf(HumanBone::kLeftUpperLeg);
  const std::array<JointIndex, 4> rightLeg{
      truth.skeleton.jointOf(HumanBone::kRightUpperLeg), truth.skeleton.jointOf(HumanBone::kRightLowerLeg),
      truth.skeleton.jointOf(HumanBone::kRightFoot), truth.skeleton.jointOf(HumanBone::kRightToes)};
  double strayed = 0.0;
  for (std::size_t v = 0; v < static_cast<std::size_t>(body.bodyVertices); ++v) {
    const TriangleTree::Hit hit = tree.nearest(body.character.mesh.vertices[v]);
    sumDistance += hit.distance;
    farthest = std::max(farthest, hit.distance);
    const auto own = influencesOf(body.character, v);
    const Triangle& t = truth.mesh.triangles[hit.triangle];
    double shared = 0.0;
    for (const Influence& i : own) {
      double there = 0.0;
      for (int k = 0; k < 3; ++k) {
        there += hit.shares[k] * weightOf(influencesOf(truth, static_cast<std::size_t>(t[k])), i.joint);
      }
      shared += std::min(i.weight, there);
    }
    sumDifference += 1.0 - shared;
    if (weightOf(own, leftThigh) > 0.5) {
      for (const JointIndex right : rightLeg) strayed = std::max(strayed, weightOf(own, right));
    }
  }
  EXPECT_LT(sumDistance / body.bodyVertices, 0.15 * body.resolution);
  EXPECT_LT(farthest, 2.0 * body.resolution);
  EXPECT_LT(sumDifference / body.bodyVertices, 0.05);
  EXPECT_EQ(strayed, 0.0);
  std::cout << body.bodyVertices << " vertices, voxel " << 1e3 * body.resolution << " mm; to the mannequin mean "
            << 1e3 * sumDistance / body.bodyVertices << " mm, farthest " << 1e3 * farthest << " mm; other weights "
            << 100 * sumDifference / body.bodyVertices << " %; outside " << 1e3 * body.distances.farthestOutside
            << " mm\n";
  for (const std::string& note : body.notes) std::cout << "  " << note << "\n";
}

TEST(MannequinBody, Torn) {
  expectMannequin(test::tornMannequin(20), 0.02);
}

TEST(MannequinBody, InOpenShells) {
  expectMannequin(test::openMannequin(), 0.02);
}

TEST(MannequinBody, InOpenShellsEverySecondInsideOut) {
  expectMannequin(test::openMannequinInsideOut(), 0.02);
}

TEST(MannequinBody, WithACape) {
  Character dressed = makeMannequin();
  const std::size_t skin = dressed.mesh.vertices.size();
  test::addCape(dressed);
  expectMannequin(dressed, 0.02);
  const ClosedBody body = test::valueOf(makeBody(dressed));
  EXPECT_EQ(body.character.mesh.vertices.size(),
            static_cast<std::size_t>(body.bodyVertices) + dressed.mesh.vertices.size());
  EXPECT_GT(dressed.mesh.vertices.size(), skin);
  // The cape protrudes, and the distances report it.
  EXPECT_GT(body.distances.farthestOutside, 0.1);
}

/// Two legs side by side, closed capsules of 12 cm, one joint each below the hips, and a block of hips.
Character legs(double gap) {
  Character character = test::bonesAt(
      {{"hips", kNoJoint, Vec3(0, 1, 0)}, {"left", 0, Vec3(0.1, 0.9, 0)}, {"right", 0, Vec3(-0.1, 0.9, 0)}});
  const auto leg = [&](double x) {
    TriMesh box;
    constexpr int kRings = 24, kAround = 24;
    for (int r = 0; r <= kRings; ++r) {
      for (int a = 0; a < kAround; ++a) {
        const double angle = 2.0 * 3.14159265358979 * a / kAround;
        box.vertices.emplace_back(x + 0.06 * std::cos(angle), 0.9 * r / kRings, 0.06 * std::sin(angle));
      }
    }
    const auto low = static_cast<VertexIndex>(box.vertices.size());
    box.vertices.emplace_back(x, 0.0, 0.0);
    box.vertices.emplace_back(x, 0.9, 0.0);
    for (int r = 0; r < kRings; ++r) {
      for (int a = 0; a < kAround; ++a) {
        const VertexIndex i = r * kAround + a, j = r * kAround + (a + 1) % kAround;
        box.triangles.push_back({i, i + kAround, j});
        box.triangles.push_back({j, i + kAround, j + kAround});
      }
    }
    for (int a = 0; a < kAround; ++a) {
      const VertexIndex j = (a + 1) % kAround;
      box.triangles.push_back({low, a, j});
      box.triangles.push_back({low + 1, kRings * kAround + j, kRings * kAround + a});
    }
    return box;
  };
  test::add(character, leg(0.06 + 0.5 * gap), 1);
  test::add(character, leg(-0.06 - 0.5 * gap), 2);
  TriMesh hips;
  hips.vertices = {};
  // A box from just above the legs' ends, so that it overlaps them.
  const Vec3 low(-0.15, 0.8, -0.08), high(0.15, 1.1, 0.08);
  for (int i = 0; i < 8; ++i) {
    hips.vertices.emplace_back((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                               (i & 4) != 0 ? high.z() : low.z());
  }
  hips.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  test::add(character, hips, 0);
  return test::finished(std::move(character));
}

TEST(MannequinBody, LegsThatTouchStayTwo) {
  for (const double gap : {0.02, 0.005, 0.0, -0.005}) {
    SCOPED_TRACE(gap);
    const ClosedBody body = test::valueOf(makeBody(legs(gap), {.resolution = 0.012}));
    // Below the hips no triangle joins the two legs.
    int across = 0;
    double mixed = 0.0;
    const std::vector<Vec3>& at = body.character.mesh.vertices;
    for (const Triangle& t : body.character.mesh.triangles) {
      std::array<bool, 2> legs{};
      bool below = true;
      for (const VertexIndex v : t) {
        const auto own = influencesOf(body.character, static_cast<std::size_t>(v));
        below = below && at[v].y() < 0.6;
        legs[0] = legs[0] || weightOf(own, 1) > 0.5;
        legs[1] = legs[1] || weightOf(own, 2) > 0.5;
        if (at[v].y() < 0.6) {
          mixed = std::max(mixed, std::min(weightOf(own, 1), weightOf(own, 2)));
        }
      }
      if (below && legs[0] && legs[1]) ++across;
    }
    EXPECT_EQ(across, 0);
    EXPECT_EQ(mixed, 0.0);
  }
}

TEST(MannequinBody, TheUnitOfLengthDoesNotMatter) {
  const Character torn = test::tornMannequin(40);
  Character large = torn;
  for (Vec3& v : large.mesh.vertices) v *= 128.0;
  for (Affine3& m : large.jointFromModel) m.translation() *= 128.0;
  large.height *= 128.0;
  const Result<ClosedBody> a = makeBody(torn);
  const Result<ClosedBody> b = makeBody(large);
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_NEAR(b->resolution / a->resolution, 128.0, 1e-6);
  EXPECT_NEAR(static_cast<double>(b->bodyVertices) / a->bodyVertices, 1.0, 1e-2);
}

// Bytes of bodies: bit for bit the same, and whatever is wrong with them is refused.

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
  EXPECT_EQ(a.onlySheets, b.onlySheets);
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
  // Where the lists begin: key, 4 counts, 5 lengths, the notes.
  std::size_t vertices = kHeaderBytes + 8 + 4 * 4 + 5 * 8 + 4;
  for (const std::string& note : openBox().body.notes) vertices += 4 + note.size();
  const auto vertexCount = static_cast<std::size_t>(openBox().body.bodyVertices);
  const std::size_t triangles = vertices + 4 + 24 * vertexCount;
  const std::size_t weights = triangles + 4 + 12 * openBox().body.character.mesh.triangles.size();
  const double nan = std::numeric_limits<double>::quiet_NaN();

  expectSentence(with(bytes, kHeaderBytes + 8, std::int32_t{-1}), "a count is -1");
  expectSentence(with(bytes, kHeaderBytes + 24, -1.0), "a length is -1");
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

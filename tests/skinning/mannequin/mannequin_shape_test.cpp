#include "skinning/mannequin/mannequin.h"

#include "tests/skinning/mannequin/surface_checks.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <cstring>

namespace lorica::test {
namespace {

const Character& mannequin() {
  static const Character character = makeMannequin();
  return character;
}

Vec3 jointPosition(HumanBone bone) {
  const Skeleton& skeleton = mannequin().skeleton;
  Vec3 p = Vec3::Zero();
  for (JointIndex j = skeleton.jointOf(bone); j != kNoJoint; j = skeleton.joint(j).parent) {
    p += skeleton.joint(j).rest.translation;  // rest rotations are identities: tested below
  }
  return p;
}

constexpr double kDegree = std::numbers::pi / 180.0;

TEST(SurfaceChecks, FindWhatTheyLookFor) {
  TriMesh apart = joined(makeBox({0, 0, 0}, {0.1, 0.1, 0.1}), makeBox({0.2, 0, 0}, {0.3, 0.1, 0.1}));
  EXPECT_TRUE(piercingEdges(apart).empty());
  TriMesh crossing = joined(makeBox({0, 0, 0}, {0.1, 0.1, 0.1}), makeBox({0.03, 0.02, -0.05}, {0.06, 0.07, 0.05}));
  EXPECT_FALSE(piercingEdges(crossing).empty());
  EXPECT_NEAR(windingNumber(apart, {0.05, 0.05, 0.05}), 1.0, 1e-12);
  EXPECT_NEAR(windingNumber(apart, {0.15, 0.05, 0.05}), 0.0, 1e-12);
  EXPECT_NEAR(volumeOf(apart.vertices, apart.triangles), 0.002, 1e-12);
}

TEST(Mannequin, IsAClosedOrientedTwoManifold) {
  const DirectedEdges edges = directedEdges(mannequin().mesh);
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1) << "edge " << edge.first << " " << edge.second;
    ASSERT_TRUE(edges.contains({edge.second, edge.first})) << "edge " << edge.first << " " << edge.second;
    ASSERT_NE(edge.first, edge.second);
  }

  // One fan of triangles around each vertex: stepping from edge to edge returns only after all of them.
  std::map<VertexIndex, std::map<VertexIndex, VertexIndex>> nextAround;
  for (const Triangle& t : mannequin().mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) nextAround[t[i]][t[(i + 1) % 3]] = t[(i + 2) % 3];
  }
  ASSERT_EQ(nextAround.size(), mannequin().mesh.vertices.size());
  for (const auto& [vertex, next] : nextAround) {
    const VertexIndex first = next.begin()->first;
    std::size_t steps = 0;
    VertexIndex v = first;
    do {
      v = next.at(v);
      ++steps;
    } while (v != first && steps <= next.size());
    ASSERT_EQ(steps, next.size()) << "vertex " << vertex;
  }
}

TEST(Mannequin, IsOnePieceWithoutHoles) {
  const TriMesh& mesh = mannequin().mesh;
  const DirectedEdges edges = directedEdges(mesh);
  const auto count = [](std::size_t n) { return static_cast<int>(n); };
  EXPECT_EQ(count(mesh.vertices.size()) - count(edges.size() / 2) + count(mesh.triangles.size()), 2);

  std::vector<VertexIndex> group(mesh.vertices.size());
  for (std::size_t v = 0; v < group.size(); ++v) group[v] = static_cast<VertexIndex>(v);
  const auto rootOf = [&](VertexIndex v) {
    while (group[v] != v) v = group[v];
    return v;
  };
  for (const auto& [edge, times] : edges) group[rootOf(edge.first)] = rootOf(edge.second);
  for (std::size_t v = 0; v < group.size(); ++v) ASSERT_EQ(rootOf(static_cast<VertexIndex>(v)), rootOf(0));
}

TEST(Mannequin, HasTheMeasuresOfAnAdult) {
  const TriMesh& mesh = mannequin().mesh;
  const Aabb box = boundsOf(mesh.vertices);
  EXPECT_GE(mesh.vertices.size(), 8000u);
  EXPECT_LE(mesh.vertices.size(), 15000u);
  EXPECT_EQ(box.min.y(), 0.0);
  EXPECT_EQ(mannequin().height, box.max.y() - box.min.y());
  EXPECT_GE(mannequin().height, 1.70);
  EXPECT_LE(mannequin().height, 1.80);
  const double span = box.max.x() - box.min.x();
  EXPECT_NEAR(span, mannequin().height, 0.05);
  const double volume = volumeOf(mesh.vertices, mesh.triangles);
  EXPECT_GT(volume, 0.055);
  EXPECT_LT(volume, 0.090);

  const double handLength = box.max.x() - jointPosition(HumanBone::kLeftHand).x();
  EXPECT_NEAR(handLength, 0.19, 0.01);
  Aabb foot;
  for (const Vec3& p : mesh.vertices) {
    if (p.y() < 0.06 && p.x() > 0.0) foot.extend(p);
  }
  EXPECT_NEAR(foot.max.z() - foot.min.z(), 0.26, 0.01);
}

TEST(Mannequin, FacesForwardWithItsLeftHandAtPositiveX) {
  EXPECT_GT(jointPosition(HumanBone::kLeftHand).x(), 0.6);
  EXPECT_LT(jointPosition(HumanBone::kRightHand).x(), -0.6);
  EXPECT_GT(jointPosition(HumanBone::kLeftToes).z(), jointPosition(HumanBone::kLeftFoot).z() + 0.1);
  // The nose is the foremost point of the head, and is in the plane of symmetry.
  Vec3 nose = Vec3::Zero();
  for (const Vec3& p : mannequin().mesh.vertices) {
    if (p.y() > 1.55 && p.z() > nose.z()) nose = p;
  }
  EXPECT_EQ(nose.x(), 0.0);
  EXPECT_NEAR(nose.y(), 1.61, 0.03);
}

TEST(Mannequin, DoesNotCrossItself) {
  const auto edges = piercingEdges(mannequin().mesh);
  EXPECT_TRUE(edges.empty()) << edges.size() << " edges, the first from "
                             << mannequin().mesh.vertices[edges[0].first].transpose();
}

TEST(Mannequin, IsItsOwnMirrorImage) {
  const Character& character = mannequin();
  using Key = std::array<double, 3>;
  std::map<Key, std::size_t> vertexAt;
  for (std::size_t v = 0; v < character.mesh.vertices.size(); ++v) {
    const Vec3& p = character.mesh.vertices[v];
    ASSERT_TRUE(vertexAt.emplace(Key{p.x() + 0.0, p.y(), p.z()}, v).second) << "two vertices at one position: " << v;
  }
  const auto weightsByName = [&](std::size_t v, bool swapped) {
    std::map<std::string, double> weights;
    for (std::uint32_t i = character.influenceBegin[v]; i < character.influenceBegin[v + 1]; ++i) {
      std::string name = character.skeleton.joint(character.influences[i].joint).name;
      if (swapped && name.starts_with("left")) {
        name = "right" + name.substr(4);
      } else if (swapped && name.starts_with("right")) {
        name = "left" + name.substr(5);
      }
      weights[name] = character.influences[i].weight;
    }
    return weights;
  };
  for (std::size_t v = 0; v < character.mesh.vertices.size(); ++v) {
    const Vec3& p = character.mesh.vertices[v];
    const auto twin = vertexAt.find(Key{-p.x() + 0.0, p.y(), p.z()});
    ASSERT_NE(twin, vertexAt.end()) << "vertex " << v << " at " << p.transpose();
    ASSERT_EQ(weightsByName(v, true), weightsByName(twin->second, false)) << "vertex " << v;
  }
}

TEST(Mannequin, HasNoNeedles) {
  const TriMesh& mesh = mannequin().mesh;
  std::vector<double> angles;
  for (const Triangle& t : mesh.triangles) angles.push_back(smallestAngle(mesh, t));
  std::sort(angles.begin(), angles.end());
  EXPECT_GT(angles.front(), 6.0 * kDegree);
  EXPECT_GT(angles[angles.size() / 50], 9.5 * kDegree) << "98 of 100 triangles";
  EXPECT_GT(angles[angles.size() / 2], 25.0 * kDegree) << "half of the triangles";
}

TEST(Mannequin, HasEveryHumanBoneNamedAndPlacedInsideItsSkin) {
  const Skeleton& skeleton = mannequin().skeleton;
  EXPECT_EQ(skeleton.jointCount(), kHumanBoneCount);
  for (int b = 0; b < kHumanBoneCount; ++b) {
    const auto bone = static_cast<HumanBone>(b);
    const JointIndex j = skeleton.jointOf(bone);
    ASSERT_NE(j, kNoJoint) << nameOf(bone);
    EXPECT_EQ(skeleton.joint(j).name, nameOf(bone));
    EXPECT_TRUE(skeleton.joint(j).rest.rotation.coeffs() == Quat::Identity().coeffs());
    EXPECT_EQ(skeleton.joint(j).rest.scale, Vec3::Ones());
    EXPECT_NEAR(windingNumber(mannequin().mesh, jointPosition(bone)), 1.0, 1e-9) << nameOf(bone);
    EXPECT_LT((mannequin().jointFromModel[j] * jointPosition(bone)).norm(), 1e-15);
  }
}

TEST(Mannequin, HangsTogetherAsVrmSays) {
  const Skeleton& skeleton = mannequin().skeleton;
  const auto parentOf = [&](HumanBone bone) -> std::string {
    const JointIndex parent = skeleton.joint(skeleton.jointOf(bone)).parent;
    return parent == kNoJoint ? "" : skeleton.joint(parent).name;
  };
  EXPECT_EQ(skeleton.jointOf(HumanBone::kHips), 0);
  EXPECT_EQ(parentOf(HumanBone::kHips), "");
  EXPECT_EQ(parentOf(HumanBone::kHead), "neck");
  EXPECT_EQ(parentOf(HumanBone::kRightShoulder), "upperChest");
  EXPECT_EQ(parentOf(HumanBone::kRightUpperArm), "rightShoulder");
  EXPECT_EQ(parentOf(HumanBone::kLeftUpperLeg), "hips");
  EXPECT_EQ(parentOf(HumanBone::kLeftToes), "leftFoot");
  EXPECT_EQ(parentOf(HumanBone::kRightLittleProximal), "rightHand");
  EXPECT_EQ(parentOf(HumanBone::kRightLittleDistal), "rightLittleIntermediate");
}

TEST(Mannequin, TwoCallsGiveTheSameBits) {
  const Character a = makeMannequin();
  const Character b = makeMannequin();
  const auto sameBytes = [](const auto& x, const auto& y) {
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0;
  };
  EXPECT_TRUE(sameBytes(a.mesh.vertices, b.mesh.vertices));
  EXPECT_TRUE(sameBytes(a.mesh.triangles, b.mesh.triangles));
  EXPECT_TRUE(sameBytes(a.influenceBegin, b.influenceBegin));
  ASSERT_EQ(a.influences.size(), b.influences.size());
  for (std::size_t i = 0; i < a.influences.size(); ++i) {
    ASSERT_EQ(a.influences[i].joint, b.influences[i].joint);
    ASSERT_EQ(a.influences[i].weight, b.influences[i].weight);
  }
}

}  // namespace
}  // namespace lorica::test

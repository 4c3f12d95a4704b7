#include "skinning/mannequin/mannequin.h"

#include "geometry/tri_mesh.h"
#include "skinning/linear_blend.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <numbers>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

namespace lorica::test {
namespace {

using DirectedEdges = std::map<std::pair<VertexIndex, VertexIndex>, int>;

inline DirectedEdges directedEdges(const TriMesh& mesh) {
  DirectedEdges edges;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  }
  return edges;
}

/// Volume as a sum of signed tetrahedra about a point near the middle.
inline double volumeOf(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
  const Vec3 o(0.0, 1.0, 0.0);
  double sum = 0.0;
  for (const Triangle& t : triangles) {
    const Vec3 a = vertices[t[0]] - o;
    const Vec3 b = vertices[t[1]] - o;
    const Vec3 c = vertices[t[2]] - o;
    sum += a.dot(b.cross(c)) / 6.0;
  }
  return sum;
}

/// How many times the surface winds around a point: 1 inside, 0 outside (solid angles after van Oosterom and Strackee).
inline double windingNumber(const TriMesh& mesh, const Vec3& p) {
  double angle = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - p;
    const Vec3 b = mesh.vertices[t[1]] - p;
    const Vec3 c = mesh.vertices[t[2]] - p;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    angle += 2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4.0 * std::numbers::pi);
}

/// Whether the open segment from p to q pierces the triangle.
inline bool pierces(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const double dp = normal.dot(p - a);
  const double dq = normal.dot(q - a);
  if ((dp > 0.0) == (dq > 0.0)) return false;
  const Vec3 x = p + dp / (dp - dq) * (q - p);
  return (b - a).cross(x - a).dot(normal) > 0.0 && (c - b).cross(x - b).dot(normal) > 0.0 &&
         (a - c).cross(x - c).dot(normal) > 0.0;
}

/// Edges that pierce a triangle which they do not touch. Two triangles that cross always have such an edge.
inline std::vector<std::pair<VertexIndex, VertexIndex>> piercingEdges(const TriMesh& mesh) {
  constexpr double kCell = 0.02;
  const auto cellOf = [](double x) { return static_cast<std::int64_t>(std::floor(x / kCell)) + 1000; };
  const auto at = [&](VertexIndex v) -> const Vec3& { return mesh.vertices[v]; };
  const auto forCells = [&](std::initializer_list<VertexIndex> corners, const auto& visit) {
    Aabb box;
    for (const VertexIndex v : corners) box.extend(at(v));
    for (std::int64_t x = cellOf(box.min.x()); x <= cellOf(box.max.x()); ++x) {
      for (std::int64_t y = cellOf(box.min.y()); y <= cellOf(box.max.y()); ++y) {
        for (std::int64_t z = cellOf(box.min.z()); z <= cellOf(box.max.z()); ++z) visit((x * 10000 + y) * 10000 + z);
      }
    }
  };

  std::unordered_map<std::int64_t, std::vector<std::size_t>> trianglesOfCell;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& tri = mesh.triangles[t];
    forCells({tri[0], tri[1], tri[2]}, [&](std::int64_t cell) { trianglesOfCell[cell].push_back(t); });
  }
  std::set<std::pair<VertexIndex, VertexIndex>> found;
  for (const auto& [edge, count] : directedEdges(mesh)) {
    const auto [p, q] = edge;
    if (p > q) continue;
    const std::pair<VertexIndex, VertexIndex> undirected(p, q);
    forCells({p, q}, [&](std::int64_t cell) {
      for (const std::size_t t : trianglesOfCell[cell]) {
        const Triangle& tri = mesh.triangles[t];
        const bool touches = std::any_of(
            tri.begin(), tri.end(), [&](VertexIndex v) { return v == undirected.first || v == undirected.second; });
        if (touches) continue;
        if (pierces(at(undirected.first), at(undirected.second), at(tri[0]), at(tri[1]), at(tri[2]))) {
          found.insert(undirected);
        }
      }
    });
  }
  return {found.begin(), found.end()};
}

inline double smallestAngle(const TriMesh& mesh, const Triangle& t) {
  double smallest = std::numbers::pi;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3& p = mesh.vertices[t[i]];
    const Vec3 a = mesh.vertices[t[(i + 1) % 3]] - p;
    const Vec3 b = mesh.vertices[t[(i + 2) % 3]] - p;
    smallest = std::min(smallest, std::atan2(a.cross(b).norm(), a.dot(b)));
  }
  return smallest;
}

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

std::vector<Vec3> posedWith(std::initializer_list<std::pair<HumanBone, Eigen::AngleAxisd>> turns) {
  Pose pose = restPose(mannequin().skeleton);
  for (const auto& [bone, turn] : turns) {
    pose[mannequin().skeleton.jointOf(bone)].rotation = Quat(turn);
  }
  std::vector<Affine3> world(pose.size());
  std::vector<Affine3> skin(pose.size());
  std::vector<Vec3> vertices(mannequin().mesh.vertices.size());
  computeWorldFromJoint(mannequin().skeleton, pose, world);
  computeWorldFromModel(mannequin(), world, skin);
  skinLinearBlend(mannequin(), skin, vertices);
  return vertices;
}

/// Volume beyond a plane in the bind pose: the flux of (p - o) . n n, to which the cut itself does not contribute.
double volumeBeyond(const Vec3& o, const Vec3& n) {
  double sum = 0.0;
  for (const Triangle& t : mannequin().mesh.triangles) {
    const auto at = [&](std::size_t i) -> const Vec3& { return mannequin().mesh.vertices[t[i]]; };
    const double depth = n.dot((at(0) + at(1) + at(2)) / 3.0 - o);
    if (depth > 0.0) sum += depth * 0.5 * n.dot((at(1) - at(0)).cross(at(2) - at(0)));
  }
  return sum;
}

constexpr double kQuarter = std::numbers::pi / 2.0;

TEST(MannequinPose, BentElbowKeepsTheArmsVolume) {
  const double arm = volumeBeyond({0.2, 0.0, 0.0}, Vec3::UnitX());
  ASSERT_GT(arm, 0.002);
  ASSERT_LT(arm, 0.005);
  const double before = volumeOf(mannequin().mesh.vertices, mannequin().mesh.triangles);
  const auto bent = posedWith({{HumanBone::kLeftLowerArm, Eigen::AngleAxisd(-kQuarter, Vec3::UnitY())}});
  EXPECT_LT(std::abs(volumeOf(bent, mannequin().mesh.triangles) - before), 0.06 * arm);
}

TEST(MannequinPose, BentKneeKeepsTheLegsVolume) {
  const double leg = 0.5 * volumeBeyond({0.0, 0.8, 0.0}, -Vec3::UnitY());
  ASSERT_GT(leg, 0.006);
  ASSERT_LT(leg, 0.015);
  const double before = volumeOf(mannequin().mesh.vertices, mannequin().mesh.triangles);
  const auto bent = posedWith({{HumanBone::kLeftLowerLeg, Eigen::AngleAxisd(kQuarter, Vec3::UnitX())}});
  EXPECT_LT(std::abs(volumeOf(bent, mannequin().mesh.triangles) - before), 0.06 * leg);
}

TEST(MannequinPose, LoweredArmsKeepTheBodysVolume) {
  const double before = volumeOf(mannequin().mesh.vertices, mannequin().mesh.triangles);
  const auto lowered = posedWith({{HumanBone::kLeftUpperArm, Eigen::AngleAxisd(-1.3, Vec3::UnitZ())},
                                  {HumanBone::kRightUpperArm, Eigen::AngleAxisd(1.3, Vec3::UnitZ())}});
  EXPECT_LT(std::abs(volumeOf(lowered, mannequin().mesh.triangles) - before), 0.04 * before);
}

TEST(MannequinPose, BentElbowTakesTheHandForwardAndNothingElse) {
  const auto bent = posedWith({{HumanBone::kLeftLowerArm, Eigen::AngleAxisd(-kQuarter, Vec3::UnitY())}});
  const Aabb box = boundsOf(bent);
  // The fingertips were 0.43 m beyond the elbow at x = 0.455; now they are as far in front of it.
  EXPECT_NEAR(box.max.z(), 0.41, 0.03);
  EXPECT_LT(box.max.x(), 0.52);
  for (std::size_t v = 0; v < bent.size(); ++v) {
    const Vec3& bind = mannequin().mesh.vertices[v];
    if (bind.x() > 0.2) continue;
    ASSERT_LT((bent[v] - bind).norm(), 1e-12) << "vertex " << v << " at " << bind.transpose();
  }
}

TEST(MannequinPose, FistClosesWithoutMovingThePalm) {
  const auto fist = posedWith({{HumanBone::kLeftIndexProximal, Eigen::AngleAxisd(-kQuarter, Vec3::UnitZ())},
                               {HumanBone::kLeftIndexIntermediate, Eigen::AngleAxisd(-kQuarter, Vec3::UnitZ())}});
  for (std::size_t v = 0; v < fist.size(); ++v) {
    const Vec3& bind = mannequin().mesh.vertices[v];
    const double moved = (fist[v] - bind).norm();
    if (bind.x() < 0.70) {
      ASSERT_LT(moved, 1e-12) << "vertex " << v << " at " << bind.transpose();
    }
    if (bind.x() > 0.865 && bind.z() > 0.012) {
      ASSERT_GT(moved, 0.05) << "vertex " << v << " at " << bind.transpose();
    }
  }
}

/// Weight of each joint at a vertex, zeros included.
std::vector<double> weightsOf(std::size_t v) {
  std::vector<double> weights(static_cast<std::size_t>(mannequin().skeleton.jointCount()), 0.0);
  for (std::uint32_t i = mannequin().influenceBegin[v]; i < mannequin().influenceBegin[v + 1]; ++i) {
    weights[mannequin().influences[i].joint] += mannequin().influences[i].weight;
  }
  return weights;
}

const std::string& nameOfJoint(std::size_t j) {
  return mannequin().skeleton.joint(static_cast<JointIndex>(j)).name;
}

/// "Index" for "leftIndexDistal"; empty for other bones.
std::string fingerOf(const std::string& name) {
  for (const char* finger : {"Thumb", "Index", "Middle", "Ring", "Little"}) {
    if (name.find(finger) != std::string::npos) return finger;
  }
  return "";
}

TEST(MannequinWeights, AtMostFourAndTheySumToOne) {
  for (std::size_t v = 0; v < mannequin().mesh.vertices.size(); ++v) {
    const std::uint32_t begin = mannequin().influenceBegin[v];
    const std::uint32_t end = mannequin().influenceBegin[v + 1];
    ASSERT_GE(end - begin, 1u) << "vertex " << v;
    ASSERT_LE(end - begin, 4u) << "vertex " << v;
    double sum = 0.0;
    std::set<JointIndex> joints;
    for (std::uint32_t i = begin; i < end; ++i) {
      ASSERT_GT(mannequin().influences[i].weight, 0.0);
      sum += mannequin().influences[i].weight;
      joints.insert(mannequin().influences[i].joint);
    }
    ASSERT_NEAR(sum, 1.0, 1e-12) << "vertex " << v;
    ASSERT_EQ(joints.size(), end - begin) << "vertex " << v << " has a joint twice";
  }
  EXPECT_TRUE(checkCharacter(mannequin()).ok());
}

TEST(MannequinWeights, EveryBoneMovesSomething) {
  std::vector<double> max(static_cast<std::size_t>(mannequin().skeleton.jointCount()), 0.0);
  for (std::size_t v = 0; v < mannequin().mesh.vertices.size(); ++v) {
    const std::vector<double> weights = weightsOf(v);
    for (std::size_t j = 0; j < max.size(); ++j) max[j] = std::max(max[j], weights[j]);
  }
  for (std::size_t j = 0; j < max.size(); ++j) EXPECT_GT(max[j], 0.3) << nameOfJoint(j);
  for (const HumanBone bone :
       {HumanBone::kHips, HumanBone::kHead, HumanBone::kLeftUpperArm, HumanBone::kLeftLowerArm, HumanBone::kLeftHand,
        HumanBone::kLeftUpperLeg, HumanBone::kLeftLowerLeg, HumanBone::kLeftFoot, HumanBone::kLeftToes}) {
    const auto j = static_cast<std::size_t>(mannequin().skeleton.jointOf(bone));
    EXPECT_GT(max[j], 0.9) << nameOfJoint(j);
  }
}

TEST(MannequinWeights, NoVertexFollowsALimbOfTheOtherSide) {
  for (std::size_t v = 0; v < mannequin().mesh.vertices.size(); ++v) {
    const double x = mannequin().mesh.vertices[v].x();
    const std::vector<double> weights = weightsOf(v);
    for (std::size_t j = 0; j < weights.size(); ++j) {
      if (weights[j] == 0.0) continue;
      if (x >= 0.0) {
        ASSERT_FALSE(nameOfJoint(j).starts_with("right")) << "vertex " << v;
      }
      if (x <= 0.0) {
        ASSERT_FALSE(nameOfJoint(j).starts_with("left")) << "vertex " << v;
      }
    }
  }
}

TEST(MannequinWeights, NoFingerFollowsAnother) {
  std::map<std::string, int> verticesOfFinger;
  for (std::size_t v = 0; v < mannequin().mesh.vertices.size(); ++v) {
    const std::vector<double> weights = weightsOf(v);
    const auto strongest = static_cast<std::size_t>(std::max_element(weights.begin(), weights.end()) - weights.begin());
    const std::string finger = fingerOf(nameOfJoint(strongest));
    // The webs belong to two fingers; beyond them a vertex follows only its own finger.
    const bool beyondWeb = nameOfJoint(strongest).find("Intermediate") != std::string::npos ||
                           nameOfJoint(strongest).find("Distal") != std::string::npos;
    if (finger.empty() || !beyondWeb) continue;
    ++verticesOfFinger[finger];
    for (std::size_t j = 0; j < weights.size(); ++j) {
      const std::string other = fingerOf(nameOfJoint(j));
      if (!other.empty() && other != finger) {
        ASSERT_EQ(weights[j], 0.0) << "vertex " << v << " of " << nameOfJoint(strongest) << " and " << nameOfJoint(j);
      }
    }
  }
  EXPECT_EQ(verticesOfFinger.size(), 5u);
  for (const auto& [finger, count] : verticesOfFinger) EXPECT_GT(count, 100) << finger;
}

TEST(MannequinWeights, NeighboursDifferLittle) {
  double worst = 0.0;
  Vec3 where = Vec3::Zero();
  std::vector<std::vector<double>> all;
  for (std::size_t v = 0; v < mannequin().mesh.vertices.size(); ++v) all.push_back(weightsOf(v));
  for (const auto& [edge, count] : directedEdges(mannequin().mesh)) {
    const std::vector<double>& a = all[edge.first];
    const std::vector<double>& b = all[edge.second];
    double moved = 0.0;  // the fraction of the weight that changes along this edge
    for (std::size_t j = 0; j < a.size(); ++j) moved += 0.5 * std::abs(a[j] - b[j]);
    if (moved > worst) where = mannequin().mesh.vertices[edge.first];
    worst = std::max(worst, moved);
  }
  EXPECT_LT(worst, 0.25) << "at " << where.transpose();
}

}  // namespace
}  // namespace lorica::test

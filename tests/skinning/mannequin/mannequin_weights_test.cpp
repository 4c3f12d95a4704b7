#include "skinning/mannequin/mannequin.h"

#include "tests/skinning/mannequin/surface_checks.h"

#include <gtest/gtest.h>

namespace lorica::test {
namespace {

const Character& mannequin() {
  static const Character character = makeMannequin();
  return character;
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

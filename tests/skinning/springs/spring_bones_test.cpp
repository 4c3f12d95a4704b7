#include "geometry/work_budgets.h"
#include "tests/skinning/springs/strand.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace lorica::test {
namespace {

/// The sentence that refuses sound springs after a change; empty if they are accepted.
std::string refusal(const std::function<void(SpringBones&)>& change) {
  const Skeleton skeleton = strandSkeleton(4);
  SpringBones springs = strandSprings(3, {.stiffness = 1.0});
  springs.chains[0].joints.pop_back();
  springs.colliders.push_back({.joint = 0, .radius = 0.1});
  springs.colliderGroups.push_back({0});
  springs.chains[0].colliderGroups = {0};
  change(springs);
  const Result<SpringSimulation> made = SpringSimulation::create(skeleton, springs);
  return made ? "" : made.error().message;
}

TEST(SpringBones, SoundOnesAreAccepted) {
  EXPECT_EQ(refusal([](SpringBones&) {}), "");
}

TEST(SpringBones, BadOnesAreRefusedWithASentence) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::pair<std::function<void(SpringBones&)>, const char*> faults[] = {
      {[](SpringBones& s) { s.chains[0].joints[1].joint = 5; }, "chain 0, joint 1: joint 5 does not exist"},
      {[](SpringBones& s) { s.chains[0].joints[1].joint = kNoJoint; }, "joint -1 does not exist"},
      {[](SpringBones& s) { s.chains[0].joints[0].tail.setZero(); }, "its tail is at 0"},
      {[](SpringBones& s) { s.chains[0].joints[0].tail.x() = kNan; }, "its tail is at 0 or not finite"},
      {[](SpringBones& s) { s.chains[0].joints[0].stiffness = -1.0; }, "stiffness -1"},
      {[](SpringBones& s) { s.chains[0].joints[0].dragForce = 1.5; }, "drag 1.5"},
      {[](SpringBones& s) { s.chains[0].joints[0].gravityDir.x() = kInfinity; }, "expected finite numbers"},
      {[](SpringBones& s) { s.chains.push_back(s.chains[0]); }, "chain 1, joint 0: swings in chain 0 already"},
      {[](SpringBones& s) { s.chains[0].joints.clear(); }, "chain 0: has no joints"},
      {[](SpringBones& s) { s.chains[0].center = 2; }, "its centre, joint 2, swings with it"},
      {[](SpringBones& s) { s.chains[0].center = 9; }, "joint 9 does not exist"},
      {[](SpringBones& s) { s.chains[0].colliderGroups = {1}; }, "collider group 1 does not exist"},
      {[](SpringBones& s) { s.colliderGroups[0] = {-1}; }, "collider -1 does not exist"},
      {[](SpringBones& s) { s.colliders[0].joint = 77; }, "collider 0: joint 77 does not exist"},
      {[](SpringBones& s) { s.colliders[0].radius = kNan; }, "collider 0: radius nan"},
      {[](SpringBones& s) { s.constraints.push_back({.joint = 4, .source = 12}); }, "joint 12 does not exist"},
      {[](SpringBones& s) { s.constraints.push_back({.joint = 4, .source = 1, .weight = 2.0}); }, "weight 2"},
      {[](SpringBones& s) { s.constraints = {{.joint = 4, .source = 4}}; }, "joint 4 depends on itself"},
      {[](SpringBones& s) { s.constraints.assign(2, {.joint = 4, .source = 1}); }, "joint 4 has another"},
      {[](SpringBones& s) { s.constraints.assign(kMaxNodeConstraints + 1, {}); }, "1001 constraints"},
      {[](SpringBones& s) { s.colliders.resize(kMaxSpringColliders + 1); }, "10001 colliders"},
      {[](SpringBones& s) {
         s.colliderGroups[0].assign(1000, 0);
         s.chains[0].colliderGroups.assign(1000, 0);
       },
       "2000000 pairs"},
  };
  for (const auto& [change, words] : faults) {
    const std::string sentence = refusal(change);
    EXPECT_NE(sentence.find(words), std::string::npos) << "expected: " << words << "\nfound: " << sentence;
  }
}

TEST(SpringBones, AsMuchAsTheBudgetsIsTaken) {
  EXPECT_EQ(refusal([](SpringBones& s) { s.colliders.resize(kMaxSpringColliders, s.colliders[0]); }), "");
  const std::size_t groups = kMaxSpringPairs / 1000 / 2;  // for each of two joints
  for (const std::size_t more : {0U, 1U}) {
    const std::string sentence = refusal([&](SpringBones& s) {
      s.colliderGroups[0].assign(1000, 0);
      s.chains[0].colliderGroups.assign(groups + more, 0);
    });
    EXPECT_EQ(sentence.find("pairs") != std::string::npos, more > 0) << sentence;
  }
}

TEST(SpringBones, AsManyJointsAsTheBudgetsSwingAndFollow) {
  const Skeleton skeleton = strandSkeleton(static_cast<int>(kMaxSprings) + 1);
  for (const bool follow : {false, true}) {
    for (const std::size_t more : {0U, 1U}) {
      SpringBones springs = follow ? SpringBones() : strandSprings(static_cast<int>(kMaxSprings + more), {});
      for (std::size_t j = 1; follow && j <= kMaxNodeConstraints + more; ++j) {
        springs.constraints.push_back({.joint = static_cast<JointIndex>(j), .source = 0});
      }
      const Result<void> checked = checkSprings(skeleton, springs);
      EXPECT_EQ(checked.ok(), more == 0) << (checked ? "" : checked.error().message);
    }
  }
}

TEST(SpringBones, ACentreMayBeTheFirstJoint) {
  EXPECT_EQ(refusal([](SpringBones& s) { s.chains[0].center = 1; }), "");
}

}  // namespace
}  // namespace lorica::test

// Skeletons without telling names whose chains are irregular.

#include "skinning/humanoid/humanoid.h"

#include "tests/skinning/humanoid/humanoid_figure.h"
#include "tests/skinning/humanoid/humanoid_samples.h"

#include <gtest/gtest.h>

#include <string>

namespace lorica {
namespace {

using test::build;
using test::Built;
using test::contradictions;
using test::differences;
using test::Figure;
using test::isDoubted;
using test::isFinger;
using test::mannequinFigure;
using test::namesOf;
using test::without;
using enum HumanBone;

/// Bones that are wrong or superfluous although no doubt names them.
[[nodiscard]] std::string surelyWrong(const Built& built, const HumanoidGuess& guess) {
  std::string wrong;
  for (const auto& [bone, joint] : namesOf(built.skeleton, guess)) {
    const auto truth = built.truth.find(bone);
    if (!isDoubted(guess, bone) && (truth == built.truth.end() || truth->second != joint)) {
      wrong += std::string(nameOf(bone)) + " ";
    }
  }
  return wrong;
}

/// All bones are found, whatever hangs on the body.
void expectFound(const Figure& figure, const std::string& what) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const Built built = build(figure, Affine3::Identity(), seed);
    const HumanoidGuess guess = guessHumanoid(built.skeleton);
    EXPECT_EQ(differences(built.truth, namesOf(built.skeleton, guess)), "") << what << ", seed " << seed;
    EXPECT_EQ(contradictions(built.skeleton, guess), "") << what;
  }
}

/// Body, legs and upper arms are found; what is wrong is in doubt.
void expectNothingSurelyWrong(const Figure& figure, const std::string& what) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const Built built = build(figure, Affine3::Identity(), seed);
    const HumanoidGuess guess = guessHumanoid(built.skeleton);
    EXPECT_EQ(surelyWrong(built, guess), "") << what << ", seed " << seed;
    EXPECT_EQ(contradictions(built.skeleton, guess), "") << what;
    const std::map<HumanBone, std::string> found = namesOf(built.skeleton, guess);
    for (const HumanBone bone : {kHips, kHead, kLeftUpperLeg, kRightUpperLeg, kLeftLowerLeg, kRightLowerLeg}) {
      const auto joint = found.find(bone);
      EXPECT_TRUE(joint != found.end() && joint->second == built.truth.at(bone)) << what << ": " << nameOf(bone);
    }
  }
}

[[nodiscard]] Figure withoutFingers() {
  Figure figure = mannequinFigure();
  figure.remove(isFinger);
  return figure;
}

TEST(IrregularRigs, AToolGoesOnFromOneHand) {
  for (const double reach : {0.3, 0.8, 1.5}) {
    Figure figure = withoutFingers();
    figure.add("grip", "rightHand", {-0.5 * reach, 0.0, 0.0});
    figure.add("blade", "grip", {-0.5 * reach, 0.0, 0.0});
    const std::string what = "a tool of " + std::to_string(reach) + " m";
    expectFound(figure, what);
    const HumanoidGuess guess = guessHumanoid(build(figure, Affine3::Identity(), 1).skeleton);
    EXPECT_TRUE(isDoubted(guess, kRightHand)) << what;
  }
}

TEST(IrregularRigs, WhateverHangsOnTheBodyItsBonesAreFound) {
  Figure oneHand = mannequinFigure(), fists = withoutFingers(), twists = fists, chains = fists;
  oneHand.remove([](const std::string& name) { return isFinger(name) && name.starts_with("left"); });
  fists.add("left fist", "leftHand", {0.08, 0.0, 0.0});
  fists.add("right fist", "rightHand", {-0.08, 0.0, 0.0});
  twists.insertAbove("leftHand", 0.5);
  twists.insertAbove("leftLowerArm", 0.5);
  chains.add("tail 1", "hips", {0.0, -0.05, -0.15});
  chains.add("tail 2", "tail 1", {0.0, -0.1, -0.25});
  chains.add("tail 3", "tail 2", {0.0, -0.1, -0.25});
  chains.add("bag", "upperChest", {0.0, 0.0, -0.2});
  chains.add("cape 1", "upperChest", {0.0, 0.1, -0.1});
  chains.add("cape 2", "cape 1", {0.0, -0.4, -0.1});
  chains.add("cape 3", "cape 2", {0.0, -0.4, -0.1});
  for (const auto& [figure, what] : {std::pair{oneHand, "fingers on the right only"},
                                     {fists, "fists"},
                                     {twists, "twist joints on the left only"},
                                     {chains, "tail, bag, cape"}}) {
    expectFound(figure, what);
  }
}

TEST(IrregularRigs, ArmsOnDifferentJointsOfTheTrunk) {
  Figure figure = withoutFingers();
  figure.parts[figure.find("rightShoulder")].parent = figure.find("chest");
  expectNothingSurelyWrong(figure, "the right arm on the chest");
}

TEST(IrregularRigs, AnArmThatIsATool) {
  Figure figure = without(withoutFingers(), {"rightLowerArm", "rightHand"});
  figure.add("cannon", "rightUpperArm", {-0.15, 0.0, 0.0});
  figure.add("muzzle", "cannon", {-0.9, 0.0, 0.1});
  expectNothingSurelyWrong(figure, "a cannon for an arm");
  const HumanoidGuess guess = guessHumanoid(build(figure, Affine3::Identity(), 1).skeleton);
  EXPECT_TRUE(isDoubted(guess, kRightLowerArm));
}

// Longer than the arms, and on the same joint.
TEST(IrregularRigs, WingsAreInDoubtBesideArms) {
  Figure figure = withoutFingers();
  for (const double side : {1.0, -1.0}) {
    const std::string name = side > 0.0 ? "left wing " : "right wing ";
    figure.add(name + "1", "upperChest", {0.1 * side, 0.05, -0.15});
    figure.add(name + "2", name + "1", {0.5 * side, 0.2, -0.2});
    figure.add(name + "3", name + "2", {0.5 * side, -0.1, -0.1});
  }
  expectNothingSurelyWrong(figure, "wings");
}

TEST(IrregularRigs, StraightLegsTellNoSides) {
  Figure figure = without(withoutFingers(), {"leftToes", "rightToes"});
  figure.straightenLegs();
  const HumanoidGuess guess = guessHumanoid(build(figure, Affine3::Identity(), 1).skeleton);
  EXPECT_TRUE(isDoubted(guess, kLeftUpperArm));
}

TEST(IrregularRigs, ARegularBodyIsNotInDoubt) {
  const HumanoidGuess guess = guessHumanoid(build(withoutFingers(), Affine3::Identity(), 1).skeleton);
  EXPECT_EQ(guess.by, "the skeleton's shape");
  EXPECT_TRUE(guess.doubts.empty()) << inWords(guess.doubts.front());
}

// A puppet: limbs of one joint each. It is not used, but suggested.
TEST(IrregularRigs, LimbsOfOneJointAreOnlySuggested) {
  const Figure puppet = without(
      withoutFingers(), {"leftLowerArm", "leftHand", "rightLowerArm", "rightHand", "leftShoulder", "rightShoulder",
                         "leftLowerLeg", "leftFoot", "leftToes", "rightLowerLeg", "rightFoot", "rightToes"});
  const Built built = build(puppet, Affine3::Identity(), 1);
  EXPECT_EQ(guessHumanoid(built.skeleton)[kHips], kNoJoint);
  const HumanoidGuess suggested = suggestHumanoid(built.skeleton);
  const std::map<HumanBone, std::string> found = namesOf(built.skeleton, suggested);
  for (const auto& [bone, joint] : found) EXPECT_TRUE(isDoubted(suggested, bone)) << nameOf(bone);
  for (const HumanBone bone : {kHips, kLeftUpperLeg, kRightUpperLeg, kLeftUpperArm, kRightUpperArm}) {
    ASSERT_TRUE(found.contains(bone)) << nameOf(bone);
    EXPECT_EQ(found.at(bone), built.truth.at(bone)) << nameOf(bone);
  }
}

TEST(IrregularRigs, NothingIsSuggestedForAChain) {
  std::vector<Joint> joints(5);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    joints[i].name = std::to_string(i);
    joints[i].parent = static_cast<JointIndex>(i) - 1;
    joints[i].rest.translation = Vec3(0.0, 0.2, 0.0);
  }
  EXPECT_EQ(suggestHumanoid(*Skeleton::create(joints))[kHips], kNoJoint);
}

}  // namespace
}  // namespace lorica

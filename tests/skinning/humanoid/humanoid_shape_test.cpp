#include "skinning/humanoid/humanoid.h"

#include "geometry/counts.h"
#include "geometry/random_numbers.h"
#include "skinning/mannequin/mannequin_skeleton.h"
#include "tests/skinning/humanoid/humanoid_figure.h"
#include "tests/skinning/humanoid/humanoid_samples.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

namespace lorica {
namespace {

using test::armsAt;
using test::build;
using test::Built;
using test::contradictions;
using test::differences;
using test::Figure;
using test::isFinger;
using test::mannequinFigure;
using test::namesOf;
using test::turned;
using test::without;
using enum HumanBone;
using test::isDoubted;

void expectFound(const Figure& figure, const std::string& what, const Affine3& world = Affine3::Identity()) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const Built built = build(figure, world, seed);
    const HumanoidGuess guess = guessHumanoid(built.skeleton);
    EXPECT_EQ(guess.by, "the skeleton's shape") << what;
    EXPECT_EQ(differences(built.truth, namesOf(built.skeleton, guess)), "") << what << ", seed " << seed;
    EXPECT_EQ(contradictions(built.skeleton, guess), "") << what;
  }
}

void expectNoHuman(const Figure& figure, const std::string& what) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const Built built = build(figure, Affine3::Identity(), seed);
    const HumanoidGuess guess = guessHumanoid(built.skeleton);
    EXPECT_EQ(guess.by, "") << what;
    EXPECT_EQ(namesOf(built.skeleton, guess).size(), 0u) << what;
  }
}

TEST(HumanoidShape, TheMannequinIsFoundWithoutNames) {
  expectFound(mannequinFigure(), "T-pose");
  expectFound(mannequinFigure(), "T-pose in centimetres", turned(0.0, Vec3::UnitX(), 100.0));
  expectFound(mannequinFigure(), "T-pose, small", turned(0.0, Vec3::UnitX(), 0.01));
}

TEST(HumanoidShape, ArmsMayHangInAnyRestPose) {
  for (const double degrees : {20.0, 45.0, 70.0, 85.0, -30.0}) {
    expectFound(armsAt(mannequinFigure(), degrees), fmt::format("arms {} degrees down", degrees));
  }
}

// The toes determine the facing direction in any orientation.
TEST(HumanoidShape, RestPosesMayBeTurned) {
  for (const double degrees : {45.0, 90.0, 180.0, 270.0}) {
    for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ()), Vec3(1, 1, 1)}) {
      expectFound(armsAt(mannequinFigure(), 40.0),
                  fmt::format("{} degrees about {} {} {}", degrees, axis.x(), axis.y(), axis.z()),
                  turned(degrees, axis.normalized()));
    }
  }
}

TEST(HumanoidShape, KneesTellTheSidesWhereThereAreNoToes) {
  const Figure figure = without(mannequinFigure(), {"leftToes", "rightToes"});
  expectFound(figure, "facing +Z");
  expectFound(figure, "facing -Z", turned(180.0, Vec3::UnitY()));
  expectFound(figure, "facing +X", turned(90.0, Vec3::UnitY()));
}

TEST(HumanoidShape, StraightLegsWithoutToesFaceAhead) {
  Figure figure = without(mannequinFigure(), {"leftToes", "rightToes"});
  figure.straightenLegs();
  expectFound(figure, "straight legs");
}

// Names that contain only sides: they take precedence over the toes.
TEST(HumanoidShape, SidesInNamesAreBelieved) {
  Built built = build(mannequinFigure(), turned(180.0, Vec3::UnitY()), 5);
  std::vector<Joint> joints(built.skeleton.joints().begin(), built.skeleton.joints().end());
  std::map<std::string, std::string> sided;
  for (const auto& [bone, name] : built.truth) {
    // Left and right exchanged: a mirrored character.
    if (mirrored(bone) != bone) sided[name] = name + (bone < mirrored(bone) ? "_R" : "_L");
  }
  for (Joint& joint : joints) {
    if (sided.contains(joint.name)) joint.name = sided.at(joint.name);
  }
  const Skeleton skeleton = std::move(*Skeleton::create(joints));
  std::map<HumanBone, std::string> truth;
  for (const auto& [bone, name] : built.truth) truth[mirrored(bone)] = sided.contains(name) ? sided.at(name) : name;
  EXPECT_EQ(differences(truth, namesOf(skeleton, guessHumanoid(skeleton))), "");
}

TEST(HumanoidShape, FewerJointsAreEnough) {
  Figure noFingers = mannequinFigure();
  noFingers.remove(isFinger);
  for (const auto& [figure, what] :
       {std::pair{noFingers, "no fingers"},
        {without(noFingers, {"leftToes", "rightToes"}), "no fingers, no toes"},
        {without(noFingers, {"leftShoulder", "rightShoulder"}), "no collar bones"},
        {without(noFingers, {"upperChest"}), "two joints of the spine"},
        {without(noFingers, {"upperChest", "chest"}), "one joint of the spine"},
        {without(noFingers, {"neck"}), "no neck"},
        {without(mannequinFigure(), {"leftShoulder", "rightShoulder", "neck", "upperChest"}), "fingers, few others"}}) {
    expectFound(figure, what);
  }
}

TEST(HumanoidShape, ExtraJointsBetweenAreLeftOut) {
  Figure figure = mannequinFigure();
  for (const char* name : {"leftLowerLeg", "rightLowerLeg", "leftFoot", "rightFoot", "leftLowerArm", "rightLowerArm",
                           "leftHand", "rightHand"}) {
    figure.insertAbove(name, 0.5);
  }
  expectFound(figure, "a twist joint in the middle of each segment");
  expectFound(armsAt(figure, 50.0), "and arms down");

  Figure ends = mannequinFigure();
  for (const char* side : {"left", "right"}) {
    ends.add("end of toes", side + std::string("Toes"), {0.0, 0.0, 0.06});
    for (const char* finger : {"ThumbDistal", "IndexDistal", "MiddleDistal", "RingDistal", "LittleDistal"}) {
      const double x = side == std::string("left") ? 0.02 : -0.02;
      ends.add("tip", side + std::string(finger),
               finger == std::string("ThumbDistal") ? Vec3(0.5 * x, 0.0, 0.018) : Vec3(x, 0.0, 0.0));
    }
  }
  ends.add("top of the head", "head", {0.0, 0.2, 0.0});
  expectFound(ends, "an end joint on each leaf");

  Figure root = mannequinFigure();
  root.parts.insert(root.parts.begin(), {"armature", -1, Vec3::Zero()});
  for (std::size_t i = 1; i < root.parts.size(); ++i) ++root.parts[i].parent;
  root.add("camera", "armature", {3.0, 1.0, 2.0});
  root.add("left foot's target", "armature", {0.1, 0.1, 0.0});
  root.add("right foot's target", "armature", {-0.1, 0.1, 0.0});
  expectFound(root, "a root above the hips, and its other children");
}

TEST(HumanoidShape, OrnamentsAreNoLimbs) {
  Figure figure = mannequinFigure();
  for (const double side : {1.0, -1.0}) {
    const std::string name = side > 0 ? "L" : "R";
    figure.add("braid " + name, "head", {0.06 * side, 0.1, -0.08});
    figure.add("braid end " + name, "braid " + name, {0.02 * side, -0.25, -0.02});
    figure.add("eye " + name, "head", {0.03 * side, 0.08, 0.07});
    figure.add("breast " + name, "upperChest", {0.08 * side, 0.0, 0.1});
    figure.add("breast end " + name, "breast " + name, {0.0, 0.0, 0.05});
    figure.add("skirt " + name, "hips", {0.15 * side, -0.05, 0.0});
    figure.add("skirt end " + name, "skirt " + name, {0.05 * side, -0.3, 0.0});
  }
  figure.add("tail", "hips", {0.0, 0.0, -0.1});
  figure.add("tail end", "tail", {0.0, -0.3, -0.3});
  expectFound(figure, "braids, breasts, a skirt and a tail");
}

// People differ, and rigs are not quite symmetric.
TEST(HumanoidShape, ProportionsMayDiffer) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    RandomNumbers random(seed);
    Figure figure = mannequinFigure();
    if (seed % 2 == 0) figure.remove(isFinger);
    const double legs = random.between(0.7, 1.2);
    const double arms = random.between(0.75, 1.2);
    std::vector<Vec3> offsets;
    for (const Figure::Part& part : figure.parts) {
      const Vec3 offset = part.parent == -1 ? part.position : Vec3(part.position - figure.parts[part.parent].position);
      const bool leg = part.name.ends_with("LowerLeg") || part.name.ends_with("Foot");
      const bool arm = part.name.ends_with("LowerArm") || part.name.ends_with("Hand");
      offsets.push_back(offset * (leg ? legs : arm ? arms : 1.0) * random.between(0.95, 1.05));
    }
    for (std::size_t i = 0; i < figure.parts.size(); ++i) {
      const int parent = figure.parts[i].parent;
      figure.parts[i].position = offsets[i] + (parent == -1 ? Vec3(Vec3::Zero()) : figure.parts[parent].position);
    }
    figure = armsAt(figure, random.between(0.0, 75.0));
    figure.bend("leftLowerArm", -random.between(0.0, 30.0), Vec3::UnitY());
    figure.bend("rightLowerArm", random.between(0.0, 30.0), Vec3::UnitY());
    const double apart = random.between(0.0, 15.0);
    figure.bend("leftUpperLeg", apart, Vec3::UnitZ());
    figure.bend("rightUpperLeg", -apart, Vec3::UnitZ());
    expectFound(figure, fmt::format("proportions {}", seed), turned(random.between(0.0, 360.0), Vec3::UnitY()));
  }
}

TEST(HumanoidShape, AnimalsAndMachinesAreNoHumans) {
  // A mannequin on all fours has a dog's skeleton: legs and arms point down from a horizontal trunk.
  Figure dog = mannequinFigure();
  dog.bend("spine", 90.0, Vec3::UnitX());
  dog.bend("head", -70.0, Vec3::UnitX());
  dog = armsAt(dog, 80.0);
  // Now the arms point down and the trunk ahead.
  ASSERT_LT(dog.at("leftHand").y(), 0.7);
  ASSERT_GT(dog.at("upperChest").z(), 0.2);
  expectNoHuman(dog, "a dog");

  Figure snake;
  for (int i = 0; i < 20; ++i) snake.parts.push_back({fmt::format("s{}", i), i - 1, Vec3(0.1 * i, 0.05, 0.0)});
  expectNoHuman(snake, "a snake");

  Figure spider;
  spider.parts.push_back({"body", -1, Vec3(0.0, 0.3, 0.0)});
  spider.parts.push_back({"abdomen", 0, Vec3(0.0, 0.35, -0.3)});
  for (int leg = 0; leg < 8; ++leg) {
    const double angle = (leg % 4 - 1.5) * 0.5;
    const double side = leg < 4 ? 1.0 : -1.0;
    const Vec3 out(side * std::cos(angle), 0.0, std::sin(angle));
    spider.parts.push_back({fmt::format("a{}", leg), 0, Vec3(0.0, 0.3, 0.0) + 0.1 * out});
    spider.parts.push_back({fmt::format("b{}", leg), countOf(spider.parts) - 1, Vec3(0.0, 0.5, 0.0) + 0.4 * out});
    spider.parts.push_back({fmt::format("c{}", leg), countOf(spider.parts) - 1, Vec3(0.0, 0.0, 0.0) + 0.8 * out});
  }
  expectNoHuman(spider, "a spider");

  Figure crane;
  crane.parts = {{"base", -1, Vec3::Zero()},        {"turret", 0, Vec3(0, 1, 0)},
                 {"boom", 1, Vec3(1, 2, 0)},        {"stick", 2, Vec3(2, 1.5, 0)},
                 {"bucket", 3, Vec3(2, 1, 0)},      {"piston", 1, Vec3(0.5, 1.2, 0.1)},
                 {"wheel front", 0, Vec3(1, 0, 0)}, {"wheel back", 0, Vec3(-1, 0, 0)}};
  expectNoHuman(crane, "a crane");
}

// A dog whose joints have human names is still a dog.
TEST(HumanoidShape, AnimalsWithHumanNamesAreNoHumans) {
  Figure dog = mannequinFigure();
  dog.bend("spine", 90.0, Vec3::UnitX());
  dog = armsAt(dog, 80.0);
  std::vector<Joint> joints;
  for (const Figure::Part& part : dog.parts) {
    Joint joint;
    joint.name = part.name;
    joint.parent = part.parent;
    joint.rest.translation = part.parent == -1 ? part.position : Vec3(part.position - dog.parts[part.parent].position);
    joints.push_back(joint);
  }
  EXPECT_EQ(guessHumanoid(*Skeleton::create(joints)).by, "");
}

// Names for the limbs only: the shape determines the rest.
TEST(HumanoidShape, ShapeFillsWhatNamesLack) {
  Figure figure = mannequinFigure();
  std::map<HumanBone, std::string> names;
  int number = 0;
  for (const Figure::Part& part : figure.parts) {
    const HumanBone bone = *humanBoneNamed(part.name);
    const bool named = bone == kHips || part.name.ends_with("Leg") || part.name.ends_with("Arm");
    names[bone] = named ? part.name : fmt::format("q{}", number++);
  }
  const Skeleton skeleton = test::renamedMannequin(names);
  const HumanoidGuess guess = guessHumanoid(skeleton);
  EXPECT_TRUE(guess.by.starts_with("names (")) << guess.by;
  EXPECT_EQ(differences(names, namesOf(skeleton, guess)), "");
}

// Skeletons without telling names whose chains are irregular.

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
void expectGuessed(const Figure& figure, const std::string& what) {
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
    expectGuessed(figure, what);
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
    expectGuessed(figure, what);
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

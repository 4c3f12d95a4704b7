#include "skinning/humanoid/humanoid.h"

#include "skinning/mannequin/mannequin_skeleton.h"
#include "tests/skinning/humanoid/humanoid_samples.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lorica {
namespace {

using test::contradictions;
using test::differences;
using test::namesOf;
using test::renamedMannequin;
using test::RigNames;
using test::rigNames;
using enum HumanBone;

[[nodiscard]] const RigNames& rig(std::string_view name) {
  for (const RigNames& rig : rigNames()) {
    if (rig.rig == name) return rig;
  }
  ADD_FAILURE() << "no rig " << name;
  return rigNames().front();
}

[[nodiscard]] Skeleton changed(const Skeleton& skeleton, const std::function<void(std::vector<Joint>&)>& change) {
  std::vector<Joint> joints(skeleton.joints().begin(), skeleton.joints().end());
  change(joints);
  return test::valueOf(Skeleton::create(std::move(joints)));
}

[[nodiscard]] Joint child(JointIndex parent, std::string name, const Vec3& offset) {
  Joint joint;
  joint.name = std::move(name);
  joint.parent = parent;
  joint.rest.translation = offset;
  return joint;
}

/// The bones of the skeleton are found by names.
HumanoidGuess expectGuess(const std::map<HumanBone, std::string>& truth, const Skeleton& skeleton,
                          std::string_view what = "") {
  HumanoidGuess guess = guessHumanoid(skeleton);
  EXPECT_EQ(differences(truth, namesOf(skeleton, guess)), "") << what;
  EXPECT_EQ(contradictions(skeleton, guess), "") << what;
  return guess;
}

TEST(Humanoid, EveryRigIsFullyRecovered) {
  for (const RigNames& names : rigNames()) {
    const std::map<HumanBone, std::string> truth = namesOf(names);
    const HumanoidGuess guess = expectGuess(truth, renamedMannequin(truth), names.rig);
    EXPECT_EQ(guess.by, "names (" + std::string(names.by) + ")") << names.rig;
  }
}

// Exporters change case and write blanks for underscores.
TEST(Humanoid, CaseAndSeparatorsDoNotMatter) {
  for (const std::string_view name : {"3ds Max Biped", "Kinect v1", "Blender", "MakeHuman's game engine", "KayKit"}) {
    std::map<HumanBone, std::string> truth = namesOf(rig(name));
    for (auto& [bone, joint] : truth) {
      for (char& c : joint) {
        if (c == '_' || c == ' ' || c == '.') c = '-';
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
      }
    }
    expectGuess(truth, renamedMannequin(truth), name);
  }
}

// Viewers and converters append a number to each joint: "mixamorig:LeftArm_09", "upper_arm.L_012".
TEST(Humanoid, RunningNumbersAndCommonEndingsAreNoNames) {
  for (const RigNames& names : rigNames()) {
    std::map<HumanBone, std::string> numbered = namesOf(names);
    std::map<HumanBone, std::string> suffixed = numbered;
    int number = 0;
    for (auto& [bone, joint] : numbered) joint += "_0" + std::to_string(number++);
    for (auto& [bone, joint] : suffixed) joint = "Hero:" + joint + "_Armature";
    for (const std::map<HumanBone, std::string>& truth : {numbered, suffixed}) {
      const HumanoidGuess guess = expectGuess(truth, renamedMannequin(truth), names.rig);
      EXPECT_EQ(guess.by, "names (" + std::string(names.by) + ")") << truth.at(kHips);
    }
  }
}

TEST(Humanoid, MetacarpalsAreBonesOfTheThumbAlone) {
  std::map<HumanBone, std::string> truth = namesOf(rig("Rokoko"));
  for (const bool left : {true, false}) {
    const auto at = [&](HumanBone bone) { return left ? bone : mirrored(bone); };
    const std::string side = left ? "Left" : "Right";
    truth[at(kLeftThumbMetacarpal)] = side + "Digit1Metacarpal";
    truth[at(kLeftThumbProximal)] = side + "Digit1ProximalPhalange";
    truth[at(kLeftThumbDistal)] = side + "Digit1DistalPhalange";
    // The mannequin has three of the index finger's four joints: its first represents the metacarpal.
    truth[at(kLeftIndexProximal)] = side + "Digit2Metacarpal";
    truth[at(kLeftIndexIntermediate)] = side + "Digit2ProximalPhalange";
    truth[at(kLeftIndexDistal)] = side + "Digit2IntermediatePhalange";
  }
  const Skeleton skeleton = renamedMannequin(truth);
  for (const bool left : {true, false}) {
    const auto at = [&](HumanBone bone) { return left ? bone : mirrored(bone); };
    const std::string side = left ? "Left" : "Right";
    truth[at(kLeftIndexProximal)] = side + "Digit2ProximalPhalange";
    truth[at(kLeftIndexIntermediate)] = side + "Digit2IntermediatePhalange";
    truth.erase(at(kLeftIndexDistal));
  }
  expectGuess(truth, skeleton);
}

TEST(Humanoid, HelpersAreNoBones) {
  const std::map<HumanBone, std::string> truth = namesOf(rig("Ready Player Me"));
  const Skeleton skeleton = changed(renamedMannequin(truth), [](std::vector<Joint>& joints) {
    const std::size_t count = joints.size();
    for (std::size_t i = 0; i < count; ++i) {
      const auto parent = static_cast<JointIndex>(i);
      const std::string name = joints[i].name;
      joints.push_back(child(parent, name + "Twist", {0.01, 0.0, 0.0}));
      joints.push_back(child(parent, name + "_end", {0.0, 0.1, 0.0}));
      joints.push_back(child(kNoJoint, name + "_IK_target", joints[i].rest.translation));
    }
  });
  expectGuess(truth, skeleton);
}

// A Rigify file with its whole rig: each bone three times, in three trees below one root.
TEST(Humanoid, OfDeformAndControlJointsTheDeformingChainIsTaken) {
  std::map<HumanBone, std::string> truth = namesOf(rig("Rigify"));
  const Skeleton deform = renamedMannequin(truth);
  const Skeleton whole = changed(deform, [&](std::vector<Joint>& joints) {
    std::vector<Joint> all = {child(kNoJoint, "root", Vec3::Zero())};
    for (const std::string_view prefix : {"ORG-", "MCH-", "", "DEF-"}) {
      const auto first = static_cast<JointIndex>(all.size());
      for (Joint joint : joints) {
        joint.name = std::string(prefix) + joint.name.substr(4);
        joint.parent = joint.parent == kNoJoint ? 0 : joint.parent + first;
        all.push_back(joint);
      }
    }
    joints = all;
  });
  expectGuess(truth, whole);
}

// As in the BVH files of CMU's database: zero-length joints in between, and a mitten for a hand.
TEST(Humanoid, CmuHasMoreJointsThanBones) {
  std::map<HumanBone, std::string> truth = namesOf(rig("CMU"));
  truth[kLeftThumbMetacarpal] = "LThumb";
  truth[kRightThumbMetacarpal] = "RThumb";
  truth[kLeftMiddleProximal] = "LFingers";
  truth[kRightMiddleProximal] = "RFingers";
  const Skeleton skeleton = changed(renamedMannequin(truth), [](std::vector<Joint>& joints) {
    const std::map<std::string, std::string> above = {{"LeftUpLeg", "LHipJoint"},
                                                      {"RightUpLeg", "RHipJoint"},
                                                      {"Head", "Neck1"},
                                                      {"LFingers", "LeftFingerBase"},
                                                      {"RFingers", "RightFingerBase"}};
    std::vector<Joint> all;
    std::vector<JointIndex> movedTo;
    for (Joint joint : joints) {
      if (joint.parent != kNoJoint) joint.parent = movedTo[joint.parent];
      if (const auto between = above.find(joint.name); between != above.end()) {
        all.push_back(child(joint.parent, between->second, Vec3::Zero()));
        joint.parent = static_cast<JointIndex>(all.size()) - 1;
      }
      movedTo.push_back(static_cast<JointIndex>(all.size()));
      all.push_back(joint);
    }
    joints = all;
  });
  EXPECT_EQ(expectGuess(truth, skeleton).by, "names (CMU)");
}

// Biped's thighs are children of the first spine joint, its collar bones of the neck.
TEST(Humanoid, OldBipedsHangThighsOnTheSpineAndCollarBonesOnTheNeck) {
  std::map<HumanBone, std::string> truth = namesOf(rig("3ds Max Biped"));
  const Skeleton skeleton = changed(renamedMannequin(truth), [](std::vector<Joint>& joints) {
    const auto find = [&](std::string_view name) {
      return static_cast<JointIndex>(std::ranges::find(joints, name, &Joint::name) - joints.begin());
    };
    for (const char* name : {"Bip01 L Thigh", "Bip01 R Thigh"}) joints[find(name)].parent = find("Bip01 Spine");
    for (const char* name : {"Bip01 L Clavicle", "Bip01 R Clavicle"}) joints[find(name)].parent = find("Bip01 Neck");
  });
  // A spine joint that rotates the legs is not used: the next two are the spine.
  truth[kSpine] = "Bip01 Spine1";
  truth[kChest] = "Bip01 Spine2";
  truth.erase(kUpperChest);
  expectGuess(truth, skeleton);
}

TEST(Humanoid, LongSpinesKeepTheirFirstMiddleAndLast) {
  std::map<HumanBone, std::string> truth = namesOf(rig("MakeHuman's game engine"));
  truth.erase(kUpperChest);
  truth[kSpine] = "spine_01";
  truth[kChest] = "spine_05";
  const Skeleton skeleton = changed(renamedMannequin(truth), [](std::vector<Joint>& joints) {
    // spine_02 to spine_04 are inserted: later joints move by three.
    std::vector<Joint> longer;
    for (Joint joint : joints) {
      if (joint.name == "spine_05") {
        const JointIndex below = joint.parent;
        for (int i = 2; i <= 4; ++i) {
          longer.push_back(child(below + i - 2, "spine_0" + std::to_string(i), 0.25 * joint.rest.translation));
        }
        joint.rest.translation *= 0.25;
        joint.parent = below + 3;
      } else if (joint.parent != kNoJoint && joint.name != "spine_01" && joint.parent >= 2) {
        joint.parent += 3;
      }
      longer.push_back(joint);
    }
    joints = longer;
  });
  truth[kChest] = "spine_03";
  truth[kUpperChest] = "spine_05";
  expectGuess(truth, skeleton);
}

TEST(Humanoid, NamesThatTheHierarchyContradictsAreNotTaken) {
  // Feet as separate targets beside the legs, as in game rigs.
  std::map<HumanBone, std::string> truth = namesOf(rig("KayKit"));
  const Skeleton skeleton = changed(renamedMannequin(truth), [](std::vector<Joint>& joints) {
    for (Joint& joint : joints) {
      if (joint.name == "foot.l" || joint.name == "foot.r") joint.parent = 0;
    }
  });
  for (const HumanBone bone : {kLeftFoot, kLeftToes, kRightFoot, kRightToes}) truth.erase(bone);
  expectGuess(truth, skeleton);
}

TEST(Humanoid, WordsAloneMakeNoHuman) {
  std::vector<Joint> joints = {child(kNoJoint, "hips", Vec3::Zero())};
  for (const char* name : {"leftUpperLeg", "leftLowerLeg", "rightUpperLeg", "rightLowerLeg", "head", "spine"}) {
    joints.push_back(child(0, name, {0.1, 0.1, 0.0}));
  }
  EXPECT_EQ(guessHumanoid(*Skeleton::create(joints)).by, "") << "no lower leg is below an upper one";
  std::vector<Joint> oneLeg = {child(kNoJoint, "hips", Vec3::Zero()), child(0, "leftUpperLeg", {0.1, 0.0, 0.0}),
                               child(1, "leftLowerLeg", {0.0, -0.4, 0.0}), child(0, "spine", {0.0, 0.2, 0.0})};
  EXPECT_EQ(guessHumanoid(*Skeleton::create(oneLeg)).by, "");
}

TEST(Humanoid, BonesThatAreThereAreKept) {
  const Skeleton mannequin = makeMannequinSkeleton();
  HumanoidGuess all;
  for (int i = 0; i < kHumanBoneCount; ++i) all.jointOf[i] = mannequin.jointOf(static_cast<HumanBone>(i));
  // The chest is given as the joint named upper chest; everything else is found by names.
  HumanoidGuess given;
  given.jointOf.fill(kNoJoint);
  given.jointOf[static_cast<std::size_t>(kSpine)] = mannequin.jointOf(kChest);
  const HumanoidGuess guess = guessHumanoid(withBones(mannequin, given));
  EXPECT_EQ(guess[kSpine], mannequin.jointOf(kChest));
  EXPECT_EQ(guess[kLeftHand], mannequin.jointOf(kLeftHand));
  EXPECT_EQ(guess[kHips], mannequin.jointOf(kHips));
  EXPECT_EQ(contradictions(mannequin, guess), "");

  const HumanoidGuess same = guessHumanoid(mannequin);
  EXPECT_EQ(same.jointOf, all.jointOf);
}

TEST(Humanoid, WithBonesMarksThoseAndNoOthers) {
  const Skeleton mannequin = makeMannequinSkeleton();
  HumanoidGuess none;
  none.jointOf.fill(kNoJoint);
  none.jointOf[static_cast<std::size_t>(kHead)] = mannequin.jointOf(kHead);
  const Skeleton marked = withBones(mannequin, none);
  for (const Joint& joint : marked.joints()) EXPECT_EQ(joint.bone.has_value(), joint.name == "head") << joint.name;
  EXPECT_EQ(marked.jointOf(kHips), kNoJoint);
}

TEST(Humanoid, ParentBonesLeadToTheHips) {
  for (int i = 0; i < kHumanBoneCount; ++i) {
    const auto bone = static_cast<HumanBone>(i);
    const std::optional<HumanBone> above = parentBone(bone);
    EXPECT_EQ(!above, bone == kHips) << nameOf(bone);
    if (!above) continue;
    EXPECT_LT(*above, bone) << nameOf(bone) << ": parents come first";
    const Skeleton mannequin = makeMannequinSkeleton();
    EXPECT_EQ(mannequin.joint(mannequin.joint(mannequin.jointOf(bone)).parent).bone, above) << nameOf(bone);
  }
}

// Names and trees that a file may contain: none may take long or crash.
TEST(Humanoid, OddSkeletonsAreSurvived) {
  const auto guess = [](const std::vector<Joint>& joints) { return guessHumanoid(*Skeleton::create(joints)).by; };
  EXPECT_EQ(guess({child(kNoJoint, "", Vec3::Zero())}), "");
  EXPECT_EQ(guess({child(kNoJoint, "::::", Vec3::Zero()), child(0, "\xff\xfe|", Vec3::Zero())}), "");
  EXPECT_EQ(guess({child(kNoJoint, "L", Vec3::Zero()), child(0, "left", Vec3::Zero()), child(0, "l0", Vec3::Zero())}),
            "");

  std::vector<Joint> chain;  // far too long for recursion, and all joints have one name
  for (JointIndex i = 0; i < 200000; ++i) chain.push_back(child(i - 1, "LeftUpLeg", {0.0, 1e-4, 0.0}));
  EXPECT_EQ(guess(chain), "");

  std::vector<Joint> star = {child(kNoJoint, "Hips", Vec3::Zero())};
  for (JointIndex i = 0; i < 20000; ++i)
    star.push_back(child(i % 2 == 0 ? 0 : i, i % 3 == 0 ? "LeftLeg" : "RightLeg", {0.01 * i, -0.1, 0.0}));
  EXPECT_EQ(guess(star), "");

  std::vector<Joint> comb;  // each joint of a long chain carries a joint
  for (JointIndex i = 0; i < 20000; ++i) {
    comb.push_back(child(i == 0 ? kNoJoint : 2 * (i - 1), "a", {0.0, 0.01, 0.0}));
    comb.push_back(child(2 * i, "LeftHandThumb1", {0.0, 0.01, 0.01}));
  }
  EXPECT_EQ(guess(comb), "");
}

}  // namespace
}  // namespace lorica

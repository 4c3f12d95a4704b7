#include "capture/retarget/proxy_skeleton.h"
#include "capture/retarget/skeletal_retarget.h"

#include "capture/files/joint_csv.h"
#include "capture/retarget/retarget.h"
#include "skinning/import/character_file.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/capture/figures.h"
#include "tests/support/allocations.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

namespace lorica {
namespace {

using test::angleBetween;
using test::degrees;
using B = HumanBone;

const Character& mannequin() {
  static const Character character = makeMannequin();
  return character;
}

std::size_t at(JointIndex joint) {
  return static_cast<std::size_t>(joint);
}

bool isBelowOrSame(const Skeleton& skeleton, JointIndex joint, JointIndex ancestor) {
  while (joint != kNoJoint && joint != ancestor) joint = skeleton.joint(joint).parent;
  return joint == ancestor;
}

JointTransform localOf(const Affine3& transform) {
  JointTransform local;
  local.translation = transform.translation();
  local.rotation = Quat(Mat3(transform.linear())).normalized();
  return local;
}

/// The mannequin without some joints: their children and vertices are attached to their parents.
Character without(const std::set<JointIndex>& removed) {
  Character character = mannequin();
  const Skeleton whole = character.skeleton;
  const std::vector<Affine3> world = test::worldOf(whole, restPose(whole));
  std::vector<JointIndex> newIndex(at(whole.jointCount()));
  std::vector<JointIndex> oldIndex;
  std::vector<Joint> joints;
  std::vector<Affine3> jointFromModel;
  for (JointIndex j = 0; j < whole.jointCount(); ++j) {
    JointIndex parent = whole.joint(j).parent;
    while (parent != kNoJoint && removed.count(parent) != 0) parent = whole.joint(parent).parent;
    if (removed.count(j) != 0) {
      newIndex[at(j)] = newIndex[at(parent)];
      continue;
    }
    newIndex[at(j)] = static_cast<JointIndex>(joints.size());
    Joint joint = whole.joint(j);
    if (parent != joint.parent) joint.rest = localOf(world[at(parent)].inverse() * world[at(j)]);
    joint.parent = parent == kNoJoint ? kNoJoint : newIndex[at(parent)];
    joints.push_back(joint);
    jointFromModel.push_back(character.jointFromModel[at(j)]);
  }
  for (Influence& influence : character.influences) influence.joint = newIndex[at(influence.joint)];
  character.skeleton = *Skeleton::create(std::move(joints));
  character.jointFromModel = std::move(jointFromModel);
  return character;
}

std::set<JointIndex> bonesOf(std::initializer_list<B> bones) {
  std::set<JointIndex> joints;
  for (const B bone : bones) joints.insert(mannequin().skeleton.jointOf(bone));
  return joints;
}

std::set<JointIndex> withAllBelow(std::initializer_list<B> bones) {
  std::set<JointIndex> joints;
  for (JointIndex j = 0; j < mannequin().skeleton.jointCount(); ++j) {
    for (const B bone : bones) {
      if (isBelowOrSame(mannequin().skeleton, j, mannequin().skeleton.jointOf(bone))) joints.insert(j);
    }
  }
  return joints;
}

/// The mannequin with its feet detached from the legs, like inverse kinematics targets; toes and feet need not be
/// marked.
Character withFeetAtTheRoot(bool marked) {
  Character character = mannequin();
  const Skeleton& whole = mannequin().skeleton;
  const std::vector<Affine3> world = test::worldOf(whole, restPose(whole));
  std::vector<Joint> joints(whole.joints().begin(), whole.joints().end());
  for (const B foot : {B::kLeftFoot, B::kRightFoot}) {
    Joint& joint = joints[at(whole.jointOf(foot))];
    joint.parent = 0;
    joint.rest = localOf(world[0].inverse() * world[at(whole.jointOf(foot))]);
  }
  for (const B bone : {B::kLeftFoot, B::kRightFoot, B::kLeftToes, B::kRightToes}) {
    if (!marked) joints[at(whole.jointOf(bone))].bone.reset();
  }
  character.skeleton = *Skeleton::create(std::move(joints));
  return character;
}

const std::vector<SkeletonFrame>& recording(const char* name) {
  static std::map<std::string, std::vector<SkeletonFrame>> read;
  std::vector<SkeletonFrame>& frames = read[name];
  if (frames.empty()) frames = *readJointCsv(test::recordingsFolder() / (std::string(name) + ".csv"));
  return frames;
}

/// The world transforms of every joint in every frame of a recording.
std::vector<std::vector<Affine3>> performances(const Character& character, const char* name, bool plantFeet = true) {
  ProxySkeleton proxy = *ProxySkeleton::create(character);
  Retargeter retargeter = *Retargeter::create(proxy.skeleton(), {.hold = {}, .plantFeet = plantFeet});
  Pose proxyPose(at(proxy.skeleton().jointCount()));
  Pose pose(at(character.skeleton.jointCount()));
  std::vector<std::vector<Affine3>> frames;
  for (const SkeletonFrame& frame : recording(name)) {
    retargeter.apply(frame, proxyPose);
    proxy.mapBack(proxyPose, pose);
    frames.push_back(test::worldOf(character.skeleton, pose));
  }
  return frames;
}

double turnBetween(const Affine3& a, const Affine3& b) {
  return Quat(Mat3(a.linear())).angularDistance(Quat(Mat3(b.linear())));
}

double lowestPoint(const Character& character, std::span<const Affine3> world) {
  std::vector<Affine3> worldFromModel(world.size());
  std::vector<Vec3> posed(character.mesh.vertices.size());
  computeWorldFromModel(character, world, worldFromModel);
  skinLinearBlend(character, worldFromModel, posed);
  double lowest = posed.front().y();
  for (const Vec3& p : posed) lowest = std::min(lowest, p.y());
  return lowest;
}

TEST(RetargetMotion, ACharacterWithoutForearmsIsAcceptedThroughItsProxy) {
  const Character character = without(bonesOf({B::kLeftLowerArm, B::kRightLowerArm}));
  SkeletalMotion source{"turn", mannequin().skeleton, {0.0, 0.1}, {}};
  for (int frame = 0; frame < 2; ++frame) {
    Pose pose = restPose(source.skeleton);
    pose[at(source.skeleton.jointOf(B::kLeftUpperArm))].rotation = Quat(Eigen::AngleAxisd(0.3 * frame, Vec3::UnitZ()));
    source.poses.insert(source.poses.end(), pose.begin(), pose.end());
  }
  EXPECT_FALSE(retargetMotion(source, character.skeleton).ok()) << "its skeleton alone lacks bones";
  const SkeletalMotion onto = test::valueOf(retargetMotion(source, character));
  ProxySkeleton proxy = ProxySkeleton::create(character).value();
  const SkeletalMotion expected = proxy.mapBack(retargetMotion(source, proxy.skeleton()).value());
  ASSERT_EQ(onto.poses.size(), 2u * static_cast<std::size_t>(character.skeleton.jointCount()));
  for (std::size_t j = 0; j < expected.poses.size(); ++j) {
    EXPECT_EQ(onto.poses[j].translation, expected.poses[j].translation);
    EXPECT_EQ(onto.poses[j].rotation.coeffs(), expected.poses[j].rotation.coeffs());
  }
}

class ProxyMotion : public ::testing::TestWithParam<const char*> {};

TEST_P(ProxyMotion, FeetThatHangOnTheRootGoWithTheLegs) {
  const auto whole = performances(mannequin(), GetParam());
  for (const bool marked : {true, false}) {
    const Character character = withFeetAtTheRoot(marked);
    ASSERT_FALSE(RetargetRig::create(character.skeleton));
    const auto frames = performances(character, GetParam());
    double farthest = 0.0;
    double turn = 0.0;
    for (std::size_t f = 0; f < whole.size(); ++f) {
      for (std::size_t j = 0; j < whole[f].size(); ++j) {
        farthest = std::max(farthest, (frames[f][j].translation() - whole[f][j].translation()).norm());
        turn = std::max(turn, turnBetween(frames[f][j], whole[f][j]));
      }
    }
    EXPECT_LT(farthest, 0.001) << marked;
    EXPECT_LT(turn, degrees(0.1)) << marked;
  }
}

TEST_P(ProxyMotion, AnArmOfOneJointPointsWhereTheHandWas) {
  const Character character = without(bonesOf({B::kLeftLowerArm, B::kRightLowerArm}));
  const auto whole = performances(mannequin(), GetParam());
  const auto frames = performances(character, GetParam());
  const Skeleton& from = mannequin().skeleton;
  const Skeleton& to = character.skeleton;
  double miss = 0.0;  // distance of the hand from the line along which the straight arm points [m]
  double hands = 0.0;
  double others = 0.0;
  for (std::size_t f = 0; f < whole.size(); ++f) {
    for (const std::size_t i : {0U, 1U}) {
      const auto line = [&](const Skeleton& skeleton, const std::vector<Affine3>& world) -> Vec3 {
        return world[at(skeleton.jointOf(limbs()[i].end))].translation() -
               world[at(skeleton.jointOf(limbs()[i].upper))].translation();
      };
      const Vec3 along = line(to, frames[f]).normalized();
      const Vec3 hand = line(from, whole[f]);
      miss = std::max(miss, (hand - hand.dot(along) * along).norm());
    }
    const auto turn = [&](B bone) {
      return turnBetween(whole[f][at(from.jointOf(bone))], frames[f][at(to.jointOf(bone))]);
    };
    for (const B bone : {B::kHips, B::kChest, B::kHead, B::kLeftFoot, B::kRightFoot, B::kLeftLowerLeg}) {
      others = std::max(others, turn(bone));
    }
    for (const B bone : {B::kLeftHand, B::kRightHand, B::kLeftIndexProximal}) hands = std::max(hands, turn(bone));
  }
  RecordProperty("arm_mm", std::to_string(1000.0 * miss));
  // The proxy's elbow is halfway, so its hand is off by (u - f) / 2 times the difference of the bones' directions,
  // where u and f are the lengths of upper arm and forearm; plus 1 cm for the elbow that is not quite straight at rest.
  const std::vector<Affine3> rest = test::worldOf(from, restPose(from));
  const auto position = [&](B bone) -> Vec3 { return rest[at(from.jointOf(bone))].translation(); };
  const double upperArm = (position(B::kLeftLowerArm) - position(B::kLeftUpperArm)).norm();
  const double forearm = (position(B::kLeftHand) - position(B::kLeftLowerArm)).norm();
  RecordProperty("bones_mm", std::to_string(1000.0 * std::abs(upperArm - forearm)));
  EXPECT_LT(miss, std::abs(upperArm - forearm) + 0.01);
  EXPECT_LT(others, degrees(0.1));
  // At rest the mannequin's elbow is bent by 1.3 degrees, which cannot be known here.
  EXPECT_LT(hands, degrees(1.5));
}

TEST_P(ProxyMotion, ALegOfOneJointPointsWhereTheFootWasAboveTheFloor) {
  const Character character = without(bonesOf({B::kLeftLowerLeg, B::kRightLowerLeg}));
  const auto whole = performances(mannequin(), GetParam());
  const auto frames = performances(character, GetParam());
  const Skeleton& from = mannequin().skeleton;
  const Skeleton& to = character.skeleton;
  double leg = 0.0;
  double others = 0.0;
  double lowest = 1.0;
  for (std::size_t f = 0; f < whole.size(); ++f) {
    for (const std::size_t i : {2U, 3U}) {
      const auto line = [&](const Skeleton& skeleton, const std::vector<Affine3>& world) -> Vec3 {
        return world[at(skeleton.jointOf(limbs()[i].end))].translation() -
               world[at(skeleton.jointOf(limbs()[i].upper))].translation();
      };
      leg = std::max(leg, angleBetween(line(from, whole[f]), line(to, frames[f])));
    }
    for (const B bone : {B::kHips, B::kChest, B::kHead, B::kLeftLowerArm, B::kRightHand}) {
      others = std::max(others, turnBetween(whole[f][at(from.jointOf(bone))], frames[f][at(to.jointOf(bone))]));
    }
    if (f % 4 == 0) lowest = std::min(lowest, lowestPoint(character, frames[f]));
  }
  RecordProperty("leg_deg", std::to_string(leg / degrees(1.0)));
  EXPECT_LT(leg, degrees(6.0));
  EXPECT_LT(others, degrees(0.1));
  EXPECT_GT(lowest, -0.01);
}

TEST_P(ProxyMotion, LimbsWithoutHandsAndFeetPointAsTheWholeOnesDo) {
  const Character character = without(withAllBelow({B::kLeftHand, B::kRightHand, B::kLeftFoot, B::kRightFoot}));
  ASSERT_FALSE(RetargetRig::create(character.skeleton));
  // A foot without toes is planted differently: compare directions without foot planting.
  const auto whole = performances(mannequin(), GetParam(), false);
  const auto frames = performances(character, GetParam(), false);
  const Skeleton& from = mannequin().skeleton;
  const Skeleton& to = character.skeleton;
  const std::vector<Affine3> restFrom = test::worldOf(from, restPose(from));
  double limb = 0.0;
  double trunk = 0.0;
  double lowest = 1.0;
  for (std::size_t f = 0; f < whole.size(); ++f) {
    for (const LimbBones& bones : limbs()) {
      const Vec3 upper = restFrom[at(from.jointOf(bones.upper))].translation();
      const Vec3 lower = restFrom[at(from.jointOf(bones.lower))].translation();
      const Vec3 end = restFrom[at(from.jointOf(bones.end))].translation();
      // The rest pose has no rotations, so the same direction in the joint's frame is the same in both.
      const auto way = [&](const std::vector<Affine3>& world, const Skeleton& skeleton, B bone, const Vec3& along) {
        return Vec3(world[at(skeleton.jointOf(bone))].linear() * along);
      };
      limb = std::max(
          {limb,
           angleBetween(way(whole[f], from, bones.upper, lower - upper),
                        way(frames[f], to, bones.upper, lower - upper)),
           angleBetween(way(whole[f], from, bones.lower, end - lower), way(frames[f], to, bones.lower, end - lower))});
    }
    for (const B bone : {B::kHips, B::kChest, B::kHead}) {
      trunk = std::max(trunk, turnBetween(whole[f][at(from.jointOf(bone))], frames[f][at(to.jointOf(bone))]));
    }
  }
  const auto planted = performances(character, GetParam());
  for (std::size_t f = 0; f < planted.size(); f += 4) lowest = std::min(lowest, lowestPoint(character, planted[f]));
  RecordProperty("limb_deg", std::to_string(limb / degrees(1.0)));
  EXPECT_LT(limb, degrees(4.0));
  EXPECT_LT(trunk, degrees(0.1));
  EXPECT_GT(lowest, -0.01);
}

INSTANTIATE_TEST_SUITE_P(All, ProxyMotion, ::testing::Values("walk", "jumping_jacks", "punch_and_kick"),
                         [](const auto& chosen) { return std::string(chosen.param); });

/// A variation of a rig with inverse kinematics: the chains of bones end as usual, but carry no mesh there.
struct ControlRig {
  bool hands = false;        ///< controls for the hands, not for the feet alone
  int toes = 0;              ///< 0 stay on the chain, 1 follow the control, 2 have a joint of their own below it
  int parent = 0;            ///< controls hang on 0 nothing, 1 a turned, scaled joint beside the hips, 2 the hips
  const char* name = "IK_";  ///< before the name of the bone

  [[nodiscard]] std::string text() const {
    return fmt::format("hands {}, toes {}, parent {}, named {}", hands, toes, parent, name);
  }
};

/// The mannequin as such a rig, and for each added joint the one whose vertices it took.
struct ControlledCharacter {
  Character character;
  std::map<JointIndex, JointIndex> took;
};

ControlledCharacter controlled(const ControlRig& rig) {
  ControlledCharacter made{mannequin(), {}};
  Character& character = made.character;
  const Skeleton& whole = mannequin().skeleton;
  const std::vector<Affine3> world = test::worldOf(whole, restPose(whole));
  std::vector<Joint> joints(whole.joints().begin(), whole.joints().end());
  std::vector<Affine3> jointWorld = world;
  std::map<JointIndex, JointIndex> newOwner;
  const auto add = [&](const std::string& name, JointIndex parent, const Affine3& where, JointIndex takes) {
    const auto joint = static_cast<JointIndex>(joints.size());
    Joint added{name, parent, {}, std::nullopt};
    const Affine3 local =
        (parent == kNoJoint ? Affine3(Affine3::Identity()) : jointWorld[at(parent)]).inverse() * where;
    const double scale = std::cbrt(local.linear().determinant());
    added.rest.translation = local.translation();
    added.rest.rotation = Quat(Mat3(local.linear() / scale)).normalized();
    added.rest.scale.setConstant(scale);
    joints.push_back(added);
    jointWorld.push_back(where);
    character.jointFromModel.push_back(takes == kNoJoint ? where.inverse() : character.jointFromModel[at(takes)]);
    if (takes != kNoJoint) {
      newOwner[takes] = joint;
      made.took[joint] = takes;
    }
    return joint;
  };
  JointIndex parent = kNoJoint;  // the mannequin's first joint is its hips
  if (rig.parent == 2) parent = whole.jointOf(B::kHips);
  if (rig.parent == 1) {
    Affine3 turned = Affine3::Identity();
    turned.rotate(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized())).scale(0.01);
    parent = add("Controls", kNoJoint, turned, kNoJoint);
  }
  std::vector<std::pair<B, B>> ends = {{B::kLeftFoot, B::kLeftToes}, {B::kRightFoot, B::kRightToes}};
  if (rig.hands) ends.insert(ends.end(), {{B::kLeftHand, B::kLeftHand}, {B::kRightHand, B::kRightHand}});
  for (const auto& [end, toe] : ends) {
    const JointIndex bone = whole.jointOf(end);
    const JointIndex control = add(rig.name + whole.joint(bone).name, parent, world[at(bone)], bone);
    const JointIndex toes = whole.jointOf(toe);
    if (toe == end || toes == kNoJoint || rig.toes == 0) continue;
    if (rig.toes == 1) {
      newOwner[toes] = control;
    } else {
      add(rig.name + whole.joint(toes).name, control, world[at(toes)], toes);
    }
  }
  for (Influence& influence : character.influences) {
    const auto found = newOwner.find(influence.joint);
    if (found != newOwner.end()) influence.joint = found->second;
  }
  character.skeleton = *Skeleton::create(std::move(joints));
  return made;
}

TEST_P(ProxyMotion, WhatCarriesTheMeshGoesWithTheBonesInEveryRig) {
  const auto whole = performances(mannequin(), GetParam());
  int rigs = 0;
  for (const bool hands : {false, true}) {
    for (const int toes : {0, 1, 2}) {
      for (const int parent : {0, 1, 2}) {
        for (const char* name : {"IK_", "ctrl ", "Bone.042 "}) {
          const ControlRig rig{hands, toes, parent, name};
          SCOPED_TRACE(rig.text());
          const ControlledCharacter made = controlled(rig);
          ASSERT_TRUE(RetargetRig::create(made.character.skeleton)) << "the chains are whole";
          const ProxySkeleton proxy = *ProxySkeleton::create(made.character);
          ASSERT_EQ(proxy.strays().empty(), false);
          for (const ProxySkeleton::Stray& stray : proxy.strays()) EXPECT_NE(stray.on, kNoJoint);

          // Skinned by the added joints, as it would be by the bones whose vertices they took.
          Character expected = made.character;
          for (Influence& influence : expected.influences) {
            const auto found = made.took.find(influence.joint);
            if (found != made.took.end()) influence.joint = found->second;
          }
          const auto frames = performances(made.character, GetParam());
          std::vector<Vec3> posed(expected.mesh.vertices.size());
          std::vector<Vec3> truth(posed.size());
          double farthest = 0.0;
          for (std::size_t f = 0; f < whole.size(); f += 7) {
            std::vector<Affine3> world = frames[f];
            computeWorldFromModel(made.character, world, world);
            skinLinearBlend(made.character, world, posed);
            world = whole[f];
            world.resize(frames[f].size(), Affine3::Identity());
            computeWorldFromModel(expected, world, world);
            skinLinearBlend(expected, world, truth);
            for (std::size_t v = 0; v < posed.size(); ++v) farthest = std::max(farthest, (posed[v] - truth[v]).norm());
          }
          // Own toes below a control turn with the foot, not with the toes of the chain.
          EXPECT_LT(farthest, toes == 2 ? 0.06 : 0.001);
          ++rigs;
        }
      }
    }
  }
  EXPECT_EQ(rigs, 54);
}

TEST(ProxySkeleton, SaysWhatStaysBehind) {
  Character character = mannequin();
  std::vector<Joint> joints(character.skeleton.joints().begin(), character.skeleton.joints().end());
  const auto far = static_cast<JointIndex>(joints.size());
  joints.push_back({"Shadow", kNoJoint, {}, std::nullopt});
  joints.back().rest.translation = Vec3(3.0, 0.0, 0.0);
  character.skeleton = *Skeleton::create(std::move(joints));
  Affine3 placed = Affine3::Identity();
  placed.translation() = Vec3(-3.0, 0.0, 0.0);
  character.jointFromModel.push_back(placed);
  character.influences[character.influenceBegin[0]] = {far, 1.0};
  for (std::uint32_t i = character.influenceBegin[0] + 1; i < character.influenceBegin[1]; ++i) {
    character.influences[i].weight = 0.0;
  }
  character.mesh.vertices[0] = Vec3(3.0, 0.0, 0.0);
  const ProxySkeleton proxy = *ProxySkeleton::create(character);
  EXPECT_TRUE(proxy.isOwn());
  ASSERT_EQ(proxy.strays().size(), 1u);
  EXPECT_EQ(proxy.strays()[0].joint, far);
  EXPECT_EQ(proxy.strays()[0].on, kNoJoint);
  const std::vector<std::string> sentences = leftBehind(character);
  ASSERT_EQ(sentences.size(), 1u);
  EXPECT_NE(sentences[0].find("Shadow"), std::string::npos);
  EXPECT_TRUE(leftBehind(mannequin()).empty());
}

TEST(ProxySkeleton, OfAWholeSkeletonIsThatSkeleton) {
  ProxySkeleton proxy = *ProxySkeleton::create(mannequin());
  EXPECT_TRUE(proxy.substitutes().empty());
  ASSERT_EQ(proxy.skeleton().jointCount(), mannequin().skeleton.jointCount());
  Retargeter retargeter = *Retargeter::create(mannequin().skeleton);
  Pose pose(at(mannequin().skeleton.jointCount()));
  Pose carried = pose;
  retargeter.apply(recording("walk")[40], pose);
  proxy.mapBack(pose, carried);
  for (std::size_t j = 0; j < pose.size(); ++j) {
    EXPECT_EQ(carried[j].translation, pose[j].translation);
    EXPECT_EQ(carried[j].rotation.coeffs(), pose[j].rotation.coeffs());
    EXPECT_EQ(carried[j].scale, pose[j].scale);
  }
}

TEST(ProxySkeleton, RestsAsTheCharacterDoes) {
  const std::vector<Character> characters = {
      withFeetAtTheRoot(false),
      without(bonesOf({B::kLeftLowerArm, B::kRightLowerArm, B::kLeftLowerLeg, B::kRightLowerLeg})),
      without(withAllBelow({B::kLeftLowerArm, B::kRightLowerArm, B::kLeftLowerLeg, B::kRightLowerLeg}))};
  for (const Character& character : characters) {
    ProxySkeleton proxy = *ProxySkeleton::create(character);
    EXPECT_TRUE(RetargetRig::create(proxy.skeleton()));
    Pose pose(at(character.skeleton.jointCount()));
    proxy.mapBack(restPose(proxy.skeleton()), pose);
    const std::vector<Affine3> rest = test::worldOf(character.skeleton, restPose(character.skeleton));
    const std::vector<Affine3> carried = test::worldOf(character.skeleton, pose);
    // Equal except for the sole, which is raised to the floor.
    const double lift = carried[0].translation().y() - rest[0].translation().y();
    EXPECT_LT(lift, 0.005);
    EXPECT_GE(lift, 0.0);
    for (std::size_t j = 0; j < rest.size(); ++j) {
      EXPECT_LT((carried[j].translation() - rest[j].translation() - Vec3(0.0, lift, 0.0)).norm(), 1e-9);
      EXPECT_LT(turnBetween(carried[j], rest[j]), 1e-7);
    }
  }
}

TEST(ProxySkeleton, MapsBackWithoutMemory) {
  for (const Character& character :
       {mannequin(), withFeetAtTheRoot(true), without(withAllBelow({B::kLeftLowerLeg, B::kRightLowerArm}))}) {
    ProxySkeleton proxy = *ProxySkeleton::create(character);
    const Pose proxyPose = restPose(proxy.skeleton());
    Pose pose(at(character.skeleton.jointCount()));
    const test::AllocationWatch watch;
    proxy.mapBack(proxyPose, pose);
    EXPECT_EQ(watch.largest(), 0U);
  }
}

TEST(ProxySkeleton, RefusesWhatIsNoHumanoid) {
  Character character = mannequin();
  for (const B bone : {B::kHips, B::kLeftUpperArm, B::kRightUpperArm, B::kLeftUpperLeg, B::kRightUpperLeg}) {
    std::vector<Joint> joints(mannequin().skeleton.joints().begin(), mannequin().skeleton.joints().end());
    joints[at(mannequin().skeleton.jointOf(bone))].bone.reset();
    character.skeleton = *Skeleton::create(std::move(joints));
    const Result<ProxySkeleton> proxy = ProxySkeleton::create(character);
    ASSERT_FALSE(proxy) << nameOf(bone);
    EXPECT_NE(proxy.error().message.find(nameOf(bone)), std::string::npos) << proxy.error().message;
    EXPECT_FALSE(canPerform(character));
  }
  std::vector<Joint> joints(mannequin().skeleton.joints().begin(), mannequin().skeleton.joints().end());
  for (const B bone : {B::kSpine, B::kChest, B::kUpperChest}) {
    if (mannequin().skeleton.jointOf(bone) != kNoJoint) joints[at(mannequin().skeleton.jointOf(bone))].bone.reset();
  }
  character.skeleton = *Skeleton::create(std::move(joints));
  EXPECT_FALSE(canPerform(character));
}

TEST(ProxySkeleton, AHandWithoutAMeshIsNowhere) {
  Character character = without(withAllBelow({B::kLeftHand}));
  EXPECT_TRUE(canPerform(character));
  character.mesh = {};
  character.influences.clear();
  character.influenceBegin = {0};
  const Result<ProxySkeleton> proxy = ProxySkeleton::create(character);
  ASSERT_FALSE(proxy);
  EXPECT_NE(proxy.error().message.find("leftHand"), std::string::npos) << proxy.error().message;
}

TEST(ProxySkeleton, TheRobotsFeetHangOnItsShins) {
  LORICA_REQUIRE_DATASET(file, "characters/raylib_robot/robot.glb");
  const CharacterFile robot = test::valueOf(readCharacterFile(file));
  const Skeleton& own = robot.character.skeleton;
  const ProxySkeleton proxy = *ProxySkeleton::create(robot.character);
  ASSERT_EQ(proxy.substitutes().size(), 2U);
  for (const std::size_t i : {0U, 1U}) {
    const ProxySkeleton::Substitute& foot = proxy.substitutes()[i];
    EXPECT_EQ(foot.bone, i == 0 ? B::kLeftFoot : B::kRightFoot);
    EXPECT_EQ(own.joint(foot.joint).name, i == 0 ? "Foot.L" : "Foot.R");
    EXPECT_EQ(own.joint(foot.on).name, i == 0 ? "LowerLeg.L" : "LowerLeg.R");
  }
}

TEST(ProxySkeleton, TheGreenmanGetsElbowsAndKnees) {
  LORICA_REQUIRE_DATASET(file, "characters/greenman/greenman.glb");
  const CharacterFile greenman = test::valueOf(readCharacterFile(file));
  const ProxySkeleton proxy = test::valueOf(ProxySkeleton::create(greenman.character));
  std::set<B> made;
  for (const ProxySkeleton::Substitute& substitute : proxy.substitutes()) made.insert(substitute.bone);
  EXPECT_EQ(made, (std::set<B>{B::kLeftLowerArm, B::kRightLowerArm, B::kLeftHand, B::kRightHand, B::kLeftLowerLeg,
                               B::kRightLowerLeg, B::kLeftFoot, B::kRightFoot}));
}

TEST(ProxySkeleton, RefusesTheFox) {
  LORICA_REQUIRE_DATASET(file, "characters/fox/Fox.glb");
  const CharacterFile fox = test::valueOf(readCharacterFile(file));
  const Result<ProxySkeleton> proxy = ProxySkeleton::create(fox.character);
  ASSERT_FALSE(proxy);
  EXPECT_NE(proxy.error().message.find("leftUpperArm"), std::string::npos) << proxy.error().message;
}

}  // namespace
}  // namespace lorica

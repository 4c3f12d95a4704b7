#include "tests/skinning/humanoid/humanoid_samples.h"

#include "skinning/mannequin/mannequin_skeleton.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace lorica::test {

namespace {

using enum HumanBone;

constexpr const char* kPinky = "Thumb,Index,Middle,Ring,Pinky";

const std::vector<RigNames> kRigs = {
    rigOf("VRM", "VRM", "left,right", "hips,spine,chest,upperChest,neck,head", "%UpperLeg,%LowerLeg,%Foot,%Toes",
          "%Shoulder,%UpperArm,%LowerArm,%Hand"),
    rigOf("VRoid", "VRM", "L,R",
          "J_Bip_C_Hips,J_Bip_C_Spine,J_Bip_C_Chest,J_Bip_C_UpperChest,J_Bip_C_Neck,J_Bip_C_Head",
          "J_Bip_%_UpperLeg,J_Bip_%_LowerLeg,J_Bip_%_Foot,J_Bip_%_ToeBase",
          "J_Bip_%_Shoulder,J_Bip_%_UpperArm,J_Bip_%_LowerArm,J_Bip_%_Hand", "J_Bip_%_@#",
          "Thumb,Index,Middle,Ring,Little"),
    rigOf("VRM 0.x fingers", "VRM", "Left,Right", "Hips,Spine,Chest,UpperChest,Neck,Head",
          "%UpperLeg,%LowerLeg,%Foot,%Toes", "%Shoulder,%UpperArm,%LowerArm,%Hand", "%@#",
          "Thumb,Index,Middle,Ring,Little", "Proximal,Intermediate,Distal"),
    rigOf("Mixamo", "Mixamo", "Left,Right",
          "mixamorig:Hips,mixamorig:Spine,mixamorig:Spine1,mixamorig:Spine2,mixamorig:Neck,mixamorig:Head",
          "mixamorig:%UpLeg,mixamorig:%Leg,mixamorig:%Foot,mixamorig:%ToeBase",
          "mixamorig:%Shoulder,mixamorig:%Arm,mixamorig:%ForeArm,mixamorig:%Hand", "mixamorig:%Hand@#", kPinky),
    rigOf("Mixamo without colon", "Mixamo", "Left,Right",
          "mixamorigHips,mixamorigSpine,mixamorigSpine1,mixamorigSpine2,mixamorigNeck,mixamorigHead",
          "mixamorig%UpLeg,mixamorig%Leg,mixamorig%Foot,mixamorig%ToeBase",
          "mixamorig%Shoulder,mixamorig%Arm,mixamorig%ForeArm,mixamorig%Hand", "mixamorig%Hand@#", kPinky),
    rigOf("Mixamo numbered", "Mixamo", "Left,Right",
          "mixamorig1:Hips,mixamorig1:Spine,mixamorig1:Spine1,mixamorig1:Spine2,mixamorig1:Neck,mixamorig1:Head",
          "mixamorig1:%UpLeg,mixamorig1:%Leg,mixamorig1:%Foot,mixamorig1:%ToeBase",
          "mixamorig1:%Shoulder,mixamorig1:%Arm,mixamorig1:%ForeArm,mixamorig1:%Hand", "mixamorig1:%Hand@#", kPinky),
    rigOf("Mixamo underscored", "Mixamo", "Left,Right",
          "mixamorig_Hips,mixamorig_Spine,mixamorig_Spine1,mixamorig_Spine2,mixamorig_Neck,mixamorig_Head",
          "mixamorig_%UpLeg,mixamorig_%Leg,mixamorig_%Foot,mixamorig_%ToeBase",
          "mixamorig_%Shoulder,mixamorig_%Arm,mixamorig_%ForeArm,mixamorig_%Hand", "mixamorig_%Hand@#", kPinky),
    rigOf("Ready Player Me", "Mixamo", "Left,Right", "Hips,Spine,Spine1,Spine2,Neck,Head", "%UpLeg,%Leg,%Foot,%ToeBase",
          "%Shoulder,%Arm,%ForeArm,%Hand", "%Hand@#", kPinky),
    rigOf("MotionBuilder", "Mixamo", "Left,Right",
          "Character1:Hips,Character1:Spine,Character1:Spine1,Character1:Spine2,Character1:Neck,Character1:Head",
          "Character1:%UpLeg,Character1:%Leg,Character1:%Foot,Character1:%ToeBase",
          "Character1:%Shoulder,Character1:%Arm,Character1:%ForeArm,Character1:%Hand", "Character1:%Hand@#", kPinky),
    rigOf("Perception Neuron", "Mixamo", "Left,Right", "Hips,Spine,Spine1,Spine2,Neck,Head", "%UpLeg,%Leg,%Foot,",
          "%Shoulder,%Arm,%ForeArm,%Hand", "Robot_%Hand@#", kPinky),
    rigOf("CMU", "CMU", "Left,Right", "Hips,LowerBack,Spine,Spine1,Neck,Head", "%UpLeg,%Leg,%Foot,%ToeBase",
          "%Shoulder,%Arm,%ForeArm,%Hand"),
    rigOf("Acclaim", "Acclaim", "l,r", "root,lowerback,upperback,thorax,lowerneck,head", "%femur,%tibia,%foot,%toes",
          "%clavicle,%humerus,%radius,%wrist"),
    rigOf("MakeHuman", "MakeHuman", "L,R", "root,spine05,spine03,spine01,neck01,head",
          "upperleg01.%,lowerleg01.%,foot.%,toe2-1.%", "clavicle.%,upperarm01.%,lowerarm01.%,wrist.%", "finger@-#.%",
          "1,2,3,4,5"),
    rigOf("MakeHuman's game engine", "Unreal", "l,r", "pelvis,spine_01,spine_02,spine_03,neck_01,head",
          "thigh_%,calf_%,foot_%,ball_%", "clavicle_%,upperarm_%,lowerarm_%,hand_%", "@_0#_%",
          "thumb,index,middle,ring,pinky"),
    rigOf("3ds Max Biped", "3ds Max Biped", "L,R",
          "Bip01 Pelvis,Bip01 Spine,Bip01 Spine1,Bip01 Spine2,Bip01 Neck,Bip01 Head",
          "Bip01 % Thigh,Bip01 % Calf,Bip01 % Foot,Bip01 % Toe0",
          "Bip01 % Clavicle,Bip01 % UpperArm,Bip01 % Forearm,Bip01 % Hand", "Bip01 % Finger@#", "0,1,2,3,4", ",1,2"),
    rigOf("3ds Max Biped, underscored", "3ds Max Biped", "L,R",
          "Bip001_Pelvis,Bip001_Spine,Bip001_Spine1,Bip001_Spine2,Bip001_Neck,Bip001_Head",
          "Bip001_%_Thigh,Bip001_%_Calf,Bip001_%_Foot,Bip001_%_Toe0",
          "Bip001_%_Clavicle,Bip001_%_UpperArm,Bip001_%_Forearm,Bip001_%_Hand", "Bip001_%_Finger@#", "0,1,2,3,4",
          ",1,2"),
    rigOf("Valve", "3ds Max Biped", "L,R",
          "ValveBiped.Bip01_Pelvis,ValveBiped.Bip01_Spine,ValveBiped.Bip01_Spine1,ValveBiped.Bip01_Spine2,ValveBiped."
          "Bip01_Neck1,ValveBiped.Bip01_Head1",
          "ValveBiped.Bip01_%_Thigh,ValveBiped.Bip01_%_Calf,ValveBiped.Bip01_%_Foot,ValveBiped.Bip01_%_Toe0",
          "ValveBiped.Bip01_%_Clavicle,ValveBiped.Bip01_%_UpperArm,ValveBiped.Bip01_%_Forearm,ValveBiped.Bip01_%_Hand"),
    rigOf("Character Creator", "Character Creator", "L,R",
          "CC_Base_Hip,CC_Base_Waist,CC_Base_Spine01,CC_Base_Spine02,CC_Base_NeckTwist01,CC_Base_Head",
          "CC_Base_%_Thigh,CC_Base_%_Calf,CC_Base_%_Foot,CC_Base_%_ToeBase",
          "CC_Base_%_Clavicle,CC_Base_%_Upperarm,CC_Base_%_Forearm,CC_Base_%_Hand", "CC_Base_%_@#",
          "Thumb,Index,Mid,Ring,Pinky"),
    rigOf("Kinect v2", "Kinect v2", "Left,Right", "SpineBase,SpineMid,SpineShoulder,,Neck,Head",
          "Hip%,Knee%,Ankle%,Foot%", ",Shoulder%,Elbow%,Wrist%"),
    rigOf("Kinect v1", "Kinect v1", "LEFT,RIGHT", "HIP_CENTER,SPINE,SHOULDER_CENTER,,,HEAD",
          "HIP_%,KNEE_%,ANKLE_%,FOOT_%", ",SHOULDER_%,ELBOW_%,WRIST_%"),
    rigOf("Azure Kinect", "Azure Kinect", "LEFT,RIGHT", "PELVIS,SPINE_NAVEL,SPINE_CHEST,,NECK,HEAD",
          "HIP_%,KNEE_%,ANKLE_%,FOOT_%", "CLAVICLE_%,SHOULDER_%,ELBOW_%,WRIST_%"),
    rigOf("NiTE", "NiTE", "left,right", "waist,torso,,,neck,head", "%_hip,%_knee,%_foot,",
          ",%_shoulder,%_elbow,%_hand"),
    rigOf("Biovision", "Biovision", "Left,Right", "Hips,Chest,Chest2,Chest3,Neck,Head", "%Hip,%Knee,%Ankle,%Toe",
          "%Collar,%Shoulder,%Elbow,%Wrist"),
    rigOf("SMPL", "Biovision", "L,R", "Pelvis,Spine1,Spine2,Spine3,Neck,Head", "%_Hip,%_Knee,%_Ankle,%_Foot",
          "%_Collar,%_Shoulder,%_Elbow,%_Wrist"),
    rigOf("Second Life", "Biovision", "Left,Right", "mPelvis,mTorso,mChest,,mNeck,mHead", "mHip%,mKnee%,mAnkle%,mFoot%",
          "mCollar%,mShoulder%,mElbow%,mWrist%"),
    rigOf("Rigify", "Rigify", "L,R", "DEF-spine,DEF-spine.001,DEF-spine.002,DEF-spine.003,DEF-spine.004,DEF-spine.006",
          "DEF-thigh.%,DEF-shin.%,DEF-foot.%,DEF-toe.%", "DEF-shoulder.%,DEF-upper_arm.%,DEF-forearm.%,DEF-hand.%",
          "DEF-@.0#.%", "thumb,f_index,f_middle,f_ring,f_pinky"),
    rigOf("Rigify without dots", "Rigify", "L,R",
          "DEF-spine,DEF-spine001,DEF-spine002,DEF-spine003,DEF-spine004,DEF-spine006",
          "DEF-thigh%,DEF-shin%,DEF-foot%,DEF-toe%", "DEF-shoulder%,DEF-upper_arm%,DEF-forearm%,DEF-hand%", "DEF-@0#%",
          "thumb,f_index,f_middle,f_ring,f_pinky"),
    rigOf("Blender", "Blender", "L,R", "hips,spine,chest,,neck,head", "thigh.%,shin.%,foot.%,toe.%",
          "shoulder.%,upper_arm.%,forearm.%,hand.%"),
    rigOf("DAZ", "DAZ", "l,r", "hip,abdomenLower,chestLower,chestUpper,neckLower,head", "%ThighBend,%Shin,%Foot,%Toe",
          "%Collar,%ShldrBend,%ForearmBend,%Hand", "%@#", "Thumb,Index,Mid,Ring,Pinky"),
    rigOf("Poser", "DAZ", "l,r", "hip,abdomen,chest,,neck,head", "%Thigh,%Shin,%Foot,%Toe",
          "%Collar,%Shldr,%ForeArm,%Hand", "%@#", "Thumb,Index,Mid,Ring,Pinky"),
    rigOf("Xsens", "Xsens", "Left,Right", "Pelvis,L5,L3,T8,Neck,Head", "%UpperLeg,%LowerLeg,%Foot,%Toe",
          "%Shoulder,%UpperArm,%ForeArm,%Hand"),
    rigOf("Rokoko", "Rokoko", "Left,Right", "Hips,Spine1,Spine2,Spine3,Neck,Head", "%Thigh,%Shin,%Foot,%Toe",
          "%Shoulder,%Arm,%ForeArm,%Hand", "%Finger@#", "1,2,3,4,5", "Proximal,Intermediate,Distal"),
    rigOf("KayKit", "KayKit", "l,r", "hips,spine,chest,,,head", "upperleg.%,lowerleg.%,foot.%,toes.%",
          ",upperarm.%,lowerarm.%,wrist.%"),
    rigOf("MikuMikuDance", "MikuMikuDance", "左,右", "センター,上半身,上半身2,,首,頭", "%足,%ひざ,%足首,%つま先",
          "%肩,%腕,%ひじ,%手首"),
};

[[nodiscard]] std::string filled(std::string_view pattern, std::string_view side, std::string_view finger,
                                 std::string_view segment) {
  std::string name;
  for (const char c : pattern) {
    name += c == '%' ? side : c == '@' ? finger : c == '#' ? segment : std::string_view(&c, 1);
  }
  return name;
}

/// The items of a list "a,b,c"; those that it lacks stay empty.
template <std::size_t N>
[[nodiscard]] std::array<std::string_view, N> itemsOf(std::string_view list) {
  std::array<std::string_view, N> items;
  for (std::string_view& item : items) {
    item = list.substr(0, list.find(','));
    list.remove_prefix(std::min(list.size(), item.size() + 1));
  }
  return items;
}

}  // namespace

RigNames rigOf(std::string_view rig, std::string_view by, std::string_view sides, std::string_view trunk,
               std::string_view leg, std::string_view arm, std::string_view finger, std::string_view fingers,
               std::string_view segments) {
  const auto [left, right] = itemsOf<2>(sides);
  return {rig,
          by,
          left,
          right,
          itemsOf<6>(trunk),
          itemsOf<4>(leg),
          itemsOf<4>(arm),
          finger,
          itemsOf<5>(fingers),
          itemsOf<3>(segments)};
}

std::span<const RigNames> rigNames() {
  return kRigs;
}

Skeleton withoutBones(const Skeleton& skeleton) {
  HumanoidGuess none;
  none.jointOf.fill(kNoJoint);
  return withBones(skeleton, none);
}

bool isDoubted(const HumanoidGuess& guess, HumanBone bone) {
  return std::ranges::any_of(
      guess.doubts, [&](const BoneDoubt& doubt) { return std::ranges::find(doubt.bones, bone) != doubt.bones.end(); });
}

std::map<HumanBone, std::string> namesOf(const RigNames& rig) {
  std::map<HumanBone, std::string> names;
  const auto add = [&](HumanBone bone, std::string_view pattern, std::string_view side, std::string_view finger,
                       std::string_view segment) {
    if (!pattern.empty()) names[bone] = filled(pattern, side, finger, segment);
  };
  const auto later = [](HumanBone bone, std::size_t by) {
    return static_cast<HumanBone>(static_cast<std::size_t>(bone) + by);
  };
  for (std::size_t i = 0; i < rig.trunk.size(); ++i) add(later(kHips, i), rig.trunk[i], "", "", "");
  for (const bool left : {true, false}) {
    const std::string_view side = left ? rig.left : rig.right;
    const auto at = [&](HumanBone bone) { return left ? bone : mirrored(bone); };
    for (std::size_t i = 0; i < rig.leg.size(); ++i) add(at(later(kLeftUpperLeg, i)), rig.leg[i], side, "", "");
    for (std::size_t i = 0; i < rig.arm.size(); ++i) add(at(later(kLeftShoulder, i)), rig.arm[i], side, "", "");
    for (std::size_t finger = 0; finger < 5; ++finger) {
      for (std::size_t segment = 0; segment < 3; ++segment) {
        add(at(later(kLeftThumbMetacarpal, finger * 3 + segment)), rig.finger, side, rig.fingers[finger],
            rig.segments[segment]);
      }
    }
  }
  return names;
}

Skeleton renamedMannequin(const std::map<HumanBone, std::string>& names) {
  std::vector<Joint> joints;
  std::map<HumanBone, JointIndex> indexOf;
  const Skeleton mannequin = makeMannequinSkeleton();
  for (const Joint& original : mannequin.joints()) {
    const HumanBone bone = *original.bone;
    const auto name = names.find(bone);
    if (name == names.end()) continue;
    std::optional<HumanBone> above = parentBone(bone);
    while (above && !indexOf.contains(*above)) above = parentBone(*above);
    Joint joint;
    joint.name = name->second;
    joint.rest.translation = mannequinJoint(bone);
    if (above) {
      joint.parent = indexOf.at(*above);
      joint.rest.translation -= mannequinJoint(*above);
    }
    indexOf[bone] = static_cast<JointIndex>(joints.size());
    joints.push_back(joint);
  }
  return std::move(*Skeleton::create(std::move(joints)));
}

std::map<HumanBone, std::string> namesOf(const Skeleton& skeleton, const HumanoidGuess& guess) {
  std::map<HumanBone, std::string> names;
  for (int bone = 0; bone < kHumanBoneCount; ++bone) {
    const JointIndex joint = guess[static_cast<HumanBone>(bone)];
    if (joint != kNoJoint) names[static_cast<HumanBone>(bone)] = skeleton.joint(joint).name;
  }
  return names;
}

std::string differences(const std::map<HumanBone, std::string>& expected,
                        const std::map<HumanBone, std::string>& found) {
  std::string text;
  for (int i = 0; i < kHumanBoneCount; ++i) {
    const auto bone = static_cast<HumanBone>(i);
    const auto truth = expected.find(bone);
    const auto guess = found.find(bone);
    const std::string expectedName = truth == expected.end() ? "nothing" : "'" + truth->second + "'";
    const std::string foundName = guess == found.end() ? "nothing" : "'" + guess->second + "'";
    if (expectedName != foundName)
      text += fmt::format("\n  {}: {}, expected {}", nameOf(bone), foundName, expectedName);
  }
  return text;
}

std::string contradictions(const Skeleton& skeleton, const HumanoidGuess& guess) {
  std::string text;
  std::set<JointIndex> used;
  for (int i = 0; i < kHumanBoneCount; ++i) {
    const auto bone = static_cast<HumanBone>(i);
    const JointIndex joint = guess[bone];
    if (joint == kNoJoint) continue;
    if (!used.insert(joint).second) text += fmt::format("\n  {} is assigned to two bones", skeleton.joint(joint).name);
    std::optional<HumanBone> above = parentBone(bone);
    while (above && guess[*above] == kNoJoint) above = parentBone(*above);
    if (!above) continue;
    JointIndex ancestor = skeleton.joint(joint).parent;
    while (ancestor != kNoJoint && ancestor != guess[*above]) ancestor = skeleton.joint(ancestor).parent;
    if (ancestor == kNoJoint) text += fmt::format("\n  {} is not below {}", nameOf(bone), nameOf(*above));
  }
  return text;
}

}  // namespace lorica::test

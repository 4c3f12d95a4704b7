#pragma once

#include "skinning/skeleton.h"

#include <array>
#include <string_view>

namespace lorica {

/// The bones that conventions name. Names of a left bone also apply to the right one. Those of kSpine are all joints of
/// the trunk; their order is given by the skeleton.
inline constexpr std::array kNamedBones = {HumanBone::kHips,
                                           HumanBone::kSpine,
                                           HumanBone::kNeck,
                                           HumanBone::kHead,
                                           HumanBone::kLeftUpperLeg,
                                           HumanBone::kLeftLowerLeg,
                                           HumanBone::kLeftFoot,
                                           HumanBone::kLeftToes,
                                           HumanBone::kLeftShoulder,
                                           HumanBone::kLeftUpperArm,
                                           HumanBone::kLeftLowerArm,
                                           HumanBone::kLeftHand,
                                           HumanBone::kLeftMiddleProximal};

/// How one convention names each of these bones: in lower case, joined ("UpLeg" is upleg), without side, prefix or
/// leading zeros; several names are separated by blanks, the best first. Empty = it has no such bone.
struct NamingConvention {
  std::string_view name;
  std::array<std::string_view, kNamedBones.size()> names;
};

/// All known conventions; the last one mixes all of them. By rows of kNamedBones: hips, trunk, neck, head; leg, shin,
/// foot, toes; shoulder, upper arm, forearm, hand, fingers.
inline constexpr NamingConvention kNamingConventions[] = {
    {"KayKit",
     {"hips", "spine chest", "", "head", "upperleg", "lowerleg", "foot", "toes", "", "upperarm", "lowerarm", "wrist"}},
    {"VRM",
     {"hips", "spine chest upperchest", "neck", "head", "upperleg", "lowerleg", "foot", "toes toebase toe", "shoulder",
      "upperarm", "lowerarm", "hand"}},
    // Names of MotionBuilder's HumanIK, also used by Mixamo, Perception Neuron, Ready Player Me, LaFAN1 and others.
    {"Mixamo",
     {"hips pelvis", "spine spine1 spine2 spine3 spine4 spine5 spine6 spine7 spine8 spine9", "neck neck1", "head",
      "upleg", "leg", "foot", "toebase toe toes footthumb1 footmiddle1", "shoulder", "arm", "forearm", "hand"}},
    {"CMU",
     {"hips", "lowerback spine spine1 spine2", "neck neck1", "head", "upleg", "leg", "foot", "toebase", "shoulder",
      "arm", "forearm", "hand", "fingers"}},
    // Acclaim's ASF, the original format of CMU's motions.
    {"Acclaim",
     {"root hips", "lowerback upperback thorax", "lowerneck upperneck neck", "head", "femur", "tibia", "foot", "toes",
      "clavicle", "humerus", "radius", "wrist hand", "fingers"}},
    {"MakeHuman",
     {"root", "spine5 spine4 spine3 spine2 spine1", "neck1 neck2 neck3", "head", "upperleg1 upperleg2",
      "lowerleg1 lowerleg2", "foot", "toe21 toe11", "clavicle shoulder1", "upperarm1 upperarm2", "lowerarm1 lowerarm2",
      "wrist"}},
    {"MakeHuman",
     {"root hips", "spine1 spine2 spine3", "neck", "head", "upleg", "loleg", "foot", "toe", "clavicle", "uparm",
      "loarm", "hand"}},
    {"3ds Max Biped",
     {"pelvis hips", "spine spine1 spine2 spine3 spine4", "neck neck1", "head", "thigh", "calf", "foot", "toe0 toe",
      "clavicle", "upperarm", "forearm", "hand"}},
    {"Unreal",
     {"pelvis", "spine1 spine2 spine3 spine4 spine5", "neck1 neck2 neck", "head", "thigh", "calf", "foot", "ball",
      "clavicle", "upperarm", "lowerarm", "hand"}},
    {"Character Creator",
     {"hip pelvis", "waist spine1 spine2", "necktwist1 neck", "head", "thigh", "calf", "foot", "toebase", "clavicle",
      "upperarm", "forearm", "hand"}},
    {"Kinect v2",
     {"spinebase", "spinemid spineshoulder", "neck", "head", "hip", "knee", "ankle", "foot", "", "shoulder", "elbow",
      "wrist"}},
    {"Kinect v1",
     {"hipcenter", "spine shouldercenter", "", "head", "hip", "knee", "ankle", "foot", "", "shoulder", "elbow",
      "wrist"}},
    {"Azure Kinect",
     {"pelvis", "spinenaval spinenavel spinechest", "neck", "head", "hip", "knee", "ankle", "foot", "clavicle",
      "shoulder", "elbow", "wrist"}},
    {"NiTE",
     {"waist hips torso", "torso", "neck", "head", "hip", "knee", "foot", "", "collar", "shoulder", "elbow", "hand"}},
    // Biovision's BVH, Second Life, SMPL: joints named after the body's joints.
    {"Biovision",
     {"hips hip pelvis root", "lowerback ab abdomen torso spine spine1 spine2 spine3 chest chest1 chest2 chest3 chest4",
      "neck lowerneck", "head", "hip", "knee", "ankle", "toe toes toebase foot", "collar", "shoulder uparm",
      "elbow lowarm", "wrist hand", "fingers"}},
    // The deforming bones of a Rigify character: the spine is numbered from the pelvis to the head.
    {"Rigify",
     {"spine hips torso", "spine1 spine2 spine3", "spine4 neck", "spine6 spine5 head", "thigh", "shin", "foot", "toe",
      "shoulder", "upperarm", "forearm", "hand"}},
    {"DAZ",
     {"hip pelvis",
      "abdomen abdomen2 abdomenlower abdomenupper chest chestlower chestupper spine1 spine2 spine3 spine4",
      "neck necklower neckupper neck1 neck2", "head", "thigh thighbend", "shin", "foot", "toe toes", "collar shoulder",
      "shldr shldrbend upperarm", "forearm forearmbend", "hand"}},
    {"Xsens",
     {"pelvis hips", "l5 l3 t12 t8 chest chest2 chest3 chest4", "neck", "head", "upperleg hip", "lowerleg knee",
      "foot ankle", "toe", "shoulder collar", "upperarm shoulder", "forearm elbow", "hand wrist"}},
    {"Rokoko",
     {"hips hip", "spine spine1 spine2 spine3 spine4 ab chest", "neck", "head", "thigh", "shin", "foot", "toe toebase",
      "shoulder", "arm uarm", "forearm farm", "hand"}},
    {"MikuMikuDance",
     {"センター 下半身 hips center", "上半身 上半身1 上半身2 上半身3", "首", "頭", "足 足d", "ひざ ひざd", "足首 足首d",
      "つま先 足先ex", "肩", "腕", "ひじ", "手首"}},
    {"Blender",
     {"hips pelvis", "spine spine1 spine2 spine3 abdomen tummy chest chest1 upperchest torso", "neck neck1", "head",
      "thigh upperleg", "shin calf lowerleg", "foot", "toes toe ball", "shoulder clavicle", "upperarm",
      "forearm lowerarm", "hand"}},
    // Any mixture. The hierarchy decides which "leg" or "shoulder" is meant: the assignment with the most bones is
    // used.
    {"common words",
     {"hips hip pelvis",
      "lowerback ab abdomen tummy belly waist stomach torso lowertorso uppertorso spine spine0 spine1 spine2 spine3 "
      "spine4 spine5 chest chest1 chest2 upperchest thorax ribcage bodylow bodyup",
      "neck neck1 lowerneck", "head", "upperleg upleg thigh femur hip legupper leg leg1",
      "lowerleg loleg lowleg shin calf tibia knee leglower leg leg2", "foot ankle", "toes toe toebase ball toe0 foot",
      "clavicle collar collarbone shoulder", "upperarm uparm humerus bicep shldr armupper arm shoulder arm1",
      "forearm lowerarm loarm lowarm radius elbow armlower arm arm2", "hand wrist palm palm2"}},
};

}  // namespace lorica

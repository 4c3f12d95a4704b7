#include "skinning/humanoid/humanoid_tables.h"

namespace lorica {

namespace {

using enum HumanBone;

// Names of MotionBuilder's HumanIK, also used by Mixamo, Perception Neuron, Ready Player Me, LaFAN1 and others.
constexpr BoneNames kMixamo[] = {
    {kHips, "hips pelvis"},      {kSpine, "spine spine1 spine2 spine3 spine4 spine5 spine6 spine7 spine8 spine9"},
    {kNeck, "neck neck1"},       {kHead, "head"},
    {kLeftUpperLeg, "upleg"},    {kLeftLowerLeg, "leg"},
    {kLeftFoot, "foot"},         {kLeftToes, "toebase toe toes footthumb1 footmiddle1"},
    {kLeftShoulder, "shoulder"}, {kLeftUpperArm, "arm"},
    {kLeftLowerArm, "forearm"},  {kLeftHand, "hand"},
};

constexpr BoneNames kVrm[] = {
    {kHips, "hips"},
    {kSpine, "spine chest upperchest"},
    {kNeck, "neck"},
    {kHead, "head"},
    {kLeftUpperLeg, "upperleg"},
    {kLeftLowerLeg, "lowerleg"},
    {kLeftFoot, "foot"},
    {kLeftToes, "toes toebase toe"},
    {kLeftShoulder, "shoulder"},
    {kLeftUpperArm, "upperarm"},
    {kLeftLowerArm, "lowerarm"},
    {kLeftHand, "hand"},
};

constexpr BoneNames kCmu[] = {
    {kHips, "hips"},
    {kSpine, "lowerback spine spine1 spine2"},
    {kNeck, "neck neck1"},
    {kHead, "head"},
    {kLeftUpperLeg, "upleg"},
    {kLeftLowerLeg, "leg"},
    {kLeftFoot, "foot"},
    {kLeftToes, "toebase"},
    {kLeftShoulder, "shoulder"},
    {kLeftUpperArm, "arm"},
    {kLeftLowerArm, "forearm"},
    {kLeftHand, "hand"},
    {kLeftMiddleProximal, "fingers"},
};

// Acclaim's ASF, the original format of CMU's motions.
constexpr BoneNames kAcclaim[] = {
    {kHips, "root hips"},
    {kSpine, "lowerback upperback thorax"},
    {kNeck, "lowerneck upperneck neck"},
    {kHead, "head"},
    {kLeftUpperLeg, "femur"},
    {kLeftLowerLeg, "tibia"},
    {kLeftFoot, "foot"},
    {kLeftToes, "toes"},
    {kLeftShoulder, "clavicle"},
    {kLeftUpperArm, "humerus"},
    {kLeftLowerArm, "radius"},
    {kLeftHand, "wrist hand"},
    {kLeftMiddleProximal, "fingers"},
};

constexpr BoneNames kMakeHuman[] = {
    {kHips, "root"},
    {kSpine, "spine5 spine4 spine3 spine2 spine1"},
    {kNeck, "neck1 neck2 neck3"},
    {kHead, "head"},
    {kLeftUpperLeg, "upperleg1 upperleg2"},
    {kLeftLowerLeg, "lowerleg1 lowerleg2"},
    {kLeftFoot, "foot"},
    {kLeftToes, "toe21 toe11"},
    {kLeftShoulder, "clavicle shoulder1"},
    {kLeftUpperArm, "upperarm1 upperarm2"},
    {kLeftLowerArm, "lowerarm1 lowerarm2"},
    {kLeftHand, "wrist"},
};

constexpr BoneNames kMakeHumanOld[] = {
    {kHips, "root hips"},        {kSpine, "spine1 spine2 spine3"}, {kNeck, "neck"},          {kHead, "head"},
    {kLeftUpperLeg, "upleg"},    {kLeftLowerLeg, "loleg"},         {kLeftFoot, "foot"},      {kLeftToes, "toe"},
    {kLeftShoulder, "clavicle"}, {kLeftUpperArm, "uparm"},         {kLeftLowerArm, "loarm"}, {kLeftHand, "hand"},
};

constexpr BoneNames kBiped[] = {
    {kHips, "pelvis hips"},      {kSpine, "spine spine1 spine2 spine3 spine4"},
    {kNeck, "neck neck1"},       {kHead, "head"},
    {kLeftUpperLeg, "thigh"},    {kLeftLowerLeg, "calf"},
    {kLeftFoot, "foot"},         {kLeftToes, "toe0 toe"},
    {kLeftShoulder, "clavicle"}, {kLeftUpperArm, "upperarm"},
    {kLeftLowerArm, "forearm"},  {kLeftHand, "hand"},
};

constexpr BoneNames kUnreal[] = {
    {kHips, "pelvis"},           {kSpine, "spine1 spine2 spine3 spine4 spine5"},
    {kNeck, "neck1 neck2 neck"}, {kHead, "head"},
    {kLeftUpperLeg, "thigh"},    {kLeftLowerLeg, "calf"},
    {kLeftFoot, "foot"},         {kLeftToes, "ball"},
    {kLeftShoulder, "clavicle"}, {kLeftUpperArm, "upperarm"},
    {kLeftLowerArm, "lowerarm"}, {kLeftHand, "hand"},
};

constexpr BoneNames kCharacterCreator[] = {
    {kHips, "hip pelvis"},       {kSpine, "waist spine1 spine2"}, {kNeck, "necktwist1 neck"}, {kHead, "head"},
    {kLeftUpperLeg, "thigh"},    {kLeftLowerLeg, "calf"},         {kLeftFoot, "foot"},        {kLeftToes, "toebase"},
    {kLeftShoulder, "clavicle"}, {kLeftUpperArm, "upperarm"},     {kLeftLowerArm, "forearm"}, {kLeftHand, "hand"},
};

constexpr BoneNames kKinect1[] = {
    {kHips, "hipcenter"},   {kSpine, "spine shouldercenter"}, {kHead, "head"},
    {kLeftUpperLeg, "hip"}, {kLeftLowerLeg, "knee"},          {kLeftFoot, "ankle"},
    {kLeftToes, "foot"},    {kLeftUpperArm, "shoulder"},      {kLeftLowerArm, "elbow"},
    {kLeftHand, "wrist"},
};

constexpr BoneNames kKinect2[] = {
    {kHips, "spinebase"},
    {kSpine, "spinemid spineshoulder"},
    {kNeck, "neck"},
    {kHead, "head"},
    {kLeftUpperLeg, "hip"},
    {kLeftLowerLeg, "knee"},
    {kLeftFoot, "ankle"},
    {kLeftToes, "foot"},
    {kLeftUpperArm, "shoulder"},
    {kLeftLowerArm, "elbow"},
    {kLeftHand, "wrist"},
};

constexpr BoneNames kAzureKinect[] = {
    {kHips, "pelvis"},
    {kSpine, "spinenaval spinenavel spinechest"},
    {kNeck, "neck"},
    {kHead, "head"},
    {kLeftUpperLeg, "hip"},
    {kLeftLowerLeg, "knee"},
    {kLeftFoot, "ankle"},
    {kLeftToes, "foot"},
    {kLeftShoulder, "clavicle"},
    {kLeftUpperArm, "shoulder"},
    {kLeftLowerArm, "elbow"},
    {kLeftHand, "wrist"},
};

constexpr BoneNames kNite[] = {
    {kHips, "waist hips torso"}, {kSpine, "torso"},        {kNeck, "neck"},     {kHead, "head"},
    {kLeftUpperLeg, "hip"},      {kLeftLowerLeg, "knee"},  {kLeftFoot, "foot"}, {kLeftShoulder, "collar"},
    {kLeftUpperArm, "shoulder"}, {kLeftLowerArm, "elbow"}, {kLeftHand, "hand"},
};

// Biovision's BVH, Second Life, SMPL: joints named after the body's joints.
constexpr BoneNames kBiovision[] = {
    {kHips, "hips hip pelvis root"},
    {kSpine, "lowerback ab abdomen torso spine spine1 spine2 spine3 chest chest1 chest2 chest3 chest4"},
    {kNeck, "neck lowerneck"},
    {kHead, "head"},
    {kLeftUpperLeg, "hip"},
    {kLeftLowerLeg, "knee"},
    {kLeftFoot, "ankle"},
    {kLeftToes, "toe toes toebase foot"},
    {kLeftShoulder, "collar"},
    {kLeftUpperArm, "shoulder uparm"},
    {kLeftLowerArm, "elbow lowarm"},
    {kLeftHand, "wrist hand"},
    {kLeftMiddleProximal, "fingers"},
};

// The deforming bones of a Rigify character: the spine is numbered from the pelvis to the head.
constexpr BoneNames kRigify[] = {
    {kHips, "spine hips torso"}, {kSpine, "spine1 spine2 spine3"},
    {kNeck, "spine4 neck"},      {kHead, "spine6 spine5 head"},
    {kLeftUpperLeg, "thigh"},    {kLeftLowerLeg, "shin"},
    {kLeftFoot, "foot"},         {kLeftToes, "toe"},
    {kLeftShoulder, "shoulder"}, {kLeftUpperArm, "upperarm"},
    {kLeftLowerArm, "forearm"},  {kLeftHand, "hand"},
};

constexpr BoneNames kBlender[] = {
    {kHips, "hips pelvis"},
    {kSpine, "spine spine1 spine2 spine3 abdomen tummy chest chest1 upperchest torso"},
    {kNeck, "neck neck1"},
    {kHead, "head"},
    {kLeftUpperLeg, "thigh upperleg"},
    {kLeftLowerLeg, "shin calf lowerleg"},
    {kLeftFoot, "foot"},
    {kLeftToes, "toes toe ball"},
    {kLeftShoulder, "shoulder clavicle"},
    {kLeftUpperArm, "upperarm"},
    {kLeftLowerArm, "forearm lowerarm"},
    {kLeftHand, "hand"},
};

constexpr BoneNames kDaz[] = {
    {kHips, "hip pelvis"},
    {kSpine, "abdomen abdomen2 abdomenlower abdomenupper chest chestlower chestupper spine1 spine2 spine3 spine4"},
    {kNeck, "neck necklower neckupper neck1 neck2"},
    {kHead, "head"},
    {kLeftUpperLeg, "thigh thighbend"},
    {kLeftLowerLeg, "shin"},
    {kLeftFoot, "foot"},
    {kLeftToes, "toe toes"},
    {kLeftShoulder, "collar shoulder"},
    {kLeftUpperArm, "shldr shldrbend upperarm"},
    {kLeftLowerArm, "forearm forearmbend"},
    {kLeftHand, "hand"},
};

constexpr BoneNames kXsens[] = {
    {kHips, "pelvis hips"},
    {kSpine, "l5 l3 t12 t8 chest chest2 chest3 chest4"},
    {kNeck, "neck"},
    {kHead, "head"},
    {kLeftUpperLeg, "upperleg hip"},
    {kLeftLowerLeg, "lowerleg knee"},
    {kLeftFoot, "foot ankle"},
    {kLeftToes, "toe"},
    {kLeftShoulder, "shoulder collar"},
    {kLeftUpperArm, "upperarm shoulder"},
    {kLeftLowerArm, "forearm elbow"},
    {kLeftHand, "hand wrist"},
};

constexpr BoneNames kRokoko[] = {
    {kHips, "hips hip"},
    {kSpine, "spine spine1 spine2 spine3 spine4 ab chest"},
    {kNeck, "neck"},
    {kHead, "head"},
    {kLeftUpperLeg, "thigh"},
    {kLeftLowerLeg, "shin"},
    {kLeftFoot, "foot"},
    {kLeftToes, "toe toebase"},
    {kLeftShoulder, "shoulder"},
    {kLeftUpperArm, "arm uarm"},
    {kLeftLowerArm, "forearm farm"},
    {kLeftHand, "hand"},
};

constexpr BoneNames kKayKit[] = {
    {kHips, "hips"},
    {kSpine, "spine chest"},
    {kHead, "head"},
    {kLeftUpperLeg, "upperleg"},
    {kLeftLowerLeg, "lowerleg"},
    {kLeftFoot, "foot"},
    {kLeftToes, "toes"},
    {kLeftUpperArm, "upperarm"},
    {kLeftLowerArm, "lowerarm"},
    {kLeftHand, "wrist"},
};

constexpr BoneNames kMmd[] = {
    {kHips, "センター 下半身 hips center"},
    {kSpine, "上半身 上半身1 上半身2 上半身3"},
    {kNeck, "首"},
    {kHead, "頭"},
    {kLeftUpperLeg, "足 足d"},
    {kLeftLowerLeg, "ひざ ひざd"},
    {kLeftFoot, "足首 足首d"},
    {kLeftToes, "つま先 足先ex"},
    {kLeftShoulder, "肩"},
    {kLeftUpperArm, "腕"},
    {kLeftLowerArm, "ひじ"},
    {kLeftHand, "手首"},
};

// Any mixture. The hierarchy decides which "leg" or "shoulder" is meant: the assignment with the most bones is used.
constexpr BoneNames kLoose[] = {
    {kHips, "hips hip pelvis"},
    {kSpine,
     "lowerback ab abdomen tummy belly waist stomach torso lowertorso uppertorso spine spine0 spine1 spine2 spine3 "
     "spine4 spine5 chest chest1 chest2 upperchest thorax ribcage bodylow bodyup"},
    {kNeck, "neck neck1 lowerneck"},
    {kHead, "head"},
    {kLeftUpperLeg, "upperleg upleg thigh femur hip legupper leg leg1"},
    {kLeftLowerLeg, "lowerleg loleg lowleg shin calf tibia knee leglower leg leg2"},
    {kLeftFoot, "foot ankle"},
    {kLeftToes, "toes toe toebase ball toe0 foot"},
    {kLeftShoulder, "clavicle collar collarbone shoulder"},
    {kLeftUpperArm, "upperarm uparm humerus bicep shldr armupper arm shoulder arm1"},
    {kLeftLowerArm, "forearm lowerarm loarm lowarm radius elbow armlower arm arm2"},
    {kLeftHand, "hand wrist palm palm2"},
};

constexpr NamingConvention kConventions[] = {
    {"KayKit", kKayKit},
    {"VRM", kVrm},
    {"Mixamo", kMixamo},
    {"CMU", kCmu},
    {"Acclaim", kAcclaim},
    {"MakeHuman", kMakeHuman},
    {"MakeHuman", kMakeHumanOld},
    {"3ds Max Biped", kBiped},
    {"Unreal", kUnreal},
    {"Character Creator", kCharacterCreator},
    {"Kinect v2", kKinect2},
    {"Kinect v1", kKinect1},
    {"Azure Kinect", kAzureKinect},
    {"NiTE", kNite},
    {"Biovision", kBiovision},
    {"Rigify", kRigify},
    {"DAZ", kDaz},
    {"Xsens", kXsens},
    {"Rokoko", kRokoko},
    {"MikuMikuDance", kMmd},
    {"Blender", kBlender},
    {"common words", kLoose},
};

}  // namespace

std::span<const NamingConvention> namingConventions() {
  return kConventions;
}

}  // namespace lorica

#include "export/motion_export.h"

#include "capture/files/bvh_file.h"
#include "capture/files/joint_csv.h"
#include "capture/retarget/proxy_skeleton.h"
#include "capture/retarget/skeletal_retarget.h"
#include "capture/smoothing.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "skinning/clip_files/character_clip.h"
#include "skinning/clip_files/own_motion.h"
#include "skinning/import/bone_map.h"
#include "skinning/import/character_file.h"
#include "skinning/mannequin/mannequin.h"

#include <fmt/format.h>

#include <algorithm>

namespace lorica {
namespace {

constexpr const char* kMannequin = "mannequin";

Result<CharacterFile> readMapped(const ConvertCharacter& from, const Host& host) {
  if (!isCharacterFile(from.name)) {
    return invalidArgument("--character {}: expected a character file (.glb, .gltf, .vrm, .fbx, .dae) or {}", from.name,
                           kMannequin);
  }
  Result<CharacterFile> file = readCharacterFile(from.name, host.characterFiles());
  if (!file || from.map.empty()) return file;
  LORICA_TRY(const BoneMap map, readBoneMap(from.map));
  LORICA_TRY(file->character.skeleton, applyBoneMap(file->character.skeleton, map, from.map));
  return file;
}

struct Performed {
  SkeletalMotion motion;
  std::optional<double> delay;
};

/// All frames of the motion on the character, as `play` shows them.
Result<Performed> performWhole(const Character& character, const Motion& motion, const MotionOptions& options) {
  LORICA_TRY(const std::unique_ptr<PoseSource> source, poseSourceOf(character, motion, options));
  Performed performed{{motion.name, character.skeleton, {}, {}}, std::nullopt};
  Pose pose = restPose(character.skeleton);
  for (;;) {
    LORICA_TRY(const std::optional<double> time, source->next(pose));
    if (!time) break;
    performed.motion.times.push_back(*time);
    performed.motion.poses.insert(performed.motion.poses.end(), pose.begin(), pose.end());
  }
  performed.delay = source->smoothingDelay();
  return performed;
}

/// A scale of joints that a BVH file cannot hold, as a sentence; empty if there is none.
std::string scaleNote(const SkeletalMotion& motion) {
  const auto scaled = [](const Joint& joint) { return (joint.rest.scale - Vec3::Ones()).norm() > 1e-4; };
  const std::span<const Joint> joints = motion.skeleton.joints();
  const auto count = std::count_if(joints.begin(), joints.end(), scaled);
  if (count == 0) return {};
  return fmt::format("{} with a scale, the first '{}': BVH has none; their joints are where they are, unscaled",
                     counted(count, "joint"), std::find_if(joints.begin(), joints.end(), scaled)->name);
}

Result<void> writeCharacterBvh(const std::string& out, const SkeletalMotion& motion, ConvertedClip& made) {
  made.joints = motion.skeleton.jointCount();
  made.units = "centimetres";
  if (const std::string note = scaleNote(motion); !note.empty()) made.notes.push_back(note);
  return writeBvh(out, motion);
}

struct Joints {
  std::vector<SkeletonFrame> frames;
  std::optional<double> delay;  ///< of smoothing [s]
};

/// The motion as joints, smoothed and mirrored if requested.
Result<Joints> asJoints(const Motion& motion, const MotionOptions& options) {
  std::vector<SkeletonFrame> frames = motion.joints;
  if (motion.bones) {
    LORICA_TRY(frames, prefixed(motion.name, bodyJointsOf(*motion.bones)));
  }
  const JointSettings settings = options.joints();
  std::optional<OneEuroFilter> filter;
  if (settings.smoothing) filter.emplace(*settings.smoothing);
  for (SkeletonFrame& frame : frames) {
    if (settings.mirror) mirror(frame);
    if (filter) filter->apply(frame);
  }
  Joints joints{std::move(frames), std::nullopt};
  if (filter) joints.delay = filter->delay();
  return joints;
}

}  // namespace

Result<ConvertedClip> convertOnto(const ConvertCharacter& from, const Motion& motion, const MotionOptions& options,
                                  const std::string& out, const Host& host) {
  const bool asBvh = lowerCase(std::filesystem::path(out).extension().string()) == ".bvh";
  ConvertedClip made;
  if (from.name == kMannequin) {
    const Character mannequin = makeMannequin();
    LORICA_TRY(const Performed performed, performWhole(mannequin, motion, options));
    made.delay = performed.delay;
    made.joints = mannequin.skeleton.jointCount();
    made.units = "metres";
    LORICA_TRY_DO(asBvh ? writeCharacterBvh(out, performed.motion, made) : writeClip(out, mannequin, performed.motion));
    return made;
  }
  LORICA_TRY(const CharacterFile file, readMapped(from, host));
  LORICA_TRY(const Performed performed, performWhole(file.character, motion, options));
  made.delay = performed.delay;
  made.notes = leftBehind(file.character);
  if (asBvh) {
    const SkeletalMotion own = withoutCopies(inMetres(file, performed.motion));
    LORICA_TRY_DO(writeCharacterBvh(out, own, made));
    return made;
  }
  LORICA_TRY(const std::vector<std::string> notes, writeClip(out, {from.name, &file, host.paths}, performed.motion));
  made.joints = file.nodeOfJoint.size() - std::count(file.nodeOfJoint.begin(), file.nodeOfJoint.end(), -1);
  made.notes.insert(made.notes.end(), notes.begin(), notes.end());
  const bool ownUnits = file.format.starts_with("glTF") || file.format.starts_with("VRM");
  made.units = !ownUnits || file.metresPerUnit == 1.0 ? "metres"
                                                      : fmt::format("the character's, {:g} m each", file.metresPerUnit);
  return made;
}

Result<ConvertedClip> writeMotion(const std::string& output, const Motion& motion, const MotionOptions& options) {
  const bool asBvh = lowerCase(std::filesystem::path(output).extension().string()) == ".bvh";
  if (asBvh && motion.bones && !options.mirror) {
    LORICA_TRY_DO(writeBvh(output, *motion.bones));
    return ConvertedClip{};
  }
  LORICA_TRY(const Joints joints, asJoints(motion, options));
  if (asBvh) {
    LORICA_TRY(const SkeletalMotion bones, skeletalMotionOf(joints.frames));
    LORICA_TRY_DO(writeBvh(output, bones));
  } else {
    LORICA_TRY_DO(writeJointCsv(output, joints.frames));
  }
  ConvertedClip made;
  made.delay = joints.delay;
  return made;
}

}  // namespace lorica

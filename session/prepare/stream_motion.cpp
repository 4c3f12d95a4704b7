#include "session/prepare/stream_motion.h"

#include "capture/retarget/bone_pose.h"
#include "capture/streams/osc.h"
#include "capture/streams/vmc_receiver.h"
#include "geometry/errors.h"
#include "geometry/interrupt.h"
#include "geometry/line_scanner.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"
#include "session/prepare/first_guess.h"
#include "session/prepare/recorded_cast.h"
#include "session/prepare/subject.h"
#include "skinning/humanoid/humanoid.h"
#include "skinning/import/character_file.h"
#include "skinning/mannequin/mannequin.h"

#include <fmt/format.h>

#include <array>
#include <memory>
#include <numeric>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr double kStep = 1.0 / 30.0;
/// An hour at 60 frames a second: their poses take 1 GB of memory.
/// A sender's bone shorter than this was sent without its length [m].
constexpr double kShortest = 1e-4;

/// A sender's skeleton, made from what it sent.
class SenderBody {
 public:
  /// @param whole  has the offsets of bones that come without one
  explicit SenderBody(BonePose whole) : offsets_(std::move(whole)) {}

  void learn(const BonePose& pose) {
    for (std::size_t b = 0; b < known_.size(); ++b) {
      if (!pose.rotation[b] || known_[b]) continue;
      known_[b] = true;
      if (pose.offset[b].norm() > kShortest) offsets_.offset[b] = pose.offset[b];
    }
  }

  [[nodiscard]] Result<Skeleton> skeleton() {
    std::vector<Joint> joints;
    for (std::size_t b = 0; b < known_.size(); ++b) {
      if (!known_[b]) continue;
      const auto bone = static_cast<HumanBone>(b);
      Joint joint;
      joint.name = nameOf(bone);
      joint.bone = bone;
      joint.rest.translation = offsets_.offset[b];
      for (std::optional<HumanBone> above = parentBone(bone); above; above = parentBone(*above)) {
        const auto a = static_cast<std::size_t>(*above);
        if (known_[a]) {
          joint.parent = jointOf_[a];
          break;
        }
        joint.rest.translation += offsets_.offset[a];
      }
      jointOf_[b] = joints.size();
      joints.push_back(std::move(joint));
    }
    return Skeleton::create(std::move(joints));
  }

  /// Appends a pose of that skeleton.
  void append(const BonePose& pose, SkeletalMotion& motion) const {
    for (std::size_t b = 0; b < known_.size(); ++b) {
      if (!known_[b]) continue;
      const JointIndex joint = jointOf_[b];
      JointTransform local = motion.skeleton.joint(joint).rest;
      const bool root = motion.skeleton.joint(joint).parent == kNoJoint;
      if (pose.rotation[b]) local.rotation = *pose.rotation[b];
      if (root) {
        // What another bone sends is its way from a parent that is not sent.
        const bool sent = static_cast<HumanBone>(b) == HumanBone::kHips && pose.offset[b].norm() > kShortest;
        local.translation = pose.rootPosition + pose.rootRotation * (sent ? pose.offset[b] : local.translation);
        local.rotation = (pose.rootRotation * local.rotation).normalized();
      }
      motion.poses.push_back(local);
    }
  }

 private:
  BonePose offsets_;
  std::array<bool, kHumanBoneCount> known_{};
  std::array<JointIndex, kHumanBoneCount> jointOf_{};
};

/// Why packets hold no bones.
std::string whatCame(const PacketFile& file) {
  OscPacket first(file.payload(file.packets().front()));
  const std::optional<OscMessage> message = first.next();
  const std::string what =
      message ? quotedWord(fmt::format("{} ,{}", message->address, message->types)) : "something else than OSC";
  return fmt::format("found {} without bones, the first of {}, expected \"/VMC/Ext/Bone/Pos ,sfffffff\"",
                     counted(std::ssize(file.packets()), "packet"), what);
}

/// Calls `use` for each frame that a recording gives. @return number of steps of a session that follows it
template <typename Use>
int playAll(const RecordedPackets& packets, Use&& use) {
  RecordedStream stream(packets.file);
  BoneFrame frame;
  int steps = 0;
  while (true) {
    const bool isNew = stream.wait(kStep, frame);
    if ((!isNew && stream.ended()) || workStopped()) return steps;
    ++steps;
    if (!isNew) continue;
    if (packets.sender) packets.sender->apply(frame.pose);
    use(frame);
  }
}

}  // namespace

Result<Motion> readPacketMotion(const fs::path& file, const MotionOptions& options, Host& host) {
  LORICA_TRY(PacketFile read, readPacketFile(file));
  LORICA_TRY(std::optional<SenderRest> sender, readSenderRest(options.sender, host));
  Motion motion;
  motion.name = file.stem().string();
  motion.format = "VMC packets";
  motion.notes = read.notes();
  motion.packets = RecordedPackets{std::make_shared<const PacketFile>(std::move(read)),
                                   sender ? std::make_shared<const SenderRest>(*std::move(sender)) : nullptr, 0};

  LORICA_TRY(BonePoseReader mannequin, BonePoseReader::create(makeMannequin().skeleton));
  SenderBody body(mannequin.read(restPose(makeMannequin().skeleton)));
  std::size_t frames = 0;
  motion.packets->steps = playAll(*motion.packets, [&](const BoneFrame& frame) {
    body.learn(frame.pose);
    ++frames;
  });
  if (workStopped()) return cancelled();
  if (frames == 0) return badFormat("{}: {}", file.string(), whatCame(*motion.packets->file));
  if (frames > kMaxStreamFrames) {
    return badFormat("{}: found {} frames of bones, expected at most {}", file.string(), frames, kMaxStreamFrames);
  }
  LORICA_TRY(Skeleton skeleton, prefixed(file.string(), body.skeleton()));
  motion.bones = SkeletalMotion{motion.name, std::move(skeleton), {}, {}};
  playAll(*motion.packets, [&](const BoneFrame& frame) {
    if (!motion.bones->times.empty() && frame.time <= motion.bones->times.back()) return;
    motion.bones->times.push_back(frame.time);
    body.append(frame.pose, *motion.bones);
  });
  return unlessStopped<Motion>(std::move(motion));
}

Result<Motion> readSessionMotion(const fs::path& file, const MotionOptions& options, Host& host) {
  const int person = options.person;
  LORICA_TRY(SessionFile recorded, readSession(file));
  Motion motion;
  motion.name = file.stem().string();
  motion.notes = recorded.notes;
  motion.format = "recorded session";
  motion.people.resize(recorded.header.avatars.size());
  std::iota(motion.people.begin(), motion.people.end(), 1);
  const std::size_t count = recorded.motions.size();
  const std::size_t index = person > 0 ? person - 1 : 0;
  if (index >= count) {
    return invalidArgument("--person {}: {} has {}, expected at most that number", person, file.string(),
                           counted(std::ssize(recorded.motions), "avatar"));
  }
  if (count > 1 && person == 0) {
    motion.notes.push_back(fmt::format("of {} avatars this is the first; --person 2 is the second", count));
  }
  const AvatarRecord& header = recorded.header.avatar(index);
  RecordedMotion& chosen = recorded.motions[index];
  if (header.poseJoints == 0) {
    motion.joints = std::move(chosen.joints);
    std::erase_if(motion.joints, [](const SkeletonFrame& frame) { return frame.user == kNobody; });
  } else {
    recorded.header.avatars[index].decomposition.clear();  // of no use here
    recorded.header.scene.clear();
    Result<SessionInputs> inputs = inputsOf(recorded, file.string(), index, "", "", host);
    if (!inputs && !options.character.empty()) {
      inputs = inputsOf(recorded, file.string(), index, options.character, "", host);
    }
    if (!inputs) return inputs.error();
    LORICA_TRY(const CharacterOptions reading, readingOf(*inputs, header));
    LORICA_TRY(Subject subject, readCharacter(inputs->character, reading, host));
    const Skeleton& skeleton = subject.character.value().skeleton;
    if (skeleton.jointCount() != header.poseJoints) {
      return invalidArgument("{}: poses of {} joints were recorded, {} has {}", file.string(), header.poseJoints,
                             inputs->character, skeleton.jointCount());
    }
    motion.bones = SkeletalMotion{motion.name, skeleton, std::move(chosen.poseTimes), std::move(chosen.poses)};
  }
  if (motion.bones ? motion.bones->times.empty() : motion.joints.empty()) {
    return badFormat("{}: found no motion, expected at least one frame", file.string());
  }
  motion.firstGuess = firstGuessOf(
      {motion.bones ? "rest pose: that of its character" : "joints as they were recorded", "metres", "Y is up"},
      motion);
  return motion;
}

Result<std::optional<SenderRest>> readSenderRest(const std::string& file, const Host& host) {
  if (file.empty()) return std::optional<SenderRest>();
  LORICA_TRY(const CharacterFile model, prefixed("--sender", readCharacterFile(file, host.characterFiles())));
  if (model.format != "VRM 1.0") {
    return invalidArgument(
        "--sender: {}: found {}, expected VRM 1.0: of other models a rotation of zero is the T-pose already", file,
        model.format);
  }
  LORICA_TRY(SenderRest rest, prefixed("--sender: " + file, SenderRest::create(model.character.skeleton)));
  return std::optional<SenderRest>(std::move(rest));
}

}  // namespace lorica

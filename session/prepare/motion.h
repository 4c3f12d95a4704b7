#pragma once

#include "capture/skeleton_frame.h"
#include "geometry/counts.h"
#include "geometry/math.h"
#include "geometry/result.h"
#include "session/pose_source.h"
#include "session/treated_source.h"
#include "skinning/character.h"
#include "skinning/clip.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

class PacketFile;
class SenderRest;

/// What a program sent while it was recorded.
struct RecordedPackets {
  std::shared_ptr<const PacketFile> file;    ///< shared by all that play it
  std::shared_ptr<const SenderRest> sender;  ///< how its bones are at rest; null = not known
  int steps = 0;                             ///< of a session that follows it, pauses included
};

/// The depth recording that joints were tracked in.
struct RecordedDepth {
  std::filesystem::path file;                   ///< see openDepthRecording()
  std::string lens = {};                        ///< the same
  std::vector<Isometry3> cameraFromWorld = {};  ///< of each frame
};

/// A recorded motion before a character performs it: joints, or the motion of a skeleton of its own.
struct Motion {
  std::string name;                             ///< a file's stem or a shipped name; "hero: Run" for a clip
  std::vector<SkeletonFrame> joints;            ///< of a person, times increasing; empty if there are bones
  std::optional<SkeletalMotion> bones;          ///< if set, there are no joints
  std::optional<RecordedPackets> packets = {};  ///< if set, poses come from these; the bones are the sender's
  std::optional<RecordedDepth> depth = {};      ///< if set, it has a frame for each frame of joints
  bool fromCharacterFile = false;       ///< the bones are those of a character; another one may use the same names
  std::string format;                   ///< "BVH", "joints (lorica)", "glTF 2.0"
  std::vector<std::string> notes;       ///< what was repaired or left out
  std::string firstGuess = {};          ///< rest pose, scale, axes, floor and facing, and what they were taken from
  std::vector<std::string> clips = {};  ///< that its file holds; empty if the file is not that of a character
  std::vector<int> people = {};         ///< that its file holds, by number; empty if that is not known

  /// Of a motion from packets, steps of a session.
  [[nodiscard]] int frameCount() const {
    if (packets) return packets->steps;
    return bones ? bones->frameCount() : countOf(joints);
  }
  /// Of its first seconds, if the frames are at even intervals; at least 1.
  [[nodiscard]] int framesIn(double seconds) const;
  /// Time stamp of the first frame [s]
  [[nodiscard]] double firstTime() const { return bones ? bones->times.front() : joints.front().time; }
  /// From the first frame to the last [s].
  [[nodiscard]] double seconds() const { return (bones ? bones->times.back() : joints.back().time) - firstTime(); }
};

inline constexpr double kClipRate = 60.0;  ///< [1/s]

/// A clip as a motion of its skeleton, at its own frames or 60 a second; or that it is too long for that.
[[nodiscard]] Result<SkeletalMotion> framesOf(const Skeleton& skeleton, const Clip& clip);

/// The whole motion on a character's skeleton: joints and other humanoids' bones are retargeted; bones from a character
/// file move the character's bones of the same names.
/// @param settings  of joints; of bones only `mirror` counts
/// @return the motion; or which humanoid bones are missing in the character or in the motion
[[nodiscard]] Result<SkeletalMotion> performedBy(const Character& character, const Motion& motion,
                                                 const JointSettings& settings = {});

/// For the end of a sentence about a character that cannot perform: how to say which joints are its bones; else empty.
[[nodiscard]] std::string mapHint(const Character& character);

/// Whether a character can perform a motion: the error of performedBy(), at the cost of one frame.
[[nodiscard]] Result<void> checkPerformed(const Character& character, const Motion& motion,
                                          const JointSettings& settings = {});

/// performedBy() as a source of poses: joints are retargeted frame by frame, as live ones are, and faults are injected.
/// @return the source; the errors of performedBy(); or that the faults do not apply to a motion of bones
[[nodiscard]] Result<std::unique_ptr<PoseSource>> poseSourceOf(const Character& character, const Motion& motion,
                                                               const SourceTreatment& treatment = {});

}  // namespace lorica

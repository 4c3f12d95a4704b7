#pragma once

#include "apps/command_line.h"
#include "capture/fault_injector.h"
#include "capture/skeleton_frame.h"
#include "geometry/result.h"
#include "session/pose_source.h"
#include "session/treated_source.h"
#include "skinning/character.h"
#include "skinning/clip.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// What the command line says of how to read a motion and what to do with it.
struct MotionOptions {
  std::string format;  ///< of joints; empty = told by the content
  int person = 0;      ///< of several in a stream of joints; 0 = the one that moves most
  std::string clip;    ///< of a file with several; empty = the first
  bool mirror = false;
  std::string smooth = "off";  ///< or "one-euro"
  OneEuroSettings oneEuro;
  std::string inject;  ///< faults, see parseFaults(); empty = none

  [[nodiscard]] JointSettings joints() const;
  [[nodiscard]] FaultSettings faults() const;
};

/// --format, --person, --clip: how a motion is read.
void addReadingOptions(CommandLine& app, MotionOptions& options);
/// --mirror, --smooth, --min-cutoff, --beta: what is done to it.
void addPlayingOptions(CommandLine& app, MotionOptions& options);
/// --inject: faults that are made in it.
void addFaultOption(CommandLine& app, MotionOptions& options);

/// A motion as its file has it, before a character performs it: joints, or a skeleton of its own.
struct Motion {
  std::string name;  ///< a file's stem or a shipped name; "hero: Run" for a clip
  std::vector<SkeletonFrame> joints;
  std::optional<SkeletalMotion> bones;  ///< then there are no joints
  bool fromCharacterFile = false;       ///< the bones are those of a character, which another may share by name
  std::string format;                   ///< "BVH", "joints (lorica)", "glTF 2.0"
  std::vector<std::string> notes;       ///< what was guessed, mended or left out

  [[nodiscard]] int frameCount() const { return bones ? bones->frameCount() : static_cast<int>(joints.size()); }
  [[nodiscard]] double firstTime() const { return bones ? bones->times.front() : joints.front().time; }
  /// From the first frame to the last [s].
  [[nodiscard]] double seconds() const { return (bones ? bones->times.back() : joints.back().time) - firstTime(); }
};

/// Reads a motion by its path or, for a bare name such as `walk`, from those that ship: joints in any known layout,
/// BVH, or a clip of a character file.
[[nodiscard]] Result<Motion> readMotion(const std::string& pathOrName, const MotionOptions& options = {});

/// The shipped recording that a word means which names no file here; empty where there is none.
[[nodiscard]] std::filesystem::path shippedRecording(const std::string& name);

/// The clean recordings that ship, in a fixed order: what humanoids without clips of their own train on.
[[nodiscard]] Result<std::vector<Motion>> readShippedRecordings();

/// Where the shipped recordings lie: $LORICA_RECORDINGS, or beside the folder of the program, as in a build and as
/// installed.
[[nodiscard]] Result<std::filesystem::path> recordingsFolder();

/// The names of what ships in a folder: "jumping_jacks, walk, ...".
[[nodiscard]] std::string shippedNames(const std::filesystem::path& folder, const std::string& extension);

/// A word without folder or extension, that names no file here.
[[nodiscard]] bool isBareName(const std::string& text);

/// The clip that a name means, letters' case aside; the first where the name is empty.
/// @param source  of the clips, for the sentence
[[nodiscard]] Result<const Clip*> findClip(std::span<const Clip> clips, const std::string& name,
                                           const std::string& source);

/// A clip as a motion of its skeleton, at 60 frames a second.
[[nodiscard]] SkeletalMotion framesOf(const Skeleton& skeleton, const Clip& clip);

/// The whole motion, performed by a character: joints and other humanoids' bones are retargeted; bones of the same
/// names as the character's, from a character file, move their namesakes.
[[nodiscard]] Result<SkeletalMotion> performedBy(const Character& character, const Motion& motion,
                                                 const MotionOptions& options = {});

/// The same, to play: joints are retargeted frame by frame, as live ones are, and faults are made.
/// @param log  of what comes before faults are made; null = none
[[nodiscard]] Result<std::unique_ptr<PoseSource>> poseSourceOf(const Character& character, const Motion& motion,
                                                               const MotionOptions& options = {},
                                                               std::shared_ptr<SourceLog> log = nullptr);

}  // namespace lorica

#pragma once

#include "capture/fault_injector.h"
#include "capture/files/joint_stream.h"
#include "collision/hulls/host.h"
#include "geometry/result.h"
#include "session/prepare/motion.h"
#include "skinning/clip.h"

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// MotionOptions::person: an avatar for each person, see readEveryone().
inline constexpr int kEveryone = -1;

/// Options for reading and processing a motion.
struct MotionOptions {
  /// A filter that joints pass as they arrive.
  enum class Smoothing : std::uint8_t { kOff, kOneEuro };
  std::optional<JointFormat> format;  ///< of joints; none = detected from the content
  int person = 0;          ///< of several in a stream of joints; 0 = the one with the most motion; or kEveryone
  std::string clip;        ///< in a file with several; empty = the first
  std::string rest;        ///< pose of a BVH file, see parseBvhRest(); empty = found
  bool mirror = false;     ///< left and right exchanged
  bool upperBody = false;  ///< the legs stand by themselves
  Smoothing smooth = Smoothing::kOff;  ///< of joints
  OneEuroSettings oneEuro;             ///< of `smooth`
  bool smoothGiven = false;            ///< one of the options of smoothing was given
  std::string sender;                  ///< model of the sender of recorded packets, see readSenderRest(); empty = none
  std::string lens;                    ///< camera of a depth recording, see openDepthRecording(); empty = its own
  std::string character;               ///< of a session, where the recorded name is not found; empty = none
  FaultSettings inject;                ///< what is made worse on purpose, see parseFaults()

  [[nodiscard]] JointSettings joints() const;  ///< of a person
};

/// Reads a motion from a path or, for a name such as `walk`, from the shipped recordings: joints in any known layout,
/// BVH, or a clip of a character file.
[[nodiscard]] Result<Motion> readMotion(const std::string& pathOrName, const MotionOptions& options, Host& host);

/// The motions of all people in a stream of joints or a depth recording, as they stood to each other; named "duel:
/// person 1", ...
/// @return at least one motion, or an error about the file
[[nodiscard]] Result<std::vector<Motion>> readEveryone(const std::string& pathOrName, const MotionOptions& options,
                                                       Host& host);

/// The shipped recording with this name; empty if there is none, or if a file of the working folder has the name.
[[nodiscard]] std::filesystem::path shippedRecording(const std::string& name);

/// A motion that ships with Lorica without noise, such as "walk", which needs no file; none if none has the name.
[[nodiscard]] std::optional<Motion> shippedMotion(const std::string& name);
/// All of them, in a fixed order: the default training of humanoids without clips.
[[nodiscard]] std::vector<Motion> shippedMotions();

/// The folder of the shipped recordings: $LORICA_RECORDINGS, or relative to the program, in a build tree or installed.
[[nodiscard]] Result<std::filesystem::path> recordingsFolder();

/// The names of the files with some extensions in a folder.
[[nodiscard]] std::vector<std::string> shippedNames(const std::filesystem::path& folder,
                                                    std::initializer_list<const char*> extensions);
/// The same as a text: "jumping_jacks, walk, ...". At its end the one that was
/// probably meant by `asked`, if there is one.
[[nodiscard]] std::string shippedNames(const std::filesystem::path& folder,
                                       std::initializer_list<const char*> extensions, const std::string& asked);

/// Whether a word has no folder and no extension, and is not the name of an existing file.
[[nodiscard]] bool isBareName(const std::string& text);

/// The clip with this name, ignoring case; the first if the name is empty.
/// @param source  of the clips, for the error message
[[nodiscard]] Result<const Clip*> findClip(std::span<const Clip> clips, const std::string& name,
                                           const std::string& source);

/// poseSourceOf() of session/prepare/motion.h with the options of the command line.
[[nodiscard]] Result<std::unique_ptr<PoseSource>> poseSourceOf(const Character& character, const Motion& motion,
                                                               const MotionOptions& options,
                                                               std::shared_ptr<SourceLog> log = nullptr);

}  // namespace lorica

#pragma once

#include "capture/fault_injector.h"
#include "session/pose_source.h"
#include "session/session.h"
#include "session/world_action.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// What a recorded session was made of. Files are named as they were then, as hints for whoever looks for them; hashes
/// say whether what was found is the same.
struct SessionHeader {
  std::string source;  ///< what moved the character: "walk"
  int poseJoints = 0;  ///< joints of a recorded pose; 0 = joints as a sensor gives them were recorded

  std::string character;        ///< name or file, as it was given
  std::string boneMap;          ///< file; empty = none
  double bodyResolution = 0.0;  ///< [m]; 0 = chosen
  std::uint64_t characterHash = 0;

  std::string decomposition;             ///< file; empty = the default one
  std::uint64_t decompositionHash = 0;   ///< hashOf(Decomposition)
  std::optional<double> coverTolerance;  ///< asked for [m]; 0 = exact
  int hullVertices = 0;                  ///< asked for; 0 = no bound
  std::uint64_t coverHash = 0;           ///< 0 = none, exact
  std::uint64_t trainingHash = 0;        ///< 0 = not known

  JointSettings joints;
  FaultSettings faults;

  std::string scene;            ///< name or file, as it was given; empty = the demo's
  std::string sceneFolder;      ///< that its meshes are relative to
  std::uint64_t sceneSeed = 0;  ///< of the demo's
  std::uint64_t worldHash = 0;  ///< hashOf(World), at the begin
};

/// One step of a session: what it took and what came of it.
struct SessionStep {
  double time = 0.0;        ///< Session::time() after it [s]
  std::size_t joints = 0;   ///< so many frames of joints were taken for it
  std::size_t poses = 0;    ///< or poses
  std::size_t actions = 0;  ///< so many things were done to the world in it
  SessionHashes hashes;     ///< Session::hashes() after it
};

/// A recorded session as its file has it.
struct SessionFile {
  SessionHeader header;
  std::string sceneText;              ///< of the scene file; empty = the demo's
  std::vector<SessionStep> steps;     ///< at least one
  std::vector<SkeletonFrame> joints;  ///< of all steps, one after the other
  std::vector<double> poseTimes;      ///< [s]
  std::vector<JointTransform> poses;  ///< header.poseJoints for each time
  std::vector<WorldAction> actions;   ///< of all steps
  bool finished = false;              ///< it was closed; else the program ended before
  std::vector<std::string> notes;     ///< what was dropped
};

/// Reads a .lsession file and checks all of it. A block at the end that was not written to its end is dropped, with a
/// note; whatever else is wrong is an error.
/// @return the session, or a sentence with file, place, found and expected
[[nodiscard]] Result<SessionFile> readSession(const std::filesystem::path& file);
/// The same of bytes in memory. @param name  what the sentences call it
[[nodiscard]] Result<SessionFile> parseSession(std::string_view bytes, const std::string& name);

/// The header as its block has it, JSON, and back.
[[nodiscard]] std::string textOf(const SessionHeader& header);
[[nodiscard]] Result<SessionHeader> parseSessionHeader(std::string_view text, const std::string& name);

/// All of a character that poses and hulls depend on, bit for bit.
[[nodiscard]] std::uint64_t hashOf(const Character& character);
/// 0 without one.
[[nodiscard]] std::uint64_t hashOf(const std::optional<CoverPromise>& cover);
[[nodiscard]] std::uint64_t hashOf(const std::optional<TrainingRange>& training);
/// All props with their meshes, substance and places, bit for bit.
[[nodiscard]] std::uint64_t hashOf(const World& world);

}  // namespace lorica

#pragma once

#include "acd/decomposition.h"
#include "session/session.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace lorica::test {

struct AvatarSoakSettings {
  double seconds = 1800.0;  ///< simulated time
  std::uint64_t seed = 1;
  int places = 6;             ///< for avatars
  double memoryGrowth = 4.0;  ///< maximum growth from the first third after the warm-up to the last third [MiB]
  double warmUp = 300.0;      ///< simulated time before memory counts [s]
};

struct AvatarSoakResult {
  double seconds = 0.0, cpuSeconds = 0.0;  ///< simulated, and CPU time of all steps
  long frames = 0, entries = 0, exits = 0, contacts = 0, meetings = 0, events = 0;
  double meanThere = 0.0;                                        ///< avatars in a frame
  double firstMemory = 0.0, lastMemory = 0.0, peakMemory = 0.0;  ///< means of the thirds, and the peak [MiB]
  std::vector<std::string> violations;                           ///< messages of the first few
};

/// A session in the demo's scene whose avatars come and go: each is there for 2 to 8 s, each time elsewhere with
/// another motion, and away for 1 to 5 s. The same settings give the same run.
/// @param parts  of the mannequin
[[nodiscard]] AvatarSoakResult soakAvatars(const Decomposition& parts, const AvatarSoakSettings& settings);

/// A scene of a soak test, created again for each use.
struct SoakScene {
  std::string name;
  std::function<World(std::uint64_t seed)> make;
};

struct SoakSettings {
  double seconds = 3600.0;  ///< simulated time
  std::uint64_t seed = 1;
  double budget = 1.0 / 60.0;  ///< CPU time per frame, all threads [s]
  double factor = 3.0;         ///< maximum CPU time of a frame as a multiple of the budget
  double memoryGrowth = 4.0;   ///< maximum growth from the first third after the warm-up to the last third [MiB]
  double warmUp = 300.0;       ///< simulated time before memory counts [s]
};

/// Results of one scene over all its uses.
struct SoakRow {
  std::string scene;
  std::vector<double> frameSeconds;  ///< CPU time of each frame
  std::size_t maxProps = 0;
  long contacts = 0;
  double lowest = 1e9;   ///< minimum height of the centre of a dynamic prop [m]
  double fastest = 0.0;  ///< maximum speed of a prop [m/s]
};

struct SoakResult {
  std::vector<SoakRow> rows;  ///< one per scene
  double seconds = 0.0;       ///< simulated
  long frames = 0, balls = 0, grabs = 0, worlds = 0, faultyFrames = 0;
  double firstMemory = 0.0, lastMemory = 0.0, maxMemory = 0.0;  ///< means of the thirds, and the peak [MiB]
  std::vector<std::string> violations;                          ///< messages of the first few
};

/// Plays motions in turn, each with other faults, in the scenes in turn. Changes the scene in the middle of each
/// motion, throws balls at the avatar, drags props around, and checks for violations. The same settings give the same
/// run.
/// @param parts  of the mannequin
[[nodiscard]] SoakResult soak(const Decomposition& parts, const std::vector<SoakScene>& scenes,
                              const SoakSettings& settings);

}  // namespace lorica::test

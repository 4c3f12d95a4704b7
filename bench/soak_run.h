#pragma once

#include "acd/decomposition.h"
#include "session/session.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace lorica::bench {

/// A scene of a soak, made anew each time.
struct SoakScene {
  std::string name;
  std::function<World(std::uint64_t seed)> make;
};

struct SoakSettings {
  double seconds = 3600.0;  ///< of simulated time
  std::uint64_t seed = 1;
  double budget = 1.0 / 60.0;  ///< CPU time of a frame, all threads [s]
  double factor = 3.0;         ///< no frame takes longer than this times the budget
  double memoryGrowth = 4.0;   ///< from the first third after the warm-up to the last third, at most [MiB]
  double warmUp = 300.0;       ///< simulated time before memory counts [s]
};

/// What came of one scene, over all the times that it was played in.
struct SoakRow {
  std::string scene;
  std::vector<double> frameSeconds;  ///< CPU time of each frame
  std::size_t mostProps = 0;
  long contacts = 0;
  double lowest = 1e9;   ///< of the middle of a prop that can move [m]
  double fastest = 0.0;  ///< of a prop [m/s]
};

struct SoakResult {
  std::vector<SoakRow> rows;  ///< one a scene
  double seconds = 0.0;       ///< simulated
  long frames = 0, balls = 0, grabs = 0, worlds = 0, faultyFrames = 0;
  double firstMemory = 0.0, lastMemory = 0.0, mostMemory = 0.0;  ///< means of the thirds, and the peak [MiB]
  std::vector<std::string> violations;                           ///< the first few, in words
};

/// Plays motions in turn, each with other faults, in scenes in turn, changes the scene in the middle of each, throws
/// balls at the avatar and drags props about, and watches over all of it. The same settings do the same.
/// @param parts  of the mannequin
[[nodiscard]] SoakResult soak(const Decomposition& parts, const std::vector<SoakScene>& scenes,
                              const SoakSettings& settings);

}  // namespace lorica::bench

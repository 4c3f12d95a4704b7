#pragma once

#include "acd/decompose.h"
#include "acd/decomposition_file.h"
#include "apps/inputs.h"
#include "apps/quality.h"
#include "skinning/character.h"

#include <string>

namespace lorica {

/// The motions that a character trains on, performed by it: those named; else its own clips; else, of a humanoid, the
/// shipped recordings; else its rest pose.
struct Training {
  std::vector<SkeletalMotion> motions;
  bool ownClips = false;
};

/// @param motions  paths or names, see readMotion(); may be none
[[nodiscard]] Result<Training> trainingMotions(const Subject& subject, std::span<const std::string> motions);

/// A frame of a motion that was chosen as a keyframe.
struct ChosenFrame {
  std::string motion;  ///< its name
  std::size_t frame = 0;
  double time = 0.0;  ///< [s]
};

/// Keyframes to train a decomposition on.
struct Keyframes {
  std::vector<Vec3> positions;  ///< [m], count x vertexCount, keyframe-major
  int count = 0;
  std::vector<ChosenFrame> chosen;  ///< one for each when they were chosen, else none
  double farthest = 0.0;            ///< of chosen ones: no frame differs more than this from one of them [m]
};

/// How many keyframes there are by default, and at most when they are chosen.
inline constexpr int kDefaultKeyframes = 12;
/// The count that stands for: choose poses that differ most. At most kDefaultKeyframes, fewer where every frame is
/// within 2 % of the character's height of one of them.
inline constexpr int kChooseKeyframes = -1;

/// Keyframes taken uniformly over motions laid end to end, or chosen.
/// @param count  1 or more, or kChooseKeyframes; none = kDefaultKeyframes, chosen where the clips are its own, of which
///               many are often alike
[[nodiscard]] Result<Keyframes> trainingKeyframes(const Character& character, const Training& training,
                                                  std::optional<int> count);

/// A decomposition and how long it took.
struct TimedDecomposition {
  Decomposition decomposition;
  double seconds = 0.0;
};

/// decompose() with a progress bar; Ctrl-C cancels it.
/// @param name  what is decomposed, for the bar and for errors: "Bunny.off"
[[nodiscard]] Result<TimedDecomposition> decomposeWithProgress(const std::string& name, const TriMesh& mesh,
                                                               PoseView keyframes, DecomposeSettings settings);

/// What a .lorica file keeps of a new decomposition: also its levels of detail, judged in the keyframes, the range of
/// poses that trained it, and the bones that move the parts of a character. No cover. Of a character every frame of the
/// training motions is a known pose, or, of more than 3,000 frames, that many, taken evenly.
/// @param character  null for a mesh, as is training
[[nodiscard]] DecompositionFile fileContent(const std::string& name, const TriMesh& mesh, const Character* character,
                                            const Training* training, PoseView keyframes, Decomposition decomposition,
                                            const Quality& quality);

}  // namespace lorica

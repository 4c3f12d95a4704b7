#pragma once

#include "acd/decompose.h"
#include "collision/hulls/host.h"
#include "skinning/character.h"
#include "skinning/clip.h"

#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// The motions that a decomposition is trained on, performed by the character.
struct Training {
  std::vector<SkeletalMotion> motions;  ///< that decompositions are made for
  bool ownClips = false;                ///< the character's own are among them
};

/// A frame of a motion that was chosen as a keyframe.
struct ChosenFrame {
  std::string motion;     ///< its name
  std::size_t frame = 0;  ///< of that motion
  double time = 0.0;      ///< [s]
};

/// Keyframes to train a decomposition on.
struct Keyframes {
  std::vector<Vec3> positions;      ///< [m], count x vertexCount, keyframe-major
  int count = 0;                    ///< keyframes
  std::vector<ChosenFrame> chosen;  ///< one for each keyframe if they were chosen by their differences, else empty
  double farthest = 0.0;            ///< of chosen ones: no frame differs more than this from its nearest keyframe [m]
  std::vector<Affine3> worldFromModel = {};  ///< of the bones, count x jointCount; empty for a mesh
};

/// The default number of keyframes, and the maximum when they are chosen by their differences.
inline constexpr int kDefaultKeyframes = 12;
/// A special count: choose the most different poses, at most kDefaultKeyframes, and fewer if every frame is within 2 %
/// of the character's height of one of them.
inline constexpr int kChooseKeyframes = -1;

/// Keyframes at even intervals over the concatenated motions, or chosen by their differences.
/// @param count  1 or more, or kChooseKeyframes. None = kDefaultKeyframes, but chosen by their differences if the
///               motions are the character's own clips, which are often alike
[[nodiscard]] Result<Keyframes> trainingKeyframes(const Character& character, const Training& training,
                                                  std::optional<int> count);

/// The most different of poses that are given by their bones. @param worldFromModel  poses x jointCount, at least one
[[nodiscard]] Keyframes trainingKeyframes(const Character& character, std::span<const Affine3> worldFromModel);

/// A decomposition and its computation time.
struct TimedDecomposition {
  Decomposition decomposition;
  double seconds = 0.0;
};

/// decompose(), timed.
/// @param name  of the mesh, for errors: "Bunny.off"
[[nodiscard]] Result<TimedDecomposition> decomposeTimed(const std::string& name, const TriMesh& mesh,
                                                        PoseView keyframes, const DecomposeSettings& settings);
/// The same as a task of the host.
[[nodiscard]] Result<TimedDecomposition> decomposeWithProgress(const std::string& name, const TriMesh& mesh,
                                                               PoseView keyframes, DecomposeSettings settings,
                                                               Host& host);

}  // namespace lorica

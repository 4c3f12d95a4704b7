#pragma once

#include "capture/skeleton_frame.h"
#include "geometry/result.h"
#include "geometry/tri_mesh.h"
#include "skinning/character.h"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// A thing that can be decomposed: a mesh, or a character whose bind pose is `mesh`.
struct Subject {
  std::string name;  ///< a file name without its folder, or "mannequin"
  TriMesh mesh;
  std::optional<Character> character;
  std::string mended;  ///< what had to be repaired to make the file's mesh a closed two-manifold; empty = nothing
};

/// Reads INPUT of `decompose` and `info`: the name of a built-in character, or else a mesh file. A mesh that is closed
/// but for edges of more than two triangles is repaired, see repairClosedMesh; any other fault is left for the check.
[[nodiscard]] Result<Subject> readSubject(const std::string& input);

/// A character by its name, or a sentence that lists the names.
[[nodiscard]] Result<Character> findCharacter(const std::string& name);

/// A recording with its name: the file's stem.
struct Recording {
  std::string name;
  std::vector<SkeletonFrame> frames;

  /// From the first frame to the last [s].
  [[nodiscard]] double seconds() const { return frames.back().time - frames.front().time; }
};

/// Reads a recording by its path or, for a bare name such as `walk`, from those that ship.
[[nodiscard]] Result<Recording> readRecording(const std::string& pathOrName);

/// The clean recordings that ship, in a fixed order: what decompositions train on by default.
[[nodiscard]] Result<std::vector<Recording>> readShippedRecordings();

/// Recordings by their paths or names.
/// @param motions  as given on the command line; empty = the shipped clean recordings
[[nodiscard]] Result<std::vector<Recording>> readMotions(std::span<const std::string> motions);

/// Where the shipped recordings lie: $LORICA_RECORDINGS, or beside the folder of the program, as in a build and as
/// installed.
[[nodiscard]] Result<std::filesystem::path> recordingsFolder();

/// A frame of a recording that was chosen as a keyframe.
struct ChosenFrame {
  std::string recording;  ///< its name
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

/// Keyframes taken uniformly over recordings laid end to end, or chosen.
/// @param motions  see readMotions()
/// @param count    1 or more, or kChooseKeyframes
[[nodiscard]] Result<Keyframes> trainingKeyframes(const Character& character, std::span<const Recording> motions,
                                                  int count);

}  // namespace lorica

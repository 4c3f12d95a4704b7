#pragma once

#include "collision/hulls/host.h"
#include "geometry/result.h"
#include "session/prepare/motion.h"
#include "session/prepare/read_motion.h"

#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// The character whose skeleton a converted motion is for.
struct ConvertCharacter {
  std::string name;  ///< a character file or `mannequin`; empty = none
  std::string map;   ///< bone map; empty = automatic
};

/// What was written.
struct ConvertedClip {
  int joints = 0;
  std::optional<double> delay;     ///< of smoothing [s]
  std::string units;               ///< of the output's lengths, for people
  std::vector<std::string> notes;  ///< one sentence each
};

/// Writes a motion on a character's skeleton: a .glb of the character in motion, see writeClip(), or a .bvh of its
/// joints.
/// @param out  ends in .glb or .bvh
[[nodiscard]] Result<ConvertedClip> convertOnto(const ConvertCharacter& character, const Motion& motion,
                                                const MotionOptions& options, const std::string& out, const Host& host);

/// Writes a motion without a character: .bvh, or else Lorica's joint CSV. A skeleton that is not mirrored keeps its
/// joints in BVH; joints are smoothed and mirrored as the options say.
[[nodiscard]] Result<ConvertedClip> writeMotion(const std::string& output, const Motion& motion,
                                                const MotionOptions& options);

}  // namespace lorica

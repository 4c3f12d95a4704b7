#pragma once

#include "apps/convert_character.h"
#include "prepare/read_motion.h"

#include <string>

namespace lorica {

/// Writes a motion without a character: .bvh, or else Lorica's joint CSV. A skeleton that is not mirrored keeps its
/// joints in BVH; joints are smoothed and mirrored as the options say.
[[nodiscard]] Result<ConvertedClip> writeMotion(const std::string& output, const Motion& motion,
                                                const MotionOptions& options);

}  // namespace lorica

#pragma once

#include "capture/fault_injector.h"
#include "session/pose_source.h"

#include <memory>

namespace lorica {

/// Injects faults of whole frames into poses: late and freeze, see FaultSettings. Allocates nothing per frame.
/// @return the source, or an error if the settings have faults of single joints, which do not apply to poses
[[nodiscard]] Result<std::unique_ptr<PoseSource>> makePoseFaults(std::unique_ptr<PoseSource> source,
                                                                 const FaultSettings& settings);

}  // namespace lorica

#pragma once

#include "capture/fault_injector.h"
#include "session/pose_source.h"

#include <memory>

namespace lorica {

/// Poses from a source, with the faults of whole frames that poses have as joints do: late and freeze, see
/// FaultSettings. Allocates nothing per frame.
/// @return the source, or that the settings ask for faults of single joints, which poses have not
[[nodiscard]] Result<std::unique_ptr<PoseSource>> makePoseFaults(std::unique_ptr<PoseSource> source,
                                                                 const FaultSettings& settings);

}  // namespace lorica

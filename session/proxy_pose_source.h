#pragma once

#include "capture/retarget/proxy_skeleton.h"
#include "session/pose_source.h"

#include <memory>

namespace lorica {

/// Maps the poses of a proxy skeleton back to its character.
[[nodiscard]] std::unique_ptr<PoseSource> makeProxyPoseSource(ProxySkeleton proxy, std::unique_ptr<PoseSource> source);

}  // namespace lorica

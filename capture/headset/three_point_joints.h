#pragma once

#include "capture/headset/worn_headset.h"
#include "capture/skeleton_frame.h"

#include <memory>

namespace lorica {

/// The wearer of a headset as a person, see ThreePointBody: next() takes the newest pose and never waits. Before the
/// first pose nobody is there; without another one the person stays as they are.
[[nodiscard]] std::unique_ptr<SkeletonSource> makeThreePointJoints(std::shared_ptr<const WornHeadset> headset);

}  // namespace lorica

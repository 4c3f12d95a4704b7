#pragma once

#include "capture/headset/worn_headset.h"
#include "capture/skeleton_frame.h"

namespace lorica {

/// Moves a person with their head: by what the headset has moved since the image, the feet not at all, what is between
/// by its height. The head is then where the headset is. Of another's headset nothing happens.
/// @param then    the head in the image, in the person's frame
/// @param latest  the head now
void moveWithHead(const WornHead& then, const WornHead& latest, SkeletonFrame& person);

}  // namespace lorica

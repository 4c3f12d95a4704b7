#pragma once

#include "capture/tracking/depth_joints.h"
#include "viewer/image.h"

namespace lorica {

/// What the camera sees, for people: near is light, what was not measured black; over it the joints that are followed,
/// green where they are seen and orange where they are guessed. Half as wide and high as the depth image; empty before
/// the first one.
void drawDepthPicture(const DepthCamera& camera, const DepthSight& sight, Image& picture);

}  // namespace lorica

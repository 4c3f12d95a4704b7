#pragma once

#include "capture/tracking/depth_joints.h"
#include "viewer/renderer/image.h"

namespace lorica {

/// Draws the depth image: near is light, unmeasured pixels are black. The tracked joints are green if they are seen and
/// orange if they are guessed. The picture has half the width and height of the depth image; it stays empty before the
/// first one.
void drawDepthPicture(const DepthCamera& camera, const DepthSight& sight, Image& picture);

}  // namespace lorica

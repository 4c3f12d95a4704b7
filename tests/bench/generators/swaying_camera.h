#pragma once

#include "capture/sensor/depth_frame.h"
#include "geometry/math.h"

namespace lorica::bench {

/// A camera that rolls by 6 degrees and pans by 7, to and fro in four and six seconds: swaying from still, at 30 frames
/// a second.
[[nodiscard]] Mat3 swayAt(int frame);

/// What it sees of what a still camera saw. Turning uncovers nothing: each pixel shows what was seen in its direction,
/// and nothing where that was outside the image.
void sway(const DepthCamera& camera, int frame, DepthFrame& depth);

}  // namespace lorica::bench

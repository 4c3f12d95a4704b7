#pragma once

#include "capture/sensor/depth_frame.h"
#include "tests/bench/real_recordings.h"

#include <memory>

namespace lorica::bench {

/// Another run of the same recording: short recordings tip one way or the other, so one run of them says little.
struct RealVariant {
  int start = 0;        ///< frames left out at the beginning
  bool mirror = false;  ///< the image's left and right are exchanged, and people's with them
  bool sways = false;   ///< the camera rolls by 6 degrees and pans by 7, to and fro in four and six seconds
};

/// The recording's truth as this variant shows it, frames counted from the first one shown.
[[nodiscard]] RealRecording altered(const RealRecording& recording, const RealVariant& variant);
/// The same of joints in the floor frame, or of offsets between them.
[[nodiscard]] Joints altered(const Joints& joints, const RealVariant& variant);
/// The recording's depth as this variant shows it. Its masks are not altered.
/// @param source  at its first frame
[[nodiscard]] std::unique_ptr<DepthSource> altered(std::unique_ptr<DepthSource> source, const RealVariant& variant);

}  // namespace lorica::bench

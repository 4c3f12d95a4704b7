#pragma once

#include "capture/sensor/depth_frame.h"
#include "tests/bench/real_recordings.h"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace lorica::bench {

/// Real people, cut out of their recordings, in a real empty room among rendered furniture that touches them: nothing
/// is missing around them. No file holds these recordings; any number can be made.
struct ComposedRoom {
  DepthCamera camera;
  std::vector<std::vector<std::uint16_t>> depthMm;  ///< frames, width x height
  std::vector<std::vector<std::uint8_t>> masks;     ///< of each frame: 0 nobody, else 1 + index of the person
  RealRecording truth;                              ///< no file; kind "composed"
};

/// @param recordings  of the folder: those that are cut out, and those of kind B, whose first second shows their room
/// @param seed        selects room, people and furniture; every third scene has a second person, who sits;
///                    nobody is hidden by more than three fifths, nor within furniture or a wall
/// @return an error with the file that could not be read
[[nodiscard]] Result<ComposedRoom> composeRoom(std::span<const RealRecording> recordings, std::uint64_t seed);

/// Shows its frames.
[[nodiscard]] std::unique_ptr<DepthSource> sourceOf(const ComposedRoom& room);

}  // namespace lorica::bench

#pragma once

#include "capture/tracking/segmentation/convolution.h"

#include <cstdint>
#include <span>

namespace lorica {

/// What a PersonNetwork computes, with vector instructions. Everything here is internal. Results are the same on every
/// instruction set.

/// What a network is told about some pixels that lie side by side, each number from 0 to 4095.
struct PixelInputs {
  std::span<std::int16_t> depth;     ///< 512 is 1 m
  std::span<std::int16_t> measured;  ///< 1024, or 0
  std::span<std::int16_t> height;    ///< 1024 is 1 m, from half a metre below the floor on
};

/// @param depthMm   a multiple of 8 pixels; 0 = nothing measured
/// @param heightMm  over the floor, used where it is known and something is measured
void measure(std::span<const std::uint16_t> depthMm, std::span<const std::int16_t> heightMm, bool floorKnown,
             const PixelInputs& to);

/// @param block  input of the block that this convolution ends, which is added if its shape says so
/// @param to     of the same size as `from`, at least 5 pixels wide; neither `from` nor `block`
void convolve(const Convolution& convolution, const FeatureMap& from, const FeatureMap& block, FeatureMap& to);

/// Each pixel is the largest of four, in each channel.
/// @param to  half as wide and high as `from`
void halve(const FeatureMap& from, FeatureMap& to);

/// Adds each pixel of an image to four of another one, whose numbers stay between 0 and 4095.
/// @param to  twice as wide and high as `from`
void addDoubled(const FeatureMap& from, FeatureMap& to);

}  // namespace lorica

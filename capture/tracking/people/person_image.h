#pragma once

#include "capture/sensor/depth_frame.h"
#include "capture/tracking/people/components.h"
#include "capture/tracking/people/depth_grid.h"
#include "capture/tracking/people/people.h"

#include <cstdint>
#include <span>

namespace lorica {

/// Computes pixel labels from cell labels: a pixel belongs to the neighbouring surface that matches its depth best.
/// @param numbers  for each slot the label of its pixels, 0 if it is not shown
/// @param person   slot + 1 of each cell
/// @param people   label - 1 is the index; box and count are written
/// @param labels   width x height; 255 if nothing was measured
void paintPeople(const DepthGrid& grid, const ComponentFinder& finder, std::span<const std::uint16_t> depthMm,
                 std::span<const std::uint8_t> numbers, std::span<const std::uint8_t> person,
                 std::span<PersonSegment> people, std::span<std::uint8_t> labels);

}  // namespace lorica

#pragma once

#include "collision/live/lifted_part.h"

namespace lorica {

/// The inner loop of LiftedPart::evaluate(), with vector instructions. Everything here is internal.
/// @param matrices  of the part's bones
/// @return the largest absolute coordinate
[[nodiscard]] float evaluateLifted(std::span<const LiftedPart::Group> groups, std::span<const std::uint32_t> groupBones,
                                   const LiftedPart::Lane* lanes, const FourColumns<float>* matrices, PointRow* rows);

/// Index of the row farthest along a direction; of several, the first. The same on every instruction set.
/// @param rows  at least one
[[nodiscard]] std::int32_t farthestRow(std::span<const PointRow> rows, const Vec3f& direction);

}  // namespace lorica

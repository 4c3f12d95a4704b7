#pragma once

#include "collision/lifted_part.h"

namespace lorica {

/// The inner loop of LiftedPart::evaluate(), with vector instructions. Internal.
/// @param bones  twelve numbers for each bone of the part, row by row
/// @return the largest absolute coordinate
[[nodiscard]] float evaluateLifted(std::span<const LiftedPart::Group> groups, std::span<const std::uint32_t> groupBones,
                                   const LiftedPart::Terms* terms, const float* bones, PointRow* rows);

}  // namespace lorica

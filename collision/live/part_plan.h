#pragma once

#include "collision/live/body_plan.h"
#include "collision/live/lifted_part.h"

#include <optional>
#include <vector>

namespace lorica {

/// A part's share of a BodyPlan. Internal.
struct BodyPlan::PartPlan {
  std::vector<PointIndex> candidates;  ///< points that form the hull, in the order of the frame's rows
  std::optional<LiftedPart> lifted;    ///< characters only
};

}  // namespace lorica

#include "collision/live/body_plan.h"

#include "acd/transfer.h"
#include "collision/live/choose_cover.h"
#include "geometry/result.h"

#include <utility>

namespace lorica {

BodyPlan::BodyPlan(Decomposition decomposition, const Character& character) : decomposition_(std::move(decomposition)) {
  const std::vector<LiftedPoint> lifted = liftPoints(character, decomposition_);
  cover_ = coverExactly(decomposition_, lifted);
  lift(lifted);
}

BodyPlan::BodyPlan(Decomposition decomposition, const Character& character, CoverPromise cover)
    : decomposition_(std::move(decomposition)), cover_(std::move(cover)) {
  CHECK(cover_.points.size() == decomposition_.parts.size(), "a promise says for each part which points it is made of");
  lift(liftPoints(character, decomposition_));
}

BodyPlan::BodyPlan(Decomposition decomposition) : decomposition_(std::move(decomposition)) {
  parts_.reserve(decomposition_.parts.size());
  for (const Part& part : decomposition_.parts) {
    PartPlan& plan = parts_.emplace_back();
    plan.candidates = spanningPoints(decomposition_, part);
    CHECK(!plan.candidates.empty(), "a decomposition has a part without points");
    std::vector<CoverPoint>& chosen = cover_.points.emplace_back();
    chosen.reserve(plan.candidates.size());
    for (const PointIndex p : plan.candidates) chosen.push_back({p, Vec3::Zero()});
  }
}

void BodyPlan::lift(std::span<const LiftedPoint> lifted) {
  parts_.reserve(decomposition_.parts.size());
  for (const std::vector<CoverPoint>& chosen : cover_.points) {
    std::vector<LiftedPoint> points;
    points.reserve(chosen.size());
    for (const CoverPoint& p : chosen) points.push_back(pushed(lifted[static_cast<std::size_t>(p.point)], p.outward));
    PartPlan& plan = parts_.emplace_back();
    plan.lifted.emplace(points);
    plan.candidates.reserve(chosen.size());
    for (const std::int32_t i : plan.lifted->order()) {
      plan.candidates.push_back(chosen[static_cast<std::size_t>(i)].point);
    }
  }
}

std::size_t BodyPlan::memory() const {
  std::size_t sum = parts_.capacity() * sizeof(PartPlan);
  for (const PartPlan& plan : parts_) {
    sum += plan.candidates.capacity() * sizeof(PointIndex);
    if (plan.lifted) sum += plan.lifted->memory();
  }
  return sum;
}

}  // namespace lorica

#include "collision/live/body_plan.h"

#include "acd/transfer.h"
#include "collision/live/choose_cover.h"
#include "collision/live/part_plan.h"
#include "geometry/errors.h"

#include <algorithm>
#include <utility>

namespace lorica {

namespace {

Result<void> check(const Decomposition& decomposition) {
  for (std::size_t i = 0; i < decomposition.parts.size(); ++i) {
    const std::vector<PointIndex>& points = decomposition.parts[i].points;
    if (points.empty()) return invalidArgument("part {} of the decomposition has no points", i);
    const auto [min, max] = std::minmax_element(points.begin(), points.end());
    if (*min < 0 || *max >= decomposition.pointCount()) {
      return invalidArgument("part {} of the decomposition has point {}, expected 0 to {}", i, *min < 0 ? *min : *max,
                             decomposition.pointCount() - 1);
    }
  }
  return {};
}

Result<void> check(const Decomposition& decomposition, const Character& character) {
  const std::size_t vertices = character.mesh.vertices.size(), triangles = character.mesh.triangles.size();
  if (std::cmp_not_equal(decomposition.vertexCount, vertices) ||
      std::cmp_not_equal(decomposition.triangleCount, triangles)) {
    return invalidArgument("the decomposition was made from a mesh of {} vertices and {} triangles; {} has {} and {}",
                           decomposition.vertexCount, decomposition.triangleCount, character.name, vertices, triangles);
  }
  return check(decomposition);
}

Result<void> check(const HullCover& cover, const Decomposition& decomposition) {
  if (cover.points.size() != decomposition.parts.size()) {
    return invalidArgument("the hull cover lists the points of {} parts, expected {}", cover.points.size(),
                           decomposition.parts.size());
  }
  for (std::size_t i = 0; i < cover.points.size(); ++i) {
    if (cover.points[i].empty()) return invalidArgument("the hull cover has no points of part {}", i);
    for (const CoverPoint& p : cover.points[i]) {
      if (p.point >= 0 && p.point < decomposition.pointCount() && p.outward.allFinite()) continue;
      return invalidArgument(
          "the hull cover of part {} has point {}, displaced by ({}, {}, {}) m, expected points 0 "
          "to {} and finite displacements",
          i, p.point, p.outward.x(), p.outward.y(), p.outward.z(), decomposition.pointCount() - 1);
    }
  }
  return {};
}

}  // namespace

BodyPlan::BodyPlan(Decomposition decomposition) : decomposition_(std::move(decomposition)) {}
BodyPlan::~BodyPlan() = default;

std::span<const PointIndex> BodyPlan::candidates(PartIndex part) const {
  return parts_[part].candidates;
}

Result<std::shared_ptr<const BodyPlan>> BodyPlan::create(Decomposition decomposition, const Character& character,
                                                         std::optional<HullCover> cover) {
  LORICA_TRY_DO(check(decomposition, character));
  if (cover) {
    LORICA_TRY_DO(check(*cover, decomposition));
  }
  const std::shared_ptr<BodyPlan> plan(new BodyPlan(std::move(decomposition)));
  const std::vector<LiftedPoint> lifted = liftPoints(character, plan->decomposition_);
  plan->cover_ = cover ? std::move(*cover) : coverExactly(plan->decomposition_, lifted);
  std::vector<JointIndex> carriers(character.shapes.empty() ? 0 : character.jointFromModel.size(), kNoJoint);
  for (const ShapeOffset& shape : character.shapes.offsets) {
    carriers[shape.joint] = character.skeleton.joint(shape.joint).parent;
  }
  plan->lift(lifted, carriers);
  return std::shared_ptr<const BodyPlan>(plan);
}

Result<std::shared_ptr<const BodyPlan>> BodyPlan::create(Decomposition decomposition) {
  LORICA_TRY_DO(check(decomposition));
  const std::shared_ptr<BodyPlan> plan(new BodyPlan(std::move(decomposition)));
  plan->parts_.reserve(plan->decomposition_.parts.size());
  for (const Part& part : plan->decomposition_.parts) {
    PartPlan& own = plan->parts_.emplace_back();
    own.candidates = spanningPoints(plan->decomposition_, part);
    std::vector<CoverPoint>& chosen = plan->cover_.points.emplace_back();
    chosen.reserve(own.candidates.size());
    for (const PointIndex p : own.candidates) chosen.push_back({p, Vec3::Zero()});
  }
  return std::shared_ptr<const BodyPlan>(plan);
}

void BodyPlan::lift(std::span<const LiftedPoint> lifted, std::span<const JointIndex> carriers) {
  parts_.reserve(decomposition_.parts.size());
  for (const std::vector<CoverPoint>& chosen : cover_.points) {
    std::vector<LiftedPoint> points;
    points.reserve(chosen.size());
    for (const CoverPoint& p : chosen) points.push_back(pushed(lifted[p.point], p.outward));
    PartPlan& plan = parts_.emplace_back();
    plan.lifted.emplace(points, carriers);
    plan.candidates.reserve(chosen.size());
    for (const std::int32_t i : plan.lifted->order()) {
      plan.candidates.push_back(chosen[i].point);
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

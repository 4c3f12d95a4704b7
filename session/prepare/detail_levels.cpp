#include "session/prepare/detail_levels.h"

#include "acd/level_of_detail.h"

#include <chrono>
#include <utility>

namespace lorica {
namespace {

/// For each part of the decomposition, the part of the level that contains it.
std::vector<std::size_t> levelParts(const Decomposition& decomposition, std::size_t partCount) {
  std::vector<std::size_t> level(decomposition.parts.size());
  for (std::size_t p = 0; p < level.size(); ++p) {
    level[p] = p < partCount ? p : level[decomposition.splitFrom[p - 1]];
  }
  return level;
}

HullCover coverOfLevel(const BodyPlan& finest, std::size_t partCount) {
  const std::vector<std::size_t> level = levelParts(finest.decomposition(), partCount);
  HullCover cover = finest.coverage();
  const std::vector<std::vector<CoverPoint>> all = std::exchange(cover.points, {});
  cover.points.resize(partCount);
  cover.maxHullVertices = 0;
  for (std::size_t p = 0; p < all.size(); ++p) {
    std::vector<CoverPoint>& points = cover.points[level[p]];
    points.insert(points.end(), all[p].begin(), all[p].end());
  }
  return cover;
}

}  // namespace

std::shared_ptr<const BodyPlan> planOfLevel(const std::shared_ptr<const BodyPlan>& finest, const Character& character,
                                            int partCount) {
  const std::size_t parts = partCount;
  if (parts == finest->decomposition().parts.size()) return finest;
  Decomposition level = levelOfDetail(finest->decomposition(), partCount);
  // Without a tolerance the cover is exact: the points of the joined parts, which need fewer, are determined again.
  if (finest->coverage().tolerance == 0.0 && finest->coverage().maxHullVertices == 0) {
    return BodyPlan::create(std::move(level), character).value();
  }
  return BodyPlan::create(std::move(level), character, coverOfLevel(*finest, parts)).value();
}

DetailLevels::DetailLevels(std::shared_ptr<const BodyPlan> finest, const Character& character)
    : character_(character), made_(finest->decomposition().parts.size()) {
  made_.back() = std::move(finest);
}

void DetailLevels::ask(int partCount) {
  LORICA_CHECK(partCount >= 1 && partCount <= maxParts(), "a level of detail has between one part and all");
  asked_ = partCount;
}

std::shared_ptr<const BodyPlan> DetailLevels::take() {
  if (making_.valid() && making_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    std::shared_ptr<const BodyPlan> plan = making_.get();
    const std::size_t parts = plan->decomposition().parts.size();
    made_[parts - 1] = std::move(plan);
  }
  if (!asked_) return nullptr;
  const std::shared_ptr<const BodyPlan>& wanted = made_[*asked_ - 1];
  if (wanted != nullptr) {
    asked_.reset();
    return wanted;
  }
  if (!making_.valid()) {
    making_ = std::async(std::launch::async, [finest = made_.back(), character = &character_, parts = *asked_] {
      return planOfLevel(finest, *character, parts);
    });
  }
  return nullptr;
}

}  // namespace lorica

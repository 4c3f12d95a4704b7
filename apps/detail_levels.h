#pragma once

#include "collision/live/body_plan.h"
#include "skinning/character.h"

#include <future>
#include <memory>
#include <optional>
#include <vector>

namespace lorica {

/// A body of as many parts as are wanted, of those that a decomposition holds: its first parts, each with all that were
/// split from it. Made as the finest body was: covering the surface exactly, or by the points that a promise chose. Of
/// those, parts that were joined have all, so that the promise holds; a bound of their number does not.
/// @param partCount  1 to the parts of `finest`
[[nodiscard]] std::shared_ptr<const BodyPlan> planOfLevel(const std::shared_ptr<const BodyPlan>& finest,
                                                          const Character& character, int partCount);

/// The levels of detail of a body, made when they are asked for, off the frame, and then kept.
class DetailLevels {
 public:
  /// @param finest     of all parts
  /// @param character  outlives this
  DetailLevels(std::shared_ptr<const BodyPlan> finest, const Character& character);

  [[nodiscard]] int mostParts() const { return static_cast<int>(made_.size()); }
  /// Begins to make a level, or does so once the one that is being made is done. Of several only the last one counts.
  /// @param partCount  1 to mostParts()
  void ask(int partCount);
  /// What was asked for last, once it is there, and only once; null else. Never waits.
  [[nodiscard]] std::shared_ptr<const BodyPlan> take();
  /// Parts of the level that was asked for and not taken yet; none where there is none.
  [[nodiscard]] std::optional<int> asked() const { return asked_; }

 private:
  const Character& character_;
  std::vector<std::shared_ptr<const BodyPlan>> made_;  // by parts - 1; null = not yet
  std::optional<int> asked_;
  std::future<std::shared_ptr<const BodyPlan>> making_;
};

}  // namespace lorica

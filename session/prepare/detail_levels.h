#pragma once

#include "collision/live/body_plan.h"
#include "skinning/character.h"

#include <future>
#include <memory>
#include <optional>
#include <vector>

namespace lorica {

/// A coarser body with fewer parts: the first parts of the decomposition, each joined with all parts that were split
/// from it. It has the same kind of hull cover as the finest body. Joined parts keep all chosen points of their
/// members, so the tolerance is still met, but a limit on the number of vertices is not.
/// @param partCount  1 to the number of parts of `finest`
[[nodiscard]] std::shared_ptr<const BodyPlan> planOfLevel(const std::shared_ptr<const BodyPlan>& finest,
                                                          const Character& character, int partCount);

/// The levels of detail of a body. They are made on demand in another thread, and then kept.
class DetailLevels {
 public:
  /// @param finest     the body with all parts
  /// @param character  outlives this
  DetailLevels(std::shared_ptr<const BodyPlan> finest, const Character& character);

  [[nodiscard]] int maxParts() const { return made_.size(); }
  /// Starts making a level, now or when the one in progress is done. Only the last of several requests counts.
  /// @param partCount  1 to maxParts()
  void ask(int partCount);
  /// Returns the level requested last, once, when it is ready; else null. Never blocks.
  [[nodiscard]] std::shared_ptr<const BodyPlan> take();
  /// Number of parts of the level that was requested and not yet taken; none if there is no request.
  [[nodiscard]] std::optional<int> asked() const { return asked_; }

 private:
  const Character& character_;
  std::vector<std::shared_ptr<const BodyPlan>> made_;  // by parts - 1; null = not yet
  std::optional<int> asked_;
  std::future<std::shared_ptr<const BodyPlan>> making_;
};

}  // namespace lorica

#pragma once

#include "session/contact_events.h"
#include "session/scenes/hit_counter.h"
#include "viewer/renderer/window_values.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// The hits of a run's targets, counted frame by frame. Without targets it does nothing.
class TargetHits {
 public:
  explicit TargetHits(std::vector<HitTarget> targets);

  /// Adds the session's last frame.
  void add(const Session& session);

  /// Of each target.
  [[nodiscard]] std::span<const TargetScore> scores() const { return scores_; }
  /// For the caption of a picture: "   hits: bag 5, board 0"; empty without targets.
  [[nodiscard]] std::string caption() const;
  [[nodiscard]] const HitCounter& counter() const { return counter_; }

 private:
  HitCounter counter_;
  std::vector<TargetScore> scores_;
  std::optional<ContactEvents> events_;
};

}  // namespace lorica

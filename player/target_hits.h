#pragma once

#include "geometry/text.h"
#include "session/contact_events.h"
#include "session/scenes/hit_counter.h"
#include "viewer/window/window_values.h"

#include <nlohmann/json_fwd.hpp>

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
  /// Adds "targets": of each its name, "hits", and those of each limb.
  void addTo(nlohmann::ordered_json& json) const;
  /// Adds a line for each target.
  void addTo(Report& report) const;

 private:
  HitCounter counter_;
  std::vector<TargetScore> scores_;
  std::optional<ContactEvents> events_;
};

}  // namespace lorica

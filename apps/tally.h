#pragma once

#include "apps/report.h"
#include "session/session.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <utility>
#include <vector>

namespace lorica {

/// What is counted and timed while a session runs.
class Tally {
 public:
  /// Takes the session's last frame into account.
  void add(const Session& session);
  /// A new session of the same recording follows: its contacts start afresh.
  void restart() { touching_.clear(); }

  [[nodiscard]] int frames() const { return static_cast<int>(stages_.size()); }
  /// Contact points between body and props, summed over the frames.
  [[nodiscard]] long long contacts() const { return contacts_; }
  /// How often a part and a prop came together that were apart in the frame before.
  [[nodiscard]] long long touches() const { return touches_; }
  [[nodiscard]] int propCount() const { return static_cast<int>(touched_.size()); }
  /// How many different props were touched.
  [[nodiscard]] int propsTouched() const;

  /// "frames", "contacts", "touches", "propsTouched" and "stages": each stage's median and p95 [us].
  void addTo(nlohmann::ordered_json& json) const;
  /// One line a stage.
  void addTo(Report& report) const;

 private:
  std::vector<StageTimes> stages_;
  std::vector<std::pair<PartIndex, int>> touching_;  // sorted pairs of the last frame
  std::vector<std::pair<PartIndex, int>> now_;
  std::vector<std::uint8_t> touched_;  // one flag a prop
  long long contacts_ = 0;
  long long touches_ = 0;
};

}  // namespace lorica

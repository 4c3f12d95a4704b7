#pragma once

#include "prepare/host.h"

#include <atomic>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lorica {

/// The host of work in a thread of its own: another thread sees how far it is and may cancel it.
class MonitoredHost final : public Host {
 public:
  struct Progress {
    std::string label;   ///< the task: "Decomposing mannequin"; empty = not known yet
    double share = 0.0;  ///< of the whole work that is done, 0 to 1; never decreases

    /// For a window: `label`, or "Loading".
    [[nodiscard]] std::string_view title() const { return label.empty() ? std::string_view("Loading") : label; }
  };

  /// @param parent  gets warnings and says too whether to stop; outlives this one
  explicit MonitoredHost(Host& parent);

  /// How many tasks a stage has is not known before, so each takes most of what remains of it.
  void beginTask(const std::string& label, const std::string& unit) override;
  void report(int done, int total) override;
  void beginStage(double from, double to) override;
  void endStage() override;
  [[nodiscard]] bool cancelled() const override { return cancelled_ || parent_.cancelled(); }
  [[nodiscard]] bool inBackground() const override { return true; }
  void tell(const std::string& sentence) override { parent_.tell(sentence); }
  void warn(const std::string& sentence) override { parent_.warn(sentence); }

  // For the other thread.
  [[nodiscard]] Progress progress() const;
  void cancel() { cancelled_ = true; }
  /// Whether cancel() was called.
  [[nodiscard]] bool stopped() const { return cancelled_; }

 private:
  void reach(double share);

  Host& parent_;
  std::atomic<bool> cancelled_ = false;
  mutable std::mutex mutex_;
  Progress progress_;
  // Of the working thread only: shares at the ends of the present stage and task.
  std::vector<std::pair<double, double>> outer_;  // stages around the present one
  double from_ = 0.0, to_ = 1.0;
  double taskFrom_ = 0.0, taskTo_ = 1.0;
};

}  // namespace lorica

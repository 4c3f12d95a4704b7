#pragma once

#include "player/work_monitor.h"

#include <chrono>
#include <functional>
#include <string>

namespace lorica {

/// Progress of long work on standard error: a bar in a terminal, else a line every ten seconds. In a thread with a
/// WorkMonitor it is reported to that instead.
class ProgressBar {
 public:
  /// @param label  the task: "Decomposing mannequin"
  /// @param unit   the counted items: "parts"
  ProgressBar(const std::string& label, std::string unit);
  /// Removes the bar from the terminal.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// @param total  0 or less if unknown
  void update(int done, int total);
  /// Whether the work should stop: Ctrl-C, or the monitor says so.
  [[nodiscard]] bool cancelled() const;

 private:
  using Clock = std::chrono::steady_clock;
  void draw(int done, int total, double seconds) const;

  std::string label_;
  std::string unit_;
  bool terminal_;
  Clock::time_point start_;
  Clock::time_point lastShown_;
  bool shown_ = false;
  WorkMonitor* monitor_;  // null = none
};

/// A progress callback that updates the bar and stops when cancelled(). @param bar  outlives the callback
[[nodiscard]] std::function<bool(int done, int total)> progressOf(ProgressBar& bar);

}  // namespace lorica

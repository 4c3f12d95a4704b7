#pragma once

#include <chrono>
#include <string>

namespace lorica {

/// How far long work is, on standard error: a bar that redraws itself in a terminal, a line every ten seconds
/// elsewhere.
class ProgressBar {
 public:
  /// @param label  what is being done: "Decomposing mannequin"
  /// @param unit   what is counted: "parts"
  ProgressBar(std::string label, std::string unit);
  /// Removes the bar from the terminal.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// @param total  0 or less when nobody knows
  void update(int done, int total);

 private:
  using Clock = std::chrono::steady_clock;
  void draw(int done, int total, double seconds) const;

  std::string label_;
  std::string unit_;
  bool terminal_;
  Clock::time_point start_;
  Clock::time_point lastShown_;
  bool shown_ = false;
};

}  // namespace lorica

#pragma once

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>

namespace lorica {

/// Of a monotonic clock [s].
[[nodiscard]] inline double secondsOf(std::chrono::steady_clock::time_point time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}
[[nodiscard]] inline double now() {
  return secondsOf(std::chrono::steady_clock::now());
}

[[nodiscard]] inline double microsecondsBetween(std::chrono::steady_clock::time_point begin,
                                                std::chrono::steady_clock::time_point end) {
  return std::chrono::duration<double, std::micro>(end - begin).count();
}

/// How long counted work will take, from what is done. The end that was once expected is never put off, so that the
/// time left falls with the clock or faster; work that takes longer than that has no estimate.
class TimeLeft {
 public:
  /// @param total    0 or less if unknown
  /// @param seconds  since the work began
  /// @return none as long as it cannot be told [s]
  std::optional<double> update(int done, int total, double seconds) {
    if (total <= 0 || done <= 0) return std::nullopt;
    if (done != done_) end_ = std::min(end_, seconds * total / done);
    done_ = done;
    if (done >= total || seconds <= kSettled || end_ <= seconds) return std::nullopt;
    return end_ - seconds;
  }

 private:
  static constexpr double kSettled = 2.0;  ///< an estimate before says nothing [s]
  int done_ = 0;
  double end_ = std::numeric_limits<double>::infinity();
};

}  // namespace lorica

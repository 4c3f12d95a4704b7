#pragma once

#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <numeric>
#include <vector>

namespace lorica::test {

/// Resident memory of this process over a long run [MiB].
class MemoryWatch {
 public:
  /// @param warmUp  simulated time before memory counts [s]
  explicit MemoryWatch(double warmUp) : warmUp_(warmUp) {}

  /// Measures every 20 simulated seconds. @param seconds  simulated so far
  void watch(double seconds) {
    if (seconds < next_) return;
    next_ += kEvery;
    const double mebibytes = resident();
    peak_ = std::max(peak_, mebibytes);
    if (seconds >= warmUp_) measured_.push_back(mebibytes);
  }

  /// Whether there is enough to compare.
  [[nodiscard]] bool hasThirds() const { return measured_.size() >= 3; }
  /// Means of the first and last third after the warm-up.
  [[nodiscard]] double firstThird() const { return meanFrom(0); }
  [[nodiscard]] double lastThird() const { return meanFrom(measured_.size() - measured_.size() / 3); }
  [[nodiscard]] double peak() const { return peak_; }

 private:
  static constexpr double kEvery = 20.0;  ///< simulated [s]

  static double resident() {
    std::ifstream statm("/proc/self/statm");
    double size = 0.0, pages = 0.0;
    statm >> size >> pages;
    return pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
  }
  [[nodiscard]] double meanFrom(std::size_t from) const {
    const auto third = static_cast<std::ptrdiff_t>(measured_.size() / 3);
    const auto begin = measured_.begin() + static_cast<std::ptrdiff_t>(from);
    return std::accumulate(begin, begin + third, 0.0) / static_cast<double>(third);
  }

  double warmUp_, next_ = 0.0, peak_ = 0.0;
  std::vector<double> measured_;
};

}  // namespace lorica::test

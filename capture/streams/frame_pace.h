#pragma once

#include <cstdint>
#include <optional>

namespace lorica {

/// Measures the pace of frames that arrive unevenly, and says when to show each to make it even.
///
/// A frame is expected one mean step after the one before, corrected by a sixteenth of what it came earlier or later,
/// as RFC 3550 filters. It is due `delay` after that, and never before it arrives. A pause of half a second begins
/// anew.
class FramePace {
 public:
  /// @param delay  [s]; 0: each frame is due when it arrives
  explicit FramePace(double delay) : delay_(delay) {}

  /// @param arrival  of the next frame; does not decrease [s]
  /// @return when it is due; does not decrease [s]
  double due(double arrival);

  /// Mean deviation of the time between frames from its mean [s].
  [[nodiscard]] double jitter() const { return jitter_; }
  /// Frames that arrived after they should have been shown.
  [[nodiscard]] std::int64_t late() const { return late_; }

 private:
  double delay_;
  std::optional<double> last_;  ///< arrival of the last frame [s]
  double meanStep_ = 0.0;
  double expected_ = 0.0;
  double due_ = 0.0;
  double jitter_ = 0.0;
  std::int64_t late_ = 0;
};

}  // namespace lorica

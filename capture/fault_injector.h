#pragma once

#include "capture/skeleton_frame.h"
#include "geometry/random_numbers.h"

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace lorica {

/// Fault rates that imitate trackers and networks. Docs: docs/SESSIONS.md.
struct FaultSettings {
  double dropout = 0.0;    ///< fraction of joints lost (confidence 0), in runs of 5 frames on average
  double jitter = 0.0;     ///< standard deviation of seen joint positions along each axis [m]
  double swap = 0.0;       ///< fraction of frames with left and right exchanged, in runs of 10 frames on average
  double late = 0.0;       ///< fraction of frames delayed by 0.03 to 0.15 s; frames they overtake are dropped
  double freeze = 0.0;     ///< fraction of frames that repeat an earlier frame, in runs of 15 frames on average
  std::uint64_t seed = 1;  ///< the same seed gives the same faults

  bool operator==(const FaultSettings&) const = default;  ///< exactly
  /// Whether it changes anything
  [[nodiscard]] bool any() const { return dropout > 0.0 || jitter > 0.0 || swap > 0.0 || late > 0.0 || freeze > 0.0; }
  /// Whether any fault affects single joints. Skeletal motion has no such faults.
  [[nodiscard]] bool ofJoints() const { return dropout > 0.0 || jitter > 0.0 || swap > 0.0; }
};

/// Parses "dropout=0.1,jitter=0.02,swap,late,freeze,seed=7": comma-separated names, each at most once, with an optional
/// value. Defaults: dropout 0.1, jitter 0.02, swap 0.02, late 0.05, freeze 0.05. Fractions are 0 to 1, jitter is 0 to 1
/// m.
/// @return the settings, or an error with found and expected
[[nodiscard]] Result<FaultSettings> parseFaults(std::string_view text);

/// Whether each is 0 to 1.
/// @return an error with found and expected
[[nodiscard]] Result<void> checkFaults(const FaultSettings& settings);

/// Text that parseFaults() reads back as the same settings, bit for bit; empty if there are no faults.
[[nodiscard]] std::string textOf(const FaultSettings& settings);

/// Two-state Markov chain that tells for each frame whether a fault that comes in runs is active.
class FaultRuns {
 public:
  /// @param share   fraction of all frames, 0 to 1
  /// @param length  mean run length [frames]; runs are longer if `share` is not reachable otherwise
  FaultRuns(double share, double length, std::uint64_t seed);
  /// Advances to the next frame and returns its state.
  [[nodiscard]] bool next();
  [[nodiscard]] RandomNumbers& random() { return random_; }  ///< of this chain, for other choices of the same fault

 private:
  RandomNumbers random_;
  double share_;
  double begin_ = 0.0, end_ = 0.0;  ///< probabilities that a run starts or ends at a frame
  bool on_ = false, started_ = false;
};

/// Faults of whole frames, for poses as well as joints.
class FrameFaults {
 public:
  /// All faults but those of single joints.
  explicit FrameFaults(const FaultSettings& settings);
  /// Delay of the next frame [s]; 0 = on time.
  [[nodiscard]] double lateness();
  /// Whether the next frame repeats the previous one.
  [[nodiscard]] bool frozen() { return freeze_.next(); }

 private:
  double late_;
  RandomNumbers random_;
  FaultRuns freeze_;
};

/// Max number of frames that one late frame can overtake.
inline constexpr int kMaxOvertaken = 1000;

/// Wraps a source and adds faults to its joints. Confidence is lowered only for lost joints; a tracker is unaware of
/// swaps, jitter and freezes. Times increase as in the source. Allocates nothing per frame.
[[nodiscard]] std::unique_ptr<SkeletonSource> makeFaultInjector(std::unique_ptr<SkeletonSource> source,
                                                                const FaultSettings& settings);

}  // namespace lorica

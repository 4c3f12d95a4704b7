#pragma once

#include "capture/skeleton_frame.h"
#include "geometry/random_numbers.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace lorica {

/// Faults as trackers and networks make them, in doses. Docs: docs/SESSIONS.md.
struct FaultSettings {
  double dropout = 0.0;    ///< share of joints that are lost (confidence 0), each in runs of 5 frames on average
  double jitter = 0.0;     ///< standard deviation of the places of seen joints along each axis [m]
  double swap = 0.0;       ///< share of frames in which left and right are exchanged, in runs of 10 frames on average
  double late = 0.0;       ///< share of frames that come 0.03 to 0.15 s late; those overtaken are lost
  double freeze = 0.0;     ///< share of frames that repeat what was seen before, in runs of 15 frames on average
  std::uint64_t seed = 1;  ///< the same seed, the same faults

  [[nodiscard]] bool any() const { return dropout > 0.0 || jitter > 0.0 || swap > 0.0 || late > 0.0 || freeze > 0.0; }
  /// Faults of single joints, which a motion of bones has not.
  [[nodiscard]] bool ofJoints() const { return dropout > 0.0 || jitter > 0.0 || swap > 0.0; }
};

/// Reads "dropout=0.1,jitter=0.02,swap,late,freeze,seed=7": names parted by commas, each once, each with a dose or with
/// the default one: dropout 0.1, jitter 0.02, swap 0.02, late 0.05, freeze 0.05. Shares are 0 to 1, jitter is 0 to 1 m.
/// @return the settings, or a sentence that says what was found and expected
[[nodiscard]] Result<FaultSettings> parseFaults(std::string_view text);

/// What parseFaults() reads as the same settings, bit for bit; empty where there are no faults.
[[nodiscard]] std::string textOf(const FaultSettings& settings);

/// Whether a fault that comes in runs is on, frame by frame: a chain of two states.
class FaultRuns {
 public:
  /// @param share   of all frames, 0 to 1
  /// @param length  mean length of a run [frames]; runs are longer where the share could not be reached otherwise
  FaultRuns(double share, double length, std::uint64_t seed);
  /// The next frame.
  [[nodiscard]] bool next();
  [[nodiscard]] RandomNumbers& random() { return random_; }

 private:
  RandomNumbers random_;
  double share_;
  double begin_ = 0.0, end_ = 0.0;  ///< chances that a run begins or ends at a frame
  bool on_ = false, started_ = false;
};

/// The faults of whole frames, which poses have as joints do.
class FrameFaults {
 public:
  explicit FrameFaults(const FaultSettings& settings);
  /// How late the next frame comes [s]; 0 = in time.
  [[nodiscard]] double lateness();
  /// Whether the next frame shows what the one before did.
  [[nodiscard]] bool frozen() { return freeze_.next(); }

 private:
  double late_;
  RandomNumbers random_;
  FaultRuns freeze_;
};

/// Frames that one late frame can overtake.
inline constexpr int kMostOvertaken = 1000;

/// Joints from a source, with faults. Confidence is lowered where a joint is lost; a tracker that swaps, shakes or
/// freezes does not know. Times rise as the source's do. Allocates nothing per frame.
[[nodiscard]] std::unique_ptr<SkeletonSource> makeFaultInjector(std::unique_ptr<SkeletonSource> source,
                                                                const FaultSettings& settings);

}  // namespace lorica

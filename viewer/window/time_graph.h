#pragma once

#include "viewer/renderer/window_values.h"

#include <array>
#include <span>

namespace lorica {

/// The times of the stages of the last frames, to be drawn as a graph. Allocates nothing.
class TimeGraph {
 public:
  static constexpr int kFrames = 200;
  static constexpr int kMaxStages = 8;

  /// Adds the next frame. If the stages differ from those before, the graph is cleared first.
  /// @param stages  up to kMaxStages
  void add(std::span<const TimedStage> stages);
  void clear() { count_ = 0; }

  [[nodiscard]] int frameCount() const { return count_ < kFrames ? count_ : kFrames; }
  [[nodiscard]] int stageCount() const { return stageCount_; }
  [[nodiscard]] const char* name(int stage) const { return names_[stage]; }
  /// @param frame  0 = oldest stored frame
  [[nodiscard]] double milliseconds(int frame, int stage) const;
  [[nodiscard]] double total(int frame) const;
  /// Mean of the last 30 frames, for readability.
  [[nodiscard]] double mean(int stage) const;
  /// Total time of the longest stored frame [ms].
  [[nodiscard]] double longest() const;

 private:
  std::array<const char*, kMaxStages> names_{};
  std::array<std::array<float, kMaxStages>, kFrames> frames_{};  // a ring
  int stageCount_ = 0;
  int count_ = 0;
};

}  // namespace lorica

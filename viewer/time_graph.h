#pragma once

#include "viewer/window_values.h"

#include <array>
#include <span>

namespace lorica {

/// The times of the last frames, stage by stage, to be drawn as a graph. Allocates nothing.
class TimeGraph {
 public:
  static constexpr int kFrames = 200;
  static constexpr int kMostStages = 8;

  /// Takes the next frame. Where its stages are others than before, the graph begins anew. @param stages  up to
  /// kMostStages
  void add(std::span<const TimedStage> stages);
  void clear() { count_ = 0; }

  [[nodiscard]] int frameCount() const { return count_ < kFrames ? count_ : kFrames; }
  [[nodiscard]] int stageCount() const { return stageCount_; }
  [[nodiscard]] const char* name(int stage) const { return names_[static_cast<std::size_t>(stage)]; }
  /// @param frame  0 = the oldest that is kept
  [[nodiscard]] double milliseconds(int frame, int stage) const;
  [[nodiscard]] double total(int frame) const;
  /// Mean of the last 30 frames: a number that people can read.
  [[nodiscard]] double mean(int stage) const;
  /// The longest frame that is kept [ms].
  [[nodiscard]] double longest() const;

 private:
  std::array<const char*, kMostStages> names_{};
  std::array<std::array<float, kMostStages>, kFrames> frames_{};  // a ring
  int stageCount_ = 0;
  int count_ = 0;
};

}  // namespace lorica

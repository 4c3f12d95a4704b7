#include "viewer/time_graph.h"

#include "geometry/result.h"

#include <algorithm>
#include <string_view>

namespace lorica {

void TimeGraph::add(std::span<const TimedStage> stages) {
  CHECK(stages.size() <= static_cast<std::size_t>(kMostStages), "the graph has room for TimeGraph::kMostStages");
  const bool same = std::ranges::equal(
      stages, std::span(names_).first(static_cast<std::size_t>(stageCount_)),
      [](const TimedStage& stage, const char* name) { return std::string_view(stage.name) == name; });
  if (!same) clear();
  stageCount_ = static_cast<int>(stages.size());
  auto& frame = frames_[static_cast<std::size_t>(count_ % kFrames)];
  for (std::size_t s = 0; s < stages.size(); ++s) {
    names_[s] = stages[s].name;
    frame[s] = static_cast<float>(stages[s].milliseconds);
  }
  ++count_;
  if (count_ == 2 * kFrames) count_ = kFrames;  // the same place in the ring
}

double TimeGraph::milliseconds(int frame, int stage) const {
  const int first = count_ < kFrames ? 0 : count_ % kFrames;
  return frames_[static_cast<std::size_t>((first + frame) % kFrames)][static_cast<std::size_t>(stage)];
}

double TimeGraph::total(int frame) const {
  double sum = 0.0;
  for (int s = 0; s < stageCount_; ++s) sum += milliseconds(frame, s);
  return sum;
}

double TimeGraph::mean(int stage) const {
  const int last = frameCount();
  const int first = std::max(0, last - 30);
  double sum = 0.0;
  for (int f = first; f < last; ++f) sum += milliseconds(f, stage);
  return last > first ? sum / (last - first) : 0.0;
}

double TimeGraph::longest() const {
  double most = 0.0;
  for (int f = 0; f < frameCount(); ++f) most = std::max(most, total(f));
  return most;
}

}  // namespace lorica

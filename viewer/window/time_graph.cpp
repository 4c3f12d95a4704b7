#include "viewer/window/time_graph.h"

#include "geometry/counts.h"
#include "geometry/result.h"

#include <algorithm>
#include <string_view>

namespace lorica {

void TimeGraph::add(std::span<const TimedStage> stages) {
  LORICA_CHECK(countOf(stages) <= kMaxStages, "more stages than TimeGraph::kMaxStages");
  const bool same = std::ranges::equal(
      stages, std::span(names_).first(stageCount_),
      [](const TimedStage& stage, const char* name) { return std::string_view(stage.name) == name; });
  if (!same) clear();
  stageCount_ = stages.size();
  auto& frame = frames_[count_ % kFrames];
  for (std::size_t s = 0; s < stages.size(); ++s) {
    names_[s] = stages[s].name;
    frame[s] = stages[s].milliseconds;
  }
  ++count_;
  if (count_ == 2 * kFrames) count_ = kFrames;  // the same position in the ring
}

double TimeGraph::milliseconds(int frame, int stage) const {
  const int first = count_ < kFrames ? 0 : count_ % kFrames;
  return frames_[(first + frame) % kFrames][stage];
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
  double max = 0.0;
  for (int f = 0; f < frameCount(); ++f) max = std::max(max, total(f));
  return max;
}

}  // namespace lorica

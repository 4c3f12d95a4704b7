#include "bake/schedule.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <queue>
#include <random>

#include "geometry/counts.h"

namespace lorica {
namespace {

/// @param freeAt    when each core has ended its last item [s]
/// @param allTaken  when the last item was started [s]
Schedule summary(std::span<const double> seconds, std::span<const double> freeAt, double allTaken) {
  Schedule schedule;
  schedule.cores = countOf(freeAt);
  schedule.items = seconds.size();
  schedule.seconds = *std::ranges::max_element(freeAt);
  schedule.tail = schedule.seconds - allTaken;
  schedule.longest = seconds.empty() ? 0.0 : *std::ranges::max_element(seconds);
  const double work = std::accumulate(seconds.begin(), seconds.end(), 0.0);
  if (schedule.seconds > 0.0) schedule.idleShare = std::max(0.0, 1.0 - work / (schedule.seconds * schedule.cores));
  return schedule;
}

}  // namespace

Schedule simulateSchedule(std::span<const double> seconds, std::span<const std::size_t> order, int cores) {
  std::priority_queue<double, std::vector<double>, std::greater<>> freeAt;
  for (int c = 0; c < cores; ++c) freeAt.push(0.0);
  double allTaken = 0.0;
  for (const std::size_t item : order) {
    allTaken = freeAt.top();
    freeAt.pop();
    freeAt.push(allTaken + seconds[item]);
  }
  std::vector<double> ends;
  for (; !freeAt.empty(); freeAt.pop()) ends.push_back(freeAt.top());
  return summary(seconds, ends, allTaken);
}

Schedule simulateShards(std::span<const double> seconds, std::span<const std::size_t> shardOf, int cores) {
  std::vector<double> ends(cores, 0.0);
  for (std::size_t i = 0; i < seconds.size(); ++i) ends[shardOf[i]] += seconds[i];
  // The first core that has nothing to do leaves the others alone with the rest.
  return summary(seconds, ends, *std::ranges::min_element(ends));
}

std::vector<std::size_t> drawItems(std::size_t measured, std::size_t count) {
  std::mt19937_64 random(20180801);
  std::vector<std::size_t> drawn(count);
  for (std::size_t& item : drawn) item = random() % measured;
  return drawn;
}

}  // namespace lorica

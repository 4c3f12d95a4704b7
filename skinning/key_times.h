#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace lorica {

/// Position of a time between two keys: `fraction` is 0 at key `first`, 1 at the next key.
struct BetweenKeys {
  std::size_t first = 0;
  double fraction = 0.0;
  double seconds = 0.0;  ///< between the two keys; 0 outside the keys
};

/// @param times  strictly increasing, at least one [s]
[[nodiscard]] inline BetweenKeys locateKeys(std::span<const double> times, double time) {
  if (!(time > times.front())) return {};
  if (time >= times.back()) return {times.size() - 1, 0.0, 0.0};
  const auto after = std::upper_bound(times.begin(), times.end(), time);
  const auto first = static_cast<std::size_t>(after - times.begin()) - 1;
  const double seconds = times[first + 1] - times[first];
  return {first, (time - times[first]) / seconds, seconds};
}

}  // namespace lorica

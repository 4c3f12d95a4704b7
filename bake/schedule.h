#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace lorica {

/// How long a list would take, and how well its cores would be used.
struct Schedule {
  int cores = 0;
  std::size_t items = 0;
  double seconds = 0.0;    ///< until the last item is done
  double idleShare = 0.0;  ///< of the cores' time until then
  double tail = 0.0;       ///< from the moment when no item waits any more to the end [s]
  double longest = 0.0;    ///< item [s]
};

/// Items on cores as `lorica bake` does them: the next item of the order goes to the core that is free first. The order
/// is that of a size which only roughly tells the time.
/// @param seconds  of each item, measured
/// @param order    the items, the first to start first
[[nodiscard]] Schedule simulateSchedule(std::span<const double> seconds, std::span<const std::size_t> order, int cores);

/// The same with a fixed share of the items for each core, as --shard divides them.
/// @param shardOf  for each item, below `cores`
[[nodiscard]] Schedule simulateShards(std::span<const double> seconds, std::span<const std::size_t> shardOf, int cores);

/// A larger list: `count` times drawn from the measured ones with a fixed seed.
[[nodiscard]] std::vector<std::size_t> drawItems(std::size_t measured, std::size_t count);

}  // namespace lorica

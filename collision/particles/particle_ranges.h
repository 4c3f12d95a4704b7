#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstddef>

namespace lorica {

inline constexpr std::size_t kParticlesAtOnce = 1024;

/// Calls work(begin, end) for ranges that together are 0 to count, on all threads. Internal to the particle
/// simulations; the division into ranges does not affect their results.
template <class Work>
void forRanges(std::size_t count, std::size_t atOnce, const Work& work) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, atOnce),
                    [&](const tbb::blocked_range<std::size_t>& range) { work(range.begin(), range.end()); });
}

}  // namespace lorica

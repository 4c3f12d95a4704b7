#pragma once

#ifndef LORICA_SERIAL
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>
#endif

#include <algorithm>
#include <cstddef>
#include <optional>
#include <type_traits>
#include <utility>

namespace lorica {

// Steps that do not depend on each other, on the threads of withThreads(), else of all cores. With
// LORICA_SERIAL, as the core alone is built, there are no threads: the steps come in order, with the same results. For
// sources, not for installed headers.

#ifdef LORICA_SERIAL

template <typename Index, typename Step>
void parallelFor(Index first, Index last, const Step& step) {
  for (; first < last; ++first) step(first);
}

template <typename Step>
void parallelPieces(std::size_t count, const Step& step) {
  parallelFor(std::size_t{0}, count, step);
}

template <typename Step>
void parallelRanges(std::size_t count, std::size_t /*least*/, const Step& step) {
  if (count > 0) step(std::size_t{0}, count);
}

template <typename First, typename Second>
void parallelBoth(const First& first, const Second& second) {
  first();
  second();
}

template <typename Work>
auto withThreads(int /*threads*/, const Work& work) {
  return work();
}

inline std::size_t threadsHere() {
  return 1;
}

#else

/// step(i) for each i from first on and below last.
template <typename Index, typename Step>
void parallelFor(Index first, Index last, const Step& step) {
  tbb::parallel_for(first, last, step);
}

/// step(i) for each i below count, where each takes long: a thread takes one after the other.
template <typename Step>
void parallelPieces(std::size_t count, const Step& step) {
  tbb::parallel_for(std::size_t{0}, count, step, tbb::simple_partitioner());
}

/// step(begin, end) for ranges, mostly of at least so many, that together are 0 to count.
template <typename Step>
void parallelRanges(std::size_t count, std::size_t least, const Step& step) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, least),
                    [&](const auto& range) { step(range.begin(), range.end()); });
}

/// Both.
template <typename First, typename Second>
void parallelBoth(const First& first, const Second& second) {
  tbb::parallel_invoke(first, second);
}

/// What work() returns, whose steps run on so many threads, even if the machine has fewer cores: so tests can show that
/// the result does not depend on them. @param threads  0 = all that the machine has
template <typename Work>
auto withThreads(int threads, const Work& work) {
  using Control = tbb::global_control;
  const std::size_t known = Control::active_value(Control::max_allowed_parallelism);
  const Control allowed(Control::max_allowed_parallelism, std::max<std::size_t>(known, threads));
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  std::optional<std::invoke_result_t<Work> > result;
  arena.execute([&] { result.emplace(work()); });
  return std::move(*result);
}

/// How many threads may share the work: how much it pays to do before it is known to be needed. No result may depend on
/// it.
inline std::size_t threadsHere() {
  return tbb::this_task_arena::max_concurrency();
}

#endif

/// step(i) for each i below count.
template <typename Index, typename Step>
void parallelFor(Index count, const Step& step) {
  parallelFor(Index{0}, count, step);
}

}  // namespace lorica

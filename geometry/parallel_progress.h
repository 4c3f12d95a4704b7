#pragma once

#include "geometry/interrupt.h"
#include "geometry/threads.h"

#include <atomic>
#include <cstddef>
#include <functional>
#include <mutex>

namespace lorica {

/// Gets how much of the work is done; returns false to stop it.
using WorkProgress = std::function<bool(int done, int count)>;

/// Does independent pieces of work on several threads, which ask the interrupt of this one. For sources that link TBB,
/// not for installed headers.
/// @param threads   0 = all that the machine has
/// @param progress  called after each piece, by one thread at a time; after it stops the work, or workStopped(), no
/// piece begins. None = as if it never did
/// @return false if it was stopped
template <typename Work>
bool inParallel(std::size_t count, int threads, const WorkProgress& progress, const Work& work) {
  std::mutex mutex;
  int done = 0;
  std::atomic<bool> stopped = false;
  const Interrupt* interrupt = InterruptScope::current();
  const auto piece = [&](std::size_t i) {
    const InterruptScope scope(interrupt);
    if (!stopped && workStopped()) stopped = true;
    if (stopped) return;
    work(i);
    const std::scoped_lock lock(mutex);
    ++done;
    if (progress && !progress(done, static_cast<int>(count))) stopped = true;
  };
  return withThreads(threads, [&] {
    parallelPieces(count, piece);
    return !stopped;
  });
}

}  // namespace lorica

#pragma once

#include "geometry/result.h"

#include <functional>
#include <utility>

namespace lorica {

/// Whether work should stop. It is asked often, by every thread of the work: for each line, list or frame that is read.
using Interrupt = std::function<bool()>;

/// While it lives, the work of this thread asks an interrupt: every reader ends soon after that says true, with
/// ErrorCode::kCancelled. Threads that work for another one take over its interrupt.
///
///     const Interrupt stops = [&] { return host.cancelled(); };
///     const InterruptScope scope(&stops);
class InterruptScope {
 public:
  /// @param interrupt  outlives the scope; null = nothing stops the work. That of an outer scope is not asked meanwhile
  explicit InterruptScope(const Interrupt* interrupt) : outer_(std::exchange(current_, interrupt)) {}
  ~InterruptScope() { current_ = outer_; }
  InterruptScope(const InterruptScope&) = delete;
  InterruptScope& operator=(const InterruptScope&) = delete;

  /// What the work of this thread asks, for a scope of another thread; null = nothing.
  [[nodiscard]] static const Interrupt* current() { return current_; }

 private:
  inline static thread_local const Interrupt* current_ = nullptr;
  const Interrupt* outer_;
};

/// Whether the work of this thread should stop.
[[nodiscard]] inline bool workStopped() {
  const Interrupt* interrupt = InterruptScope::current();
  return interrupt != nullptr && (*interrupt)();
}

/// workStopped() for inner loops, where asking each time would cost more than the work: asks once in so many calls.
class SparseInterrupt {
 public:
  /// Whether the work of this thread should stop, as far as it was asked.
  [[nodiscard]] bool stopped() { return (++calls_ & kAtOnce) == 0 && workStopped(); }

 private:
  static constexpr unsigned kAtOnce = 255;
  unsigned calls_ = 0;
};

/// What was read, or kCancelled: what was stopped meanwhile may be incomplete.
template <typename T>
[[nodiscard]] Result<T> unlessStopped(Result<T> read) {
  if (workStopped()) return Error{ErrorCode::kCancelled, "cancelled"};
  return read;
}

}  // namespace lorica

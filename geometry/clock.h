#pragma once

#include <chrono>

namespace lorica {

/// Of a monotonic clock [s].
[[nodiscard]] inline double secondsOf(std::chrono::steady_clock::time_point time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}
[[nodiscard]] inline double now() {
  return secondsOf(std::chrono::steady_clock::now());
}

}  // namespace lorica

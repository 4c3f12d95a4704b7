#pragma once

#include "collision/hulls/host.h"
#include "geometry/errors.h"
#include "geometry/result.h"

#include <chrono>
#include <functional>
#include <future>
#include <string>
#include <thread>
#include <utility>

namespace lorica {

/// Whether work was given up that may still run in a thread.
[[nodiscard]] bool workAbandoned();
void noteAbandoned();
/// Ends the program without destroying what that thread may use.
[[noreturn]] void endWithoutIt(int status);

/// Runs work that cannot be stopped, such as opening a camera. If the work of this thread has a monitor and is
/// cancelled meanwhile, it is given up: its result counts no more, and main() ends with endWithoutIt().
/// @param work  owns what it uses
/// @return its result, or kCancelled
template <class T>
[[nodiscard]] Result<T> runOrAbandon(const std::string& label, Host& host, std::function<Result<T>()> work) {
  if (!host.inBackground()) return work();
  const Task opening(host, label, "");
  std::packaged_task<Result<T>()> task(std::move(work));
  std::future<Result<T>> result = task.get_future();
  std::thread(std::move(task)).detach();
  while (result.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready) {
    if (!host.cancelled()) continue;
    noteAbandoned();
    return cancelled();
  }
  return result.get();
}

}  // namespace lorica

#include "geometry/hard_stop.h"

#include <chrono>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace lorica {
namespace {

struct Tasks {
  std::mutex mutex;
  std::vector<std::pair<std::uint64_t, std::function<void()>>> list;
  std::uint64_t next = 0;
  bool ending = false;  // the list stays as it is from here on
};

/// Never destroyed: a task may be added or removed while the program ends.
Tasks& tasks() {
  static auto* const all = new Tasks;
  return *all;
}

[[noreturn]] void waitForTheEnd() {
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

}  // namespace

AtHardStop::AtHardStop(std::function<void()> task) {
  Tasks& all = tasks();
  {
    const std::lock_guard<std::mutex> lock(all.mutex);
    if (!all.ending) {
      number_ = all.next++;
      all.list.emplace_back(number_, std::move(task));
      return;
    }
  }
  task();  // of what began after the others were undone
  waitForTheEnd();
}

AtHardStop::~AtHardStop() {
  Tasks& all = tasks();
  {
    const std::lock_guard<std::mutex> lock(all.mutex);
    std::erase_if(all.list, [&](const auto& task) { return !all.ending && task.first == number_; });
    if (!all.ending) return;
  }
  waitForTheEnd();
}

void runHardStop() {
  Tasks& all = tasks();
  {
    const std::lock_guard<std::mutex> lock(all.mutex);
    all.ending = true;
  }
  for (auto task = all.list.rbegin(); task != all.list.rend(); ++task) task->second();
}

}  // namespace lorica

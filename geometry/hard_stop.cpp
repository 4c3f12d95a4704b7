#include "geometry/hard_stop.h"

#include <algorithm>
#include <mutex>
#include <utility>
#include <vector>

namespace lorica {
namespace {

struct Tasks {
  std::mutex mutex;
  std::vector<std::pair<std::uint64_t, std::function<void()>>> list;
  std::uint64_t next = 0;
};

/// Never destroyed: a task may be added or removed while the program ends.
Tasks& tasks() {
  static auto* const all = new Tasks;
  return *all;
}

}  // namespace

AtHardStop::AtHardStop(std::function<void()> task) {
  Tasks& all = tasks();
  const std::lock_guard<std::mutex> lock(all.mutex);
  number_ = all.next++;
  all.list.emplace_back(number_, std::move(task));
}

AtHardStop::~AtHardStop() {
  Tasks& all = tasks();
  const std::lock_guard<std::mutex> lock(all.mutex);
  std::erase_if(all.list, [this](const auto& task) { return task.first == number_; });
}

void runHardStop() {
  Tasks& all = tasks();
  all.mutex.lock();  // for ever: nobody removes its own task or adds one from here on
  for (auto task = all.list.rbegin(); task != all.list.rend(); ++task) task->second();
}

}  // namespace lorica

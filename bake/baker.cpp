#include "bake/baker.h"

#include "geometry/counts.h"
#include "geometry/hard_stop.h"

#include <fmt/format.h>

#include <algorithm>
#include <list>
#include <mutex>
#include <thread>
#include <utility>

namespace lorica {
namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::ordered_json;

constexpr std::chrono::milliseconds kPause{4};
constexpr std::chrono::milliseconds kPauseForOthers{500};

class Baker {
 public:
  Baker(BakeStore& store, Claims& claims, const BakerSettings& settings)
      : store_(store), claims_(claims), settings_(settings) {}

  Result<BakeOutcome> run(std::span<const BakeJob> jobs);

 private:
  void findWork(std::span<const BakeJob> jobs);
  [[nodiscard]] Result<void> takeUp();
  [[nodiscard]] Result<bool> tryStart(const BakeJob& job);
  [[nodiscard]] Result<void> collectEnded();
  [[nodiscard]] Result<void> finish(const ItemRun& run, const ordered_json& description);
  void askAboutOthers();
  void dropAll();
  [[nodiscard]] std::uint64_t memoryInUse() const;

  BakeStore& store_;
  Claims& claims_;
  const BakerSettings& settings_;
  std::list<const BakeJob*> waiting_;   // large ones first
  std::list<const BakeJob*> atOthers_;  // claimed by other processes
  std::list<ItemRun> running_;
  BakeOutcome outcome_;
  Clock::time_point nextAsked_;
};

void Baker::findWork(std::span<const BakeJob> jobs) {
  outcome_.items = countOf(jobs);
  for (const BakeJob& job : jobs) {
    const std::uint64_t bound = memoryBound(job.triangles);
    outcome_.memoryBound = std::max(outcome_.memoryBound, bound);
    bool there = store_.has(job.name);
    if (there && settings_.retryFailed) {
      const Result<ordered_json> description = store_.describe(job.name);
      there = description && !description->contains("failure");
      if (!there) (void)store_.discard(job.name);
    }
    if (there) {
      ++outcome_.there;
    } else if (bound > settings_.memory) {
      outcome_.tooLarge.push_back(fmt::format("{}: {} triangles may take {} MB, but --memory is {} MB", job.item.input,
                                              job.triangles, bound / 1'000'000, settings_.memory / 1'000'000));
    } else {
      waiting_.push_back(&job);
    }
  }
  waiting_.sort([](const BakeJob* a, const BakeJob* b) {
    return std::pair(b->triangles, a->key) < std::pair(a->triangles, b->key);
  });
}

std::uint64_t Baker::memoryInUse() const {
  std::uint64_t sum = 0;
  for (const ItemRun& run : running_) sum += memoryBound(run.job().triangles);
  return sum;
}

/// Starts waiting items while cores and memory are free.
Result<void> Baker::takeUp() {
  for (auto next = waiting_.begin(); next != waiting_.end() && std::ssize(running_) < settings_.jobs;) {
    const BakeJob& job = **next;
    if (memoryInUse() + memoryBound(job.triangles) > settings_.memory) {
      ++next;
      continue;
    }
    next = waiting_.erase(next);
    LORICA_TRY_DO(tryStart(job));
    claims_.beat();
  }
  return {};
}

/// @return false if the item is done or at another process
Result<bool> Baker::tryStart(const BakeJob& job) {
  const auto done = [&] {
    const bool has = store_.has(job.name);
    outcome_.byOthers += has ? 1 : 0;
    return has;
  };
  if (done()) return false;
  LORICA_TRY(const std::optional<int> claimed, claims_.claim(job.name));
  if (!claimed) {
    atOthers_.push_back(&job);
    return false;
  }
  if (done()) {  // between the look and the claim
    claims_.release(job.name);
    return false;
  }
  LORICA_TRY(const std::filesystem::path folder, store_.begin(job.name, *claimed));
  Result<ItemRun> run = ItemRun::start(job, folder, settings_.item);
  if (!run) {
    store_.drop(folder);
    return run.error();
  }
  running_.push_back(std::move(*run));
  return true;
}

Result<void> Baker::collectEnded() {
  for (auto run = running_.begin(); run != running_.end();) {
    const Result<std::optional<ordered_json>> description = run->poll();
    if (description && !*description) {
      ++run;
      continue;
    }
    if (description) {
      LORICA_TRY_DO(finish(*run, **description));
    } else if (settings_.stopping()) {  // who stops this process may have ended its items too
      store_.drop(run->folder());
      outcome_.stopped = true;
    } else {
      return description.error();
    }
    run = running_.erase(run);
  }
  return {};
}

Result<void> Baker::finish(const ItemRun& run, const ordered_json& description) {
  LORICA_TRY(const bool published, store_.publish(run.job().name, run.folder(), description));
  claims_.release(run.job().name);
  outcome_.cpuSeconds += description["cpuSeconds"].get<double>();
  outcome_.longest = std::max(outcome_.longest, description["seconds"].get<double>());
  outcome_.peakMemory = std::max(outcome_.peakMemory, description["peakMemory"].get<std::uint64_t>());
  if (!published) {
    ++outcome_.byOthers;
  } else if (description.contains("failure")) {
    ++outcome_.failed;
  } else {
    ++outcome_.made;
  }
  return {};
}

/// What others were making may be done, or its process lost: then it can be claimed.
void Baker::askAboutOthers() {
  if (!waiting_.empty() || Clock::now() < nextAsked_) return;
  nextAsked_ = Clock::now() + kPauseForOthers;
  waiting_.swap(atOthers_);
}

void Baker::dropAll() {
  for (ItemRun& run : running_) {
    const std::filesystem::path folder = run.folder();
    { const ItemRun ended = std::move(run); }  // before its files are removed
    store_.drop(folder);
  }
  running_.clear();
  store_.tidy();
  claims_.end();
}

Result<BakeOutcome> Baker::run(std::span<const BakeJob> jobs) {
  const Clock::time_point begin = Clock::now();
  std::mutex working;
  const AtHardStop dropping([this, &working] {
    working.lock();  // for ever: the program ends
    dropAll();
  });
  findWork(jobs);
  const int toDo = countOf(waiting_);
  Result<void> fine;
  while (fine && !(waiting_.empty() && atOthers_.empty() && running_.empty())) {
    {
      const std::lock_guard<std::mutex> lock(working);
      claims_.beat();
      fine = collectEnded();
      if (fine && !settings_.stopping()) {
        askAboutOthers();
        fine = takeUp();
      } else if (running_.empty()) {
        outcome_.stopped = true;
        break;
      }
      settings_.progress(outcome_.made + outcome_.failed + outcome_.byOthers, toDo);
    }
    std::this_thread::sleep_for(kPause);
  }
  const std::lock_guard<std::mutex> lock(working);
  dropAll();
  if (!fine) return fine.error();
  outcome_.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  return outcome_;
}

}  // namespace

Result<BakeOutcome> bakeAll(std::span<const BakeJob> jobs, BakeStore& store, Claims& claims,
                            const BakerSettings& settings) {
  return Baker(store, claims, settings).run(jobs);
}

}  // namespace lorica

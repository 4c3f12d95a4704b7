#include "export/bake/baker.h"

#include "acd/decompose.h"
#include "export/bake/child_process.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/hard_stop.h"
#include "geometry/json.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstring>
#include <list>
#include <mutex>
#include <thread>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using nlohmann::ordered_json;

constexpr std::chrono::milliseconds kPause{4};
constexpr double kDay = 24.0 * 3600.0;

// Beside the result while it is made; removed before it is published.
constexpr const char* kLog = "log.txt";
constexpr const char* kReport = "report.json";
constexpr const char* kFailure = "failure.json";
constexpr const char* kCache = "cache";

constexpr double kEachItem = 2'000.0;  // triangles that cost what a process costs

constexpr int kRefused = 2;  // exit status: bad input, or output that cannot be written

void addSetting(const BakeItem& item, const std::string& name, std::vector<std::string>& arguments) {
  const auto found = item.settings.find(name);
  if (found == item.settings.end()) return;
  if (name == "exact") return arguments.push_back("--exact");
  for (const std::string& value : found->second) arguments.insert(arguments.end(), {"--" + name, value});
}

void addCommon(const ItemSettings& settings, std::vector<std::string>& arguments) {
  arguments.insert(arguments.end(), {"--threads", std::to_string(settings.threads)});
  arguments.emplace_back("--force");  // pictures are made one after the other in one folder
  if (settings.trustPaths) arguments.emplace_back("--trust-paths");
}

/// `decompose INPUT -o FOLDER/bunny.lorica --parts 16 ...`, then `export INPUT FOLDER/bunny.glb ...`
std::vector<std::vector<std::string>> stepsFor(const BakeJob& job, const fs::path& folder,
                                               const ItemSettings& settings) {
  const std::string lorica = folder / (job.stem + ".lorica");
  const std::string report = folder / kReport;
  std::vector<std::string> decompose = {"decompose", job.item.input, "-o", lorica, "--json", report, "--held-out"};
  addCommon(settings, decompose);
  for (const auto& [name, values] : job.item.settings) {
    if (name != "export" && name != "engine") addSetting(job.item, name, decompose);
  }
  std::vector<std::vector<std::string>> steps = {decompose};
  const auto exports = job.item.settings.find("export");
  if (exports == job.item.settings.end()) return steps;
  for (const std::string& ending : exports->second) {
    steps.push_back(exportArguments(job.item, lorica, folder / (job.stem + "." + ending), settings));
  }
  return steps;
}

/// Copies figures of decompose's report.
void addFigures(const fs::path& report, ordered_json& description) {
  const Result<std::string> text = readFile(report, NamedBy::kFile);
  if (!text) return;
  const Result<ordered_json> json = parseJson<ordered_json>(*text, report.string());
  if (!json || !json->is_object()) return;
  for (const char* name : {"parts", "score", "error", "heldOutError", "heldOutPoses", "distance", "concavity",
                           "meanConcavity", "endedBy", "repaired", "body", "hash"}) {
    if (json->contains(name) && !json->at(name).is_null()) description[name] = (*json)[name];
  }
}

/// Why a process gave up.
struct Refusal {
  std::string kind;      ///< see nameOf(ErrorCode); empty if it did not say
  std::string sentence;  ///< "x.off: line 3: ..."; empty if it said nothing
};

Refusal refusalIn(const fs::path& folder) {
  Refusal refusal;
  const Result<std::string> text = readFile(folder / kFailure, NamedBy::kFile);
  const Result<ordered_json> json = text ? parseJson<ordered_json>(*text, kFailure) : text.error();
  if (json && json->is_object() && json->contains("failure")) {
    refusal = {json->at("failure").value("kind", ""), json->at("failure").value("message", "")};
  }
  std::string& sentence = refusal.sentence;
  if (sentence.empty()) {
    constexpr std::string_view kName = "lorica: ";  // before what it printed last
    const Result<std::string> log = readFile(folder / kLog, NamedBy::kFile);
    const std::size_t at = log ? log->rfind(kName) : std::string::npos;
    if (at != std::string::npos) sentence = log->substr(at + kName.size(), log->find('\n', at) - at - kName.size());
  }
  // The folder is gone when somebody reads this.
  const std::string prefix = folder.string() + "/";
  for (std::size_t at = 0; (at = sentence.find(prefix)) != std::string::npos;) sentence.erase(at, prefix.size());
  return refusal;
}

/// What the end of a process says about the item: why there is no result, or nothing if it did well. An error if it
/// says something about this machine: the disk is full, a file server away, or somebody killed the process.
Result<std::string> failureOf(const BakeJob& job, const fs::path& folder, const ProcessEnd& end) {
  if (end.signal == 0 && end.exitStatus == 0) return std::string();
  const auto [kind, sentence] = refusalIn(folder);
  const bool refused = end.signal == 0 && end.exitStatus == kRefused;
  const bool filesThere = std::ranges::all_of(
      job.inputs, [](const BakeInput& input) { return input.hash.empty() || ::access(input.file.c_str(), R_OK) == 0; });
  // A process that cannot write its output cannot always write why.
  if (refused && (kind.empty() || kind == nameOf(ErrorCode::kUnwritable))) return unwritable(sentence);
  if (refused && !filesThere) return unreadable(sentence);  // they were, when the list was read
  // Lorica reports signals as shells do.
  const int signal = end.signal != 0 ? end.signal : end.exitStatus - 128;
  if (signal == SIGKILL || signal == SIGTERM || signal == SIGINT || signal == SIGHUP) {
    return Error{ErrorCode::kCancelled, fmt::format("{}: somebody ended the process that made it by signal {} ({})",
                                                    job.item.input, signal, ::strsignal(signal))};
  }

  if (refused && !sentence.empty()) return sentence;
  const std::uint64_t bound = memoryBound(job.triangles);
  if (kind == kOutOfMemory || end.peakMemory > bound / 10 * 9) {
    return fmt::format("{}: needs more than the {} MB that {} triangles may take", job.item.input,
                       (bound + 999'999) / 1'000'000, job.triangles);
  }
  if (end.signal != 0) {
    return fmt::format("{}: the process that made it was ended by signal {} ({})", job.item.input, signal,
                       ::strsignal(signal));
  }
  return fmt::format("{}: {}", job.item.input,
                     sentence.empty() ? fmt::format("exit status {} without a word", end.exitStatus) : sentence);
}

/// Makes an item by processes one after the other: `decompose`, then an `export` for each file.
/// @param folder  empty; gets the files of the result
/// @param goOn    see runProgram()
/// @return the description of the result, which may be a failure; or an error of this machine, not of the item
Result<ordered_json> makeItem(const BakeJob& job, const fs::path& folder, const ItemSettings& settings,
                              const std::function<bool()>& goOn) {
  const Clock::time_point begin = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  double cpuSeconds = 0.0;
  std::uint64_t peakMemory = 0;
  std::string failure = job.refused;
  for (const std::vector<std::string>& arguments : stepsFor(job, folder, settings)) {
    if (!failure.empty()) break;
    // A cache of its own: `export` finds the body that `decompose` made, and nothing is shared over the network.
    const ProcessOrder order{
        settings.program,
        arguments,
        {{"XDG_CACHE_HOME", fs::absolute(folder / kCache)}, {"LORICA_FAILURE_FILE", fs::absolute(folder / kFailure)}},
        folder / kLog,
        memoryBound(job.triangles)};
    LORICA_TRY(const ProcessEnd end, runProgram(order, [&] { return goOn() && elapsed() < settings.timeout; }));
    cpuSeconds += end.cpuSeconds;
    peakMemory = std::max(peakMemory, end.peakMemory);
    if (!goOn()) return cancelled();
    if (end.stopped) {
      failure = fmt::format("{}: took longer than the {:g} s of --timeout", job.item.input, settings.timeout);
    } else {
      LORICA_TRY(failure, failureOf(job, folder, end));
    }
  }

  ordered_json description;
  description["item"] = job.name;
  description["input"] = job.item.input;
  for (const BakeInput& input : job.inputs) {
    description["inputs"].push_back({{"file", input.file}, {"hash", input.hash}});
  }
  description["settings"] = textOf(job.item.settings);
  description["version"] = kAlgorithmVersion;
  description["triangles"] = job.triangles;
  if (failure.empty()) {
    addFigures(folder / kReport, description);
  } else {
    description["failure"] = failure;
  }
  description["seconds"] = elapsed();
  description["cpuSeconds"] = cpuSeconds;
  description["peakMemory"] = peakMemory;
  description["memoryBound"] = memoryBound(job.triangles);

  // A failure leaves its sentence alone, in the same folder: another thread would take the name of one that is gone.
  std::error_code error;
  if (failure.empty()) {
    for (const char* name : {kLog, kReport, kFailure, kCache}) fs::remove_all(folder / name, error);
  } else {
    fs::directory_iterator entry(folder, error);
    while (!error && entry != fs::directory_iterator()) {
      fs::remove_all(entry->path(), error);
      if (!error) entry.increment(error);
    }
  }
  if (error) return unwritable(folder, error.value());
  LORICA_TRY(const std::vector<BakedFile> files, bakedFiles(folder));
  description["files"] = ordered_json::array();
  for (const BakedFile& file : files) {
    description["files"].push_back({{"file", file.name}, {"hash", file.hash}, {"bytes", file.bytes}});
  }
  description["result"] = resultHash(files);
  return description;
}

/// How much work an item is, as far as its size tells [triangles].
double workOf(const BakeJob& job) {
  return kEachItem + double(job.triangles);
}

class Baker {
 public:
  Baker(const BakeStore& store, const BakerSettings& settings) : store_(store), settings_(settings) {}

  Result<BakeOutcome> run(std::span<const BakeJob> jobs);

 private:
  [[nodiscard]] Result<void> findWork(std::span<const BakeJob> jobs);
  [[nodiscard]] Result<bool> isThere(const BakeJob& job) const;
  void work();
  [[nodiscard]] const BakeJob* take();
  [[nodiscard]] Result<void> make(const BakeJob& job);
  void count(const ordered_json& description, bool published);

  const BakeStore& store_;
  const BakerSettings& settings_;
  std::mutex mutex_;                   // of the next five
  std::list<const BakeJob*> waiting_;  // large ones first
  std::uint64_t memoryInUse_ = 0;
  double workDone_ = 0.0;  // see workOf()
  Result<void> fine_;      // of the machine
  BakeOutcome outcome_;
  std::atomic<int> workers_ = 0;
  std::atomic<bool> stop_ = false;  // begin no more items
  std::atomic<bool> drop_ = false;  // nor finish those in progress
};

Result<void> Baker::findWork(std::span<const BakeJob> jobs) {
  outcome_.items = countOf(jobs);
  for (const BakeJob& job : jobs) {
    const std::uint64_t bound = memoryBound(job.triangles);
    outcome_.memoryBound = std::max(outcome_.memoryBound, bound);
    LORICA_TRY(const bool there, isThere(job));
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
  return {};
}

/// Whether there is a result that can stay. Others are taken away.
Result<bool> Baker::isThere(const BakeJob& job) const {
  const Result<ordered_json> description = store_.describe(job.name);
  if (!description && description.error().code == ErrorCode::kNotFound) return false;
  if (!description && description.error().code != ErrorCode::kBadFormat) return description.error();
  const bool stays = description && store_.damageOf(job.name, *description).empty() &&
                     !(settings_.retryFailed && description->contains("failure"));
  if (!stays) LORICA_TRY_DO(store_.discard(job.name));
  return stays;
}

/// A thread: makes items as long as there are any.
void Baker::work() {
  while (const BakeJob* job = take()) {
    Result<void> made = make(*job);
    const std::lock_guard<std::mutex> lock(mutex_);
    memoryInUse_ -= memoryBound(job->triangles);
    workDone_ += workOf(*job);
    if (made) continue;
    if (fine_) fine_ = std::move(made);
    if (!stop_.exchange(true)) drop_ = true;  // who stops this process may have ended its items too
  }
  --workers_;
}

/// Waits until memory is free for the largest item that may ever fit. @return null if nothing is left to do
const BakeJob* Baker::take() {
  for (; !stop_; std::this_thread::sleep_for(kPause)) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (waiting_.empty()) break;
    const auto next = std::ranges::find_if(waiting_, [this](const BakeJob* job) {
      return memoryInUse_ + memoryBound(job->triangles) <= settings_.memory;
    });
    if (next == waiting_.end()) continue;
    const BakeJob* job = *next;
    waiting_.erase(next);
    memoryInUse_ += memoryBound(job->triangles);
    return job;
  }
  return nullptr;
}

Result<void> Baker::make(const BakeJob& job) {
  if (store_.has(job.name)) {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++outcome_.byOthers;
    return {};
  }
  LORICA_TRY(const fs::path folder, store_.begin());
  const Result<ordered_json> description = makeItem(job, folder, settings_.item, [this] { return !drop_; });
  if (!description) {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    return description.error();
  }
  LORICA_TRY(const bool published, store_.publish(job.name, folder, *description));
  const std::lock_guard<std::mutex> lock(mutex_);
  count(*description, published);
  return {};
}

void Baker::count(const ordered_json& description, bool published) {
  outcome_.cpuSeconds += description["cpuSeconds"].get<double>();
  outcome_.longest = std::max(outcome_.longest, description["seconds"].get<double>());
  outcome_.peakMemory = std::max(outcome_.peakMemory, description["peakMemory"].get<std::uint64_t>());
  ++(!published ? outcome_.byOthers : description.contains("failure") ? outcome_.failed : outcome_.made);
}

Result<BakeOutcome> Baker::run(std::span<const BakeJob> jobs) {
  const Clock::time_point begin = Clock::now();
  store_.removeAbandoned(std::max(kDay, 2.0 * settings_.item.timeout));  // no living process takes so long
  LORICA_TRY_DO(findWork(jobs));
  const int toDo = countOf(waiting_);
  double allWork = 0.0;
  for (const BakeJob* job : waiting_) allWork += workOf(*job);
  const AtHardStop dropping([this] {
    stop_ = drop_ = true;
    while (workers_ > 0) std::this_thread::sleep_for(kPause);
  });
  const std::uint64_t most = settings_.memory / memoryBound(0);  // that may ever work at once
  workers_ = static_cast<int>(std::min<std::uint64_t>({most, std::uint64_t(settings_.jobs), std::uint64_t(toDo)}));
  std::vector<std::jthread> threads(workers_);
  for (std::jthread& thread : threads) thread = std::jthread([this] { work(); });
  while (workers_ > 0) {
    if (settings_.stopping()) stop_ = true;
    std::unique_lock<std::mutex> lock(mutex_);
    const int done = outcome_.made + outcome_.failed + outcome_.byOthers;
    const double share = allWork > 0.0 ? workDone_ / allWork : 1.0;
    lock.unlock();
    settings_.progress(done, toDo, share);
    std::this_thread::sleep_for(kPause);
  }
  threads.clear();
  if (!fine_ && !settings_.stopping()) return fine_.error();
  outcome_.stopped = !fine_ || !waiting_.empty();
  outcome_.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  return outcome_;
}

}  // namespace

std::vector<std::string> exportArguments(const BakeItem& item, const fs::path& lorica, const fs::path& out,
                                         const ItemSettings& settings) {
  std::vector<std::string> arguments = {"export", item.input, out, "--decomposition", lorica};
  addCommon(settings, arguments);
  for (const char* name : {"body", "body-resolution", "walls", "thickness", "map", "hide", "hull-vertices", "engine"}) {
    addSetting(item, name, arguments);
  }
  return arguments;
}

Result<BakeOutcome> bakeAll(std::span<const BakeJob> jobs, const BakeStore& store, const BakerSettings& settings) {
  return Baker(store, settings).run(jobs);
}

}  // namespace lorica

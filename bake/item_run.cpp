#include "bake/item_run.h"

#include "acd/decompose.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/json.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

// Beside the result while it is made; removed before it is published.
constexpr const char* kLog = "log.txt";
constexpr const char* kReport = "report.json";
constexpr const char* kFailure = "failure.json";
constexpr const char* kCache = "cache";

constexpr int kRefused = 2;  // exit status: bad input, or output that cannot be written

void addSetting(const BakeItem& item, const std::string& name, std::vector<std::string>& arguments) {
  const auto found = item.settings.find(name);
  if (found == item.settings.end()) return;
  if (name == "exact") return arguments.push_back("--exact");
  for (const std::string& value : found->second) arguments.insert(arguments.end(), {"--" + name, value});
}

void addCommon(const ItemRunSettings& settings, std::vector<std::string>& arguments) {
  arguments.insert(arguments.end(), {"--threads", std::to_string(settings.threads)});
  arguments.emplace_back("--force");  // of what an earlier try left behind
  if (settings.trustPaths) arguments.emplace_back("--trust-paths");
}

/// `decompose INPUT -o FOLDER/bunny.lorica --parts 16 ...`, then `export INPUT FOLDER/bunny.glb ...`
std::vector<std::vector<std::string>> stepsFor(const BakeJob& job, const fs::path& folder,
                                               const ItemRunSettings& settings) {
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

std::string megabytes(std::uint64_t bytes) {
  return fmt::format("{} MB", (bytes + 999'999) / 1'000'000);
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

}  // namespace

std::vector<std::string> exportArguments(const BakeItem& item, const fs::path& lorica, const fs::path& out,
                                         const ItemRunSettings& settings) {
  std::vector<std::string> arguments = {"export", item.input, out, "--decomposition", lorica};
  addCommon(settings, arguments);
  for (const char* name : {"body", "body-resolution", "walls", "thickness", "map", "hide", "hull-vertices", "engine"}) {
    addSetting(item, name, arguments);
  }
  return arguments;
}

ItemRun::ItemRun(BakeJob job, fs::path folder, ItemRunSettings settings)
    : job_(std::move(job)),
      folder_(std::move(folder)),
      settings_(std::move(settings)),
      steps_(stepsFor(job_, folder_, settings_)),
      begin_(Clock::now()) {}

Result<ItemRun> ItemRun::start(const BakeJob& job, const fs::path& folder, const ItemRunSettings& settings) {
  ItemRun run(job, folder, settings);
  if (job.refused.empty()) {
    LORICA_TRY_DO(run.startStep());
  }
  return run;
}

Result<void> ItemRun::startStep() {
  // A cache of its own: `export` finds the body that `decompose` made, and nothing is shared over the network.
  ProcessOrder order{
      settings_.program,
      steps_[step_],
      {{"XDG_CACHE_HOME", fs::absolute(folder_ / kCache)}, {"LORICA_FAILURE_FILE", fs::absolute(folder_ / kFailure)}},
      folder_ / kLog,
      memoryBound(job_.triangles)};
  LORICA_TRY(process_, ChildProcess::start(order));
  return {};
}

Result<std::optional<ordered_json>> ItemRun::poll() {
  const auto done = [this](const std::string& failure) -> Result<std::optional<ordered_json>> {
    LORICA_TRY(ordered_json description, finish(failure));
    return std::optional(std::move(description));
  };
  if (!job_.refused.empty()) return done(job_.refused);
  const std::optional<ProcessEnd> end = process_->ended();
  if (!end) {
    if (std::chrono::duration<double>(Clock::now() - begin_).count() < settings_.timeout) {
      return std::optional<ordered_json>();
    }
    process_->kill();
    return done(fmt::format("{}: took longer than the {:g} s of --timeout", job_.item.input, settings_.timeout));
  }
  cpuSeconds_ += end->cpuSeconds;
  peakMemory_ = std::max(peakMemory_, end->peakMemory);
  LORICA_TRY_DO(checkMachine(*end));
  if (const std::string failure = failureOf(*end); !failure.empty()) return done(failure);
  if (++step_ == steps_.size()) return done("");
  LORICA_TRY_DO(startStep());
  return std::optional<ordered_json>();
}

/// What the command said last: "lorica: x.off: line 3: ..." without its name; or nothing.
std::string ItemRun::lastSentence() const {
  std::string sentence = refusal().message;
  if (sentence.empty()) {
    constexpr std::string_view kName = "lorica: ";
    const Result<std::string> text = readFile(folder_ / kLog, NamedBy::kFile);
    const std::size_t at = text ? text->rfind(kName) : std::string::npos;
    if (at == std::string::npos) return "";
    const std::size_t begin = at + kName.size();
    sentence = text->substr(begin, text->find('\n', begin) - begin);
  }
  // The folder is gone when somebody reads this.
  const std::string folder = folder_.string() + "/";
  for (std::size_t found = 0; (found = sentence.find(folder)) != std::string::npos;)
    sentence.erase(found, folder.size());
  return sentence;
}

ItemRun::Refusal ItemRun::refusal() const {
  const Result<std::string> text = readFile(folder_ / kFailure, NamedBy::kFile);
  if (!text) return {};
  const Result<ordered_json> json = parseJson<ordered_json>(*text, kFailure);
  if (!json || !json->is_object() || !json->contains("failure")) return {};
  const ordered_json& failure = json->at("failure");
  return {failure.value("kind", ""), failure.value("message", "")};
}

Result<void> ItemRun::checkMachine(const ProcessEnd& end) const {
  if (end.signal == 0 && end.exitStatus == kRefused) {
    const std::string kind = refusal().kind;
    const bool filesThere = std::ranges::all_of(job_.inputs, [](const BakeInput& input) {
      return input.hash.empty() || ::access(input.file.c_str(), R_OK) == 0;
    });
    // A process that cannot write its output cannot always write why.
    if (kind.empty() || kind == nameOf(ErrorCode::kUnwritable)) return unwritable(lastSentence());
    if (!filesThere) return unreadable(lastSentence());  // they were, when the list was read
  }
  // Lorica reports signals as shells do.
  const int signal = end.signal != 0 ? end.signal : end.exitStatus - 128;
  if (signal != SIGKILL && signal != SIGTERM && signal != SIGINT && signal != SIGHUP) return {};
  return Error{ErrorCode::kCancelled, fmt::format("{}: somebody ended the process that made it by signal {} ({})",
                                                  job_.item.input, signal, ::strsignal(signal))};
}

std::string ItemRun::failureOf(const ProcessEnd& end) const {
  if (end.signal == 0 && end.exitStatus == 0) return "";
  const std::string said = lastSentence();
  if (end.signal == 0 && end.exitStatus == kRefused && !said.empty()) return said;
  const bool memory = refusal().kind == kOutOfMemory || end.peakMemory > memoryBound(job_.triangles) / 10 * 9;
  if (memory) {
    return fmt::format("{}: needs more than the {} that {} triangles may take", job_.item.input,
                       megabytes(memoryBound(job_.triangles)), job_.triangles);
  }
  if (end.signal != 0) {
    return fmt::format("{}: the process that made it was ended by signal {} ({})", job_.item.input, end.signal,
                       ::strsignal(end.signal));
  }
  return fmt::format("{}: {}", job_.item.input,
                     said.empty() ? fmt::format("exit status {} without a word", end.exitStatus) : said);
}

Result<ordered_json> ItemRun::finish(const std::string& failure) {
  ordered_json description;
  description["item"] = job_.name;
  description["input"] = job_.item.input;
  for (const BakeInput& input : job_.inputs) {
    description["inputs"].push_back({{"file", input.file}, {"hash", input.hash}});
  }
  description["settings"] = textOf(job_.item.settings);
  description["version"] = kAlgorithmVersion;
  description["triangles"] = job_.triangles;
  if (failure.empty()) {
    addFigures(folder_ / kReport, description);
  } else {
    description["failure"] = failure;
  }
  description["seconds"] = std::chrono::duration<double>(Clock::now() - begin_).count();
  description["cpuSeconds"] = cpuSeconds_;
  description["peakMemory"] = peakMemory_;
  description["memoryBound"] = memoryBound(job_.triangles);

  // A failure leaves its sentence alone.
  std::error_code error;
  if (failure.empty()) {
    for (const char* name : {kLog, kReport, kFailure, kCache}) fs::remove_all(folder_ / name, error);
  } else {
    fs::remove_all(folder_, error);
    fs::create_directory(folder_, error);
  }
  if (error) return unwritable(folder_, error.value());
  LORICA_TRY(const std::vector<BakedFile> files, bakedFiles(folder_));
  description["files"] = ordered_json::array();
  for (const BakedFile& file : files) {
    description["files"].push_back({{"file", file.name}, {"hash", file.hash}, {"bytes", file.bytes}});
  }
  description["result"] = resultHash(files);
  return description;
}

}  // namespace lorica

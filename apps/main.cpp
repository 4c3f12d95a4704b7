#include "apps/interrupt.h"
#include "apps/memory_limit.h"
#include "apps/options.h"
#include "apps/report.h"
#include "collision/hulls/host.h"
#include "geometry/clock.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "session/prepare/abandoned_work.h"
#include "session/prepare/file_kinds.h"
#include "session/prepare/read_motion.h"
#include "viewer/player/monitored_host.h"
#include "viewer/window/window.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace lorica {
namespace {

constexpr double kRedrawSeconds = 0.05;
constexpr double kLineSeconds = 10.0;
constexpr int kWidestBar = 40;
constexpr std::size_t kLongestLabel = 100;  // [bytes]

/// What the user waits for, on standard error: a bar in a terminal, else a line every ten seconds. Whatever stages and
/// tasks it has, it is one bar with one estimate.
class ProgressBar {
 public:
  WorkShare work;
  std::vector<std::string> stages = {};                         ///< names of those that have begun, the inner ones last
  std::vector<std::pair<std::string, std::string>> tasks = {};  ///< label and unit of each

  ProgressBar() = default;
  /// Removes the bar from the terminal.
  ~ProgressBar() {
    if (terminal_ && shown_) say("\r\x1b[K");
  }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Shows how far the inner task is. @param total  0 or less if unknown
  void show(int done, int total) {
    const Clock::time_point now = Clock::now();
    const double sinceShown = std::chrono::duration<double>(now - lastShown_).count();
    const double seconds = std::chrono::duration<double>(now - start_).count();
    if (terminal_ ? shown_ && sinceShown < kRedrawSeconds : sinceShown < kLineSeconds) return;
    const auto& [label, unit] = tasks.back();
    const auto name = std::ranges::find_if(stages.rbegin(), stages.rend(), [](const auto& s) { return !s.empty(); });
    const std::string what = printable((name == stages.rend() ? "" : *name + ", ") + label, kLongestLabel);
    const std::string count = !stages.empty() ? fmt::format("{:.0f} %", 100.0 * work.share())
                              : total > 0     ? fmt::format("{} of {} {}", done, total, unit)
                                              : fmt::format("{} {}", done, unit);
    const std::optional<double> left = timeLeft(work.worked(), 1.0 - work.share(), seconds);
    const std::string time = fmt::format("{:.0f} s{}", seconds, left ? ", " + roughly(*left) + " left" : "");
    if (terminal_) {
      draw(what, fmt::format("  {}  {}", count, time), total > 0 || !stages.empty());
    } else {
      say(fmt::format("{}: {} after {}\n", what, count, time));
    }
    lastShown_ = now;
    shown_ = true;
  }

 private:
  using Clock = std::chrono::steady_clock;

  void draw(const std::string& label, const std::string& tail, bool known) const {
    std::string line = label + "  ";
    const int columns = terminalWidth(STDERR_FILENO).value_or(80);
    const int room = columns - 1 - countOf(line) - countOf(tail);
    const int width = std::min(kWidestBar, room - 2);
    if (width >= 5 && known) {
      const int filled = std::clamp(static_cast<int>(width * work.share()), 0, width);
      line += fmt::format("[{:<{}}]", std::string(filled, '='), width);
    }
    line += tail;
    // A line longer than the terminal would wrap and could not be erased.
    line.resize(std::min<std::size_t>(line.size(), std::max(columns - 1, 1)));
    say(fmt::format("\r\x1b[K{}", line));
  }

  // A dumb terminal cannot return to the start of a line.
  bool terminal_ = isatty(STDERR_FILENO) == 1 && environment("TERM") != "dumb";
  Clock::time_point start_ = Clock::now();
  Clock::time_point lastShown_ = start_;
  bool shown_ = false;
};

/// The first argument with which this program reads a file for another process of itself, see serveIsolatedReader().
/// Internal: no subcommand that users see.
constexpr std::string_view kReadForItself = "--read-character-for-itself";

/// The host of the command: progress and messages on standard error, Ctrl-C cancels. FBX and COLLADA files are read by
/// a process of this program of their own.
class TerminalHost final : public Host {
 public:
  explicit TerminalHost(const CommonOptions& common) {
    threads = common.threadCount();
    if (common.trustPaths) paths = PathTrust::kAnywhere;
    // The file of this program may have been replaced or moved since it was started; this name still leads to it.
    reader = IsolatedReader{"/proc/self/exe", {std::string(kReadForItself)}};
  }

  void beginStage(double from, double to, const std::string& name) override {
    bar().stages.push_back(name);
    bar_->work.beginStage(from, to);
  }
  void endStage() override {
    bar_->work.endStage();
    bar_->stages.pop_back();
    endBar();
  }
  void beginTask(const std::string& label, const std::string& unit) override {
    if (bar().tasks.empty()) bar_->work.beginTask(bar_->stages.empty());
    bar_->tasks.emplace_back(label, unit);
  }
  void report(int done, int total, double share) override {
    if (!bar_ || bar_->tasks.empty()) return;
    if (bar_->tasks.size() == 1) bar_->work.report(done, total, share);
    bar_->show(done, total);
  }
  void endTask() override {
    bar_->tasks.pop_back();
    endBar();
  }
  [[nodiscard]] bool cancelled() const override { return interrupted(); }
  void tell(const std::string& sentence) override { say(sentence + "\n"); }
  void warn(const std::string& sentence) override { lorica::warn(sentence); }

 private:
  ProgressBar& bar() { return bar_ ? *bar_ : bar_.emplace(); }
  /// It is over when the outermost stage or task is.
  void endBar() {
    if (bar_->stages.empty() && bar_->tasks.empty()) bar_.reset();
  }
  std::optional<ProgressBar> bar_;
};

/// `lorica FILE` opens whatever it is: motions, characters, recordings and scenes are played, in a window if there is a
/// display; sessions are replayed; meshes are props in a window, else described; so is anything else. What ships is
/// named without a folder. `lorica replay FILE` plays what is no session.
/// @param words     of the command line, after the program's name
/// @param commands  the subcommands, which win over files of their names
/// @return the words with the subcommand in front; unchanged if the first names no file
std::vector<std::string> withCommand(std::vector<std::string> words, const std::vector<std::string>& commands) {
  if (words.empty()) return words;
  const std::string named = words.front();
  const bool isCommand = std::ranges::find(commands, named) != commands.end();
  std::error_code ignored;
  const bool found = std::filesystem::is_regular_file(named, ignored);
  const bool ships = named == "mannequin" || (isBareName(named) && !shippedRecording(named).empty());
  if (isCommand || named.starts_with("-") || (!found && !ships && isBareName(named))) return words;
  const FileKind kind = kindOf(named);
  const bool described = kind == FileKind::kDecomposition || (kind == FileKind::kUnknown && !ships) ||
                         (!found && !ships) || (kind == FileKind::kMesh && !displayAvailable());
  const auto wantsNone = [](const std::string& word) {
    return word.starts_with("--snapshots") || word.starts_with("--video") || word == "--headless" ||
           word == "--window" || word == "--serve";
  };
  if (!described && std::ranges::none_of(words, wantsNone)) {
    if (displayAvailable()) {
      words.push_back("--window");
    } else if (kind != FileKind::kSession) {
      say(printable(fmt::format("No display: `lorica snapshot {}` or --snapshots DIR makes pictures.", named)) + "\n");
    }
  }
  words.insert(words.begin(), described ? "info" : kind == FileKind::kSession ? "replay" : "play");
  return words;
}

int fail(const Error& error) {
  if (error.code == ErrorCode::kCancelled) {
    answerInterrupt();
    sayCancelled();
    return interruptedStatus();
  }
  publishFailure(nameOf(error.code), error.message);
  say(fmt::format("lorica: {}\n", printable(error.message)));
  return kBadInputStatus;
}

int runCommand(int argc, char** argv) {
  const std::unique_ptr<CLI::App> app =
      makeCommandLine("lorica", "Lorica: a live motion-capture avatar that collides.", LORICA_VERSION);
  app->footer(
      "Examples:\n"
      "  lorica demo                              # a character kicks boxes and balls\n"
      "  lorica decompose mannequin -o body.lorica\n"
      "  lorica play walk --decomposition body.lorica\n"
      "  lorica live --virtual                    # follow a person before a depth camera, here a virtual one\n"
      "  lorica hero.glb                          # open any file: a character, a motion, a recording, a scene\n"
      "  lorica info hero.glb                     # describe your own character\n"
      "  lorica play walk --character hero.glb --window\n"
      "\n`lorica help COMMAND` describes each command.\n"
      "Exit status: 0 = done, 1 = a failure of Lorica, 2 = bad input or output that cannot be written, 130 = Ctrl-C "
      "before the end.");
  CommonOptions common;
  std::vector<Command> commands;
  const auto add = [&](const char* group, std::initializer_list<AddCommand*> adding) {
    for (const auto one : adding) {
      commands.push_back(one(*app, common));
      commands.back().app->group(group);
    }
  };
  add("See it move", {addDemo, addPlay, addLive, addServe, addReplay, addSnapshot});
  add("Make files", {addDecompose, addExport, addConvert, addRecord, addBake});
  add("Learn what is there", {addInfo, addScore, addContacts});

  std::vector<std::string> words = withCommand({argv + 1, argv + argc}, subcommandNames(*app));
  for (std::string& word : words) {  // shells leave --out=~/pictures as it is
    const std::size_t home = word.starts_with("--") ? word.find("=~/") : std::string::npos;
    if (home != std::string::npos && home == word.find('=')) word.replace(home + 1, 1, environment("HOME"));
  }
  if (const std::optional<int> status = parse(*app, words)) return *status;
  const auto chosen =
      std::find_if(commands.begin(), commands.end(), [](const Command& command) { return command.app->parsed(); });

  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, common.threadCount());
  TerminalHost host(common);
  Result<void> done;
  const std::optional<std::uint64_t> given = bytesIn(common.memory);
  limitMemory(given.value_or(usualMemory(words)), common.threadCount(), given ? LimitOf::kUser : LimitOf::kUsual);
  try {
    done = chosen->run(common, host);
  } catch (const std::bad_alloc&) {
    endWithoutMemory();
  }
  if (!done) return fail(done.error());
  return chosen->status ? chosen->status() : 0;
}

}  // namespace
}  // namespace lorica

int main(int argc, char** argv) {
  // Lorica's code throws no exceptions; this reports std::bad_alloc and exceptions of libraries.
  try {
    if (argc == 2 && argv[1] == lorica::kReadForItself) return lorica::serveIsolatedReader();
    lorica::openStandardStreams();
    lorica::watchInterrupt();
    const int status = lorica::runCommand(argc, argv);
    if (lorica::workAbandoned()) lorica::endWithoutIt(status);
    return status;
  } catch (const std::exception& error) {
    lorica::say(fmt::format("lorica: stopped: {}\n", lorica::printable(error.what())));
    return 1;
  }
}

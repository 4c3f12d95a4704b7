#include "apps/terminal_host.h"

#include "geometry/clock.h"
#include "geometry/counts.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>
#include <utility>

namespace lorica {
namespace {

constexpr double kRedrawSeconds = 0.05;
constexpr double kLineSeconds = 10.0;
constexpr int kWidestBar = 40;
constexpr std::size_t kLongestLabel = 100;  // [bytes]

/// "12 of 240 frames", or "12 parts" if the total is unknown.
std::string countText(int done, int total, const std::string& unit) {
  return total > 0 ? fmt::format("{} of {} {}", done, total, unit) : fmt::format("{} {}", done, unit);
}

}  // namespace

/// Progress of a task on standard error.
class ProgressBar {
 public:
  /// @param label  the task: "Decomposing mannequin"
  /// @param unit   the counted items: "parts"
  ProgressBar(const std::string& label, std::string unit)
      : label_(printable(label, kLongestLabel)),
        unit_(std::move(unit)),
        // A dumb terminal cannot return to the start of a line.
        terminal_(isatty(STDERR_FILENO) == 1 && environment("TERM") != "dumb"),
        start_(Clock::now()),
        lastShown_(start_) {}
  /// Removes the bar from the terminal.
  ~ProgressBar() {
    if (terminal_ && shown_) say("\r\x1b[K");
  }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// @param total  0 or less if unknown
  void update(int done, int total) {
    const Clock::time_point now = Clock::now();
    const double sinceShown = std::chrono::duration<double>(now - lastShown_).count();
    const double seconds = std::chrono::duration<double>(now - start_).count();
    const std::optional<double> left = timeLeft_.update(done, total, seconds);
    const std::string leftText = left ? fmt::format(", {:.0f} s left", *left) : "";
    if (terminal_) {
      if (shown_ && sinceShown < kRedrawSeconds) return;
      draw(done, total, fmt::format("{:.0f} s{}", seconds, leftText));
    } else {
      if (sinceShown < kLineSeconds) return;
      say(fmt::format("{}: {} after {:.0f} s{}\n", label_, countText(done, total, unit_), seconds, leftText));
    }
    lastShown_ = now;
    shown_ = true;
  }

 private:
  using Clock = std::chrono::steady_clock;

  void draw(int done, int total, const std::string& time) const {
    const std::string tail = fmt::format("  {}  {}", countText(done, total, unit_), time);
    std::string line = label_ + "  ";
    const int room = terminalWidth(stderr) - 1 - countOf(line) - countOf(tail);
    const int width = std::min(kWidestBar, room - 2);
    if (width >= 5 && total > 0) {
      const int filled = std::clamp(width * done / total, 0, width);
      line += fmt::format("[{:<{}}]", std::string(filled, '='), width);
    }
    line += tail;
    // A line longer than the terminal would wrap and could not be erased.
    line.resize(std::min<std::size_t>(line.size(), std::max(terminalWidth(stderr) - 1, 1)));
    say(fmt::format("\r\x1b[K{}", line));
  }

  std::string label_;
  std::string unit_;
  bool terminal_;
  Clock::time_point start_;
  Clock::time_point lastShown_;
  TimeLeft timeLeft_;
  bool shown_ = false;
};

TerminalHost::TerminalHost(const CommonOptions& common) {
  threads = common.threadCount();
  if (common.trustPaths) paths = PathTrust::kAnywhere;
  // The file of this program may have been replaced or moved since it was started; this name still leads to it.
  reader = IsolatedReader{"/proc/self/exe", {std::string(kReadForItself)}};
}

TerminalHost::~TerminalHost() = default;

void TerminalHost::beginTask(const std::string& label, const std::string& unit) {
  bars_.push_back(std::make_unique<ProgressBar>(label, unit));
}

void TerminalHost::report(int done, int total) {
  if (!bars_.empty()) bars_.back()->update(done, total);
}

void TerminalHost::endTask() {
  bars_.pop_back();
}

}  // namespace lorica

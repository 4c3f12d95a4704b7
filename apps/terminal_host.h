#pragma once

#include "apps/interrupt.h"
#include "apps/report.h"
#include "prepare/host.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

class ProgressBar;

/// The first argument with which this program reads a file for another process of itself, see serveIsolatedReader().
/// Internal: no subcommand that users see.
inline constexpr std::string_view kReadForItself = "--read-character-for-itself";

/// The host of the command: progress and messages on standard error, Ctrl-C cancels. FBX and COLLADA files are read by
/// a process of this program of their own.
class TerminalHost final : public Host {
 public:
  explicit TerminalHost(const CommonOptions& common);
  ~TerminalHost() override;

  /// A bar in a terminal, else a line every ten seconds.
  void beginTask(const std::string& label, const std::string& unit) override;
  void report(int done, int total) override;
  void endTask() override;
  [[nodiscard]] bool cancelled() const override { return interrupted(); }
  void tell(const std::string& sentence) override { say(sentence + "\n"); }
  void warn(const std::string& sentence) override { lorica::warn(sentence); }

 private:
  std::vector<std::unique_ptr<ProgressBar>> bars_;  // of the tasks that have begun, the inner ones last
};

}  // namespace lorica

#pragma once

#include "apps/command_line.h"
#include "apps/report.h"
#include "geometry/result.h"

#include <functional>
#include <string>
#include <vector>

namespace lorica {

/// A subcommand: its options, and what it does once they are understood.
struct Command {
  CommandLine* app = nullptr;
  std::function<Result<void>(const CommonOptions&)> run;
  std::function<int()> status = {};  ///< exit status of a run without an error; null = 0
};

/// A subcommand with the options that all share: --json, --threads, --help.
/// @param examples  lines "command  # what it does", shown under the options
[[nodiscard]] CommandLine* addSubcommand(CommandLine& parent, CommonOptions& common, const std::string& name,
                                         const std::string& description, const std::string& examples);

/// An option that takes a whole number of at least `least`; anything else is refused in a sentence.
Option* addCount(CommandLine& app, const std::string& name, int& value, int least, const std::string& description);

/// What addCountOrAuto() makes of the word `auto`.
inline constexpr int kAuto = -1;

/// An option that takes a whole number of at least `least`, or the word `auto`.
Option* addCountOrAuto(CommandLine& app, const std::string& name, int& value, int least,
                       const std::string& description);

/// A check for an option that takes one of a few words; anything else is refused in a sentence.
[[nodiscard]] TextCheck oneOf(std::vector<std::string> words);

/// An option that takes seconds above zero.
Option* addSeconds(CommandLine& app, const std::string& name, double& value, const std::string& description);

/// An option that takes a number above zero.
Option* addPositive(CommandLine& app, const std::string& name, double& value, const std::string& description,
                    const std::string& typeName);

/// An option that takes a length above zero.
Option* addLength(CommandLine& app, const std::string& name, double& value, const std::string& description);

/// An option that takes a share above zero, as a number or in percent: 0.05 or 5%.
Option* addShare(CommandLine& app, const std::string& name, double& value, const std::string& description);

/// One file a subcommand: demo.cpp, decompose.cpp, score.cpp, play.cpp, live.cpp, record.cpp, replay.cpp, info.cpp,
/// convert.cpp, snapshot.cpp.
[[nodiscard]] Command addDemo(CommandLine& parent, CommonOptions& common);
[[nodiscard]] Command addDecompose(CommandLine& parent, CommonOptions& common);
[[nodiscard]] Command addScore(CommandLine& parent, CommonOptions& common);
[[nodiscard]] Command addPlay(CommandLine& parent, CommonOptions& common);
[[nodiscard]] Command addLive(CommandLine& parent, CommonOptions& common);
[[nodiscard]] Command addRecord(CommandLine& parent, CommonOptions& common);
[[nodiscard]] Command addReplay(CommandLine& parent, CommonOptions& common);
[[nodiscard]] Command addInfo(CommandLine& parent, CommonOptions& common);
[[nodiscard]] Command addConvert(CommandLine& parent, CommonOptions& common);
[[nodiscard]] Command addSnapshot(CommandLine& parent, CommonOptions& common);

}  // namespace lorica

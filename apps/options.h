#pragma once

#include "apps/command_line.h"
#include "apps/report.h"
#include "geometry/result.h"
#include "geometry/work_budgets.h"
#include "prepare/host.h"

#include <functional>
#include <string>
#include <vector>

namespace lorica {

/// A subcommand: its options, and the function that runs it.
struct Command {
  CommandLine* app = nullptr;
  std::function<Result<void>(const CommonOptions&, Host&)> run;
  std::function<int()> status = {};  ///< exit status of a run without an error; null = 0
};

/// Adds a subcommand with the common options --json, --threads, --trust-paths, --memory and --help.
/// @param examples  lines "command  # what it does", shown under the options
[[nodiscard]] CommandLine* addSubcommand(CommandLine& parent, CommonOptions& common, const std::string& name,
                                         const std::string& description, const std::string& examples);

/// An option with an integer value from `min` to `max`; other values are rejected.
Option* addCount(CommandLine& app, const std::string& name, int& value, int min, const std::string& description,
                 int max = kMaxOfAnything);

/// The value of addCountOrAuto() for the word `auto`.
inline constexpr int kAuto = -1;

/// An option with an integer value of at least `min`, or the word `auto`.
Option* addCountOrAuto(CommandLine& app, const std::string& name, int& value, int min, const std::string& description);

/// A check that accepts one of several words; other values are rejected.
[[nodiscard]] TextCheck oneOf(std::vector<std::string> words);

/// An option with a time since the beginning: 0 s or more.
Option* addMoment(CommandLine& app, const std::string& name, double& value, const std::string& description);
/// An option with a positive number of seconds.
Option* addSeconds(CommandLine& app, const std::string& name, double& value, const std::string& description);
/// An option with a positive number.
Option* addPositive(CommandLine& app, const std::string& name, double& value, const std::string& description,
                    const std::string& typeName);
/// An option with a positive length.
Option* addLength(CommandLine& app, const std::string& name, double& value, const std::string& description);
/// An option with a positive fraction, as a number or in percent: 0.05 or 5%.
Option* addShare(CommandLine& app, const std::string& name, double& value, const std::string& description);

/// One source file per subcommand: demo.cpp, decompose.cpp, score.cpp, play.cpp, live.cpp, record.cpp, replay.cpp,
/// info.cpp, convert.cpp, export.cpp, snapshot.cpp, bake.cpp, serve.cpp, contacts.cpp.
using AddCommand = Command(CommandLine& parent, CommonOptions& common);
[[nodiscard]] AddCommand addDemo, addDecompose, addScore, addPlay, addLive, addRecord, addReplay, addInfo, addConvert,
    addExport, addSnapshot, addServe, addContacts, addBake;

}  // namespace lorica

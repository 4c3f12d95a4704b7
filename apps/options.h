#pragma once

#include "apps/report.h"
#include "geometry/result.h"

#include <CLI/CLI.hpp>

#include <functional>
#include <string>
#include <vector>

namespace lorica {

/// A subcommand: how CLI11 knows it, and what it does once its arguments are understood.
struct Command {
  CLI::App* app = nullptr;
  std::function<Result<void>(const CommonOptions&)> run;
  std::function<int()> status = {};  ///< exit status of a run without an error; null = 0
};

/// A subcommand with the options that all share: --json, --threads, --help.
/// @param examples  lines "command  # what it does", shown under the options
[[nodiscard]] CLI::App* addSubcommand(CLI::App& parent, CommonOptions& common, const std::string& name,
                                      const std::string& description, const std::string& examples);

/// An option that takes a whole number of at least `least`; anything else is refused in a sentence.
CLI::Option* addCount(CLI::App& app, const std::string& name, int& value, int least, const std::string& description);

/// What addCountOrAuto() makes of the word `auto`.
inline constexpr int kAuto = -1;

/// An option that takes a whole number of at least `least`, or the word `auto`.
CLI::Option* addCountOrAuto(CLI::App& app, const std::string& name, int& value, int least,
                            const std::string& description);

/// A check for an option that takes one of a few words; anything else is refused in a sentence.
[[nodiscard]] CLI::Validator oneOf(std::vector<std::string> words);

/// An option that takes seconds above zero.
CLI::Option* addSeconds(CLI::App& app, const std::string& name, double& value, const std::string& description);

/// An option that takes a number above zero.
CLI::Option* addPositive(CLI::App& app, const std::string& name, double& value, const std::string& description,
                         const std::string& typeName);

/// An option that takes a length above zero.
CLI::Option* addLength(CLI::App& app, const std::string& name, double& value, const std::string& description);

/// An option that takes a share above zero, as a number or in percent: 0.05 or 5%.
CLI::Option* addShare(CLI::App& app, const std::string& name, double& value, const std::string& description);

/// One file a subcommand: demo.cpp, decompose.cpp, score.cpp, play.cpp, live.cpp, record.cpp, replay.cpp, info.cpp,
/// convert.cpp, snapshot.cpp.
[[nodiscard]] Command addDemo(CLI::App& parent, CommonOptions& common);
[[nodiscard]] Command addDecompose(CLI::App& parent, CommonOptions& common);
[[nodiscard]] Command addScore(CLI::App& parent, CommonOptions& common);
[[nodiscard]] Command addPlay(CLI::App& parent, CommonOptions& common);
[[nodiscard]] Command addLive(CLI::App& parent, CommonOptions& common);
[[nodiscard]] Command addRecord(CLI::App& parent, CommonOptions& common);
[[nodiscard]] Command addReplay(CLI::App& parent, CommonOptions& common);
[[nodiscard]] Command addInfo(CLI::App& parent, CommonOptions& common);
[[nodiscard]] Command addConvert(CLI::App& parent, CommonOptions& common);
[[nodiscard]] Command addSnapshot(CLI::App& parent, CommonOptions& common);

}  // namespace lorica

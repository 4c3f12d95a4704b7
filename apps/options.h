#pragma once

#include "apps/report.h"
#include "collision/hulls/host.h"
#include "geometry/result.h"
#include "geometry/work_budgets.h"

#include <CLI/CLI.hpp>

#include <charconv>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <type_traits>
#include <utility>
#include <vector>

namespace lorica {

/// What CLI11 lacks: help as wide as the terminal, in groups and short or whole; sentences with what was found, what
/// was expected and what may have been meant; output that cannot be written is an error.

/// The whole command. @param version  what --version prints
[[nodiscard]] std::unique_ptr<CLI::App> makeCommandLine(const std::string& name, const std::string& description,
                                                        const std::string& version);
[[nodiscard]] std::vector<std::string> subcommandNames(const CLI::App& app);

/// Parses the words after the program's name.
/// @return the exit status if there is nothing more to do: help was shown, or an error was printed
[[nodiscard]] std::optional<int> parse(CLI::App& app, std::vector<std::string> words);

/// Checks the text of an option's value and may change it.
/// @return empty if it is valid, else what was found and what was expected
using TextCheck = std::function<std::string(std::string&)>;

/// For Option::transform().
[[nodiscard]] inline CLI::Validator checkedBy(TextCheck check) {
  return CLI::Validator(std::move(check), "");
}

/// Parses the whole text as a number. @return false if it is not one
template <typename Number>
[[nodiscard]] bool parseWhole(const std::string& text, Number& number) {
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && stopped == end;
}

/// Why a text is no number of the type; empty if it is one. For Option::check().
template <typename Number>
[[nodiscard]] std::string numberError(const std::string& text) {
  Number parsed{};
  if (CLI::detail::lexical_cast(text, parsed)) return "";
  return "found `" + text + "`, expected a " + (std::is_integral_v<Number> ? "whole number" : "number");
}

/// An option with a value of any type that CLI11 reads.
template <typename Value>
CLI::Option* addOption(CLI::App& app, const std::string& name, Value& value, const std::string& typeName,
                       const std::string& description) {
  return app.add_option(name, value, description)->type_name(typeName);
}

/// The same that may be repeated.
template <typename Value>
CLI::Option* addRepeated(CLI::App& app, const std::string& name, std::vector<Value>& values,
                         const std::string& typeName, const std::string& description) {
  return addOption(app, name, values, typeName, description)->expected(1)->take_all();
}

/// An option of any type. @param read  puts each value where it belongs, and returns as TextCheck does
CLI::Option* addReader(CLI::App& app, const std::string& name, TextCheck read, const std::string& typeName,
                       const std::string& description);

/// An option with an integer value from `min` to `max`; other values are rejected.
CLI::Option* addCount(CLI::App& app, const std::string& name, int& value, int min, const std::string& description,
                      int max = kMaxOfAnything);

/// The value of addCountOrAuto() for the word `auto`.
inline constexpr int kAuto = -1;

/// An option with an integer value of at least `min`, or the word `auto`.
CLI::Option* addCountOrAuto(CLI::App& app, const std::string& name, int& value, int min,
                            const std::string& description);

/// A check that accepts one of several words; other values are rejected.
[[nodiscard]] CLI::Validator oneOf(std::vector<std::string> words);

/// An option with a time since the beginning: 0 s or more.
CLI::Option* addMoment(CLI::App& app, const std::string& name, double& value, const std::string& description);
/// An option with a positive number of seconds.
CLI::Option* addSeconds(CLI::App& app, const std::string& name, double& value, const std::string& description);
/// An option with a positive number.
CLI::Option* addPositive(CLI::App& app, const std::string& name, double& value, const std::string& typeName,
                         const std::string& description);
/// An option with a positive length.
CLI::Option* addLength(CLI::App& app, const std::string& name, double& value, const std::string& description);
/// An option with a positive fraction, as a number or in percent: 0.05 or 5%.
CLI::Option* addShare(CLI::App& app, const std::string& name, double& value, const std::string& description);

/// "8G" as bytes, with the units of Slurm: K, M, G, T are powers of 1024.
[[nodiscard]] std::optional<std::uint64_t> bytesIn(const std::string& text);

/// A check that accepts what bytesIn() knows, from a number of megabytes on.
[[nodiscard]] CLI::Validator memorySize(std::uint64_t leastMegabytes = 0);

/// A subcommand: its options, and the function that runs it.
struct Command {
  CLI::App* app = nullptr;
  std::function<Result<void>(const CommonOptions&, Host&)> run;
  std::function<int()> status = {};  ///< exit status of a run without an error; null = 0
};

/// Adds a subcommand with the common options --json, --threads, --trust-paths, --memory and --help.
/// @param examples  lines "command  # what it does", shown under the options
[[nodiscard]] CLI::App* addSubcommand(CLI::App& parent, CommonOptions& common, const std::string& name,
                                      const std::string& description, const std::string& examples);

/// One source file per subcommand: demo.cpp, decompose.cpp, score.cpp, play.cpp, live.cpp, record.cpp, replay.cpp,
/// info.cpp, convert.cpp, export.cpp, snapshot.cpp, bake.cpp, serve.cpp, contacts.cpp.
using AddCommand = Command(CLI::App& parent, CommonOptions& common);
[[nodiscard]] AddCommand addDemo, addDecompose, addScore, addPlay, addLive, addRecord, addReplay, addInfo, addConvert,
    addExport, addSnapshot, addServe, addContacts, addBake;

}  // namespace lorica

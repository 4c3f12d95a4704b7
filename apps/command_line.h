#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace lorica {

/// Exit status where arguments or files were refused.
inline constexpr int kBadInputStatus = 2;

/// Looks at the text that an option was given, and may change it.
/// @return empty when it is fine, else what was found and what was expected
using TextCheck = std::function<std::string(std::string&)>;

/// One option, flag or positional argument. A thin cover of CLI11's, whose headers take longer to compile than a whole
/// subcommand: one source file includes them.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  /// What stands for the value in the help; empty for a positional argument, whose name says it.
  Option* typeName(const std::string& name);
  Option* required();
  Option* check(TextCheck check);
  Option* excludes(Option* other);
  Option* needs(Option* other);
  /// Several values in one word, told apart by a sign: 1,2,3.
  Option* separatedBy(char sign);
  /// One value each time that the option is given, and all of them count.
  Option* repeatable();

 private:
  CLI::Option* option_;
};

/// The options of the whole command or of one subcommand. Values are written where the references say, by parse().
class CommandLine {
 public:
  CommandLine(const std::string& name, const std::string& description, const std::string& version);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// @param footer  shown under the options
  CommandLine* addSubcommand(const std::string& name, const std::string& description, const std::string& footer);
  void footer(const std::string& text);

  /// @param name  "--long", "-s,--long", or a bare word for a positional argument
  Option* addOption(const std::string& name, std::string& value, const std::string& description);
  Option* addOption(const std::string& name, int& value, const std::string& description);
  Option* addOption(const std::string& name, double& value, const std::string& description);
  Option* addOption(const std::string& name, std::optional<double>& value, const std::string& description);
  Option* addOption(const std::string& name, std::vector<std::string>& values, const std::string& description);
  Option* addOption(const std::string& name, std::vector<double>& values, const std::string& description);
  Option* addOption(const std::string& name, std::vector<int>& values, const std::string& description);
  Option* addFlag(const std::string& name, bool& value, const std::string& description);

  /// Of the whole command: reads the arguments.
  /// @return the exit status where there is nothing more to do: help was shown, or a sentence said what is wrong
  [[nodiscard]] std::optional<int> parse(int argc, char** argv);

  /// Whether this subcommand was asked for, and whether this option of it was given.
  [[nodiscard]] bool parsed() const;
  [[nodiscard]] bool given(const std::string& option) const;

 private:
  explicit CommandLine(CLI::App* app);
  template <typename Value>
  Option* add(const std::string& name, Value& value, const std::string& description);
  [[nodiscard]] std::string subcommandNames() const;
  [[nodiscard]] std::string helpCommand() const;

  std::unique_ptr<CLI::App> root_;  ///< null for a subcommand
  CLI::App* app_;
  std::deque<Option> options_;
  std::deque<std::unique_ptr<CommandLine>> subcommands_;
};

}  // namespace lorica

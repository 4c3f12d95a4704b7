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
class ParseError;
}  // namespace CLI

namespace lorica {

/// Exit status for rejected arguments or files, and for output that cannot be written.
inline constexpr int kBadInputStatus = 2;

/// Checks the text of an option's value and may change it.
/// @return empty if it is valid, else what was found and what was expected
using TextCheck = std::function<std::string(std::string&)>;

/// Reads an option's value and puts it where it belongs.
/// @return as of TextCheck
using TextReader = std::function<std::string(const std::string&)>;

/// One option, flag or positional argument. A thin wrapper of CLI11, whose headers take longer to compile than a whole
/// subcommand: only one source file includes them.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option* required();
  Option* check(TextCheck check);
  Option* excludes(Option* other);
  Option* needs(Option* other);
  /// Several values in one word, separated by a character: 1,2,3.
  Option* separatedBy(char sign);
  /// The option may be given several times; all values are kept.
  Option* repeatable();

 private:
  CLI::Option* option_;
};

/// The options of the whole command or of one subcommand. parse() writes the values to the given references.
class CommandLine {
 public:
  CommandLine(const std::string& name, const std::string& description, const std::string& version);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// @param footer  shown under the options
  CommandLine* addSubcommand(const std::string& name, const std::string& description, const std::string& footer);
  void footer(const std::string& text);
  /// The heading in the help of the subcommands that are added from now on.
  void group(const std::string& name);

  /// @param name  "--long", "-s,--long", or a word without dashes for a positional argument
  /// @param value  text, a number, an optional number, or a list of one of these
  /// @param typeName  the placeholder of the value in the help; a positional argument's name is enough
  template <typename Value>
  Option* addOption(const std::string& name, Value& value, const std::string& description,
                    const std::string& typeName = "");
  /// An option of any other type. @param read  is called for each of its values
  Option* addOption(const std::string& name, TextReader read, const std::string& description,
                    const std::string& typeName);
  Option* addFlag(const std::string& name, bool& value, const std::string& description);

  /// Parses the arguments; for the whole command only.
  /// @return the exit status if there is nothing more to do: help was shown, or an error was printed
  [[nodiscard]] std::optional<int> parse(int argc, char** argv);

  /// Whether this subcommand was chosen, and whether one of its options was given.
  [[nodiscard]] bool parsed() const;
  [[nodiscard]] bool given(const std::string& option) const;
  [[nodiscard]] std::vector<std::string> subcommandNames() const;

 private:
  explicit CommandLine(CLI::App* app);
  [[nodiscard]] std::string unexpected(const std::string& argument, bool opened) const;
  [[nodiscard]] std::string helpCommand() const;
  [[nodiscard]] int printHelp(const CLI::ParseError& asked) const;

  std::unique_ptr<CLI::App> root_;  ///< null for a subcommand
  CLI::App* app_;
  std::string group_;
  std::deque<Option> options_;
  std::deque<std::unique_ptr<CommandLine>> subcommands_;
};

}  // namespace lorica

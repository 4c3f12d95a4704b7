#include "apps/command_line.h"

#include "apps/report.h"
#include "geometry/text.h"
#include "prepare/read_motion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <sstream>
#include <string_view>
#include <type_traits>
#include <utility>

namespace lorica {
namespace {

constexpr std::size_t kColumnWidth = 30;  // of the options' names in the help
constexpr std::size_t kGap = 2;           // minimum between a name and its description
constexpr const char* kOwnOptions = "Options";

/// Columns for the help: those of the terminal, else what COLUMNS says, else 100; at least 60 and at most 120, since
/// longer lines read badly.
int helpWidth() {
  winsize window{};
  int columns = 100;
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 0) {
    columns = window.ws_col;
  } else if (const char* wished = std::getenv("COLUMNS")) {
    columns = std::atoi(wished);
  }
  return std::clamp(columns, 60, 120);
}

/// Breaks a text between words so that no line reaches beyond the width, if no word does.
/// @param column  where the text begins in its first line; the others are indented to it
std::string wrapped(std::string_view text, std::size_t column, std::size_t width) {
  std::string result;
  std::size_t at = column;
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(text.size(), word.size() + 1));
    if (at > column && at + 1 + word.size() > width) {
      result += "\n" + std::string(column, ' ');
      at = column;
    } else if (at > column) {
      result += ' ';
      ++at;
    }
    result += word;
    at += word.size();
  }
  return result;
}

/// CLI11's layout, but lines are as long as the terminal is wide, and a name that leaves less than kGap before the
/// description is followed by a line break.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() { column_width(kColumnWidth); }

  std::string make_option(const CLI::Option* option, bool positional) const override {
    std::string text = "  " + make_option_name(option, positional) + make_option_opts(option);
    const std::string description = make_option_desc(option);
    if (description.empty()) return text + "\n";
    if (text.size() + kGap > kColumnWidth) {
      text += "\n" + std::string(kColumnWidth, ' ');
    } else {
      text.resize(kColumnWidth, ' ');
    }
    return text + wrapped(description, kColumnWidth, width_) + "\n";
  }

  std::string make_subcommand(const CLI::App* command) const override {
    std::string name = "  " + command->get_name();
    name.resize(kColumnWidth, ' ');
    return name + wrapped(command->get_description(), kColumnWidth, width_) + "\n";
  }

  std::string make_description(const CLI::App* app) const override {
    return wrapped(app->get_description(), 0, width_) + "\n";
  }

  /// In the short help of a command, what it shares with others is only named.
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    if (mode != CLI::AppFormatMode::Normal || app->get_parent() == nullptr)
      return Formatter::make_help(app, name, mode);
    std::string own, more;
    for (const std::string& group : app->get_groups()) {
      const auto options = app->get_options(
          [&](const CLI::Option* option) { return option->get_group() == group && option->nonpositional(); });
      if (group == kOwnOptions) {
        own = make_group(group, false, options);
      } else if (!group.empty()) {
        std::string names = options[0]->get_name();
        for (std::size_t i = 1; i < options.size(); ++i) names += " " + options[i]->get_name();
        more += fmt::format("  {:{}}{}\n", group, kColumnWidth - 2, wrapped(names, kColumnWidth, width_));
      }
    }
    return make_description(app) + make_usage(app, name) + make_positionals(app) + own +
           "\nMore, explained by --help:\n" + more + "\n" + make_footer(app);
  }

 private:
  std::size_t width_ = helpWidth();
};

/// The heading of an option in the help of every command, whichever has it.
std::string groupOf(const std::string& option) {
  static constexpr std::array<std::array<std::string_view, 2>, 6> kGroups = {{
      {"Motion",
       " --motion --format --person --clip --rest --sender --mirror --upper-body --smooth --min-cutoff --beta "
       "--inject --keyframes "},
      {"Character", " --character --map --body --body-resolution --walls --thickness --expression --hide --springs "},
      {"Hulls",
       " --decomposition --cover --hull-vertices --parts --exact --max-error --max-distance "
       "--max-concavity --preset --candidates --orientations --held-out --engine --per-bone --self-contacts "},
      {"Cameras and networks",
       " --device --devices --driver --virtual --people --lower-body --nite --vmc --delay --vmc-out "
       "--vmc-bones --vrchat --vrchat-trackers --serve --port --lan --certificate --key "},
      {"Pictures",
       " --window --headless --snapshots --every --video --from --to --camera --eye --target --texture-size "
       "--size --background --show --strip "},
      {"Every command", " --json --threads --force --trust-paths --memory "},
  }};
  for (const auto& [group, names] : kGroups) {
    if (names.find(" " + option + " ") != std::string_view::npos) return std::string(group);
  }
  return kOwnOptions;
}

/// Why a text is not of a number's type; empty if it is.
template <typename Number>
std::string numberError(const std::string& text) {
  Number parsed{};
  if (CLI::detail::lexical_cast(text, parsed)) return "";
  return fmt::format("found `{}`, expected a {}number", text, std::is_integral_v<Number> ? "whole " : "");
}

CLI::Validator validatorOf(TextCheck check) {
  CLI::Validator validator("");
  validator.operation(std::move(check));
  return validator;
}

}  // namespace

Option* Option::required() {
  option_->required();
  return this;
}

Option* Option::check(TextCheck check) {
  // Unlike check(), transform() may change the text.
  option_->transform(validatorOf(std::move(check)));
  return this;
}

Option* Option::excludes(Option* other) {
  option_->excludes(other->option_);
  return this;
}

Option* Option::needs(Option* other) {
  option_->needs(other->option_);
  return this;
}

Option* Option::separatedBy(char sign) {
  option_->delimiter(sign)->expected(1, CLI::detail::expected_max_vector_size);
  return this;
}

Option* Option::repeatable() {
  option_->expected(1)->take_all();
  return this;
}

CommandLine::CommandLine(const std::string& name, const std::string& description, const std::string& version)
    : root_(std::make_unique<CLI::App>(description, name)), app_(root_.get()) {
  app_->set_help_flag("-h,--help", "Show this help");
  app_->set_version_flag("--version", name + " " + version);
  app_->formatter(std::make_shared<HelpFormatter>());
  app_->require_subcommand(0, 1);
}

CommandLine::CommandLine(CLI::App* app) : app_(app) {}

CommandLine::~CommandLine() = default;

CommandLine* CommandLine::addSubcommand(const std::string& name, const std::string& description,
                                        const std::string& footer) {
  CLI::App* app = app_->add_subcommand(name, description);
  app->set_help_flag("-h", "Show the most important options");
  app->set_help_all_flag("--help", "Show all options");
  app->footer(footer);
  if (!group_.empty()) app->group(group_);
  subcommands_.emplace_back(new CommandLine(app));
  return subcommands_.back().get();
}

void CommandLine::footer(const std::string& text) {
  app_->footer(text);
}

template <typename Value>
Option* CommandLine::addOption(const std::string& name, Value& value, const std::string& description,
                               const std::string& typeName) {
  CLI::Option* option = app_->add_option(name, value, description)->group(groupOf(name))->type_name(typeName);
  if constexpr (std::is_same_v<Value, int> || std::is_same_v<Value, std::vector<int>>) {
    option->check(numberError<int>);
  } else if constexpr (!std::is_same_v<Value, std::string> && !std::is_same_v<Value, std::vector<std::string>>) {
    option->check(numberError<double>);
  }
  return &options_.emplace_back(option);
}
template Option* CommandLine::addOption(const std::string&, std::string&, const std::string&, const std::string&);
template Option* CommandLine::addOption(const std::string&, int&, const std::string&, const std::string&);
template Option* CommandLine::addOption(const std::string&, double&, const std::string&, const std::string&);
template Option* CommandLine::addOption(const std::string&, std::optional<double>&, const std::string&,
                                        const std::string&);
template Option* CommandLine::addOption(const std::string&, std::vector<std::string>&, const std::string&,
                                        const std::string&);
template Option* CommandLine::addOption(const std::string&, std::vector<double>&, const std::string&,
                                        const std::string&);
template Option* CommandLine::addOption(const std::string&, std::vector<int>&, const std::string&, const std::string&);

Option* CommandLine::addOption(const std::string& name, TextReader read, const std::string& description,
                               const std::string& typeName) {
  CLI::Option* option = app_->add_option(
      name, [](const CLI::results_t&) { return true; }, description);
  option->group(groupOf(name))->type_name(typeName)->transform(validatorOf(std::move(read)));
  return &options_.emplace_back(option);
}

void CommandLine::group(const std::string& name) {
  group_ = name;
}

Option* CommandLine::addFlag(const std::string& name, bool& value, const std::string& description) {
  return &options_.emplace_back(app_->add_flag(name, value, description)->group(groupOf(name)));
}

std::vector<std::string> CommandLine::subcommandNames() const {
  std::vector<std::string> names;
  for (const auto& command : subcommands_) names.push_back(command->app_->get_name());
  return names;
}

/// Why an argument that nothing takes is refused. @param opened  `lorica walk` would open what ships under that name
std::string CommandLine::unexpected(const std::string& argument, bool opened) const {
  const std::vector<CLI::App*> chosen = app_->get_subcommands();
  if (chosen.empty()) {
    const std::vector<std::string> commands = subcommandNames();
    std::vector<std::string> names = commands;
    if (const Result<std::filesystem::path> folder = recordingsFolder(); opened && folder) {
      const std::vector<std::string> motions = shippedNames(*folder, {".csv", ".oni"});
      names.insert(names.end(), motions.begin(), motions.end());
      names.emplace_back("mannequin");
    }
    if (argument.starts_with("-")) names = {"--help", "--version"};
    const std::string similar = didYouMean(argument, names);
    return fmt::format("{}: unknown {}{}", argument.empty() ? "\"\"" : argument,
                       argument.starts_with("-") ? "option" : "command",
                       similar.empty() ? fmt::format(", expected one of {}", fmt::join(commands, ", ")) : similar);
  }
  if (argument.rfind("--", 0) != 0) {
    const bool live = chosen.front()->get_name() == "live";
    return argument + ": unexpected argument" + (live ? "; `lorica play " + argument + "` plays a recording" : "");
  }
  std::vector<std::string> names;
  for (const CLI::Option* option : chosen.front()->get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  const std::string name = argument.substr(0, argument.find('='));
  if (std::find(names.begin(), names.end(), name) != names.end()) {
    return fmt::format("{0}: stands before the command, expected `{1} {2} {0}`", name, app_->get_name(),
                       chosen.front()->get_name());
  }
  return fmt::format("{}: unknown option{}", name, didYouMean(name, names));
}

/// The help command for the chosen subcommand, for error messages.
std::string CommandLine::helpCommand() const {
  for (const auto& command : subcommands_) {
    if (command->parsed()) return app_->get_name() + " " + command->app_->get_name() + " --help";
  }
  return app_->get_name() + " --help";
}

/// Prints help, a version, or why they could not be printed. @return the exit status
int CommandLine::printHelp(const CLI::ParseError& asked) const {
  std::ostringstream out, err;
  (void)app_->exit(asked, out, err);
  const Result<void> printed = print(out.str(), "the help");
  if (printed) return 0;
  say(fmt::format("{}: {}\n", app_->get_name(), printed.error().message));
  return kBadInputStatus;
}

std::optional<int> CommandLine::parse(int argc, char** argv) {
  const std::string& name = app_->get_name();
  const auto refuse = [&](const std::string& sentence) {
    say(fmt::format("{}: {}\nTry `{}`.\n", name, printable(sentence), helpCommand()));
    return kBadInputStatus;
  };
  std::vector<std::string> arguments(argv + 1, argv + argc);
  // `lorica help play` is `lorica play --help`.
  if (!arguments.empty() && arguments[0] == "help") {
    const std::vector<std::string> names = subcommandNames();
    const bool one = arguments.size() > 1;
    if (one && std::find(names.begin(), names.end(), arguments[1]) == names.end()) {
      return refuse(unexpected(arguments[1], false));
    }
    arguments = one ? std::vector<std::string>{arguments[1], "--help"} : std::vector<std::string>{"--help"};
  }
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
  try {
    app_->parse(std::move(arguments));
  } catch (const CLI::ExtrasError&) {
    const std::vector<std::string> extras = app_->remaining(true);
    return refuse(unexpected(extras.empty() ? "?" : extras.front(), true));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return printHelp(error);  // --help and --version
    return refuse(error.what());
  }
  if (app_->get_subcommands().empty()) {
    return refuse(fmt::format("no command given, expected one of {}", fmt::join(subcommandNames(), ", ")));
  }
  return std::nullopt;
}

bool CommandLine::parsed() const {
  return app_->parsed();
}
bool CommandLine::given(const std::string& option) const {
  return app_->count(option) > 0;
}

}  // namespace lorica

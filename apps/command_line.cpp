#include "apps/command_line.h"

#include "apps/standard_streams.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <sstream>
#include <utility>

namespace lorica {
namespace {

constexpr std::size_t kColumnWidth = 30;  // of the options' names in the help
constexpr std::size_t kGap = 2;           // minimum between a name and its description

/// CLI11's layout, but a name that leaves less than kGap before the description is followed by a line break.
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
    return text + description + "\n";
  }
};

CLI::Validator validatorOf(TextCheck check) {
  CLI::Validator validator("");
  validator.operation(std::move(check));
  return validator;
}

}  // namespace

Option* Option::typeName(const std::string& name) {
  option_->type_name(name);
  return this;
}

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
  option_->delimiter(sign);
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
  app->set_help_flag("-h,--help", "Show this help");
  app->footer(footer);
  subcommands_.emplace_back(new CommandLine(app));
  return subcommands_.back().get();
}

void CommandLine::footer(const std::string& text) {
  app_->footer(text);
}

template <typename Value>
Option* CommandLine::add(const std::string& name, Value& value, const std::string& description) {
  return &options_.emplace_back(app_->add_option(name, value, description));
}

Option* CommandLine::addOption(const std::string& name, std::string& value, const std::string& description) {
  return add(name, value, description);
}
Option* CommandLine::addOption(const std::string& name, int& value, const std::string& description) {
  return add(name, value, description);
}
Option* CommandLine::addOption(const std::string& name, double& value, const std::string& description) {
  return add(name, value, description);
}
Option* CommandLine::addOption(const std::string& name, std::optional<double>& value, const std::string& description) {
  return add(name, value, description);
}
Option* CommandLine::addOption(const std::string& name, std::vector<std::string>& values,
                               const std::string& description) {
  return add(name, values, description);
}
Option* CommandLine::addOption(const std::string& name, std::vector<double>& values, const std::string& description) {
  return add(name, values, description);
}
Option* CommandLine::addOption(const std::string& name, std::vector<int>& values, const std::string& description) {
  return add(name, values, description);
}

Option* CommandLine::addFlag(const std::string& name, bool& value, const std::string& description) {
  return &options_.emplace_back(app_->add_flag(name, value, description));
}

std::string CommandLine::subcommandNames() const {
  std::string names;
  for (const auto& command : subcommands_) names += (names.empty() ? "" : ", ") + command->app_->get_name();
  return names;
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
  try {
    app_->parse(argc, argv);
  } catch (const CLI::ExtrasError&) {
    const std::vector<std::string> extras = app_->remaining(true);
    return refuse(fmt::format("{}: {}", extras.empty() ? "?" : extras.front(),
                              app_->get_subcommands().empty() ? "unknown command, expected one of " + subcommandNames()
                                                              : "unexpected argument"));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return printHelp(error);  // --help and --version
    return refuse(error.what());
  }
  if (app_->get_subcommands().empty()) {
    return refuse("no command given, expected one of " + subcommandNames());
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

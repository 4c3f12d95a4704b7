#include "apps/options.h"

#include "geometry/text.h"
#include "session/prepare/read_motion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string_view>
#include <utility>

namespace lorica {
namespace {

constexpr std::size_t kColumnWidth = 30;  // of the options' names in the help
constexpr std::size_t kGap = 2;           // minimum between a name and its description
constexpr const char* kOwnOptions = "Options";

/// Columns for the help: those of the terminal, else what COLUMNS says, else 100; at least 60 and at most 120, since
/// longer lines read badly.
int helpWidth() {
  const char* const asked = std::getenv("COLUMNS");
  return std::clamp(terminalWidth(STDOUT_FILENO).value_or(asked != nullptr ? std::atoi(asked) : 100), 60, 120);
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

/// Parses the whole text as a number. @return false if it is not one
template <typename Number>
bool parseWhole(const std::string& text, Number& number) {
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && stopped == end;
}

CLI::Validator countBetween(int min, int max, bool orAuto = false) {
  return checkedBy([=](std::string& text) -> std::string {
    int number = 0;
    if (parseWhole(text, number) && number >= min && number <= max) return "";
    if (!orAuto || text != "auto") {
      return fmt::format("found `{}`, expected a whole number from {} to {}{}", text, min, max,
                         orAuto ? ", or auto" : "");
    }
    text = std::to_string(kAuto);
    return "";
  });
}

CLI::Validator numberAboveZero(const char* what) {
  return checkedBy([what](std::string& text) -> std::string {
    double number = 0.0;
    if (parseWhole(text, number) && std::isfinite(number) && number > 0.0) return "";
    return fmt::format("found `{}`, expected {} above 0", text, what);
  });
}

/// Why an argument that nothing takes is refused. @param opened  `lorica walk` would open what ships under that name
std::string unexpected(const CLI::App& app, const std::string& argument, bool opened) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  if (chosen.empty()) {
    const std::vector<std::string> commands = subcommandNames(app);
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
    return fmt::format("{0}: stands before the command, expected `{1} {2} {0}`", name, app.get_name(),
                       chosen.front()->get_name());
  }
  return fmt::format("{}: unknown option{}", name, didYouMean(name, names));
}

/// Prints help, a version, or why they could not be printed. @return the exit status
int printHelp(const CLI::App& app, const CLI::ParseError& asked) {
  std::ostringstream out, err;
  (void)app.exit(asked, out, err);
  const Result<void> printed = print(out.str(), "the help");
  if (printed) return 0;
  say(fmt::format("{}: {}\n", app.get_name(), printed.error().message));
  return kBadInputStatus;
}

}  // namespace

std::unique_ptr<CLI::App> makeCommandLine(const std::string& name, const std::string& description,
                                          const std::string& version) {
  auto app = std::make_unique<CLI::App>(description, name);
  app->set_help_flag("-h,--help", "Show this help");
  app->set_version_flag("--version", name + " " + version);
  app->formatter(std::make_shared<HelpFormatter>());
  app->require_subcommand(0, 1);
  return app;
}

CLI::Option* addReader(CLI::App& app, const std::string& name, TextCheck read, const std::string& description,
                       const std::string& typeName) {
  const auto isRead = [](const CLI::results_t&) { return true; };
  return app.add_option(name, isRead, description)->type_name(typeName)->transform(checkedBy(std::move(read)));
}

std::vector<std::string> subcommandNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

std::optional<int> parse(CLI::App& app, std::vector<std::string> words) {
  for (CLI::App* command : app.get_subcommands({})) {
    for (CLI::Option* option : command->get_options()) {
      option->group(groupOf(option->get_name()));
      if (option->get_positional()) option->type_name("");  // its name is enough
    }
  }
  const std::string& name = app.get_name();
  const auto refuse = [&](const std::string& sentence) {
    const std::vector<CLI::App*> chosen = app.get_subcommands();
    const std::string command = chosen.empty() ? "" : " " + chosen.front()->get_name();
    say(fmt::format("{0}: {1}\nTry `{0}{2} --help`.\n", name, printable(sentence), command));
    return kBadInputStatus;
  };
  // `lorica help play` is `lorica play --help`.
  if (!words.empty() && words[0] == "help") {
    const std::vector<std::string> names = subcommandNames(app);
    const bool one = words.size() > 1;
    if (one && std::ranges::find(names, words[1]) == names.end()) return refuse(unexpected(app, words[1], false));
    words = one ? std::vector<std::string>{words[1], "--help"} : std::vector<std::string>{"--help"};
  }
  std::ranges::reverse(words);  // as CLI11 takes them
  try {
    app.parse(std::move(words));
  } catch (const CLI::ExtrasError&) {
    const std::vector<std::string> extras = app.remaining(true);
    return refuse(unexpected(app, extras.empty() ? "?" : extras.front(), true));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return printHelp(app, error);  // --help and --version
    return refuse(error.what());
  }
  if (app.get_subcommands().empty()) {
    return refuse(fmt::format("no command given, expected one of {}", fmt::join(subcommandNames(app), ", ")));
  }
  return std::nullopt;
}

CLI::App* addSubcommand(CLI::App& parent, CommonOptions& common, const std::string& name,
                        const std::string& description, const std::string& examples) {
  CLI::App* app = parent.add_subcommand(name, description);
  app->set_help_flag("-h", "Show the most important options");
  app->set_help_all_flag("--help", "Show all options");
  app->footer("Examples:\n" + examples);
  app->add_option("--json", common.json, "Write the report as JSON; `-` = to standard output, instead of the text")
      ->type_name("FILE");
  app->add_option("--threads", common.threads,
                  "Number of threads; the result does not depend on it [default: all cores]")
      ->type_name("N")
      ->transform(countBetween(1, kMaxThreads));
  app->add_flag("--force", common.force, "Overwrite files that exist");
  app->add_flag("--trust-paths", common.trustPaths,
                "Characters, scenes and sessions may name files outside their own folders");
  if (name != "bake") {  // whose option of that name is for all its processes
    app->add_option("--memory", common.memory,
                    "Memory that the command may take [default: 2G, or 200 bytes for each byte of its files; no limit "
                    "with --window]")
        ->type_name("SIZE")
        ->transform(memorySize(64));  // less does not hold the libraries
  }
  return app;
}

CLI::Option* addCount(CLI::App& app, const std::string& name, int& value, int min, const std::string& description,
                      int max) {
  return app.add_option(name, value, description)->type_name("N")->transform(countBetween(min, max));
}

CLI::Option* addCountOrAuto(CLI::App& app, const std::string& name, int& value, int min,
                            const std::string& description) {
  return app.add_option(name, value, description)->type_name("N")->transform(countBetween(min, kMaxOfAnything, true));
}

CLI::Validator oneOf(std::vector<std::string> words) {
  return checkedBy([words = std::move(words)](std::string& text) -> std::string {
    if (std::find(words.begin(), words.end(), text) != words.end()) return "";
    return fmt::format("found `{}`, expected {}", text, fmt::join(words, ", "));
  });
}

std::optional<std::uint64_t> bytesIn(const std::string& text) {
  std::uint64_t number = 0;
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || number == 0 || end - stopped != 1) return std::nullopt;
  constexpr std::string_view kUnits = "KMGT";
  const std::size_t unit = kUnits.find(*stopped);
  constexpr std::uint64_t kMax = std::uint64_t{1} << 20;
  if (unit == std::string_view::npos || number > kMax) return std::nullopt;
  return number << (10 * (unit + 1));
}

CLI::Validator memorySize(std::uint64_t leastMegabytes) {
  return checkedBy([leastMegabytes](std::string& text) -> std::string {
    const std::optional<std::uint64_t> bytes = bytesIn(text);
    if (bytes && *bytes >> 20 >= leastMegabytes) return "";
    const std::string least = leastMegabytes > 0 ? fmt::format(", at least {}M", leastMegabytes) : "";
    return fmt::format("found `{}`, expected a size such as 500M or 8G{}", text, least);
  });
}

CLI::Option* addMoment(CLI::App& app, const std::string& name, double& value, const std::string& description) {
  const auto check = [](std::string& text) -> std::string {
    double number = 0.0;
    if (parseWhole(text, number) && std::isfinite(number) && number >= 0.0) return "";
    return fmt::format("found `{}`, expected 0 seconds or more", text);
  };
  return app.add_option(name, value, description)->type_name("S")->transform(checkedBy(check));
}

CLI::Option* addSeconds(CLI::App& app, const std::string& name, double& value, const std::string& description) {
  return app.add_option(name, value, description)->type_name("S")->transform(numberAboveZero("seconds"));
}

CLI::Option* addPositive(CLI::App& app, const std::string& name, double& value, const std::string& description,
                         const std::string& typeName) {
  return app.add_option(name, value, description)->type_name(typeName)->transform(numberAboveZero("a number"));
}

CLI::Option* addLength(CLI::App& app, const std::string& name, double& value, const std::string& description) {
  return app.add_option(name, value, description)->type_name("METRES")->transform(numberAboveZero("a length"));
}

CLI::Option* addShare(CLI::App& app, const std::string& name, double& value, const std::string& description) {
  const auto check = [](std::string& text) -> std::string {
    const bool isPercent = text.ends_with('%');
    double number = 0.0;
    if (!parseWhole(isPercent ? text.substr(0, text.size() - 1) : text, number) || !(number > 0.0) ||
        !std::isfinite(number)) {
      return fmt::format("found `{}`, expected a fraction above 0, such as 0.05 or 5%", text);
    }
    if (!isPercent && number >= 1.0) {
      return fmt::format("found `{}`, expected a fraction below 1, such as 0.05, or percent; did you mean \"{}%\"?",
                         text, text);
    }
    if (isPercent) text = fmt::format("{}", number / 100.0);
    return "";
  };
  return app.add_option(name, value, description)->type_name("E")->transform(checkedBy(check));
}

}  // namespace lorica

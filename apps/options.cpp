#include "apps/options.h"

#include "geometry/result.h"
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
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

namespace lorica {
namespace {

constexpr std::size_t kColumnWidth = 30;  // of the options' names in the help
constexpr std::size_t kGap = 2;           // minimum between a name and its description
constexpr int kFewExamples = 4;           // of the short help

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

/// What options are for, in the help of every command; in each heading those that are used most come first.
struct Heading {
  const char* name;
  const char* options;
};
constexpr std::array<Heading, 10> kHeadings = {{
    {"Whom it follows",
     "--vmc --depth --depth-format --virtual --webcam --device --devices --driver --people --three-point --lower-body "
     "--nite --delay"},
    {"The character",
     "--character --map --write-map --hide --springs --expression --body --walls --thickness --body-resolution"},
    {"Where it is seen", "--window --serve --lan --vr --headless --port --recordings --certificate --key"},
    {"What is seen", "--scene --background --size --camera --show --eye --target --strip --texture-size"},
    {"The motion",
     "--motion --clip --person --format --lens --rest --mirror --upper-body --smooth --min-cutoff --beta --keyframes "
     "--sender --inject"},
    {"The parts and hulls",
     "--parts --max-concavity --max-error --max-distance --exact --preset --engine --hull-vertices --hull-planes "
     "--per-bone --decomposition --cover --capsules --package --mocap --khr --show-colliders --up --self-contacts "
     "--held-out --candidates --orientations"},
    {"What it writes",
     "--out --output --export --export-obj --export-frames --picture --csv --snapshots --every --video --from --to "
     "--at --frame --near --record --seconds --frames --as-fast-as-possible --events --camera-frame"},
    {"What it sends", "--vmc-out --vmc-bones --vrchat --vmt --trackers"},
    {"How the library is done", "--jobs --shard --timeout --retry-failed --collect"},
    {"Every command", "--json --force --threads --memory --trust-paths --help -h"},
}};

/// What a user new to a command needs first: the short help explains these, and the other help begins with their
/// headings.
constexpr std::array<Heading, 14> kUsedMost = {{
    {"demo", "--window --serve --scene --headless --out --seconds"},
    {"play", "--character --window --serve --scene --snapshots --video --clip --record"},
    {"live", "--character --vmc --depth --virtual --serve --window --background --scene"},
    {"serve", "--character --lan --vmc --virtual --scene --window"},
    {"replay", "--window --video --snapshots --character"},
    {"snapshot", "--out --at --character --show --scene --background --size --camera --video"},
    {"decompose", "--parts --max-concavity --hull-vertices --preset --output --export-obj --picture"},
    {"export", "--engine --hull-vertices --parts --per-bone --motion --at"},
    {"convert", "--character --person --clip --format"},
    {"record", "--vmc --virtual --character --seconds --people"},
    {"bake", "--out --parts --export --engine --jobs --collect"},
    {"info", "--devices --write-map --clip --hide"},
    {"score", "--csv --every"},
    {"contacts", "--out --character --scene --near"},
}};

/// Those of some options that the command has.
std::vector<const CLI::Option*> optionsIn(const CLI::App& command, const char* names) {
  std::vector<const CLI::Option*> options;
  std::istringstream words(names);
  for (std::string word; words >> word;) {
    if (const CLI::Option* option = command.get_option_no_throw(word)) options.push_back(option);
  }
  return options;
}

/// " (with --serve, not with --window)"
std::string conditionsOf(const CLI::Option& option) {
  const auto listed = [](const std::set<CLI::Option*>& others) {
    std::set<std::string> names;
    for (const CLI::Option* other : others) names.insert(other->get_name());
    return fmt::format("{}", fmt::join(names, ", "));
  };
  std::string text;
  if (!option.get_needs().empty()) text = "with " + listed(option.get_needs());
  if (!option.get_excludes().empty())
    text += (text.empty() ? "" : "; ") + ("not with " + listed(option.get_excludes()));
  return text.empty() ? "" : " (" + text + ")";
}

/// Help in groups, short or whole. Lines are as long as the terminal is wide, and a name that leaves less than kGap
/// before the description is followed by a line break.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() {
    column_width(kColumnWidth);
    label("SUBCOMMAND", "COMMAND");
  }

  std::string make_option(const CLI::Option* option, bool positional) const override {
    std::string text = "  " + make_option_name(option, positional);
    if (positional && option->get_expected_max() > 1) text += "...";
    if (!positional && option->get_type_size() != 0) text += " " + option->get_type_name();
    const std::string description = option->get_description() + conditionsOf(*option);
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

  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    if (app->get_parent() == nullptr) return Formatter::make_help(app, name, mode);
    const bool whole = mode == CLI::AppFormatMode::All;
    std::string text = make_description(app) + make_usage(app, name);
    const auto add = [&](const auto& options) {
      for (const CLI::Option* option : options) text += make_option(option, option->get_positional());
    };
    if (const auto given = app->get_options([](const CLI::Option* o) { return o->get_positional(); }); !given.empty()) {
      text += "\n";
      add(given);
    }
    const auto* own =
        std::ranges::find(kUsedMost, app->get_name(), [](const Heading& one) { return std::string(one.name); });
    LORICA_CHECK(own != kUsedMost.end(), "a command is not in kUsedMost");
    const std::vector<const CLI::Option*> most = optionsIn(*app, own->options);
    using Group = std::pair<const char*, std::vector<const CLI::Option*>>;
    std::vector<Group> groups;
    groups.reserve(kHeadings.size());
    for (const Heading& heading : kHeadings) groups.emplace_back(heading.name, optionsIn(*app, heading.options));
    std::ranges::stable_sort(
        groups, {}, [&](const Group& group) { return std::ranges::find_first_of(most, group.second) - most.begin(); });
    std::size_t grouped = 0;
    for (const Group& group : groups) grouped += group.second.size();
    LORICA_CHECK(grouped == app->get_options([](const CLI::Option* o) { return !o->get_positional(); }).size(),
                 "an option of a command is in no heading of kHeadings");
    if (!whole) {
      text += "\nUsed most:\n";
      add(most);
      text += "\nMore, explained by --help:\n";
    }
    for (const auto& [heading, options] : groups) {
      if (whole && !options.empty()) {
        text += fmt::format("\n{}:\n", heading);
        add(options);
      }
      std::string names;
      for (const CLI::Option* option : options) {
        if (std::ranges::find(most, option) == most.end()) names += (names.empty() ? "" : " ") + option->get_name();
      }
      if (!whole && !names.empty()) {
        text += fmt::format("  {:{}}{}\n", heading, kColumnWidth - 2, wrapped(names, kColumnWidth, width_));
      }
    }
    return text + "\n" + footerOf(*app, whole) + "\n";
  }

 private:
  /// Examples; then, in the whole help, what else is to be known.
  std::string footerOf(const CLI::App& app, bool whole) const {
    const std::string footer = app.get_footer();
    const std::size_t end = footer.find("\n\n");
    std::string examples = footer.substr(0, end);
    if (whole) return examples + (end == std::string::npos ? "" : "\n\n" + paragraph(footer.substr(end + 2)));
    std::size_t at = 0;
    for (int i = 0; i <= kFewExamples && at != std::string::npos; ++i) at = examples.find("\n  lorica ", at + 1);
    return examples.substr(0, at);
  }

  std::string paragraph(std::string text) const {
    std::ranges::replace(text, '\n', ' ');
    return wrapped(text, 0, width_);
  }

  std::size_t width_ = helpWidth();
};

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

CLI::Option* addReader(CLI::App& app, const std::string& name, TextCheck read, const std::string& typeName,
                       const std::string& description) {
  const auto isRead = [](const CLI::results_t&) { return true; };
  return app.add_option(name, isRead, description)->type_name(typeName)->transform(checkedBy(std::move(read)));
}

std::vector<std::string> subcommandNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

std::optional<int> parse(CLI::App& app, std::vector<std::string> words) {
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
    if (words.size() > 2)
      return refuse(fmt::format("{}: unexpected argument, expected `{} help {}`", words[2], name, words[1]));
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
  addOption(*app, "--json", common.json, "FILE",
            "Write the report as JSON; `-` = to standard output, instead of the text");
  addOption(*app, "--threads", common.threads, "N",
            "Number of threads; the result does not depend on it [default: all cores]")
      ->transform(countBetween(1, kMaxThreads));
  app->add_flag("--force", common.force, "Overwrite files that exist");
  app->add_flag("--trust-paths", common.trustPaths,
                "Characters, scenes and sessions may name files outside their own folders");
  if (name != "bake") {  // whose option of that name is for all its processes
    addOption(*app, "--memory", common.memory, "SIZE",
              "Memory that the command may take [default: 2G, or 200 bytes for each byte of its files; no limit with "
              "--window]")
        ->transform(memorySize(64));  // less does not hold the libraries
  }
  return app;
}

CLI::Option* addCount(CLI::App& app, const std::string& name, int& value, int min, const std::string& description,
                      int max) {
  return addOption(app, name, value, "N", description)->transform(countBetween(min, max));
}

CLI::Option* addCountOrAuto(CLI::App& app, const std::string& name, int& value, int min,
                            const std::string& description) {
  return addOption(app, name, value, "N", description)->transform(countBetween(min, kMaxOfAnything, true));
}

CLI::Validator oneOf(std::vector<std::string> words) {
  return checkedBy([words = std::move(words)](std::string& text) -> std::string {
    if (std::find(words.begin(), words.end(), text) != words.end()) return "";
    return fmt::format("found `{}`, expected {}{}", text, fmt::join(words, ", "), didYouMean(text, words));
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
  return addOption(app, name, value, "S", description)->transform(checkedBy(check));
}

CLI::Option* addSeconds(CLI::App& app, const std::string& name, double& value, const std::string& description) {
  return addOption(app, name, value, "S", description)->transform(numberAboveZero("seconds"));
}

CLI::Option* addPositive(CLI::App& app, const std::string& name, double& value, const std::string& typeName,
                         const std::string& description) {
  return addOption(app, name, value, typeName, description)->transform(numberAboveZero("a number"));
}

CLI::Option* addLength(CLI::App& app, const std::string& name, double& value, const std::string& description) {
  return addOption(app, name, value, "METRES", description)->transform(numberAboveZero("a length"));
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
  return addOption(app, name, value, "E", description)->transform(checkedBy(check));
}

}  // namespace lorica

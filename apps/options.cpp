#include "apps/options.h"

#include "apps/memory_limit.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace lorica {
namespace {

/// Parses the whole text as a number. @return false if it is not one
template <typename Number>
bool parseWhole(const std::string& text, Number& number) {
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && stopped == end;
}

TextCheck countBetween(int min, int max) {
  return [min, max](std::string& text) -> std::string {
    int number = 0;
    if (parseWhole(text, number) && number >= min && number <= max) return "";
    return fmt::format("found `{}`, expected a whole number from {} to {}", text, min, max);
  };
}

TextCheck numberAboveZero(const char* what) {
  return [what](std::string& text) -> std::string {
    double number = 0.0;
    if (parseWhole(text, number) && std::isfinite(number) && number > 0.0) return "";
    return fmt::format("found `{}`, expected {} above 0", text, what);
  };
}

}  // namespace

CommandLine* addSubcommand(CommandLine& parent, CommonOptions& common, const std::string& name,
                           const std::string& description, const std::string& examples) {
  CommandLine* app = parent.addSubcommand(name, description, "Examples:\n" + examples);
  app->addOption("--json", common.json, "Write the report as JSON; `-` = to standard output, instead of the text",
                 "FILE");
  app->addOption("--threads", common.threads,
                 "Number of threads; the result does not depend on it [default: all cores]", "N")
      ->check(countBetween(1, kMaxThreads));
  app->addFlag("--force", common.force, "Overwrite files that exist");
  app->addFlag("--trust-paths", common.trustPaths,
               "Characters, scenes and sessions may name files outside their own folders");
  if (name != "bake") {  // whose option of that name is for all its processes
    app->addOption("--memory", common.memory,
                   "Memory that the command may take [default: 2G, or 200 bytes for each byte of its files; no limit "
                   "with --window]",
                   "SIZE")
        ->check(memorySize(64));  // less does not hold the libraries
  }
  return app;
}

Option* addCount(CommandLine& app, const std::string& name, int& value, int min, const std::string& description,
                 int max) {
  return app.addOption(name, value, description, "N")->check(countBetween(min, max));
}

Option* addCountOrAuto(CommandLine& app, const std::string& name, int& value, int min, const std::string& description) {
  const TextCheck check = [min](std::string& text) -> std::string {
    int number = 0;
    if (text == "auto") {
      text = std::to_string(kAuto);
    } else if (!parseWhole(text, number) || number < min || number > kMaxOfAnything) {
      return fmt::format("found `{}`, expected a whole number from {} to {}, or auto", text, min, kMaxOfAnything);
    }
    return "";
  };
  return app.addOption(name, value, description, "N")->check(check);
}

TextCheck oneOf(std::vector<std::string> words) {
  return [words = std::move(words)](std::string& text) -> std::string {
    if (std::find(words.begin(), words.end(), text) != words.end()) return "";
    return fmt::format("found `{}`, expected {}", text, fmt::join(words, ", "));
  };
}

Option* addMoment(CommandLine& app, const std::string& name, double& value, const std::string& description) {
  const TextCheck check = [](std::string& text) -> std::string {
    double number = 0.0;
    if (parseWhole(text, number) && std::isfinite(number) && number >= 0.0) return "";
    return fmt::format("found `{}`, expected 0 seconds or more", text);
  };
  return app.addOption(name, value, description, "S")->check(check);
}

Option* addSeconds(CommandLine& app, const std::string& name, double& value, const std::string& description) {
  return app.addOption(name, value, description, "S")->check(numberAboveZero("seconds"));
}

Option* addPositive(CommandLine& app, const std::string& name, double& value, const std::string& description,
                    const std::string& typeName) {
  return app.addOption(name, value, description, typeName)->check(numberAboveZero("a number"));
}

Option* addLength(CommandLine& app, const std::string& name, double& value, const std::string& description) {
  return app.addOption(name, value, description, "METRES")->check(numberAboveZero("a length"));
}

Option* addShare(CommandLine& app, const std::string& name, double& value, const std::string& description) {
  const TextCheck check = [](std::string& text) -> std::string {
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
  return app.addOption(name, value, description, "E")->check(check);
}

}  // namespace lorica

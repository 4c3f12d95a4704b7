#include "apps/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace lorica {
namespace {

constexpr int kMostThreads = 1024;
constexpr int kMostOfAnything = 1000000;

/// The whole text as a number, or nothing.
template <typename Number>
bool parseWhole(const std::string& text, Number& number) {
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && stopped == end;
}

/// CLI11 wants an empty string for "fine" and puts the option's name before any other.
CLI::Validator countBetween(int least, int most) {
  CLI::Validator validator("");
  validator.operation([least, most](std::string& text) -> std::string {
    int number = 0;
    if (parseWhole(text, number) && number >= least && number <= most) return "";
    return fmt::format("found `{}`, expected a whole number from {} to {}", text, least, most);
  });
  return validator;
}

CLI::Validator numberAboveZero(const char* what) {
  CLI::Validator validator("");
  validator.operation([what](std::string& text) -> std::string {
    double number = 0.0;
    if (parseWhole(text, number) && std::isfinite(number) && number > 0.0) return "";
    return fmt::format("found `{}`, expected {} above 0", text, what);
  });
  return validator;
}

}  // namespace

CLI::App* addSubcommand(CLI::App& parent, CommonOptions& common, const std::string& name,
                        const std::string& description, const std::string& examples) {
  CLI::App* app = parent.add_subcommand(name, description);
  app->set_help_flag("-h,--help", "Show this help");
  app->footer("Examples:\n" + examples);
  app->add_option("--json", common.json, "Write the report as JSON; `-` = standard output and nothing else there")
      ->type_name("FILE");
  app->add_option("--threads", common.threads, "Use so many threads; the result is the same [default: all cores]")
      ->type_name("N")
      ->check(countBetween(1, kMostThreads));
  return app;
}

CLI::Option* addCount(CLI::App& app, const std::string& name, int& value, int least, const std::string& description) {
  return app.add_option(name, value, description)->type_name("N")->check(countBetween(least, kMostOfAnything));
}

CLI::Option* addCountOrAuto(CLI::App& app, const std::string& name, int& value, int least,
                            const std::string& description) {
  CLI::Validator validator("");
  validator.operation([least](std::string& text) -> std::string {
    int number = 0;
    if (text == "auto") {
      text = std::to_string(kAuto);
    } else if (!parseWhole(text, number) || number < least || number > kMostOfAnything) {
      return fmt::format("found `{}`, expected a whole number from {} to {}, or auto", text, least, kMostOfAnything);
    }
    return "";
  });
  return app.add_option(name, value, description)->type_name("N")->transform(validator);
}

CLI::Validator oneOf(std::vector<std::string> words) {
  CLI::Validator validator("");
  validator.operation([words = std::move(words)](std::string& text) -> std::string {
    if (std::find(words.begin(), words.end(), text) != words.end()) return "";
    return fmt::format("found `{}`, expected {}", text, fmt::join(words, ", "));
  });
  return validator;
}

CLI::Option* addSeconds(CLI::App& app, const std::string& name, double& value, const std::string& description) {
  return app.add_option(name, value, description)->type_name("S")->check(numberAboveZero("seconds"));
}

CLI::Option* addPositive(CLI::App& app, const std::string& name, double& value, const std::string& description,
                         const std::string& typeName) {
  return app.add_option(name, value, description)->type_name(typeName)->check(numberAboveZero("a number"));
}

CLI::Option* addLength(CLI::App& app, const std::string& name, double& value, const std::string& description) {
  return app.add_option(name, value, description)->type_name("METRES")->check(numberAboveZero("a length"));
}

CLI::Option* addShare(CLI::App& app, const std::string& name, double& value, const std::string& description) {
  CLI::Validator validator("");
  validator.operation([](std::string& text) -> std::string {
    const bool isPercent = text.ends_with('%');
    double number = 0.0;
    if (!parseWhole(isPercent ? text.substr(0, text.size() - 1) : text, number) || !(number > 0.0) ||
        !std::isfinite(number)) {
      return fmt::format("found `{}`, expected a share above 0, such as 0.05 or 5%", text);
    }
    if (isPercent) text = fmt::format("{}", number / 100.0);
    return "";
  });
  return app.add_option(name, value, description)->type_name("E")->transform(validator);
}

}  // namespace lorica

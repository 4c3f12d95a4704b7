#include "apps/interrupt.h"
#include "apps/options.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <exception>
#include <vector>

namespace {

constexpr int kBadInput = 2;

int fail(const lorica::Error& error) {
  if (error.code == lorica::ErrorCode::kCancelled) {
    fmt::print(stderr, "lorica: cancelled\n");
    return lorica::kInterruptedStatus;
  }
  fmt::print(stderr, "lorica: {}\n", error.message);
  return kBadInput;
}

/// The command that the arguments were meant for, to point at its help.
std::string helpFor(const std::vector<lorica::Command>& commands) {
  for (const lorica::Command& command : commands) {
    if (command.app->parsed()) return "lorica " + command.app->get_name() + " --help";
  }
  return "lorica --help";
}

std::string commandNames(const std::vector<lorica::Command>& commands) {
  std::string names;
  for (const lorica::Command& command : commands) names += (names.empty() ? "" : ", ") + command.app->get_name();
  return names;
}

int run(int argc, char** argv) {
  CLI::App app("Lorica: a live motion-capture avatar that collides.", "lorica");
  app.set_help_flag("-h,--help", "Show this help");
  app.set_version_flag("--version", "lorica " LORICA_VERSION);
  app.get_formatter()->column_width(30);
  app.require_subcommand(0, 1);
  app.footer(
      "Examples:\n"
      "  lorica demo                              # see it: a character knocks boxes and balls about\n"
      "  lorica decompose mannequin -o body.lorica\n"
      "  lorica play walk --decomposition body.lorica\n"
      "  lorica live --virtual                    # follow a person before a depth camera, here a virtual one\n"
      "  lorica info hero.glb                     # your own character: what is in it\n"
      "  lorica play walk --character hero.glb --window\n"
      "\n`lorica COMMAND --help` says more about each command.");
  lorica::CommonOptions common;
  const std::vector<lorica::Command> commands = {
      lorica::addDemo(app, common),     lorica::addDecompose(app, common), lorica::addScore(app, common),
      lorica::addPlay(app, common),     lorica::addLive(app, common),      lorica::addRecord(app, common),
      lorica::addReplay(app, common),   lorica::addInfo(app, common),      lorica::addConvert(app, common),
      lorica::addSnapshot(app, common),
  };

  try {
    app.parse(argc, argv);
  } catch (const CLI::ExtrasError& error) {
    const std::vector<std::string> extras = app.remaining(true);
    const bool noCommand = app.get_subcommands().empty();
    fmt::print(stderr, "lorica: {}: {}\nTry `{}`.\n", extras.empty() ? "?" : extras.front(),
               noCommand ? "no such command, expected one of " + commandNames(commands) : "not expected here",
               helpFor(commands));
    return kBadInput;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help and --version
    fmt::print(stderr, "lorica: {}\nTry `{}`.\n", error.what(), helpFor(commands));
    return kBadInput;
  }
  const auto chosen = std::find_if(commands.begin(), commands.end(),
                                   [](const lorica::Command& command) { return command.app->parsed(); });
  if (chosen == commands.end()) {
    fmt::print(stderr, "lorica: no command given, expected one of {}\nTry `lorica --help`.\n", commandNames(commands));
    return kBadInput;
  }

  lorica::watchInterrupt();
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(common.threadCount()));
  const lorica::Result<void> done = chosen->run(common);
  if (!done) return fail(done.error());
  return chosen->status ? chosen->status() : 0;
}

}  // namespace

int main(int argc, char** argv) {
  // No exception of ours reaches this; memory that runs out, or a library's own, still deserves a sentence.
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "lorica: stopped: {}\n", error.what());
    return 1;
  }
}

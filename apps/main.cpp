#include "apps/interrupt.h"
#include "apps/memory_limit.h"
#include "apps/open_file.h"
#include "apps/options.h"
#include "apps/report.h"
#include "apps/standard_streams.h"
#include "apps/terminal_host.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "prepare/abandoned_work.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <exception>
#include <initializer_list>
#include <new>
#include <string>
#include <vector>

namespace {

int fail(const lorica::Error& error) {
  if (error.code == lorica::ErrorCode::kCancelled) {
    lorica::answerInterrupt();
    lorica::sayCancelled();
    return lorica::interruptedStatus();
  }
  lorica::publishFailure(lorica::nameOf(error.code), error.message);
  lorica::say(fmt::format("lorica: {}\n", lorica::printable(error.message)));
  return lorica::kBadInputStatus;
}

int run(int argc, char** argv) {
  lorica::CommandLine app("lorica", "Lorica: a live motion-capture avatar that collides.", LORICA_VERSION);
  app.footer(
      "Examples:\n"
      "  lorica demo                              # a character kicks boxes and balls\n"
      "  lorica decompose mannequin -o body.lorica\n"
      "  lorica play walk --decomposition body.lorica\n"
      "  lorica live --virtual                    # follow a person before a depth camera, here a virtual one\n"
      "  lorica hero.glb                          # open any file: a character, a motion, a recording, a scene\n"
      "  lorica info hero.glb                     # describe your own character\n"
      "  lorica play walk --character hero.glb --window\n"
      "\n`lorica help COMMAND` describes each command.\n"
      "Exit status: 0 = done, 1 = a failure of Lorica, 2 = bad input or output that cannot be written, 130 = Ctrl-C.");
  lorica::CommonOptions common;
  std::vector<lorica::Command> commands;
  const auto add = [&](const char* group, std::initializer_list<lorica::AddCommand*> adding) {
    app.group(group);
    for (const auto one : adding) commands.push_back(one(app, common));
  };
  add("See it move",
      {lorica::addDemo, lorica::addPlay, lorica::addLive, lorica::addServe, lorica::addReplay, lorica::addSnapshot});
  add("Make files", {lorica::addDecompose, lorica::addExport, lorica::addConvert, lorica::addRecord, lorica::addBake});
  add("Learn what is there", {lorica::addInfo, lorica::addScore, lorica::addContacts});

  std::vector<std::string> words = lorica::withCommand({argv + 1, argv + argc}, app.subcommandNames());
  for (std::string& word : words) {  // shells leave --out=~/pictures as it is
    const std::size_t home = word.starts_with("--") ? word.find("=~/") : std::string::npos;
    if (home != std::string::npos && home == word.find('=')) word.replace(home + 1, 1, lorica::environment("HOME"));
  }
  std::vector<char*> arguments = {argv[0]};
  for (std::string& word : words) arguments.push_back(word.data());
  if (const std::optional<int> status = app.parse(int(arguments.size()), arguments.data())) return *status;
  const auto chosen = std::find_if(commands.begin(), commands.end(),
                                   [](const lorica::Command& command) { return command.app->parsed(); });

  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, common.threadCount());
  lorica::TerminalHost host(common);
  lorica::Result<void> done;
  const bool window = std::find(words.begin(), words.end(), "--window") != words.end();
  const bool bake = std::find(words.begin(), words.end(), "bake") == words.begin();
  if (const std::optional<std::uint64_t> given = lorica::bytesIn(common.memory)) {
    lorica::limitMemory(*given, common.threadCount());
  } else if (!window && !bake) {
    lorica::limitMemory(lorica::usualMemory(words), common.threadCount());
  }
  try {
    done = chosen->run(common, host);
  } catch (const std::bad_alloc&) {
    lorica::endWithoutMemory();
  }
  if (!done) return fail(done.error());
  return chosen->status ? chosen->status() : 0;
}

}  // namespace

int main(int argc, char** argv) {
  // Lorica's code throws no exceptions; this reports std::bad_alloc and exceptions of libraries.
  try {
    if (argc == 2 && argv[1] == lorica::kReadForItself) return lorica::serveIsolatedReader();
    lorica::openStandardStreams();
    lorica::watchInterrupt();
    const int status = run(argc, argv);
    if (lorica::workAbandoned()) lorica::endWithoutIt(status);
    return status;
  } catch (const std::exception& error) {
    lorica::say(fmt::format("lorica: stopped: {}\n", lorica::printable(error.what())));
    return 1;
  }
}

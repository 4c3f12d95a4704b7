#include "apps/interrupt.h"
#include "apps/memory_limit.h"
#include "apps/options.h"
#include "apps/report.h"
#include "apps/terminal_host.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "prepare/abandoned_work.h"
#include "prepare/file_kinds.h"
#include "prepare/read_motion.h"
#include "viewer/window/window.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <initializer_list>
#include <new>
#include <string>
#include <system_error>
#include <vector>

namespace lorica {
namespace {

/// `lorica FILE` opens whatever it is: motions, characters, recordings and scenes are played, in a window if there is a
/// display; sessions are replayed; meshes are props in a window, else described; so is anything else. What ships is
/// named without a folder. `lorica replay FILE` plays what is no session.
/// @param words     of the command line, after the program's name
/// @param commands  the subcommands, which win over files of their names
/// @return the words with the subcommand in front; unchanged if the first names no file
std::vector<std::string> withCommand(std::vector<std::string> words, const std::vector<std::string>& commands) {
  if (words.empty()) return words;
  const std::string named = words.front();
  const bool isCommand = std::ranges::find(commands, named) != commands.end();
  std::error_code ignored;
  const bool found = std::filesystem::is_regular_file(named, ignored);
  const bool ships = named == "mannequin" || (isBareName(named) && !shippedRecording(named).empty());
  if (isCommand || named.starts_with("-") || (!found && !ships && isBareName(named))) return words;
  const FileKind kind = kindOf(named);
  const bool described = kind == FileKind::kDecomposition || (kind == FileKind::kUnknown && !ships) ||
                         (!found && !ships) || (kind == FileKind::kMesh && !displayAvailable());
  const auto wantsNone = [](const std::string& word) {
    return word.starts_with("--snapshots") || word.starts_with("--video") || word == "--headless" ||
           word == "--window" || word == "--serve";
  };
  if (!described && std::ranges::none_of(words, wantsNone)) {
    if (displayAvailable()) {
      words.push_back("--window");
    } else if (kind != FileKind::kSession) {
      say(printable(fmt::format("No display: `lorica snapshot {}` or --snapshots DIR makes pictures.", named)) + "\n");
    }
  }
  words.insert(words.begin(), described ? "info" : kind == FileKind::kSession ? "replay" : "play");
  return words;
}

int fail(const Error& error) {
  if (error.code == ErrorCode::kCancelled) {
    answerInterrupt();
    sayCancelled();
    return interruptedStatus();
  }
  publishFailure(nameOf(error.code), error.message);
  say(fmt::format("lorica: {}\n", printable(error.message)));
  return kBadInputStatus;
}

int run(int argc, char** argv) {
  CommandLine app("lorica", "Lorica: a live motion-capture avatar that collides.", LORICA_VERSION);
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
      "Exit status: 0 = done, 1 = a failure of Lorica, 2 = bad input or output that cannot be written, "
      "130 = Ctrl-C before the end.");
  CommonOptions common;
  std::vector<Command> commands;
  const auto add = [&](const char* group, std::initializer_list<AddCommand*> adding) {
    app.group(group);
    for (const auto one : adding) commands.push_back(one(app, common));
  };
  add("See it move", {addDemo, addPlay, addLive, addServe, addReplay, addSnapshot});
  add("Make files", {addDecompose, addExport, addConvert, addRecord, addBake});
  add("Learn what is there", {addInfo, addScore, addContacts});

  std::vector<std::string> words = withCommand({argv + 1, argv + argc}, app.subcommandNames());
  for (std::string& word : words) {  // shells leave --out=~/pictures as it is
    const std::size_t home = word.starts_with("--") ? word.find("=~/") : std::string::npos;
    if (home != std::string::npos && home == word.find('=')) word.replace(home + 1, 1, environment("HOME"));
  }
  std::vector<char*> arguments = {argv[0]};
  for (std::string& word : words) arguments.push_back(word.data());
  if (const std::optional<int> status = app.parse(int(arguments.size()), arguments.data())) return *status;
  const auto chosen =
      std::find_if(commands.begin(), commands.end(), [](const Command& command) { return command.app->parsed(); });

  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, common.threadCount());
  TerminalHost host(common);
  Result<void> done;
  const bool window = std::find(words.begin(), words.end(), "--window") != words.end();
  const bool bake = std::find(words.begin(), words.end(), "bake") == words.begin();
  if (const std::optional<std::uint64_t> given = bytesIn(common.memory)) {
    limitMemory(*given, common.threadCount());
  } else if (!window && !bake) {
    limitMemory(usualMemory(words), common.threadCount());
  }
  try {
    done = chosen->run(common, host);
  } catch (const std::bad_alloc&) {
    endWithoutMemory();
  }
  if (!done) return fail(done.error());
  return chosen->status ? chosen->status() : 0;
}

}  // namespace
}  // namespace lorica

int main(int argc, char** argv) {
  // Lorica's code throws no exceptions; this reports std::bad_alloc and exceptions of libraries.
  try {
    if (argc == 2 && argv[1] == lorica::kReadForItself) return lorica::serveIsolatedReader();
    lorica::openStandardStreams();
    lorica::watchInterrupt();
    const int status = lorica::run(argc, argv);
    if (lorica::workAbandoned()) lorica::endWithoutIt(status);
    return status;
  } catch (const std::exception& error) {
    lorica::say(fmt::format("lorica: stopped: {}\n", lorica::printable(error.what())));
    return 1;
  }
}

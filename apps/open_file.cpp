#include "apps/open_file.h"

#include "apps/standard_streams.h"
#include "geometry/text.h"
#include "prepare/file_kinds.h"
#include "prepare/read_motion.h"
#include "viewer/window/window.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace lorica {

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

}  // namespace lorica

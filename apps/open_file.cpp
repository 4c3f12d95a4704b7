#include "apps/open_file.h"

#include "geometry/text.h"
#include "prepare/file_kinds.h"
#include "viewer/window/window.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

namespace lorica {
namespace {

namespace fs = std::filesystem;

/// What opens a file.
std::vector<std::string> wordsFor(const fs::path& file) {
  constexpr std::array kPlayed = {".glb", ".gltf", ".vrm", ".vrma", ".fbx", ".dae",
                                  ".bvh", ".csv",  ".txt", ".oni",  ".pcap"};
  const std::string extension = lowerCase(file.extension().string());
  if (extension == ".lsession") return {"replay"};
  if (isJointJson(file)) return {"play"};
  if (extension == ".json") return {"play", "--scene"};
  if (std::ranges::find(kPlayed, extension) != kPlayed.end()) return {"play"};
  return {"info"};
}

}  // namespace

std::vector<std::string> withCommand(std::vector<std::string> words, const std::vector<std::string>& commands) {
  std::error_code ignored;
  if (words.empty()) return words;
  const bool replayed = words.front() == "replay" && words.size() > 1;
  const std::string& named = words[replayed ? 1 : 0];
  const bool isCommand = !replayed && std::ranges::find(commands, named) != commands.end();
  if (isCommand || named.starts_with("-") || !fs::is_regular_file(named, ignored)) return words;
  std::vector<std::string> opening = wordsFor(named);
  if (replayed && opening.front() != "play") return words;
  if (opening.front() != "info" && !replayed && displayAvailable()) {
    const auto isOutput = [](const std::string& word) {
      return word.starts_with("--snapshots") || word.starts_with("--video");
    };
    if (std::ranges::find(words, "--window") == words.end() && std::ranges::none_of(words, isOutput)) {
      words.push_back("--window");
    }
  }
  if (replayed) words.erase(words.begin());
  words.insert(words.begin(), opening.begin(), opening.end());
  return words;
}

}  // namespace lorica

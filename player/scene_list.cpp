#include "player/scene_list.h"

#include "prepare/scenes.h"

#include <algorithm>
#include <filesystem>

namespace lorica {
namespace {

constexpr const char* kDemoScene = "boxes and balls";

}  // namespace

SceneList scenesNextTo(const std::string& present) {
  SceneList list{{kDemoScene}, {""}};
  if (const Result<std::filesystem::path> folder = scenesFolder()) {
    std::error_code ignored;
    std::vector<std::string> shipped;
    for (const auto& entry : std::filesystem::directory_iterator(*folder, ignored)) {
      if (entry.path().extension() == ".json") shipped.push_back(entry.path().stem().string());
    }
    std::sort(shipped.begin(), shipped.end());
    list.names.insert(list.names.end(), shipped.begin(), shipped.end());
    list.arguments.insert(list.arguments.end(), shipped.begin(), shipped.end());
  }
  auto found = std::find(list.arguments.begin(), list.arguments.end(), present);
  if (found == list.arguments.end()) {
    list.names.push_back(std::filesystem::path(present).filename().string());
    list.arguments.push_back(present);
    found = list.arguments.end() - 1;
  }
  list.present = found - list.arguments.begin();
  return list;
}

}  // namespace lorica

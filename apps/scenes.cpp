#include "apps/scenes.h"

#include "apps/motions.h"
#include "session/demo_scene.h"
#include "session/scene_file.h"

#include <fmt/format.h>

#include <filesystem>

namespace lorica {

void addSceneOption(CLI::App& app, std::string& scene) {
  app.add_option("--scene", scene,
                 "What stands around: a scene file (.json), or boxes, bowling or curtain [default: boxes and balls]")
      ->type_name("SCENE");
}

Result<World> openScene(const std::string& scene) {
  if (scene.empty()) return makeDemoWorld(kDemoSeed);
  std::filesystem::path file = scene;
  if (isBareName(scene)) {
    // Scenes lie beside the recordings, in the source tree and as installed.
    const Result<std::filesystem::path> folder = recordingsFolder();
    if (!folder) return folder.error();
    file = folder->parent_path() / "scenes" / (scene + ".json");
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) {
      return Error{ErrorCode::kNotFound,
                   fmt::format("--scene: {}: no such file and no shipped scene of that name, expected a scene file "
                               "(.json) or one of {}",
                               scene, shippedNames(file.parent_path(), ".json"))};
    }
  }
  const Result<SceneFile> read = readScene(file);
  if (!read) return read.error();
  return makeWorld(*read);
}

}  // namespace lorica

#include "apps/scenes.h"

#include "apps/decomposition_cache.h"
#include "apps/motions.h"
#include "geometry/files.h"
#include "session/demo_scene.h"
#include "session/scene_file.h"

#include <fmt/format.h>

#include <filesystem>

namespace lorica {

void addSceneOption(CommandLine& app, std::string& scene) {
  app.addOption(
         "--scene", scene,
         "What stands around: a scene file (.json), or boxes, bowling, curtain or sand [default: boxes and balls]")
      ->typeName("SCENE");
}

Result<SceneText> readSceneText(const std::string& scene) {
  if (scene.empty()) return SceneText();
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
  Result<std::string> text = readFile(file);
  if (!text) return text.error();
  return SceneText{std::move(*text), file.parent_path()};
}

Result<World> worldOf(const SceneText& scene, const std::string& name) {
  if (scene.text.empty() && name.empty()) return makeDemoWorld(kDemoSeed);
  SceneReading reading;
  reading.folder = scene.folder;
  reading.decomposer = [](const std::string& mesh, const TriMesh& surface, int parts) {
    return cachedMeshDecomposition(mesh, surface, parts);
  };
  const Result<SceneFile> read = parseScene(scene.text, name, reading);
  if (!read) return read.error();
  return makeWorld(*read);
}

Result<World> openScene(const std::string& scene) {
  const Result<SceneText> text = readSceneText(scene);
  if (!text) return text.error();
  return worldOf(*text, scene);
}

}  // namespace lorica

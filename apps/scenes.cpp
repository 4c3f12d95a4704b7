#include "apps/scenes.h"

#include "apps/body_choice.h"
#include "apps/file_trust.h"
#include "apps/interrupt.h"
#include "apps/motions.h"
#include "apps/progress_bar.h"
#include "geometry/files.h"
#include "session/demo_scene.h"
#include "session/scene_file.h"

#include <fmt/format.h>

#include <filesystem>

namespace lorica {
namespace {

/// The decomposition of a prop's mesh: from the user's cache, or computed with a progress bar. Ctrl-C cancels.
Result<Decomposition> decomposeProp(const std::string& name, const TriMesh& surface, int parts) {
  ProgressBar bar("Decomposing " + name, "parts");
  DecomposeSettings settings;
  settings.maxParts = parts;
  settings.progress = progressOf(bar);
  Result<CachedDecomposition> made = meshDecomposition(name, surface, settings, userCache());
  if (interrupted()) return Error{ErrorCode::kCancelled, "cancelled"};
  if (!made) return made.error();
  return std::move(made->file.decomposition);
}

}  // namespace

void addSceneOption(CommandLine& app, std::string& scene) {
  app.addOption(
         "--scene", scene,
         "Scene: a scene file (.json), or boxes, bowling, curtain or sand [default: boxes and balls of the demo]")
      ->typeName("SCENE");
}

Result<std::filesystem::path> scenesFolder() {
  // It is next to that of recordings, in the source tree and when installed.
  const Result<std::filesystem::path> recordings = recordingsFolder();
  if (!recordings) return recordings.error();
  return recordings->parent_path() / "scenes";
}

Result<SceneText> readSceneText(const std::string& scene) {
  if (scene.empty()) return SceneText();
  std::filesystem::path file = scene;
  if (isBareName(scene)) {
    const Result<std::filesystem::path> folder = scenesFolder();
    if (!folder) return folder.error();
    file = *folder / (scene + ".json");
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) {
      return Error{ErrorCode::kNotFound,
                   fmt::format("--scene: {}: no such file and no shipped scene with that name, expected a scene file "
                               "(.json) or one of {}",
                               scene, shippedNames(file.parent_path(), ".json"))};
    }
  }
  Result<std::string> text = readFile(file);
  if (!text) return text.error();
  return SceneText{std::move(*text), file.parent_path(), pathTrust()};
}

Result<World> worldOf(const SceneText& scene, const std::string& name) {
  if (scene.text.empty() && name.empty()) return makeDemoWorld(kDemoSeed);
  SceneReading reading;
  reading.folder = scene.folder;
  reading.decomposer = decomposeProp;
  reading.paths = scene.paths;
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

#pragma once

#include "apps/command_line.h"
#include "collision/world/world.h"
#include "geometry/result.h"

#include <filesystem>
#include <string>

namespace lorica {

/// --scene.
void addSceneOption(CommandLine& app, std::string& scene);

/// What an avatar plays among: a scene file, or one of those that ship by its name. Empty = the demo's boxes and balls.
/// @return the world, or what is wrong with the file
[[nodiscard]] Result<World> openScene(const std::string& scene);

/// A scene as its file has it.
struct SceneText {
  std::string text;              ///< empty = the demo's boxes and balls
  std::filesystem::path folder;  ///< that its meshes are relative to
};

/// What openScene() reads.
[[nodiscard]] Result<SceneText> readSceneText(const std::string& scene);

/// The world of a scene whose text is at hand. @param name  for sentences
[[nodiscard]] Result<World> worldOf(const SceneText& scene, const std::string& name);

}  // namespace lorica

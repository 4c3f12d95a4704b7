#pragma once

#include "collision/world.h"
#include "geometry/result.h"

#include <CLI/CLI.hpp>

#include <string>

namespace lorica {

/// --scene.
void addSceneOption(CLI::App& app, std::string& scene);

/// What an avatar plays among: a scene file, or one of those that ship by its name. Empty = the demo's boxes and balls.
/// @return the world, or what is wrong with the file
[[nodiscard]] Result<World> openScene(const std::string& scene);

}  // namespace lorica

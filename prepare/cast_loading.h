#pragma once

#include "prepare/cast.h"
#include "prepare/cast_choices.h"

#include <span>
#include <string>
#include <vector>

namespace lorica {

/// Avatars, a scene and mesh files that become props in it.
struct CastRequest {
  PlaybackInputOptions input;
  BodyOptions body;
  std::string scene;                ///< see openScene()
  std::vector<std::string> meshes;  ///< files
};

/// What was loaded, ready for a session.
struct LoadedCast {
  CastRequest request;
  OpenedCast opened;
  std::vector<Prop> added;  ///< of the request's meshes, which are in the world of `opened` already
  CastChoices choices = {};
};

/// Reads, decomposes, opens the scene, in which sand and water settle.
/// @param attempts  the first that can be loaded is; if none can, the error of the first counts
[[nodiscard]] Result<LoadedCast> loadCast(const std::vector<CastRequest>& attempts, int threads);

/// Adds props to a world, as they are.
void addProps(std::span<const Prop> props, World& world);

}  // namespace lorica

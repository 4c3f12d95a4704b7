#pragma once

#include "collision/world/prop_meshes.h"
#include "collision/world/world.h"
#include "geometry/named_file.h"
#include "geometry/result.h"
#include "session/scenes/hit_counter.h"
#include "session/scenes/scene_stage.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// The contents of a scene file: props, links and particles around avatars, and avatars. Format: docs/SCENES.md.
struct SceneFile {
  /// A ball joint between two props, or between a prop and the world; see World::addLink().
  struct Link {
    int a = 0, b = kWorldItself;
    Vec3 position = Vec3::Zero();  ///< world [m]
  };

  std::string name;
  World::Settings world;
  std::vector<Prop> props;  ///< including the links of chains
  std::vector<Link> links;
  std::optional<ParticleSettings> particles;
  std::vector<HitTarget> targets;    ///< in the order of the file
  std::vector<AvatarSetting> stage;  ///< the avatars that perform in it; empty = whichever is played
};

/// What is needed to read a scene in addition to its text.
struct SceneReading {
  std::filesystem::path folder;           ///< base folder of relative mesh paths
  MeshDecomposer decomposer = {};         ///< empty = decomposePropMesh()
  PathTrust paths = PathTrust::kBeneath;  ///< which mesh files a scene may name
};

/// Reads a scene file and its meshes, and validates everything.
/// @return the scene, or an error with file, element, found and expected
[[nodiscard]] Result<SceneFile> readScene(const std::filesystem::path& file, const MeshDecomposer& decomposer = {},
                                          PathTrust paths = PathTrust::kBeneath);
/// The same for text in memory. @param name  of the text in error messages
[[nodiscard]] Result<SceneFile> parseScene(std::string_view text, std::string_view name,
                                           const SceneReading& reading = {});

/// The world of a scene in its initial state.
[[nodiscard]] World makeWorld(const SceneFile& scene);

}  // namespace lorica

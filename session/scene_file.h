#pragma once

#include "collision/world/world.h"
#include "geometry/result.h"
#include "session/prop_meshes.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// What stands, lies and hangs around an avatar, as a scene file says. Format: docs/SCENES.md.
struct SceneFile {
  /// A ball joint between two props, or of one with the world; see World::addLink().
  struct Link {
    int a = 0, b = kWorldItself;
    Vec3 place = Vec3::Zero();  ///< world [m]
  };

  std::string name;
  World::Settings world;
  std::vector<Prop> props;  ///< chains are among them
  std::vector<Link> links;
  std::optional<ParticleSettings> particles;
};

/// What a scene needs beside its text.
struct SceneReading {
  std::filesystem::path folder;    ///< that its mesh files are relative to
  MeshDecomposer decomposer = {};  ///< empty = decomposePropMesh()
};

/// Reads a scene file, with the meshes that it names, and checks all of it.
/// @return the scene, or a sentence with file, element, found and expected
[[nodiscard]] Result<SceneFile> readScene(const std::filesystem::path& file, const MeshDecomposer& decomposer = {});
/// The same of text in memory. @param name  what the sentences call it
[[nodiscard]] Result<SceneFile> parseScene(std::string_view text, std::string_view name,
                                           const SceneReading& reading = {});

/// The world of a scene, at its begin.
[[nodiscard]] World makeWorld(const SceneFile& scene);

}  // namespace lorica

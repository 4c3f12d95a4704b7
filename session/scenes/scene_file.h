#pragma once

#include "collision/particles/particles.h"
#include "collision/world/prop_meshes.h"
#include "collision/world/world.h"
#include "geometry/math.h"
#include "geometry/named_file.h"
#include "geometry/result.h"
#include "session/scenes/hit_counter.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// An avatar that a scene file asks for.
struct AvatarSetting {
  std::string character = "mannequin";  ///< what ships, or a file beneath the scene's folder
  std::string motion;                   ///< the same; empty = the character's own clip
  double start = 0.0;                   ///< time in the motion at which it begins, from its first frame [s]
  Vec3 place = Vec3::Zero();            ///< of the motion's origin [m]
  double heading = 0.0;                 ///< by which the motion is turned around the vertical [degrees]
  std::optional<Vec3f> color;           ///< its look is tinted with this, linear RGB; none = as it is
};

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
/// @return the world; an error only if the particles of a scene that was not read here are out of range
[[nodiscard]] Result<World> makeWorld(const SceneFile& scene);

}  // namespace lorica

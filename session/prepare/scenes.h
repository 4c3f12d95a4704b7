#pragma once

#include "collision/hulls/host.h"
#include "collision/world/world.h"
#include "geometry/named_file.h"
#include "geometry/result.h"
#include "session/scenes/hit_counter.h"
#include "session/scenes/scene_file.h"
#include "session/session.h"

#include <filesystem>
#include <string>
#include <vector>

namespace lorica {

/// The world of a scene file or of a shipped scene, given by its name. Empty = the boxes and balls of the demo.
/// @param gravity  times that of the scene
/// @return the world, or an error about the file
[[nodiscard]] Result<World> openScene(const std::string& scene, double gravity, Host& host, double scale = 1.0);

/// The scene without props; no file has it.
inline constexpr const char* kEmptyStage = "none";

/// The text of a scene file.
struct SceneText {
  std::string text;                       ///< empty = the boxes and balls of the demo
  std::filesystem::path folder;           ///< base of relative mesh paths
  PathTrust paths = PathTrust::kBeneath;  ///< which mesh files it may name
};

/// The folder of the shipped scenes.
[[nodiscard]] Result<std::filesystem::path> scenesFolder();

/// The text that openScene() reads.
[[nodiscard]] Result<SceneText> readSceneText(const std::string& scene, const Host& host);

/// A scene that was opened.
struct OpenedScene {
  World world;
  std::vector<HitTarget> targets;
  std::vector<AvatarSetting> stage;  ///< character and motion as names of what ships, or as paths
};

/// openScene() with the avatars of the scene.
[[nodiscard]] Result<OpenedScene> openStage(const std::string& scene, Host& host);

/// The targets of a scene that the user chose; none if it cannot be read any more.
[[nodiscard]] std::vector<HitTarget> targetsOf(const std::string& scene, Host& host);

/// A prop at rest at the world's origin, from a mesh file: in at most 8 convex parts if the mesh is closed, else its
/// convex hull. A mesh whose largest side is not 0.1 to 1.5 units long is scaled to 0.5 m, else a unit is a metre.
[[nodiscard]] Result<Prop> openMeshProp(const std::string& file, Host& host);

/// The world of a scene text. @param name  for error messages
[[nodiscard]] Result<World> worldOf(const SceneText& scene, const std::string& name, Host& host);
/// The targets of a scene text that worldOf() has read.
[[nodiscard]] std::vector<HitTarget> targetsOf(const SceneText& scene, const std::string& name, Host& host);

/// The scenes that a window offers.
struct SceneList {
  std::vector<std::string> names;
  std::vector<std::string> arguments;  ///< of openScene()
  int present = 0;                     ///< index of the current one
};

/// The scene of the demo, the empty one, the other shipped ones, and the present one if it is the user's own.
/// @param present  as given to openScene()
[[nodiscard]] SceneList scenesNextTo(const std::string& present);

/// The parts of each avatar of a session, as they are now.
using PartsOfAvatars = std::vector<std::vector<LivePart>>;
[[nodiscard]] PartsOfAvatars partsOf(const Session& session);

/// Whether a step of this world begins with letting sand or water settle, which takes seconds.
[[nodiscard]] bool mustSettle(const World& world);
/// Share of the work of opening what an avatar and a scene need that comes before settling, see Stage.
inline constexpr double kBeforeSettling = 0.6;

/// Lets sand and water settle around parts that stand. A task of the host; stops if that is cancelled: the world is to
/// be given up then.
void settleAround(const PartsOfAvatars& parts, World& world, Host& host);

/// The same in the first step of a session. If it is stopped, the step that ends it is no longer watched, so that it is
/// not recorded.
[[nodiscard]] Result<bool> stepAndSettle(Session& session, Host& host);

}  // namespace lorica

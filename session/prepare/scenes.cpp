#include "session/prepare/scenes.h"

#include "collision/particles/particles.h"
#include "collision/world/prop_meshes.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/mesh_files.h"
#include "session/prepare/body.h"
#include "session/prepare/file_kinds.h"
#include "session/prepare/read_motion.h"
#include "session/scenes/demo_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <utility>

namespace lorica {
namespace {

constexpr int kDroppedParts = 8;
constexpr double kShortestSide = 0.1, kLongestSide = 1.5, kScaledSide = 0.5;  // see openMeshProp()

/// Decomposes the meshes of props: from the user's cache, or as a task of the host.
MeshDecomposer decomposerOf(Host& host) {
  return [&host](const std::string& name, const TriMesh& surface, int parts) -> Result<Decomposition> {
    DecomposeSettings settings;
    settings.maxParts = parts;
    LORICA_TRY(CachedDecomposition made, meshDecomposition(name, surface, settings, host));
    return std::move(made.file.decomposition);
  };
}

constexpr const char* kDemoScene = "boxes and balls";

/// @param stopped  called if the settling is stopped
std::function<bool(int, int)> reporting(Host& host, std::function<void()> stopped) {
  return [&host, stopped = std::move(stopped)](int frame, int frames) {
    host.report(frame, frames, -1.0);
    if (!host.cancelled()) return true;
    stopped();
    return false;
  };
}

bool unwatched(int /*frame*/, int /*frames*/) {
  return true;
}

const char* titleOf(const World& world) {
  const bool sand = world.particles()->settings().kind == ParticleSettings::Kind::kSand;
  return sand ? "Settling the sand" : "Settling the water";
}

}  // namespace

Result<std::filesystem::path> scenesFolder() {
  LORICA_TRY(const std::filesystem::path recordings, recordingsFolder());
  return recordings / "scenes";
}

Result<SceneText> readSceneText(const std::string& scene, const Host& host) {
  if (scene.empty()) return SceneText();
  if (scene == kEmptyStage) return SceneText{R"({"format": "lorica scene 1", "name": "none"})", {}, host.paths};
  std::filesystem::path file = scene;
  if (isBareName(scene)) {
    LORICA_TRY(const std::filesystem::path folder, scenesFolder());
    file = folder / (scene + ".json");
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) {
      return notFound(
          "--scene: {}: no such file and no shipped scene with that name, expected a scene file (.json) or one of "
          "none, {}",
          scene, shippedNames(file.parent_path(), {".json"}, scene));
    }
  }
  LORICA_TRY_DO(refuseOtherKinds(file));
  LORICA_TRY(std::string text, readFile(file));
  return SceneText{std::move(text), file.parent_path(), host.paths};
}

namespace {

/// @param name  for error messages
Result<SceneFile> sceneOf(const SceneText& scene, const std::string& name, Host& host) {
  SceneReading reading;
  reading.folder = scene.folder;
  reading.decomposer = decomposerOf(host);
  reading.paths = scene.paths;
  return parseScene(scene.text, name, reading);
}

/// The path of a file that a scene names; names without folder and extension are of what ships.
Result<void> findNamed(const SceneText& scene, std::string& name) {
  const std::filesystem::path path(name);
  if (name.empty() || (!path.has_parent_path() && !path.has_extension())) return {};
  LORICA_TRY(const std::filesystem::path found, NamedFiles{scene.folder, scene.paths}.find(name));
  name = found.string();
  return {};
}

}  // namespace

Result<World> worldOf(const SceneText& scene, const std::string& name, Host& host) {
  if (scene.text.empty() && name.empty()) return makeDemoWorld(kDemoSeed);
  LORICA_TRY(const SceneFile read, sceneOf(scene, name, host));
  return makeWorld(read);
}

std::vector<HitTarget> targetsOf(const SceneText& scene, const std::string& name, Host& host) {
  if (scene.text.empty()) return {};
  Result<SceneFile> read = sceneOf(scene, name, host);
  return read ? std::move(read->targets) : std::vector<HitTarget>();
}

Result<OpenedScene> openStage(const std::string& scene, Host& host) {
  LORICA_TRY(const SceneText text, readSceneText(scene, host));
  if (text.text.empty()) return OpenedScene{makeDemoWorld(kDemoSeed), {}, {}};
  LORICA_TRY(SceneFile read, sceneOf(text, scene, host));
  for (std::size_t i = 0; i < read.stage.size(); ++i) {
    for (std::string* name : {&read.stage[i].character, &read.stage[i].motion}) {
      LORICA_TRY_DO(prefixed(fmt::format("{}: avatars[{}]", scene, i), findNamed(text, *name)));
    }
  }
  LORICA_TRY(World world, makeWorld(read));
  return OpenedScene{std::move(world), std::move(read.targets), std::move(read.stage)};
}

std::vector<HitTarget> targetsOf(const std::string& scene, Host& host) {
  const Result<SceneText> text = readSceneText(scene, host);
  return text ? targetsOf(*text, scene, host) : std::vector<HitTarget>();
}

Result<Prop> openMeshProp(const std::string& file, Host& host) {
  LORICA_TRY(const TriMesh mesh, readMesh(file));
  Eigen::AlignedBox3d box;
  for (const Vec3& v : mesh.vertices) box.extend(v);
  const double side = mesh.vertices.empty() ? 0.0 : box.sizes().maxCoeff();
  PropMeshRequest request{file};
  request.parts = kDroppedParts;
  request.limited = false;
  if (side > 0.0 && (side < kShortestSide || side > kLongestSide)) request.scale = kScaledSide / side;
  Result<std::shared_ptr<const PropMeshShape>> shape = readPropMesh(request, decomposerOf(host));
  if (!shape && shape.error().code != ErrorCode::kCancelled) {
    request.parts = 1;
    shape = readPropMesh(request, decomposerOf(host));
  }
  if (!shape) return shape.error();
  return meshProp(std::move(*shape));
}

Result<World> openScene(const std::string& scene, double gravity, Host& host, double scale) {
  LORICA_TRY(const SceneText text, readSceneText(scene, host));
  if (text.text.empty()) return makeDemoWorldUnder(gravity * World::Settings().gravity, kDemoSeed, scale);
  LORICA_TRY(SceneFile read, sceneOf(text, scene, host));
  read.world.gravity *= gravity;
  if (read.particles) read.particles->gravity *= gravity;
  return makeWorld(read);
}

SceneList scenesNextTo(const std::string& present) {
  SceneList list{{kDemoScene, kEmptyStage}, {"", kEmptyStage}};
  if (const Result<std::filesystem::path> folder = scenesFolder()) {
    const std::vector<std::string> shipped = shippedNames(*folder, {".json"});
    list.names.insert(list.names.end(), shipped.begin(), shipped.end());
    list.arguments.insert(list.arguments.end(), shipped.begin(), shipped.end());
  }
  auto found = std::find(list.arguments.begin(), list.arguments.end(), present);
  if (found == list.arguments.end()) {
    list.names.push_back(std::filesystem::path(present).filename().string());
    list.arguments.push_back(present);
    found = list.arguments.end() - 1;
  }
  list.present = found - list.arguments.begin();
  return list;
}

PartsOfAvatars partsOf(const Session& session) {
  PartsOfAvatars parts;
  for (const SessionAvatar& avatar : session.avatars()) {
    const std::span<const LivePart> its = avatar.partsInWorld();
    parts.emplace_back(its.begin(), its.end());
  }
  return parts;
}

bool mustSettle(const World& world) {
  return world.particles() != nullptr && !world.particles()->settled();
}

void settleAround(const PartsOfAvatars& parts, World& world, Host& host) {
  if (!mustSettle(world)) return;
  const std::vector<std::span<const LivePart>> avatars(parts.begin(), parts.end());
  const Task task(host, titleOf(world), "frames");
  world.watchSettling(reporting(host, [] {}));
  world.settle(avatars);
  world.watchSettling(unwatched);  // the world outlives the host
}

Result<bool> stepAndSettle(Session& session, Host& host) {
  if (!mustSettle(session.world())) return session.step();
  const Task task(host, titleOf(session.world()), "frames");
  session.world().watchSettling(reporting(host, [&session] { session.watch(nullptr); }));
  Result<bool> more = session.step();
  session.world().watchSettling(unwatched);
  return more;
}

}  // namespace lorica

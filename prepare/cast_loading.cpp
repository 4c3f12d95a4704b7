#include "prepare/cast_loading.h"

#include "player/work_monitor.h"
#include "prepare/scenes.h"
#include "prepare/settling.h"

#include <optional>
#include <utility>

namespace lorica {
namespace {

constexpr double kBeside = 0.7;  // of the first dropped thing from the avatar, and between them [m]
constexpr double kAhead = 0.4;   // [m]
constexpr double kAbove = 0.3;   // of its lowest point over the floor, from where it falls [m]
constexpr int kInRow = 3;

/// Where a dropped thing falls: in rows before the avatar.
Isometry3 placeOfDropped(std::size_t index, const Prop& prop) {
  const int column = static_cast<int>(index) % kInRow - 1, row = static_cast<int>(index) / kInRow;
  return Isometry3(Eigen::Translation3d(kBeside * column, kAbove + prop.halfExtents.y(), kAhead + kBeside * (row + 1)));
}

/// Lets sand and water settle around the avatars' first poses, as the first step of the session would.
Result<void> settle(LoadedCast& loaded) {
  if (!mustSettle(loaded.opened.world)) return {};
  const WorkMonitor::Stage stage(kBeforeSettling, 1.0);
  // The poses come from a step in another world: of the same props, without particles.
  Result<World> other = openScene(loaded.request.scene);
  if (!other) return other.error();
  addProps(loaded.added, *other);
  other->setParticles(ParticleSettings());
  Result<Session> session = startSession(loaded.opened.avatars, nullptr, std::move(*other));
  if (!session) return session.error();
  if (const Result<bool> stepped = session->step(); !stepped) return stepped.error();
  settleAround(partsOf(*session), loaded.opened.world);
  return {};
}

Result<LoadedCast> load(const CastRequest& request, int threads) {
  Result<OpenedCast> opened = openCast(request.input, request.body, request.scene, threads);
  if (!opened) return opened.error();
  LoadedCast loaded{request, std::move(*opened), {}};
  for (const std::string& mesh : request.meshes) {
    Result<Prop> prop = openMeshProp(mesh);
    if (!prop) return prop.error();
    prop->worldFromProp = placeOfDropped(loaded.added.size(), *prop);
    loaded.added.push_back(std::move(*prop));
  }
  addProps(loaded.added, loaded.opened.world);
  loaded.choices = choicesOf(request.input, loaded.opened);
  if (Result<void> settled = settle(loaded); !settled) return settled.error();
  return loaded;
}

}  // namespace

void addProps(std::span<const Prop> props, World& world) {
  for (const Prop& prop : props) {
    if (world.props().size() < static_cast<std::size_t>(World::kMaxProps)) world.addProp(prop);
  }
}

Result<LoadedCast> loadCast(const std::vector<CastRequest>& attempts, int threads) {
  std::optional<Error> first;
  for (const CastRequest& attempt : attempts) {
    Result<LoadedCast> loaded = load(attempt, threads);
    if (loaded) return loaded;
    if (!first) first = loaded.error();
  }
  return *first;
}

}  // namespace lorica

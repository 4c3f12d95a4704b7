#include "apps/cast_loading.h"

#include "apps/scenes.h"
#include "apps/settling.h"
#include "apps/work_monitor.h"
#include "geometry/counts.h"

#include <optional>
#include <utility>

namespace lorica {
namespace {

constexpr double kBeside = 0.7;  // of the first dropped thing from the avatar, and between them [m]
constexpr double kAhead = 0.4;   // [m]
constexpr double kAbove = 0.3;   // of its lowest point over the floor, from where it falls [m]
constexpr int kInRow = 3;

/// Where a dropped thing falls: in rows before the avatar.
Isometry3 placeOfDropped(int index, const Prop& prop) {
  const int column = index % kInRow - 1, row = index / kInRow;
  return Isometry3(Eigen::Translation3d(kBeside * column, kAbove + prop.halfExtents.y(), kAhead + kBeside * (row + 1)));
}

/// Lets sand and water settle around the avatars' first poses, as the first step of the session would.
Result<void> settle(LoadedCast& loaded) {
  if (!mustSettle(loaded.opened.world)) return {};
  const WorkMonitor::Stage stage(kBeforeSettling, 1.0);
  // The poses come from a step in another world: of the same props, without particles.
  LORICA_TRY(World other, openScene(loaded.request.scene));
  addProps(loaded.added, other);
  other.setParticles(ParticleSettings());
  LORICA_TRY(Session session, startSession(loaded.opened.avatars, nullptr, std::move(other)));
  LORICA_TRY_DO(session.step());
  settleAround(partsOf(session), loaded.opened.world);
  return {};
}

Result<LoadedCast> load(const CastRequest& request, int threads) {
  LORICA_TRY(OpenedCast opened, openCast(request.input, request.body, request.scene, threads));
  LoadedCast loaded{request, std::move(opened), {}};
  for (const std::string& mesh : request.meshes) {
    LORICA_TRY(Prop prop, openMeshProp(mesh));
    prop.worldFromProp = placeOfDropped(loaded.added.size(), prop);
    loaded.added.push_back(std::move(prop));
  }
  addProps(loaded.added, loaded.opened.world);
  loaded.choices = choicesOf(request.input, loaded.opened);
  LORICA_TRY_DO(settle(loaded));
  return loaded;
}

}  // namespace

void addProps(std::span<const Prop> props, World& world) {
  for (const Prop& prop : props) {
    if (countOf(world.props()) < World::kMaxProps) world.addProp(prop);
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

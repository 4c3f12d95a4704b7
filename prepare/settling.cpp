#include "prepare/settling.h"

#include "player/work_monitor.h"

#include <functional>
#include <utility>

namespace lorica {
namespace {

/// @param stopped  called if the settling is stopped
Particles::SettlingWatch reporting(const World& world, std::function<void()> stopped) {
  WorkMonitor* monitor = WorkMonitor::ofThisThread();
  if (monitor == nullptr) return [](int, int) { return true; };
  const bool sand = world.particles()->settings().kind == ParticleSettings::Kind::kSand;
  monitor->begin(sand ? "Settling the sand" : "Settling the water");
  return [monitor, stopped = std::move(stopped)](int frame, int frames) {
    monitor->report(frame, frames);
    if (!monitor->cancelled()) return true;
    stopped();
    return false;
  };
}

}  // namespace

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

void settleAround(const PartsOfAvatars& parts, World& world) {
  if (!mustSettle(world)) return;
  const std::vector<std::span<const LivePart>> avatars(parts.begin(), parts.end());
  world.watchSettling(reporting(world, [] {}));
  world.settle(avatars);
}

Result<bool> stepAndSettle(Session& session) {
  if (mustSettle(session.world())) {
    session.world().watchSettling(reporting(session.world(), [&session] { session.watch(nullptr); }));
  }
  return session.step();
}

}  // namespace lorica

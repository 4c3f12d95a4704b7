#include "prepare/settling.h"

#include <functional>
#include <utility>

namespace lorica {
namespace {

/// @param stopped  called if the settling is stopped
Particles::SettlingWatch reporting(const World& world, std::function<void()> stopped, Host& host) {
  const bool sand = world.particles()->settings().kind == ParticleSettings::Kind::kSand;
  auto task = std::make_shared<Task>(host, sand ? "Settling the sand" : "Settling the water", "frames");
  return [task, stopped = std::move(stopped)](int frame, int frames) {
    task->update(frame, frames);
    if (!task->cancelled()) return true;
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

void settleAround(const PartsOfAvatars& parts, World& world, Host& host) {
  if (!mustSettle(world)) return;
  const std::vector<std::span<const LivePart>> avatars(parts.begin(), parts.end());
  world.watchSettling(reporting(
      world, [] {}, host));
  world.settle(avatars);
}

Result<bool> stepAndSettle(Session& session, Host& host) {
  if (mustSettle(session.world())) {
    session.world().watchSettling(reporting(
        session.world(), [&session] { session.watch(nullptr); }, host));
  }
  return session.step();
}

}  // namespace lorica

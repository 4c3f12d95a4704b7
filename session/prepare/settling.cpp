#include "session/prepare/settling.h"

#include "collision/particles/particles.h"

#include <functional>
#include <utility>

namespace lorica {
namespace {

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

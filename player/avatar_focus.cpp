#include "player/avatar_focus.h"

#include "collision/live/ray_query.h"
#include "geometry/counts.h"

#include <fmt/format.h>

#include <cmath>
#include <span>
#include <utility>
#include <vector>

namespace lorica {
namespace {

constexpr double kFollowSeconds = 0.3;  // in which the focus makes up for most of a step [s]

/// The middle of the avatars' parts.
std::optional<Vec3> middleOf(const Session& session, int avatar) {
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (int a = 0; a < countOf(session.avatars()); ++a) {
    if (avatar >= 0 && avatar != a) continue;
    for (const LivePart& part : session.avatars()[a].partsInWorld()) {
      sum += part.worldFromPart.translation();
      ++count;
    }
  }
  if (count == 0) return std::nullopt;
  return Vec3(sum / count);
}

}  // namespace

void AvatarFocus::update(const Session& session) {
  const std::optional<Vec3> middle = middleOf(session, avatar_);
  const double seconds = session.time() - std::exchange(time_, session.time());
  if (!middle) return;
  const double share = position_ && seconds > 0.0 ? 1.0 - std::exp(-seconds / kFollowSeconds) : 1.0;
  position_ = position_ ? Vec3(*position_ + share * (*middle - *position_)) : *middle;
}

std::optional<Aabb> AvatarFocus::bounds(const Session& session) const {
  Aabb box;
  for (int a = 0; a < countOf(session.avatars()); ++a) {
    if (avatar_ >= 0 && avatar_ != a) continue;
    for (const LivePart& part : session.avatars()[a].partsInWorld()) {
      for (const Vec3& vertex : part.shape.vertices) box.extend(part.worldFromPart * vertex);
    }
  }
  if (box.empty()) return std::nullopt;
  return box;
}

int avatarAt(const Session& session, const Ray& ray) {
  std::vector<std::span<const LivePart>> bodies;
  for (const SessionAvatar& avatar : session.avatars()) bodies.push_back(avatar.partsInWorld());
  RayQuery query;
  query.update(bodies);
  return query.nearest({ray.origin, ray.direction}).body;
}

std::vector<std::string> avatarNames(const Session& session) {
  std::vector<std::string> names;
  for (const SessionAvatar& avatar : session.avatars()) {
    names.push_back(fmt::format("{} {}", names.size() + 1, avatar.character().name));
  }
  return names;
}

}  // namespace lorica

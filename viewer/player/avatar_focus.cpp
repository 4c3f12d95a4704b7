#include "viewer/player/avatar_focus.h"

#include "collision/live/ray_query.h"
#include "geometry/counts.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace lorica {
namespace {

constexpr double kFocusSeconds = 0.3;  // in which the focus makes up for most of a step [s]
constexpr double kRiseSeconds = 1.5;   // the same of its height: arms that go up and down do not move it [s]
constexpr double kUpright = 0.5;       // horizontal share of a direction that faces somewhere

/// Calls visit(const LivePart&) for each part of an avatar or of all: -1.
void eachPart(const Session& session, int avatar, const auto& visit) {
  for (int a = 0; a < countOf(session.avatars()); ++a) {
    if (avatar >= 0 && avatar != a) continue;
    for (const LivePart& part : session.avatars()[a].partsInWorld()) visit(part);
  }
}

/// The middle of the avatars' parts.
std::optional<Vec3> middleOf(const Session& session, int avatar) {
  Vec3 sum = Vec3::Zero();
  int count = 0;
  eachPart(session, avatar, [&](const LivePart& part) {
    sum += part.worldFromPart.translation();
    ++count;
  });
  if (count == 0) return std::nullopt;
  return Vec3(sum / count);
}

}  // namespace

void AvatarFocus::update(const Session& session) {
  std::optional<Vec3> middle = middleOf(session, avatar_);
  const double seconds = session.time() - std::exchange(time_, session.time());
  if (!middle) return;
  const double share = position_ && seconds > 0.0 ? 1.0 - std::exp(-seconds / kFocusSeconds) : 1.0;
  const double rise = position_ && seconds > 0.0 ? 1.0 - std::exp(-seconds / kRiseSeconds) : 1.0;
  if (const std::optional<Aabb> box = bounds(session)) middle->y() = box->center().y();
  if (!position_) position_ = middle;
  *position_ += Vec3(share, rise, share).cwiseProduct(*middle - *position_);
}

std::optional<Aabb> boundsOf(const Session& session, int avatar) {
  Aabb box;
  eachPart(session, avatar, [&](const LivePart& part) {
    for (const Vec3& vertex : part.shape.vertices) box.extend(part.worldFromPart * vertex);
  });
  if (box.empty()) return std::nullopt;
  return box;
}

double facingOf(const SessionAvatar& avatar, std::span<const HumanBone> bones) {
  const Character& character = avatar.character();
  for (const HumanBone bone : bones) {
    const JointIndex joint = character.skeleton.jointOf(bone);
    if (joint == kNoJoint) continue;
    const Affine3 worldFromModel = avatar.worldFromJoint()[joint] * character.jointFromModel[joint];
    const Vec3 to = worldFromModel.linear().col(2);  // a character in its bind pose faces +Z
    if (std::hypot(to.x(), to.z()) > kUpright * to.norm()) return std::atan2(to.x(), to.z());
  }
  return 0.0;
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

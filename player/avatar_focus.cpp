#include "player/avatar_focus.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/counts.h"

namespace lorica {
namespace {

constexpr double kFollowSeconds = 0.3;  // in which the focus makes up for most of a step [s]
constexpr double kRiseSeconds = 1.5;    // the same of its height: arms that go up and down do not move it [s]
constexpr double kUpright = 0.5;        // horizontal share of a direction that faces somewhere

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

/// Where a ray enters a hull, in lengths of its direction. @param ray  in the hull's frame
std::optional<double> entryOf(const Ray& ray, const ConvexHull& hull) {
  if (hull.triangles.empty()) return std::nullopt;
  double in = 0.0, out = std::numeric_limits<double>::max();
  for (const Triangle& t : hull.triangles) {
    const Vec3& a = hull.vertices[t[0]];
    const Vec3 normal = (hull.vertices[t[1]] - a).cross(hull.vertices[t[2]] - a);
    const double towards = normal.dot(ray.direction), outside = normal.dot(ray.origin - a);
    if (towards == 0.0) {
      if (outside > 0.0) return std::nullopt;
      continue;
    }
    if (towards < 0.0) in = std::max(in, -outside / towards);
    if (towards > 0.0) out = std::min(out, -outside / towards);
  }
  if (in > out) return std::nullopt;
  return in;
}

}  // namespace

void AvatarFocus::update(const Session& session) {
  std::optional<Vec3> middle = middleOf(session, avatar_);
  const double seconds = session.time() - std::exchange(time_, session.time());
  if (!middle) return;
  const double share = position_ && seconds > 0.0 ? 1.0 - std::exp(-seconds / kFollowSeconds) : 1.0;
  const double rise = position_ && seconds > 0.0 ? 1.0 - std::exp(-seconds / kRiseSeconds) : 1.0;
  if (const std::optional<Aabb> box = bounds(session)) middle->y() = box->center().y();
  if (!position_) position_ = middle;
  *position_ += Vec3(share, rise, share).cwiseProduct(*middle - *position_);
}

std::optional<Aabb> boundsOf(const Session& session, int avatar) {
  Aabb box;
  for (int a = 0; a < countOf(session.avatars()); ++a) {
    if (avatar >= 0 && avatar != a) continue;
    for (const LivePart& part : session.avatars()[a].partsInWorld()) {
      for (const Vec3& vertex : part.shape.vertices) box.extend(part.worldFromPart * vertex);
    }
  }
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
  int nearest = -1;
  double distance = std::numeric_limits<double>::max();
  for (int a = 0; a < countOf(session.avatars()); ++a) {
    for (const LivePart& part : session.avatars()[a].partsInWorld()) {
      const Isometry3 partFromWorld = part.worldFromPart.inverse();
      const Ray inPart{partFromWorld * ray.origin, partFromWorld.linear() * ray.direction};
      const std::optional<double> entry = entryOf(inPart, part.shape);
      if (!entry || *entry >= distance) continue;
      distance = *entry;
      nearest = a;
    }
  }
  return nearest;
}

std::vector<std::string> avatarNames(const Session& session) {
  std::vector<std::string> names;
  for (const SessionAvatar& avatar : session.avatars()) {
    names.push_back(fmt::format("{} {}", names.size() + 1, avatar.character().name));
  }
  return names;
}

}  // namespace lorica

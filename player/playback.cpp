#include "player/playback.h"

#include "geometry/text.h"
#include "player/follow_camera.h"

#include <fmt/format.h>

#include <set>

namespace lorica {
namespace {

// In heights of the character.
constexpr double kWindowDistance = 2.97;
constexpr double kWiderForEach = 0.25;  // further avatar
const Vec3 kWindowTarget(0.171, 0.486, 0.229);

}  // namespace

std::string captionOf(const std::string& name, const Session& session, double seconds) {
  std::set<int> touched;
  for (const Contact& contact : session.world().contacts()) touched.insert(contact.prop);
  std::ptrdiff_t parts = 0;
  for (const SessionAvatar& avatar : session.avatars())
    parts += avatar.present() ? std::ssize(avatar.body().parts()) : 0;
  std::string caption = fmt::format("{}   {:.1f} s   {}", name, seconds, counted(parts, "convex part"));
  if (!touched.empty()) caption += fmt::format("   touching {}", counted(std::ssize(touched), "prop"));
  return caption;
}

Camera windowCamera(double height, std::size_t avatars) {
  Camera camera;
  camera.target = height * kWindowTarget;
  const double wider = 1.0 + kWiderForEach * (avatars - 1);
  camera.eye = camera.target + height * kWindowDistance * wider * kViewDirection;
  return camera;
}

}  // namespace lorica

#include "player/playback.h"

#include "geometry/text.h"

#include <fmt/format.h>

#include <set>

namespace lorica {
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

}  // namespace lorica

#include "viewer/player/window_texts.h"

#include "geometry/text.h"

#include <fmt/format.h>

#include <array>
#include <set>
#include <span>

namespace lorica {
namespace {

std::ptrdiff_t partCountOf(const Session& session) {
  std::ptrdiff_t parts = 0;
  for (const SessionAvatar& avatar : session.avatars()) {
    parts += avatar.present() ? std::ssize(avatar.body().parts()) : 0;
  }
  return parts;
}

std::ptrdiff_t touchedProps(const Session& session) {
  std::set<int> touched;
  for (const Contact& contact : session.world().contacts()) touched.insert(contact.prop);
  return std::ssize(touched);
}

}  // namespace

std::string titleOf(const Session& session, const std::string& source, bool live) {
  const std::size_t count = session.avatars().size();
  if (count == 0) return source;
  const std::string who = count == 1 ? session.character().name : fmt::format("{} avatars", count);
  const std::string does = fmt::format("{}{}", live ? "follow" : "perform", count == 1 ? "s" : "");
  // Its own clip is named after the character, too.
  const std::string own = who + ": ";
  return fmt::format("{} {} {}", who, does, source.starts_with(own) ? source.substr(own.size()) : source);
}

std::string statusOf(const Session& session, bool ended) {
  std::string status = counted(partCountOf(session), "part");
  if (const std::ptrdiff_t touched = touchedProps(session); touched > 0) {
    status += ", touching " + counted(touched, "prop");
  }
  if (ended) status += ", end of recording";
  return status;
}

void addStageTimes(const Session& session, std::optional<double> tracking, Screen& screen) {
  const StageTimes& t = session.times();
  std::array<TimedStage, 8> stages;
  std::size_t count = 0;
  const auto add = [&](const char* name, double microseconds) { stages[count++] = {name, 1e-3 * microseconds}; };
  if (tracking) add("joints", 1e6 * *tracking);
  add("pose", t.retarget);
  if (session.springs() != nullptr) add("springs", t.springs);
  add("motion", t.motion);
  add("points", t.points);
  add("hulls", t.hulls);
  add("physics", t.physics);
  if (session.world().particles() != nullptr) add("particles", t.particles);
  screen.addTimes(std::span(stages).first(count));
}

std::string captionOf(const std::string& name, const Session& session, double seconds) {
  std::string caption = fmt::format("{}   {:.1f} s   {}", name, seconds, counted(partCountOf(session), "convex part"));
  if (const std::ptrdiff_t touched = touchedProps(session); touched > 0) {
    caption += "   touching " + counted(touched, "prop");
  }
  return caption;
}

}  // namespace lorica

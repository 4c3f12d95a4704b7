#include "apps/playback.h"

#include "apps/report.h"
#include "apps/snapshots.h"
#include "session/demo_scene.h"

#include <fmt/format.h>

#include <set>

namespace lorica {
namespace {

// In heights of the character.
constexpr double kWindowDistance = 2.97;
constexpr double kWiderForEach = 0.25;  // further avatar
const Vec3 kWindowTarget(0.171, 0.486, 0.229);

}  // namespace

Result<void> addAvatar(Session& session, const Character& character, const DecompositionFile& body,
                       std::unique_ptr<PoseSource> source, const AvatarSetting& setting) {
  LORICA_TRY(SessionAvatar avatar,
             SessionAvatar::create(character, body.decomposition, std::move(source), body.cover, body.training));
  if (setting.place) avatar.setPlace(*setting.place);
  const int index = session.addAvatar(std::move(avatar));
  return addSprings(setting.springs, session, index);
}

Result<Session> startSession(const Character& character, const DecompositionFile& body,
                             std::unique_ptr<PoseSource> source, World world) {
  Session session(std::move(world));
  LORICA_TRY_DO(addAvatar(session, character, body, std::move(source)));
  return session;
}

Result<Session> startDemoSession(const Character& character, const DecompositionFile& body, const Motion& motion) {
  LORICA_TRY(std::unique_ptr<PoseSource> source, poseSourceOf(character, motion, SourceTreatment{}));
  return startSession(character, body, std::move(source), makeDemoWorld(kDemoSeed));
}

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

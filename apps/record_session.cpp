#include "apps/record_session.h"

#include "apps/cast.h"
#include "apps/interrupt.h"
#include "apps/live_cast.h"
#include "apps/playback.h"
#include "apps/scenes.h"
#include "apps/session_files.h"
#include "apps/standard_streams.h"
#include "geometry/errors.h"
#include "geometry/files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace lorica {
namespace {

/// A session that is recorded.
struct Recording {
  Session session;
  std::shared_ptr<SessionRecorder> recorder;
  std::string source;         ///< of the motion
  std::vector<VmcInput> vmc;  ///< of each avatar; empty without a program that sends
};

bool followsPeople(const SessionRecording& options) {
  return options.input.motion.empty() && options.input.performing.clip.empty();
}

/// The options of `lorica live` that follow the same people.
LiveOptions liveOf(const SessionRecording& options) {
  LiveOptions live;
  live.depth = options.depth;
  live.vmc = options.vmc;
  live.person = options.input.performing.person;
  live.people = options.people;
  if (!options.input.character.empty()) live.character = options.input.character;
  live.reading = options.input.reading;
  live.springs = options.input.springs;
  live.performing = options.input.performing;
  live.body = options.body;
  live.scene = options.scene;
  live.record = options.out;
  return live;
}

Result<Recording> startMotions(const SessionRecording& options, int threads) {
  LORICA_TRY(OpenedCast opened, openCast(options.input, options.body, options.scene, threads));
  const std::vector<CastMember>& cast = opened.avatars;
  LORICA_TRY(std::shared_ptr<SessionRecorder> recorder,
             startRecorder(options.out, cast, options.body, options.scene, opened.world));
  Result<Session> session = startSession(cast, recorder, std::move(opened.world));
  if (!session) {
    (void)recorder->finish();  // removes the file
    return session.error();
  }
  return Recording{std::move(*session), std::move(recorder), motionsOf(cast), {}};
}

Result<Recording> startLive(const SessionRecording& options, int threads) {
  const LiveOptions live = liveOf(options);
  LORICA_TRY(World world, openSceneForPeople(live.scene));
  LORICA_TRY(const std::vector<Follower> followers, readFollowers(live, false, threads));
  // The source is opened last, because it runs while the rest is prepared.
  LORICA_TRY(Performer performer, openPerformer(live));
  LORICA_TRY(std::shared_ptr<SessionRecorder> recorder, startRecorder(live, performer, followers, world));
  Result<Session> session = startSession(live, performer, followers, recorder, std::move(world));
  if (!session) {
    (void)recorder->finish();  // removes the file
    return session.error();
  }
  return Recording{std::move(*session), std::move(recorder), performer.name, std::move(performer.vmc)};
}

/// Runs until the end, the limit or Ctrl-C. @return seconds from the first step to the last
Result<double> runAll(const SessionRecording& options, Recording& recording) {
  Session& session = recording.session;
  double first = 0.0;
  while (!interrupted()) {
    LORICA_TRY(const bool more, session.step());
    if (!more) break;
    for (VmcInput& sender : recording.vmc) sender.add(session);
    if (session.frameCount() == 1) first = session.time();
    if (options.limit.frames > 0 && session.frameCount() >= options.limit.frames) break;
    if (options.limit.seconds > 0.0 && session.time() - first >= options.limit.seconds) break;
  }
  answerInterrupt();
  return session.frameCount() > 0 ? session.time() - first : 0.0;
}

Result<void> checkSource(const SessionRecording& options) {
  if (followsPeople(options) && options.input.performing.person == kEveryone) {
    return invalidArgument(
        "--person all: found a camera, expected a recording; --people says how many avatars follow a camera");
  }
  if (followsPeople(options)) return checkPeople(liveOf(options));
  const std::string& motion = options.input.motion.empty() ? options.input.character : options.input.motion;
  const char* other = nullptr;
  if (!options.vmc.listenAt.empty()) other = "--vmc";
  if (options.people > 1) other = "--people";
  if (other != nullptr) {
    return invalidArgument("found a motion and {}, expected only one of them", other);
  }
  if (options.depth.virtualCamera || !options.depth.device.empty() || !options.depth.driver.empty()) {
    return invalidArgument("found a motion, {}, and a camera, expected only one of them", motion);
  }
  return checkVmcInput(options.vmc);
}

nlohmann::ordered_json toJson(const Recording& recording, double seconds) {
  const Session& session = recording.session;
  nlohmann::ordered_json json;
  json["source"] = recording.source;
  json["character"] = session.character().name;
  json["seconds"] = seconds;
  json["avatars"] = nlohmann::ordered_json::array();
  for (const SessionAvatar& avatar : session.avatars()) {
    json["avatars"].push_back(
        {{"character", avatar.character().name}, {"frames", avatar.frameCount()}, {"hash", hexDigits(avatar.hash())}});
  }
  json["hash"] = hexDigits(session.hash());
  return json;
}

}  // namespace

std::size_t avatarsOf(const SessionRecording& options) {
  return followsPeople(options) ? avatarsOf(liveOf(options)) : namesIn(options.input.motion).size();
}

Result<void> recordSession(const SessionRecording& options, const CommonOptions& common,
                           const std::function<Result<void>(Report&)>& finished) {
  LORICA_TRY_DO(checkSource(options));
  const bool live = followsPeople(options);
  LORICA_TRY(Recording recording,
             live ? startLive(options, common.threadCount()) : startMotions(options, common.threadCount()));
  Session& session = recording.session;
  session.watch(recording.recorder);

  if (live) say(fmt::format("Recording {}; press Ctrl-C to stop.\n", recording.source));
  const Result<double> ran = runAll(options, recording);
  if (interrupted() && session.frameCount() == 0) {
    (void)recording.recorder->finish();  // removes the file
    return cancelled();
  }
  const double seconds = ran ? *ran : 0.0;
  const std::string avatars =
      session.avatars().size() > 1 ? fmt::format(", {}", counted(std::ssize(session.avatars()), "avatar")) : "";
  Report report(fmt::format("Recorded a session of {}{}: {} ({:.1f} s)", recording.source, avatars,
                            counted(session.frameCount(), "step"), seconds));
  nlohmann::ordered_json json = toJson(recording, seconds);
  LORICA_TRY_DO(finishRecorder(recording.recorder, options.out, report, json));
  if (!ran) return ran.error();
  for (VmcInput& sender : recording.vmc) {
    sender.addTo(report);
    if (&sender == &recording.vmc.front()) sender.addTo(json);
  }
  if (finished) {
    LORICA_TRY_DO(finished(report));
  }
  report.line("hash", hexDigits(session.hash()));
  return publish(common, report, json);
}

}  // namespace lorica

#include "apps/record.h"

#include "apps/interrupt.h"
#include "apps/report_parts.h"
#include "apps/show.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <utility>

namespace lorica {
namespace {

bool followsPeople(const CastRequest& request) {
  return request.motion.empty() && request.performing.clip.empty();
}

/// The people before the camera, or what sends, as `lorica live` follows them.
LiveRequest liveOf(const SessionRecording& options) {
  LiveRequest live = options.live;
  live.person = options.request.performing.person;
  return live;
}

Result<std::unique_ptr<Run>> start(const SessionRecording& options, Host& host) {
  RunSetting setting;
  setting.record = options.out;
  setting.frames = options.frames;
  setting.seconds = options.seconds;
  setting.doing = "Recording";
  if (followsPeople(options.request)) {
    LORICA_TRY(LiveCast live, prepareLiveCast(options.request, liveOf(options), host));
    return Run::start(std::move(live), setting, host);
  }
  LORICA_TRY(Cast cast, prepareCast(options.request, host));
  return Run::start(std::move(cast), setting, host);
}

Result<void> checkSource(const SessionRecording& options, const Host& host) {
  const CastRequest& request = options.request;
  const LiveRequest& live = options.live;
  if (followsPeople(request) && request.performing.person == kEveryone) {
    return invalidArgument(
        "--person all: found a camera, expected a recording; --people says how many avatars follow a camera");
  }
  if (followsPeople(request)) return checkLive(liveOf(options), host);
  const std::string& motion = request.motion.empty() ? request.character : request.motion;
  const char* other = live.people > 1 ? "--people" : !live.vmc.listenAt.empty() ? "--vmc" : nullptr;
  if (other != nullptr) {
    return invalidArgument("found a motion and {}, expected only one of them", other);
  }
  if (live.depth.virtualCamera || !live.depth.device.empty() || !live.depth.driver.empty()) {
    return invalidArgument("found a motion, {}, and a camera, expected only one of them", motion);
  }
  return checkVmcInput(live.vmc, host);
}

}  // namespace

std::size_t avatarsOf(const SessionRecording& options) {
  return followsPeople(options.request) ? liveOf(options).avatars() : namesIn(options.request.motion).size();
}

Result<void> recordSession(const SessionRecording& options, const CommonOptions& common, Host& host,
                           const std::function<Result<void>()>& finished) {
  LORICA_TRY_DO(checkSource(options, host));
  LORICA_TRY(const std::unique_ptr<Run> run, start(options, host));
  const Session& session = run->session;
  if (run->live()) host.tell(fmt::format("Recording {}; press Ctrl-C to stop.", run->name()));
  Shown shown;
  const Result<RunEnd> end = play(*run, shown, host);
  answerInterrupt();
  if (host.cancelled() && session.frameCount() == 0) {
    (void)run->recorder->finish();  // removes the file
    return cancelled();
  }
  const int avatars = countOf(session.avatars());
  Report report(fmt::format("Recorded a session of {}{}: {} ({:.1f} s)", run->name(),
                            avatars > 1 ? fmt::format(", {}", counted(avatars, "avatar")) : "",
                            counted(session.frameCount(), "step"), run->seconds()));
  nlohmann::ordered_json json;
  json["source"] = run->name();
  json["character"] = session.character().name;
  json["seconds"] = run->seconds();
  addAvatarsTo(json, session);
  json["hash"] = hexDigits(session.hash());
  LORICA_TRY_DO(finishRecorder(*run, options.into.empty() ? options.out : options.into, report, json));
  if (!end) return end.error();
  for (const VmcInput& stream : run->streams()) {
    addStreamTo(report, stream);
    if (&stream == &run->streams().front()) addStreamTo(json, stream);
  }
  if (finished) LORICA_TRY_DO(finished());
  report.line("hash", hexDigits(session.hash()));
  return publish(common, report, json);
}

}  // namespace lorica

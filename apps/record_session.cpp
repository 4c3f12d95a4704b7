#include "apps/record_session.h"

#include "apps/interrupt.h"
#include "apps/playback.h"
#include "apps/scenes.h"
#include "apps/session_files.h"
#include "apps/standard_streams.h"
#include "capture/tracking/live_joints.h"
#include "geometry/files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <optional>

namespace lorica {
namespace {

/// The character and the source of its motion.
struct Performer {
  Subject subject;
  std::string name;                        ///< of the character, as given by the user
  std::optional<Motion> motion;            ///< none = live camera
  std::unique_ptr<SkeletonSource> joints;  ///< of the live camera
  std::string source;
  std::optional<std::string> clip = {};  ///< see PlaybackInput::ownClip
};

Result<Performer> openMotion(const SessionRecording& options) {
  Result<PlaybackInput> input = readPlaybackInput(options.input);
  if (!input) return input.error();
  const bool ownFile = options.input.character.empty() && input->subject.file.has_value();
  std::string source = input->motion.name;
  return Performer{std::move(input->subject), ownFile ? options.input.motion : options.input.character,
                   std::move(input->motion),  nullptr,
                   std::move(source),         std::move(input->ownClip)};
}

Result<Performer> openCharacter(const SessionRecording& options) {
  const std::string name = options.input.character.empty() ? "mannequin" : options.input.character;
  CharacterOptions reading = options.input.reading;
  reading.suits = followsPerson;
  Result<Subject> subject = readCharacter(name, reading);
  if (!subject) return subject.error();
  return Performer{std::move(*subject), name, std::nullopt, nullptr, ""};
}

/// Opens the camera. Call it last, because the camera runs while the rest is prepared.
Result<void> openCameraFor(const SessionRecording& options, Performer& performer) {
  Result<std::unique_ptr<DepthSource>> depth = openDepth(options.depth);
  if (!depth) return depth.error();
  Result<Tracker> tracker = Tracker::create((*depth)->camera());
  if (!tracker) return tracker.error();
  auto joints = std::make_unique<LiveJoints>(
      DepthJoints(std::move(*depth), std::move(*tracker), options.input.performing.person));
  performer.source = joints->source().name();
  performer.joints = std::move(joints);
  return {};
}

/// Runs until the end, the limit or Ctrl-C. @return seconds from the first step to the last
Result<double> runAll(const SessionRecording& options, Session& session) {
  double first = 0.0;
  while (!interrupted()) {
    const Result<bool> more = session.step();
    if (!more) return more.error();
    if (!*more) break;
    if (session.frameCount() == 1) first = session.time();
    if (options.limit.frames > 0 && session.frameCount() >= options.limit.frames) break;
    if (options.limit.seconds > 0.0 && session.time() - first >= options.limit.seconds) break;
  }
  answerInterrupt();
  return session.frameCount() > 0 ? session.time() - first : 0.0;
}

}  // namespace

Result<void> recordSession(const SessionRecording& options, const CommonOptions& common) {
  const bool live = options.input.motion.empty() && options.input.performing.clip.empty();
  if (!live && (options.depth.virtualCamera || !options.depth.device.empty() || !options.depth.driver.empty())) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("found a motion, {}, and a camera, expected only one of them",
                             options.input.motion.empty() ? options.input.character : options.input.motion)};
  }
  Result<Performer> performer = live ? openCharacter(options) : openMotion(options);
  if (!performer) return performer.error();
  const Character& character = *performer->subject.character;
  if (Result<void> fine = checkCover(options.body.cover, character); !fine) return fine;
  Result<World> world = openScene(options.scene);
  if (!world) return world.error();
  const Result<DecompositionFile> body = chooseBody(options.body, performer->subject, common.threadCount());
  if (!body) return body.error();
  if (live) {
    if (Result<void> opened = openCameraFor(options, *performer); !opened) return opened;
  }
  const MotionOptions& performing = options.input.performing;
  const bool poses = performer->motion && performer->motion->bones;
  const std::optional<SpringChoice> springs = chooseSprings(performer->subject, options.input.springs);
  const RecordedAs as{performer->source, poses,         performer->name, options.input.reading, performing,
                      options.body,      options.scene, springs,         performer->clip};
  const Result<std::shared_ptr<SessionRecorder>> recorder = startRecorder(options.out, as, character, *body, *world);
  if (!recorder) return recorder.error();
  const std::shared_ptr<SourceLog>& log = (*recorder)->log();
  Result<std::unique_ptr<PoseSource>> source =
      live ? makeTreatedSource(character, std::move(performer->joints), {log, performing.faults(), performing.joints()})
           : poseSourceOf(character, *performer->motion, performing, log);
  if (!source) {
    (void)(*recorder)->finish();
    return source.error();
  }
  Result<Session> session = startSession(character, *body, std::move(*source), std::move(*world));
  if (!session) return session.error();
  if (Result<void> added = addSprings(springs, *session); !added) return added;
  session->watch(*recorder);

  if (live) say(fmt::format("Recording {}; press Ctrl-C to stop.\n", performer->source));
  const Result<double> seconds = runAll(options, *session);
  if (interrupted() && session->frameCount() == 0) {
    (void)(*recorder)->finish();  // removes the file
    return Error{ErrorCode::kCancelled, "cancelled"};
  }
  Report report(fmt::format("Recorded a session of {}: {} ({:.1f} s)", performer->source,
                            counted(session->frameCount(), "step"), seconds ? *seconds : 0.0));
  nlohmann::ordered_json json;
  json["source"] = performer->source;
  json["character"] = character.name;
  json["seconds"] = seconds ? *seconds : 0.0;
  json["hash"] = hexDigits(session->hash());
  if (Result<void> kept = finishRecorder(*recorder, options.out, report, json); !kept) return kept;
  if (!seconds) return seconds.error();
  report.line("hash", hexDigits(session->hash()));
  return publish(common, report, json);
}

}  // namespace lorica

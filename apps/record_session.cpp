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
  std::optional<VmcInput> vmc;             ///< the program that sends
  std::string source;
  std::optional<std::string> clip = {};  ///< see PlaybackInput::ownClip
};

Result<Performer> openMotion(const SessionRecording& options) {
  Result<PlaybackInput> input = readPlaybackInput(options.input);
  if (!input) return input.error();
  const bool ownFile = options.input.character.empty() && input->subject.file.has_value();
  std::string source = input->motion.name;
  return Performer{std::move(input->subject),
                   ownFile ? options.input.motion : options.input.character,
                   std::move(input->motion),
                   nullptr,
                   std::nullopt,
                   std::move(source),
                   std::move(input->ownClip)};
}

Result<Performer> openCharacter(const SessionRecording& options) {
  const std::string name = options.input.character.empty() ? "mannequin" : options.input.character;
  CharacterOptions reading = options.input.reading;
  if (options.vmc.listenAt.empty()) reading.suits = followsPerson;
  Result<Subject> subject = readCharacter(name, reading);
  if (!subject) return subject.error();
  return Performer{std::move(*subject), name, std::nullopt, nullptr, std::nullopt, ""};
}

/// Opens the camera, or listens. Call it last, because both run while the rest is prepared.
Result<void> openLive(const SessionRecording& options, Performer& performer) {
  if (!options.vmc.listenAt.empty()) {
    Result<VmcInput> vmc = VmcInput::open(options.vmc);
    if (!vmc) return vmc.error();
    performer.source = vmc->name();
    performer.vmc = std::move(*vmc);
    return {};
  }
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

Result<std::unique_ptr<PoseSource>> sourceOf(Performer& performer, const MotionOptions& performing,
                                             const std::shared_ptr<SourceLog>& log) {
  const Character& character = *performer.subject.character;
  if (performer.motion) return poseSourceOf(character, *performer.motion, performing, log);
  const SourceTreatment treatment{log, performing.faults(), performing.joints()};
  if (!performer.vmc) return makeTreatedSource(character, std::move(performer.joints), treatment);
  Result<std::unique_ptr<PoseSource>> sent = performer.vmc->makeSource(character, treatment.joints.mirror);
  if (!sent) return sent.error();
  return makeTreatedSource(std::move(*sent), treatment);
}

/// Runs until the end, the limit or Ctrl-C. @return seconds from the first step to the last
Result<double> runAll(const SessionRecording& options, std::optional<VmcInput>& vmc, Session& session) {
  double first = 0.0;
  while (!interrupted()) {
    const Result<bool> more = session.step();
    if (!more) return more.error();
    if (!*more) break;
    if (vmc) vmc->add(session);
    if (session.frameCount() == 1) first = session.time();
    if (options.limit.frames > 0 && session.frameCount() >= options.limit.frames) break;
    if (options.limit.seconds > 0.0 && session.time() - first >= options.limit.seconds) break;
  }
  answerInterrupt();
  return session.frameCount() > 0 ? session.time() - first : 0.0;
}

}  // namespace

Result<void> recordSession(const SessionRecording& options, const CommonOptions& common,
                           const std::function<Result<void>(Report&)>& finished) {
  const bool live = options.input.motion.empty() && options.input.performing.clip.empty();
  if (Result<void> fine = checkVmcInput(options.vmc); !fine) return fine;
  if (!live && !options.vmc.listenAt.empty()) {
    return Error{ErrorCode::kInvalidArgument, "found a motion and --vmc, expected only one of them"};
  }
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
    if (Result<void> opened = openLive(options, *performer); !opened) return opened;
  }
  const MotionOptions& performing = options.input.performing;
  const bool stream = performer->vmc || (performer->motion && performer->motion->packets);
  const bool poses = stream || (performer->motion && performer->motion->bones);
  const std::optional<SpringChoice> springs = chooseSprings(performer->subject, options.input.springs);
  const RecordedAvatar as{{performer->source, poses, performer->name, options.input.reading, performing, options.body,
                           springs, performer->clip, stream},
                          character,
                          *body};
  const Result<std::shared_ptr<SessionRecorder>> recorder =
      startRecorder(options.out, std::span(&as, 1), options.scene, *world);
  if (!recorder) return recorder.error();
  Result<std::unique_ptr<PoseSource>> source = sourceOf(*performer, performing, (*recorder)->log());
  if (!source) {
    (void)(*recorder)->finish();
    return source.error();
  }
  Result<Session> session = startSession(character, *body, std::move(*source), std::move(*world));
  if (!session) return session.error();
  if (Result<void> added = addSprings(springs, *session); !added) return added;
  session->watch(*recorder);

  if (live) say(fmt::format("Recording {}; press Ctrl-C to stop.\n", performer->source));
  const Result<double> seconds = runAll(options, performer->vmc, *session);
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
  if (performer->vmc) {
    performer->vmc->addTo(report);
    performer->vmc->addTo(json);
  }
  if (finished) {
    if (Result<void> done = finished(report); !done) return done;
  }
  report.line("hash", hexDigits(session->hash()));
  return publish(common, report, json);
}

}  // namespace lorica

#include "acd/decomposition_file.h"
#include "apps/body_choice.h"
#include "apps/events_output.h"
#include "apps/inputs.h"
#include "apps/options.h"
#include "apps/playback.h"
#include "apps/playback_input.h"
#include "apps/pose_output.h"
#include "apps/run_session.h"
#include "apps/run_statistics.h"
#include "apps/scenes.h"
#include "apps/session_files.h"
#include "geometry/files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <optional>

namespace lorica {
namespace {

struct Options {
  PlaybackInputOptions input;
  BodyOptions body;
  std::string scene;
  SnapshotOptions pictures;
  PlaybackOptions playing;
  std::string record;  // file; empty = none
  PoseOutputOptions out;
  std::string events;  // file or -; empty = none
  bool window = false;
  bool selfContacts = false;
};

Result<void> playWithWindow(const Options& options, const PlaybackInput& input, Session& session,
                            RunStatistics& statistics) {
  const Motion& motion = input.motion;
  WindowSubject subject{session, motion.name};
  subject.duration = motion.seconds();
  subject.sourceAgain = [&] { return poseSourceOf(*input.subject.character, motion, options.input.performing); };
  subject.scene = options.scene;
  subject.stepped = [&] { statistics.add(session, options.selfContacts); };
  subject.restarted = [&] { statistics = RunStatistics(); };  // the report covers the last run only
  return runInOwnWindow(subject, options.playing);
}

Result<DrawnFiles> playHeadless(const Options& options, const Motion& motion, Session& session,
                                RunStatistics& statistics) {
  HeadlessRun all{"Playing", motion.name};
  all.frames = motion.frameCount();
  if (options.playing.frames > 0) all.frames = std::min(all.frames, options.playing.frames);
  all.stepped = [&] { statistics.add(session, options.selfContacts); };
  return runHeadless(all, options.pictures, session);
}

nlohmann::ordered_json toJson(const Options& options, const Motion& motion, const Session& session,
                              const DecompositionFile& file, const RunStatistics& statistics, const DrawnFiles& drawn) {
  nlohmann::ordered_json json;
  json["recording"] = motion.name;
  json["format"] = motion.format;
  json["notes"] = motion.notes;
  json["character"] = session.character().name;
  json["parts"] = file.decomposition.parts.size();
  json["error"] = file.errorPerKeyframe.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(file.meanError);
  addCoverTo(json, file.cover);
  statistics.addTo(json);
  const std::optional<double> delay = session.source().smoothingDelay();
  json["refusedLegs"] = session.source().refusedLegs();
  json["smoothingDelay"] = delay ? nlohmann::ordered_json(*delay) : nlohmann::ordered_json();
  drawn.addTo(options.pictures, json);
  json["hash"] = hexDigits(session.hash());
  return json;
}

Report toReport(const Options& options, const Motion& motion, const Session& session, const DecompositionFile& file,
                const RunStatistics& statistics, const DrawnFiles& drawn) {
  Report report(
      fmt::format("{} performed {}: {}", session.character().name, motion.name, counted(statistics.frames(), "frame")));
  std::string parts = std::to_string(file.decomposition.parts.size());
  if (!file.errorPerKeyframe.empty()) {
    parts += fmt::format("; hulls have {} more volume than the body (mean over {})", percent(file.meanError),
                         counted(std::ssize(file.errorPerKeyframe), "training keyframe"));
  }
  report.line("parts", parts);
  addCoverTo(report, file.cover);
  statistics.addTrainingTo(report);
  if (const std::optional<double> delay = session.source().smoothingDelay()) {
    report.line("smoothing", fmt::format("joints lag by {:.0f} ms", 1e3 * *delay));
  }
  report.line("contacts",
              fmt::format("{} with {}; {} over all frames", counted(statistics.touches(), "touch", "touches"),
                          counted(statistics.propsTouched(), "prop"), counted(statistics.contacts(), "contact point")));
  statistics.addSelfContactsTo(report);
  report.line("hash", hexDigits(session.hash()));
  drawn.addTo(options.pictures, report);
  report.gap();
  report.line("frame time", "median");
  statistics.addTo(report);
  for (const std::string& note : motion.notes) report.note(note);
  if (session.source().refusedLegs()) report.note(kRefusedLegs);
  return report;
}

Result<void> run(const Options& options, const CommonOptions& common) {
  if (Result<void> fine =
          checkJsonOutput(common, {options.input.motion, options.input.character, options.body.decomposition});
      !fine) {
    return fine;
  }
  if (Result<void> fine = checkWindow(options.window, "--snapshots DIR and --video FILE do not need one"); !fine)
    return fine;
  if (Result<void> fine = checkSnapshots(options.pictures); !fine) return fine;
  if (Result<void> fine = checkRecord("--record", options.record); !fine) return fine;
  if (Result<void> fine = checkPoseOutput(options.out); !fine) return fine;
  if (Result<void> fine =
          checkEvents(options.events, common,
                      {options.input.motion, options.input.character, options.body.decomposition, options.record});
      !fine)
    return fine;
  PlaybackInputOptions asked = options.input;
  asked.reading.drawn = options.window || options.pictures.any();
  const Result<PlaybackInput> input = readPlaybackInput(asked);
  if (!input) return input.error();
  const Subject& subject = input->subject;
  const Motion& motion = input->motion;
  if (Result<void> fine = checkCover(options.body.cover, *subject.character); !fine) return fine;
  Result<World> world = openScene(options.scene);
  if (!world) return world.error();
  const Result<DecompositionFile> file = chooseBody(options.body, subject, common.threadCount());
  if (!file) return file.error();
  const std::string& character =
      !options.input.character.empty() || !subject.file ? options.input.character : options.input.motion;
  const std::optional<SpringChoice> springs = chooseSprings(subject, options.input.springs);
  const RecordedAs as{motion.name,
                      motion.bones.has_value(),
                      character,
                      options.input.reading,
                      options.input.performing,
                      options.body,
                      options.scene,
                      springs,
                      input->ownClip,
                      motion.packets.has_value()};
  const Result<std::shared_ptr<SessionRecorder>> recorder =
      startRecorder(options.record, as, *subject.character, *file, *world);
  if (!recorder) return recorder.error();
  Result<std::unique_ptr<PoseSource>> source =
      poseSourceOf(*subject.character, motion, options.input.performing, *recorder ? (*recorder)->log() : nullptr);
  if (!source) return source.error();
  Result<Session> session = startSession(*subject.character, *file, std::move(*source), std::move(*world));
  if (!session) return session.error();
  if (Result<void> added = addSprings(springs, *session); !added) return added;

  RunStatistics statistics;
  Result<std::shared_ptr<StepWatcher>> watcher =
      makePoseOutput(options.out, subject, options.input.reading.expressions, *recorder);
  if (!watcher) return watcher.error();
  const Result<std::shared_ptr<EventsOutput>> events = makeEventsOutput(options.events, *watcher);
  if (!events) return events.error();
  session->watch(*events ? *events : *watcher);
  DrawnFiles drawn;
  const auto play = [&]() -> Result<void> {
    if (options.window) return playWithWindow(options, *input, *session, statistics);
    const Result<DrawnFiles> played = playHeadless(options, motion, *session, statistics);
    if (!played) return played.error();
    drawn = *played;
    return {};
  };
  if (Result<void> played = play(); !played) {
    if (*recorder) (void)(*recorder)->finish();  // keep what was recorded despite the error
    return played;
  }
  Report report = toReport(options, motion, *session, *file, statistics, drawn);
  nlohmann::ordered_json json = toJson(options, motion, *session, *file, statistics, drawn);
  if (Result<void> kept = finishEvents(*events); !kept) return kept;
  if (Result<void> kept = finishRecorder(*recorder, options.record, report, json); !kept) return kept;
  return publish(common, report, json, options.events == "-");
}

}  // namespace

Command addPlay(CommandLine& parent, CommonOptions& common) {
  const auto options = std::make_shared<Options>();
  CommandLine* app = addSubcommand(
      parent, common, "play",
      "Play a motion: the character moves, its hulls follow, and objects around it collide with them.",
      "  lorica play walk\n"
      "      a shipped recording, without pictures: prints contacts and the time of each stage\n"
      "  lorica play walk --window\n"
      "      in a window\n"
      "  lorica play walk --snapshots pictures --every 15\n"
      "      pictures/frame_0000.png, frame_0015.png, ...; needs no display\n"
      "  lorica play punch_and_kick --scene bowling --video kick.mp4\n"
      "      a video, without a display; `lorica snapshot --video` has more options\n"
      "  lorica play walk.bvh --character hero.glb --window\n"
      "      your own motion and character\n"
      "  lorica play hero.glb --clip Run\n"
      "      a character's own clip\n"
      "  lorica play punch_and_kick --scene bowling\n"
      "      in another scene: boxes, bowling, curtain, sand, or your own scene file\n"
      "  lorica play walk --inject dropout=0.1,swap,seed=7\n"
      "      with simulated tracking faults: lost and swapped joints\n"
      "  lorica play body.oni\n"
      "      track the person in a depth recording\n"
      "  lorica decompose mannequin --parts 24 -o body.lorica\n"
      "  lorica play joints.csv --decomposition body.lorica\n"
      "      your own joints and decomposition\n"
      "  lorica play walk --hull-vertices 64\n"
      "      hulls of at most 64 vertices that contain the body in 128 sampled poses\n"
      "  lorica play wave --json - | jq .stages.total.median\n"
      "\nWithout --decomposition: 16 parts from 12 keyframes, computed on the first run and then cached, as are the\n"
      "body of a character whose surface is open, and the hull covers of --cover and --hull-vertices. Keyframes come\n"
      "from the character's own clips and, of a humanoid, from the shipped recordings.");
  addPlaybackInputOptions(*app, options->input);
  addBodyOptions(*app, options->body);
  addSceneOption(*app, options->scene);
  addFaultOption(*app, options->input.performing);
  addPoseOutputOptions(*app, options->out);
  addEventsOption(*app, options->events);
  addRecordOption(*app, options->record);
  addCount(*app, "--frames", options->playing.frames, 1, "Stop after N frames");
  app->addFlag("--as-fast-as-possible", options->playing.hurry,
               "Do not play in real time in a window; without a window this is always so");
  app->addFlag("--self-contacts", options->selfContacts,
               "Report overlapping parts of the body that are not neighbours");
  Option* window =
      app->addFlag("--window", options->window, "Open a window and play in real time; fail if there is no display");
  addSnapshotOptions(*app, options->pictures, window);
  addTextureOption(*app, options->input.reading.textureSize);
  return {app, [options](const CommonOptions& given) { return run(*options, given); }};
}

}  // namespace lorica

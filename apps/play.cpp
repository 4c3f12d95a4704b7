#include "acd/decomposition_file.h"
#include "apps/body_choice.h"
#include "apps/inputs.h"
#include "apps/options.h"
#include "apps/playback.h"
#include "apps/playback_input.h"
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
  CastOptions cast;
  BodyOptions body;
  std::string scene;
  SnapshotOptions pictures;
  PlaybackOptions playing;
  std::string record;  // file; empty = none
  bool window = false;
  bool selfContacts = false;
};

Result<void> playWithWindow(const Options& options, const Cast& cast, Session& session, Tally& tally) {
  const Motion& motion = cast.motion;
  WindowSubject subject{session, motion.name};
  subject.duration = motion.seconds();
  subject.sourceAnew = [&] { return poseSourceOf(*cast.subject.character, motion, options.cast.performing); };
  subject.scene = options.scene;
  subject.stepped = [&] { tally.add(session, options.selfContacts); };
  subject.restarted = [&] { tally = Tally(); };  // what is told afterwards is of the last run
  return runInOwnWindow(subject, options.playing);
}

Result<DrawnFiles> playHeadless(const Options& options, const Motion& motion, Session& session, Tally& tally) {
  HeadlessRun all{"Playing", motion.name};
  all.frames = motion.frameCount();
  if (options.playing.frames > 0) all.frames = std::min(all.frames, options.playing.frames);
  all.stepped = [&] { tally.add(session, options.selfContacts); };
  return runHeadless(all, options.pictures, session);
}

nlohmann::ordered_json toJson(const Options& options, const Motion& motion, const Session& session,
                              const DecompositionFile& file, const Tally& tally, const DrawnFiles& drawn) {
  nlohmann::ordered_json json;
  json["recording"] = motion.name;
  json["format"] = motion.format;
  json["notes"] = motion.notes;
  json["character"] = session.character().name;
  json["parts"] = file.decomposition.parts.size();
  json["error"] = file.meanError;
  addCoverTo(json, file.cover);
  tally.addTo(json);
  const std::optional<double> delay = session.source().smoothingDelay();
  json["smoothingDelay"] = delay ? nlohmann::ordered_json(*delay) : nlohmann::ordered_json();
  drawn.addTo(options.pictures, json);
  json["hash"] = hexDigits(session.hash());
  return json;
}

Report toReport(const Options& options, const Motion& motion, const Session& session, const DecompositionFile& file,
                const Tally& tally, const DrawnFiles& drawn) {
  Report report(
      fmt::format("{} performed {}: {}", session.character().name, motion.name, counted(tally.frames(), "frame")));
  report.line("parts",
              fmt::format("{}, {} more volume than the body (mean over {})", file.decomposition.parts.size(),
                          percent(file.meanError), counted(std::ssize(file.errorPerKeyframe), "training keyframe")));
  addCoverTo(report, file.cover);
  tally.addTrainingTo(report);
  if (const std::optional<double> delay = session.source().smoothingDelay()) {
    report.line("smoothing", fmt::format("joints lag by {:.0f} ms", 1e3 * *delay));
  }
  report.line("contacts",
              fmt::format("{}, on {}; {} over all frames", counted(tally.touches(), "touch", "touches"),
                          counted(tally.propsTouched(), "prop"), counted(tally.contacts(), "contact point")));
  tally.addSelfContactsTo(report);
  report.line("hash", hexDigits(session.hash()));
  drawn.addTo(options.pictures, report);
  report.gap();
  report.line("time a frame", "median");
  tally.addTo(report);
  for (const std::string& note : motion.notes) report.note(note);
  return report;
}

Result<void> run(const Options& options, const CommonOptions& common) {
  if (Result<void> fine =
          checkJsonOutput(common, {options.cast.motion, options.cast.character, options.body.decomposition});
      !fine) {
    return fine;
  }
  if (Result<void> fine = checkWindow(options.window, "--snapshots DIR and --video FILE need none"); !fine) return fine;
  if (Result<void> fine = checkSnapshots(options.pictures); !fine) return fine;
  if (Result<void> fine = checkRecord("--record", options.record); !fine) return fine;
  const Result<Cast> cast = readCast(options.cast);
  if (!cast) return cast.error();
  const Subject& subject = cast->subject;
  const Motion& motion = cast->motion;
  if (Result<void> fine = checkCover(options.body.cover, *subject.character); !fine) return fine;
  const Result<DecompositionFile> file = chooseBody(options.body, subject, common.threadCount());
  if (!file) return file.error();
  Result<World> world = openScene(options.scene);
  if (!world) return world.error();
  const std::string& character =
      !options.cast.character.empty() || !subject.file ? options.cast.character : options.cast.motion;
  const RecordedAs as{motion.name,          motion.bones.has_value(), character,
                      options.cast.reading, options.cast.performing,  options.body,
                      options.scene};
  const Result<std::shared_ptr<SessionRecorder>> recorder =
      startRecorder(options.record, as, *subject.character, *file, *world);
  if (!recorder) return recorder.error();
  Result<std::unique_ptr<PoseSource>> source =
      poseSourceOf(*subject.character, motion, options.cast.performing, *recorder ? (*recorder)->log() : nullptr);
  if (!source) return source.error();
  Result<Session> session = startSession(*subject.character, *file, std::move(*source), std::move(*world));
  if (!session) return session.error();

  Tally tally;
  session->watch(*recorder);
  DrawnFiles drawn;
  const auto play = [&]() -> Result<void> {
    if (options.window) return playWithWindow(options, *cast, *session, tally);
    const Result<DrawnFiles> played = playHeadless(options, motion, *session, tally);
    if (!played) return played.error();
    drawn = *played;
    return {};
  };
  if (Result<void> played = play(); !played) {
    if (*recorder) (void)(*recorder)->finish();  // what was recorded stays, whatever ended it
    return played;
  }
  Report report = toReport(options, motion, *session, *file, tally, drawn);
  nlohmann::ordered_json json = toJson(options, motion, *session, *file, tally, drawn);
  if (Result<void> kept = finishRecorder(*recorder, options.record, report, json); !kept) return kept;
  return publish(common, report, json);
}

}  // namespace

Command addPlay(CommandLine& parent, CommonOptions& common) {
  const auto options = std::make_shared<Options>();
  CommandLine* app = addSubcommand(
      parent, common, "play", "Play a motion: the character moves, its hulls follow, things around it bounce.",
      "  lorica play walk\n"
      "      a shipped recording, without pictures: time of each stage, contacts\n"
      "  lorica play walk --window\n"
      "      watch it\n"
      "  lorica play walk --snapshots pictures --every 15\n"
      "      pictures/frame_0000.png, frame_0015.png, ...; needs no display\n"
      "  lorica play punch_and_kick --scene bowling --video kick.mp4\n"
      "      a film, with no display; `lorica snapshot --video` has more to choose from\n"
      "  lorica play walk.bvh --character hero.glb --window\n"
      "      a motion and a character of your own\n"
      "  lorica play hero.glb --clip Run\n"
      "      a character's own clip\n"
      "  lorica play punch_and_kick --scene bowling\n"
      "      among other things: boxes, bowling, curtain, or a scene file of your own\n"
      "  lorica play walk --inject dropout=0.1,swap,seed=7\n"
      "      with joints that are lost or exchanged, as trackers do\n"
      "  lorica play body.oni\n"
      "      whoever is in a depth recording\n"
      "  lorica decompose mannequin --parts 24 -o body.lorica\n"
      "  lorica play joints.csv --decomposition body.lorica\n"
      "      joints of your own, a decomposition of your own\n"
      "  lorica play walk --hull-vertices 64\n"
      "      hulls of at most 64 vertices, which hold the body in 128 sampled poses\n"
      "  lorica play wave --json - | jq .stages.total.median\n"
      "\nWithout --decomposition: 16 parts from 12 keyframes, computed the first time and then cached. So is what\n"
      "--cover and --hull-vertices ask for. Keyframes come from the character's own clips, else from the shipped\n"
      "recordings.");
  addCastOptions(*app, options->cast);
  addBodyOptions(*app, options->body);
  addSceneOption(*app, options->scene);
  addFaultOption(*app, options->cast.performing);
  addRecordOption(*app, options->record);
  addCount(*app, "--frames", options->playing.frames, 1, "Stop after so many frames");
  app->addFlag("--as-fast-as-possible", options->playing.hurry,
               "In a window too; without one nothing waits for the recording's pace");
  app->addFlag("--self-contacts", options->selfContacts,
               "Tell which parts of the body overlap that are not neighbours");
  Option* window = app->addFlag("--window", options->window, "Watch it in a window, at the recording's pace");
  addSnapshotOptions(*app, options->pictures, window);
  return {app, [options](const CommonOptions& given) { return run(*options, given); }};
}

}  // namespace lorica

#include "apps/body_choice.h"
#include "apps/depth_inputs.h"
#include "apps/depth_picture.h"
#include "apps/inputs.h"
#include "apps/interrupt.h"
#include "apps/live_log.h"
#include "apps/options.h"
#include "apps/playback.h"
#include "apps/run_session.h"
#include "apps/run_statistics.h"
#include "apps/scenes.h"
#include "apps/session_files.h"
#include "capture/tracking/live_joints.h"
#include "geometry/files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <optional>

namespace lorica {
namespace {

struct Options {
  DepthOptions depth;
  std::string nite;  // library; empty = Lorica's own tracker
  int person = 0;
  std::string character = "mannequin";
  CharacterOptions reading;
  MotionOptions performing;
  BodyOptions body;
  std::string scene;
  SnapshotOptions pictures;
  PlaybackOptions limit;
  std::string record;  // file; empty = none
  bool window = false;
  bool headless = false;
};

/// What runs, and what came of it.
struct Live {
  Session session;
  const LiveJoints* joints;  // the session's own; null where NiTE 2 tracks
  std::string name;
  LiveLog log;
  Tally tally;
  DrawnFiles drawn;
  Image picture;  // of what the camera sees
};

/// Takes the session's last frame into account. @return seconds since the first one
double note(Live& live, double& firstTime) {
  if (live.session.frameCount() == 1) firstTime = live.session.time();
  const double seconds = live.session.time() - firstTime;
  if (live.joints != nullptr) live.log.add(*live.joints, seconds);
  live.tally.add(live.session);
  return seconds;
}

/// One frame. @return false at the end
Result<bool> step(const Options& options, Live& live, double& firstTime) {
  const Result<bool> more = live.session.step();
  if (!more || !*more) return more;
  const double seconds = note(live, firstTime);
  const PlaybackOptions& limit = options.limit;
  const bool over = (limit.frames > 0 && live.session.frameCount() >= limit.frames) ||
                    (limit.seconds > 0.0 && seconds >= limit.seconds);
  return !over;
}

Result<void> runHeadless(const Options& options, Live& live) {
  Result<std::optional<SnapshotSeries>> pictures = SnapshotSeries::create(options.pictures, live.session);
  if (!pictures) return pictures.error();
  double firstTime = 0.0;
  while (!interrupted()) {
    const Result<bool> more = step(options, live, firstTime);
    if (!more) return more.error();
    if (*pictures) {
      if (live.joints != nullptr && (*pictures)->due(live.session))
        drawDepthPicture(live.joints->source().camera(), live.joints->sight(), live.picture);
      if (Result<void> drawn = (*pictures)->add(live.session, live.name, &live.picture); !drawn) return drawn;
    }
    if (!*more) break;
  }
  if (!*pictures) return {};
  const Result<DrawnFiles> drawn = (*pictures)->finish();
  if (!drawn) return drawn.error();
  live.drawn = *drawn;
  return {};
}

Result<void> runInWindow(const Options& options, Live& live) {
  Result<Window> window = openWindow(live.name, live.session.character().height);
  if (!window) return window.error();
  WindowSubject subject{live.session, live.name};
  subject.scene = options.scene;
  subject.atEnd = WindowSubject::AtEnd::kReturn;
  double firstTime = 0.0;
  subject.stepped = [&] {
    note(live, firstTime);
    if (live.joints != nullptr) drawDepthPicture(live.joints->source().camera(), live.joints->sight(), live.picture);
  };
  if (live.joints != nullptr) {
    subject.ready = [&] { return live.joints->ready(); };
    subject.trouble = [&] { return live.log.state(); };
    subject.trackingSeconds = [&] { return live.joints->sight().trackSeconds; };
    subject.inset = &live.picture;
  }
  const Result<WindowEnd> end = runInWindow(*window, subject, options.limit);
  return end ? Result<void>() : end.error();
}

nlohmann::ordered_json toJson(const Options& options, const Live& live, const DecompositionFile& body) {
  nlohmann::ordered_json json;
  json["source"] = live.name;
  json["character"] = live.session.character().name;
  json["parts"] = body.decomposition.parts.size();
  if (live.joints != nullptr) live.log.addTo(json);
  live.tally.addTo(json);
  const std::optional<double> delay = live.session.source().smoothingDelay();
  json["smoothingDelay"] = delay ? nlohmann::ordered_json(*delay) : nlohmann::ordered_json();
  live.drawn.addTo(options.pictures, json);
  json["hash"] = hexDigits(live.session.hash());
  return json;
}

Report toReport(const Options& options, const Live& live) {
  Report report(fmt::format("{} followed {}: {}", live.session.character().name, live.name,
                            counted(live.tally.frames(), "frame")));
  if (live.joints != nullptr) live.log.addTo(report);
  if (const std::optional<double> delay = live.session.source().smoothingDelay()) {
    report.line("smoothing", fmt::format("joints lag by {:.0f} ms more", 1e3 * *delay));
  }
  live.tally.addTrainingTo(report);
  report.line("contacts", fmt::format("{}, on {}", counted(live.tally.touches(), "touch", "touches"),
                                      counted(live.tally.propsTouched(), "prop")));
  live.drawn.addTo(options.pictures, report);
  report.gap();
  report.line("time a frame", "median");
  live.tally.addTo(report);
  return report;
}

/// A window where one was asked for or can be had and nothing else was asked for.
Result<bool> chooseWindow(const Options& options) {
  if (options.headless || options.pictures.any()) return false;
  if (Result<void> fine = checkWindow(options.window, "--headless, --snapshots DIR and --video FILE need none");
      !fine) {
    return fine.error();
  }
  return displayAvailable();
}

/// Whoever finds the joints.
struct Joints {
  std::unique_ptr<SkeletonSource> source;
  const LiveJoints* tracked;  // the source; null where NiTE 2 tracks
  std::string name;
};

Result<Joints> openJoints(const Options& options) {
  if (!options.nite.empty()) {
    Result<std::unique_ptr<SkeletonSource>> source = openNite(options.depth, options.nite);
    if (!source) return source.error();
    return Joints{std::move(*source), nullptr, "NiTE 2"};
  }
  Result<std::unique_ptr<DepthSource>> depth = openDepth(options.depth);
  if (!depth) return depth.error();
  Result<Tracker> tracker = Tracker::create((*depth)->camera());
  if (!tracker) return tracker.error();
  auto joints = std::make_unique<LiveJoints>(DepthJoints(std::move(*depth), std::move(*tracker), options.person));
  const LiveJoints* tracked = joints.get();
  return Joints{std::move(joints), tracked, tracked->source().name()};
}

Result<void> run(const Options& options, const CommonOptions& common) {
  if (Result<void> fine = checkJsonOutput(common, {options.character, options.body.decomposition}); !fine) return fine;
  if (Result<void> fine = checkSnapshots(options.pictures); !fine) return fine;
  if (Result<void> fine = checkRecord("--record", options.record); !fine) return fine;
  const Result<bool> inWindow = chooseWindow(options);
  if (!inWindow) return inWindow.error();
  const Result<Subject> subject = readCharacter(options.character, options.reading);
  if (!subject) return subject.error();
  if (Result<void> fine = checkCover(options.body.cover, *subject->character); !fine) return fine;
  const Result<DecompositionFile> body = chooseBody(options.body, *subject, common.threadCount());
  if (!body) return body.error();

  Result<World> world = openScene(options.scene);
  if (!world) return world.error();

  // The source is opened last: a live one runs on while others are made ready.
  Result<Joints> joints = openJoints(options);
  if (!joints) return joints.error();
  const RecordedAs as{joints->name,       false,        options.character, options.reading,
                      options.performing, options.body, options.scene};
  const Result<std::shared_ptr<SessionRecorder>> recorder =
      startRecorder(options.record, as, *subject->character, *body, *world);
  if (!recorder) return recorder.error();
  const SourceTreatment treatment{*recorder ? (*recorder)->log() : nullptr, options.performing.faults(),
                                  options.performing.joints()};
  Result<std::unique_ptr<PoseSource>> source =
      makeTreatedSource(*subject->character, std::move(joints->source), treatment);
  if (!source) return source.error();
  Result<Session> session = startSession(*subject->character, *body, std::move(*source), std::move(*world));
  if (!session) return session.error();
  session->watch(*recorder);

  Live live{std::move(*session), joints->tracked, joints->name, {}, {}, {}, {}};
  if (!*inWindow) fmt::print(stderr, "Following {}; Ctrl-C ends.\n", live.name);
  const Result<void> ran = *inWindow ? runInWindow(options, live) : runHeadless(options, live);
  if (!ran) {
    if (*recorder) (void)(*recorder)->finish();  // what was recorded stays, whatever ended it
    return ran;
  }
  Report report = toReport(options, live);
  nlohmann::ordered_json json = toJson(options, live, *body);
  if (Result<void> kept = finishRecorder(*recorder, options.record, report, json); !kept) return kept;
  return publish(common, report, json);
}

}  // namespace

Command addLive(CommandLine& parent, CommonOptions& common) {
  const auto options = std::make_shared<Options>();
  CommandLine* app = addSubcommand(
      parent, common, "live", "Follow whoever stands before a depth camera: the character moves as they do.",
      "  lorica live\n"
      "      the first OpenNI2 depth camera; a window where there is a display\n"
      "  lorica live --virtual\n"
      "      without a camera: a virtual one before a virtual person\n"
      "  lorica live --virtual --motion jumping_jacks --character hero.glb\n"
      "  lorica live --virtual --seconds 4 --snapshots pictures\n"
      "      pictures/frame_0000.png, ...; needs no display\n"
      "  lorica live --driver libfreenect-openni2/libFreenectDriver.so.0\n"
      "      a Kinect, by a driver of your own\n"
      "\nCtrl-C ends it, and a summary follows. Which camera needs which driver: docs/SENSORS.md.");
  addDepthOptions(*app, options->depth);
  Option* person =
      addCount(*app, "--person", options->person, 1, "Whom to follow, by the order of coming [default: the nearest]");
  app->addOption("--nite", options->nite, "Have NiTE 2 find the joints, where you have it: libNiTE2.so")
      ->typeName("FILE")
      ->excludes(person);
  app->addOption("--character", options->character,
                 "Who performs: .glb, .gltf, .vrm, .fbx, .dae or mannequin [default: mannequin]")
      ->typeName("FILE");
  addPlayingOptions(*app, options->performing);
  addCharacterOptions(*app, options->reading);
  addBodyOptions(*app, options->body);
  addSceneOption(*app, options->scene);
  addFaultOption(*app, options->performing);
  addRecordOption(*app, options->record);
  addCount(*app, "--frames", options->limit.frames, 1, "Stop after so many frames");
  addSeconds(*app, "--seconds", options->limit.seconds, "Stop after so many seconds");
  Option* window = app->addFlag("--window", options->window, "In a window, and an error where none can be had");
  addSnapshotOptions(*app, options->pictures, window);
  app->addFlag("--headless", options->headless, "No window, even where there is a display")->excludes(window);
  return {app, [options](const CommonOptions& given) { return run(*options, given); }};
}

}  // namespace lorica

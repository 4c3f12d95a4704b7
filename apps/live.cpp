#include "apps/abandoned_work.h"
#include "apps/body_choice.h"
#include "apps/cast.h"
#include "apps/depth_inputs.h"
#include "apps/depth_picture.h"
#include "apps/events_output.h"
#include "apps/inputs.h"
#include "apps/interrupt.h"
#include "apps/live_cast.h"
#include "apps/live_log.h"
#include "apps/load_in_window.h"
#include "apps/options.h"
#include "apps/playback.h"
#include "apps/pose_output.h"
#include "apps/run_session.h"
#include "apps/run_statistics.h"
#include "apps/scenes.h"
#include "apps/session_files.h"
#include "apps/standard_streams.h"
#include "apps/stream_motion.h"
#include "apps/target_hits.h"
#include "apps/vmc_input.h"
#include "capture/tracking/live_joints.h"
#include "geometry/files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lorica {
namespace {

using Options = LiveOptions;

/// The running session and its results.
struct Live {
  Session session;
  const LiveJoints* joints;  // owned by the session; null if NiTE 2 tracks or a program sends
  std::vector<VmcInput> vmc;
  std::string name;
  LiveLog log;
  RunStatistics statistics;
  DrawnFiles drawn;
  Image picture;  // of the depth image
  TargetHits hits;
};

/// Adds the session's last frame to the statistics. @return seconds since the first frame
double note(Live& live, double& firstTime) {
  if (live.session.frameCount() == 1) firstTime = live.session.time();
  const double seconds = live.session.time() - firstTime;
  if (live.joints != nullptr) live.log.add(*live.joints, seconds);
  for (VmcInput& sender : live.vmc) sender.add(live.session);
  live.statistics.add(live.session);
  live.hits.add(live.session);
  return seconds;
}

/// Runs one frame. @return false at the end
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
  LORICA_TRY(std::optional<SnapshotSeries> pictures, SnapshotSeries::create(options.pictures, live.session));
  double firstTime = 0.0;
  while (!interrupted()) {
    LORICA_TRY(const bool more, step(options, live, firstTime));
    if (pictures) {
      if (live.joints != nullptr && pictures->due(live.session))
        drawDepthPicture(live.joints->source().camera(), live.joints->sight(), live.picture);
      LORICA_TRY_DO(pictures->add(live.session, live.name, &live.picture));
    }
    if (!more) break;
  }
  answerInterrupt();
  if (!pictures) return {};
  LORICA_TRY(live.drawn, pictures->finish());
  return {};
}

Result<void> runInWindow(const Options& options, Window& window, const TreatmentControl& treatment, Live& live) {
  prepareWindow(live.name, live.session.character(), live.session.avatars().size(), window);
  WindowSubject subject{live.session, live.name};
  subject.scene = options.scene;
  subject.atEnd = WindowSubject::AtEnd::kReturn;
  subject.treatment = treatment;
  subject.sceneChosen = [&](const std::string& scene) { live.hits = TargetHits(targetsOf(scene)); };
  subject.hits = [&] { return live.hits.scores(); };
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
  if (!live.vmc.empty()) {
    subject.ready = [&] { return live.vmc.front().ready(live.session); };
    subject.trouble = [&] { return live.vmc.front().state(); };
  }
  const Result<WindowEnd> end = runInWindow(window, subject, options.limit);
  answerInterrupt();
  return end ? Result<void>() : end.error();
}

nlohmann::ordered_json toJson(const Options& options, const Live& live, const DecompositionFile& body) {
  nlohmann::ordered_json json;
  json["source"] = live.name;
  json["character"] = live.session.character().name;
  json["parts"] = body.decomposition.parts.size();
  json["avatars"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < live.session.avatars().size(); ++i) {
    const SessionAvatar& avatar = live.session.avatars()[i];
    json["avatars"].push_back({{"character", avatar.character().name},
                               {"person", i + 1},
                               {"frames", avatar.frameCount()},
                               {"contacts", live.statistics.contactsOf(i)},
                               {"hash", hexDigits(avatar.hash())}});
  }
  if (live.joints != nullptr) live.log.addTo(json);
  for (const VmcInput& sender : live.vmc) {
    nlohmann::ordered_json one;
    sender.addTo(one);
    if (&sender == &live.vmc.front()) json.update(one);
    json["streams"].push_back(one["stream"]);
  }
  live.statistics.addTo(json);
  const std::optional<double> delay = live.session.source().smoothingDelay();
  json["refusedLegs"] = live.session.source().refusedLegs();
  json["smoothingDelay"] = delay ? nlohmann::ordered_json(*delay) : nlohmann::ordered_json();
  live.drawn.addTo(options.pictures, json);
  json["hash"] = hexDigits(live.session.hash());
  return json;
}

Report toReport(const Options& options, const Live& live) {
  Report report(fmt::format("{} followed {}: {}", live.session.character().name, live.name,
                            counted(live.statistics.frames(), "frame")));
  if (live.joints != nullptr) live.log.addTo(report);
  for (const VmcInput& sender : live.vmc) sender.addTo(report);
  if (const std::optional<double> delay = live.session.source().smoothingDelay()) {
    report.line("smoothing", fmt::format("joints lag by another {:.0f} ms", 1e3 * *delay));
  }
  for (std::size_t i = 0; live.session.avatars().size() > 1 && i < live.session.avatars().size(); ++i) {
    const SessionAvatar& avatar = live.session.avatars()[i];
    report.line(fmt::format("avatar {}", i + 1),
                fmt::format("{} was there in {}: {}", avatar.character().name, counted(avatar.frameCount(), "frame"),
                            counted(live.statistics.contactsOf(i), "contact point")));
  }
  live.hits.addTo(report);
  live.statistics.addTrainingTo(report);
  report.line("contacts", fmt::format("{} with {}", counted(live.statistics.touches(), "touch", "touches"),
                                      counted(live.statistics.propsTouched(), "prop")));
  live.drawn.addTo(options.pictures, report);
  report.gap();
  report.line("frame time", "median");
  live.statistics.addTo(report);
  if (live.session.source().refusedLegs()) report.note(kRefusedLegs);
  return report;
}

/// Whether to open a window: if requested, or if a display is available and no other output was requested.
Result<bool> chooseWindow(const Options& options) {
  if (options.headless || options.pictures.any()) return false;
  LORICA_TRY_DO(checkWindow(options.window, "--headless, --snapshots DIR and --video FILE do not need one"));
  return displayAvailable();
}

Result<void> checkOptions(const Options& options, const CommonOptions& common) {
  std::vector<std::filesystem::path> inputs{options.body.decomposition};
  for (const std::string& name : namesIn(options.character)) inputs.emplace_back(name);
  LORICA_TRY_DO(checkJsonOutput(common, inputs));
  LORICA_TRY_DO(checkSnapshots(options.pictures));
  LORICA_TRY_DO(checkRecord("--record", options.record));
  LORICA_TRY_DO(checkPoseOutput(options.out));
  inputs.emplace_back(options.record);
  LORICA_TRY_DO(checkPeople(options));
  return checkEvents(options.events, common, inputs);
}

/// What a live session needs.
struct Loaded {
  World world;
  std::vector<Follower> followers;
  Performer performer;
};

/// @param drawn  whether pictures are drawn of the characters
Result<Loaded> load(const Options& options, bool drawn, int threads) {
  LORICA_TRY(World world, openSceneForPeople(options.scene));
  LORICA_TRY(std::vector<Follower> followers, readFollowers(options, drawn, threads));
  // The source is opened last, because it runs while the rest is prepared. A driver may take as long as it likes.
  LORICA_TRY(Performer performer,
             runOrAbandon<Performer>("Opening the camera", [options] { return openPerformer(options); }));
  return Loaded{std::move(world), std::move(followers), std::move(performer)};
}

/// @param window  null = none
Result<void> follow(const Options& options, const CommonOptions& common, Loaded loaded, Window* window) {
  auto& [world, followers, performer] = loaded;
  const bool sent = !performer.vmc.empty();
  LORICA_TRY(const std::shared_ptr<SessionRecorder> recorder, startRecorder(options, performer, followers, world));
  LORICA_TRY(Session session, startSession(options, performer, followers, recorder, std::move(world)));
  LORICA_TRY(std::shared_ptr<StepWatcher> watcher,
             makePoseOutput(options.out, followers.front().subject, options.reading.expressions, recorder));
  LORICA_TRY(const std::shared_ptr<EventsOutput> events, makeEventsOutput(options.events, watcher));
  session.watch(events ? events : watcher);

  Live live{std::move(session),
            performer.tracked,
            std::move(performer.vmc),
            performer.name,
            {},
            {},
            {},
            {},
            TargetHits(targetsOf(options.scene))};
  if (window == nullptr) {
    say(fmt::format("{} {}; press Ctrl-C to stop.\n", sent ? "Listening for" : "Tracking with", live.name));
  }
  TreatmentControl treatment = treatmentControl(options.performing, !sent);
  if (!sent) {
    treatment.sources = [&options, &loaded](const WindowTreatment& chosen) {
      return sourcesOf(options, loaded.performer, loaded.followers, chosen);
    };
  }
  if (!options.record.empty() || !options.events.empty() || options.out.any()) {
    treatment.fix("what is written or sent is as the command says");
  }
  const Result<void> ran =
      window != nullptr ? runInWindow(options, *window, treatment, live) : runHeadless(options, live);
  if (!ran) {
    if (recorder) (void)recorder->finish();  // keep what was recorded despite the error
    return ran;
  }
  Report report = toReport(options, live);
  nlohmann::ordered_json json = toJson(options, live, followers.front().body);
  LORICA_TRY_DO(finishEvents(events));
  LORICA_TRY_DO(finishRecorder(recorder, options.record, report, json));
  return publish(common, report, json, options.events == "-");
}

/// Opens the window first: it shows how the rest is loaded.
Result<void> followInWindow(const Options& options, const CommonOptions& common) {
  LORICA_TRY(Window window, openWindow());
  LORICA_TRY(std::optional<Loaded> loaded,
             loadInWindow<Loaded>(window, [&] { return load(options, true, common.threadCount()); }));
  return loaded ? follow(options, common, std::move(*loaded), &window) : Result<void>();
}

Result<void> run(const Options& options, const CommonOptions& common) {
  LORICA_TRY_DO(checkOptions(options, common));
  LORICA_TRY(const bool inWindow, chooseWindow(options));
  if (inWindow) return followInWindow(options, common);
  LORICA_TRY(Loaded loaded, load(options, options.pictures.any(), common.threadCount()));
  return follow(options, common, std::move(loaded), nullptr);
}

}  // namespace

Command addLive(CommandLine& parent, CommonOptions& common) {
  const auto options = std::make_shared<Options>();
  CommandLine* app = addSubcommand(
      parent, common, "live", "Follow a person before a depth camera: the character copies their motion.",
      "  lorica live\n"
      "      the first OpenNI2 depth camera; a window if there is a display\n"
      "  lorica live --virtual\n"
      "      no camera needed: a virtual camera with a virtual person\n"
      "  lorica live --virtual --motion jumping_jacks --character hero.glb\n"
      "  lorica live --virtual --seconds 4 --snapshots pictures\n"
      "      pictures/frame_0000.png, ...; needs no display\n"
      "  lorica live --driver libfreenect-openni2/libFreenectDriver.so.0\n"
      "      a Kinect with an additional driver\n"
      "  lorica live --people 2 --character hero.vrm,robot.glb\n"
      "      two people, in the order of coming, with an avatar each; they touch each other\n"
      "  lorica live --vmc 39539 --character hero.vrm\n"
      "      no camera: follow a program that sends the VMC protocol to this machine\n"
      "  lorica live --vmc 39539,39540 --character hero.vrm,robot.glb\n"
      "      two programs that send, with an avatar each\n"
      "  lorica live --vmc-out 192.168.0.7:39539\n"
      "      send the tracked pose to a program on another machine\n"
      "\nThe window opens first and shows how characters, scene and camera are loaded. Ctrl-C stops it and\n"
      "prints a summary. Drivers for each camera: docs/SENSORS.md.");
  addDepthOptions(*app, options->depth);
  Option* person = addCount(*app, "--person", options->person, 1,
                            "Person to follow, numbered by order of appearance [default: the nearest]");
  Option* people = addCount(*app, "--people", options->people, 1,
                            "People to follow at once, each with an avatar, at most 6 [default: 1]")
                       ->excludes(person);
  Option* nite = app->addOption("--nite", options->nite, "Track with NiTE 2, if you have it: libNiTE2.so")
                     ->typeName("FILE")
                     ->excludes(person)
                     ->excludes(people);
  addVmcInputOptions(*app, options->vmc)->excludes(person)->excludes(people)->excludes(nite);
  addSenderOption(*app, options->vmc.sender);
  addPoseOutputOptions(*app, options->out);
  addEventsOption(*app, options->events);
  app->addOption("--character", options->character,
                 "Character: .glb, .gltf, .vrm, .fbx, .dae or mannequin; with --people one for all or one for each, "
                 "separated by commas [default: mannequin]")
      ->typeName("FILE");
  addPlayingOptions(*app, options->performing);
  addCharacterOptions(*app, options->reading);
  addSpringOption(*app, options->springs);
  addBodyOptions(*app, options->body);
  addSceneOption(*app, options->scene);
  addFaultOption(*app, options->performing);
  addRecordOption(*app, options->record);
  addCount(*app, "--frames", options->limit.frames, 1, "Stop after N frames");
  addSeconds(*app, "--seconds", options->limit.seconds, "Stop after S seconds");
  Option* window = app->addFlag("--window", options->window, "Open a window; fail if there is no display");
  addSnapshotOptions(*app, options->pictures, window);
  addTextureOption(*app, options->reading.textureSize);
  app->addFlag("--headless", options->headless, "Do not open a window, even if there is a display")->excludes(window);
  return {app, [options, app](const CommonOptions& given) {
            options->performing.smoothGiven = smoothingGiven(*app);
            return run(*options, given);
          }};
}

}  // namespace lorica

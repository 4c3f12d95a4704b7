#include "apps/option_groups.h"
#include "apps/options.h"
#include "apps/report_parts.h"
#include "apps/show.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/text.h"
#include "session/prepare/live_cast.h"
#include "session/prepare/scenes.h"
#include "viewer/player/monitored_host.h"
#include "viewer/player/window_texts.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace lorica {
namespace {

Report liveReport(const Run& run, const DrawnFiles& drawn) {
  const Session& session = run.session;
  const RunStatistics& statistics = run.statistics;
  const bool nobody = run.tracked() && run.log.figures().followed == 0;
  Report report(
      fmt::format("{} followed {}: {}", session.character().name, nobody ? "nobody" : run.name(),
                  counted(statistics.frames(), "frame")),
      "source character parts avatars depthFrames framesWithPerson maxPeople unplugged firstPose tracking depthStream "
      "stream latency streams frames contacts touches propsTouched avatarTouches selfContacts training stages");
  report.add("source", run.name());
  report.add("character", session.character().name);
  report.add("parts", run.cast.avatars.front().body.decomposition.parts.size());
  if (run.tracked()) report.add(liveFacts(run.log));
  if (const DepthStream* sent = run.depthStream()) report.add(depthStreamFacts(*sent));
  Json streams;
  for (const VmcInput& stream : run.streams()) {
    const Facts facts = streamFacts(stream);
    report.add(streams.empty() ? facts : facts.textOnly());
    streams.push_back(facts.list().front().value);
  }
  if (!streams.empty()) report.add("streams", std::move(streams));
  report.add(smoothingFacts(session, "joints lag by another"));
  Json avatars = Json::array();
  for (std::size_t i = 0; i < session.avatars().size(); ++i) {
    const SessionAvatar& avatar = session.avatars()[i];
    const long long contacts = statistics.contactsOf(i);
    avatars.push_back({{"character", avatar.character().name},
                       {"person", i + 1},
                       {"frames", avatar.frameCount()},
                       {"contacts", contacts},
                       {"hash", hexDigits(avatar.hash())}});
    if (session.avatars().size() == 1) break;
    report.line(fmt::format("avatar {}", i + 1),
                fmt::format("{} was there in {}: {}", avatar.character().name, counted(avatar.frameCount(), "frame"),
                            counted(contacts, "contact point")));
  }
  report.add("avatars", std::move(avatars));
  report.add(hitFacts(run.hits).textOnly());
  report.add(trainingFacts(statistics));
  if (!session.world().props().empty()) {
    report.line("contacts", fmt::format("{} with {}", counted(statistics.touches(), "touch", "touches"),
                                        counted(statistics.propsTouched(), "prop")));
  }
  report.add(contactFacts(statistics));
  report.add(drawnFacts(drawn));
  report.add("hash", hexDigits(session.hash()));
  report.add(stageFacts(statistics));
  if (session.source().refusedLegs()) report.note(kRefusedLegs);
  return report;
}

/// Whether to open a window: if requested, or if a display is available and no other output was requested.
Result<bool> chooseWindow(const ShowOptions& options) {
  if (options.pictures.headless || options.pictures.any() || (options.serve.serve && !options.window)) return false;
  LORICA_TRY_DO(checkWindow(options.window, "--headless, --snapshots DIR and --video FILE do not need one"));
  return displayAvailable();
}

/// @param screen  null = none
/// @param opener  with a screen @param opened  gets what the user opened; then there is no report
Result<void> followCast(const ShowOptions& options, const CommonOptions& common, Host& host, LiveCast cast,
                        Screen* screen, WindowOpener* opener, Showing& opened) {
  LORICA_TRY(const std::unique_ptr<Run> run, Run::start(std::move(cast), options.run, host));
  if (screen == nullptr) {
    if (!options.pictures.headless && !options.pictures.any()) {
      host.tell("No display: --snapshots DIR makes pictures, --serve a page.");
    }
    host.tell(fmt::format("{} {}; press Ctrl-C to stop.", run->streams().empty() ? "Tracking with" : "Listening for",
                          run->name()));
  }
  LORICA_TRY(opened, show(*run, options.pictures, screen, opener, host));
  if (opened.next) return {};
  Report report = liveReport(*run, opened.drawn);
  return finishAndPublish(*run, common, report);
}

/// The camera or the programs that send stay when the user opens another character.
Result<void> followInTurn(ShowOptions options, const CommonOptions& common, Host& host, LiveCast cast, Screen& screen) {
  const auto load = [live = options.live, sources = cast.sources](const std::vector<CastRequest>& attempts,
                                                                  Host& loading) -> Result<Cast> {
    if (!attempts.front().motion.empty()) return prepareSettledCast(attempts, loading);
    LORICA_TRY(LiveCast again, prepareLiveCast(attempts.front(), live, loading, sources));
    return std::move(again.cast);
  };
  WindowOpener opener(options.request, host, options.run.written() ? kWrittenOnce : "", load);
  opener.recordInto(options.serve.setting.recordings);
  std::shared_ptr<LiveSources> sources = cast.sources;
  for (;;) {
    Showing opened;
    LORICA_TRY_DO(followCast(options, common, host, std::move(cast), &screen, &opener, opened));
    if (!opened.next) return {};
    if (opened.next->sources != sources) return playOpened(common, host, screen, opener, std::move(opened));
    cast = LiveCast{std::move(*opened.next), sources};
    options.run.record = opened.record;
  }
}

}  // namespace

Result<void> follow(const ShowOptions& given, const CommonOptions& common, Host& host) {
  if (given.webcam) {
    return invalidArgument(
        "--webcam: Lorica looks at depth images, which a webcam has not: let a program that follows you by webcam, "
        "such as VSeeFace, send VMC to 127.0.0.1, port 39539, and start `lorica live --vmc 39539`; docs/RECIPES.md has "
        "it step by step");
  }
  LORICA_TRY_DO(checkOutputs(given.run, given.pictures, common, given.request.files()));
  LORICA_TRY_DO(checkLive(given.live, host));
  LORICA_TRY(const bool inWindow, chooseWindow(given));
  if (given.live.threePoint && !given.serve.any()) {
    return invalidArgument("--three-point needs a headset: --vr, or --serve for one with a browser");
  }
  ShowOptions options = given;
  options.live.headset = given.serve.vr;
  if (!given.sceneGiven) options.request.scene = kEmptyStage;
  options.request.reading.drawn = inWindow || options.serve.any() || options.pictures.any();
  if (!inWindow && !options.serve.any()) {
    LORICA_TRY(LiveCast cast, prepareLiveCast(options.request, options.live, host));
    Showing none;
    return followCast(options, common, host, std::move(cast), nullptr, nullptr, none);
  }
  // The screen comes first: it shows how the rest is loaded.
  LORICA_TRY(const std::unique_ptr<Screens> screens, Screens::open(inWindow, options.serve, options.pictures, host));
  Screen& screen = screens->screen();
  LORICA_TRY(std::optional<LiveCast> cast,
             loadOnScreen<LiveCast>(screen, host, [request = options.request, live = options.live](Host& loading) {
               return prepareLiveCast(request, live, loading);
             }));
  if (cast) screens->announce(host);
  return cast ? followInTurn(options, common, host, std::move(*cast), screen) : Result<void>();
}

Command addLive(CLI::App& parent, CommonOptions& common) {
  const auto options = std::make_shared<ShowOptions>();
  CLI::App* app = addSubcommand(
      parent, common, "live",
      "Follow somebody live: the character copies who stands before a depth camera, or what a program sends (VMC).",
      "  lorica live\n"
      "      the first OpenNI2 depth camera; a window if there is a display\n"
      "  lorica live --virtual\n"
      "      to try it without a camera: a virtual one with a virtual person\n"
      "  lorica live --vmc 39539 --character hero.vrm\n"
      "      a webcam: follow a tracker that sends the VMC protocol to this machine (docs/RECIPES.md)\n"
      "  lorica live --serve --lan\n"
      "      on a phone or in a headset, too: the terminal shows a link and a code for cameras\n"
      "  lorica live --virtual --motion jumping_jacks --character hero.glb\n"
      "  lorica live --virtual --seconds 4 --snapshots pictures\n"
      "      pictures/frame_0000.png, ...; needs no display\n"
      "  lorica live --driver libfreenect-openni2/libFreenectDriver.so.0\n"
      "      a Kinect with an additional driver\n"
      "  lorica live --people 2 --character hero.vrm,robot.glb\n"
      "      two people, in the order of coming, with an avatar each; they touch each other\n"
      "  rs_sender.py | lorica live --depth -\n"
      "      any other camera: a program sends its depth images; docs/SENSORS.md has senders\n"
      "  lorica live --vmc 39539,39540 --character hero.vrm,robot.glb\n"
      "      two programs that send, with an avatar each\n"
      "  lorica live --vmc-out 192.168.0.7:39539\n"
      "      send the tracked pose to a program on another machine\n"
      "\nThe window opens first and shows how characters, scene and camera are loaded. Ctrl-C stops it and\n"
      "prints a summary. Drivers for each camera: docs/SENSORS.md.");
  addDepthOptions(*app, options->live.depth);
  app->add_flag("--webcam", options->webcam, "Says how: a program follows you by webcam, and sends VMC");
  CLI::Option* person = addCount(*app, "--person", options->live.person, 1,
                                 "Person to follow, numbered by order of appearance [default: the nearest]");
  CLI::Option* people = addCount(*app, "--people", options->live.people, 1,
                                 "People to follow at once, each with an avatar, at most 6 [default: 1]")
                            ->excludes(person);
  CLI::Option* lower = addWearerOptions(*app, options->live);
  CLI::Option* nite =
      addOption(*app, "--nite", options->live.nite, "FILE", "Track with NiTE 2, if you have it: libNiTE2.so")
          ->excludes(person)
          ->excludes(people)
          ->excludes(lower);
  addVmcInputOptions(*app, options->live.vmc)->excludes(person)->excludes(people)->excludes(nite)->excludes(lower);
  addSenderOption(*app, options->live.vmc.sender);
  addOutputOptions(*app, options->run);
  addOption(*app, "--character", options->request.character, "FILE",
            "Character: .glb, .gltf, .vrm, .fbx, .dae or mannequin; with --people one for all or one for each, "
            "separated by commas [default: mannequin]");
  addPlayingOptions(*app, options->request.performing);
  addCharacterOptions(*app, options->request.reading);
  addSpringOption(*app, options->request.springs);
  addBodyOptions(*app, options->request.body);
  addSceneOption(*app, options->request.scene, kEmptyStage)->each([options](const std::string&) {
    options->sceneGiven = true;
  });
  addFaultOption(*app, options->request.performing);
  addRecordOptions(*app, options->run);
  addSeconds(*app, "--seconds", options->run.seconds, "Stop after S seconds");
  CLI::Option* window = app->add_flag("--window", options->window, "Open a window; fail if there is no display");
  addServeOptions(*app, options->serve, true);
  addSnapshotOptions(*app, options->pictures, window);
  addTextureOption(*app, options->request.reading.textureSize);
  return {app, [options](const CommonOptions& given, Host& host) { return follow(*options, given, host); }};
}

}  // namespace lorica

#include "apps/body_choice.h"
#include "apps/cast.h"
#include "apps/events_output.h"
#include "apps/inputs.h"
#include "apps/load_in_window.h"
#include "apps/options.h"
#include "apps/playback.h"
#include "apps/playback_input.h"
#include "apps/pose_output.h"
#include "apps/run_session.h"
#include "apps/run_statistics.h"
#include "apps/scenes.h"
#include "apps/session_files.h"
#include "apps/target_hits.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "session/prop_overlaps.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

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

  [[nodiscard]] bool written() const { return !record.empty() || !events.empty() || out.any(); }
};

using Cast = std::vector<CastMember>;

/// Warns of avatars whose middle is in a static body, which they pass through. Call after the first frame.
void warnOfWalls(const Session& session) {
  for (std::size_t a = 0; a < session.avatars().size(); ++a) {
    const SessionAvatar& avatar = session.avatars()[a];
    const std::span<const Vec3> points = avatar.points();
    const Vec3 middle = std::accumulate(points.begin(), points.end(), Vec3(Vec3::Zero())) / std::ssize(points);
    const std::optional<std::size_t> around = findStaticAround(session.world().props(), middle);
    if (!avatar.present() || !around) continue;
    const Vec3 at = session.world().props()[*around].worldFromProp.translation();
    warn(fmt::format("avatar {} ({}) starts inside the fixed object at ({:.2f}, {:.2f}, {:.2f}) and passes through it",
                     a + 1, avatar.character().name, at.x(), at.y(), at.z()));
  }
}

/// What is counted while a session runs.
struct Counts {
  RunStatistics statistics;
  TargetHits hits;

  void add(const Session& session, const Options& options) {
    statistics.add(session, options.selfContacts);
    hits.add(session);
    if (statistics.frames() == 1) warnOfWalls(session);
  }
};

/// A window in which casts are played, one after the other.
struct PlayWindow {
  Window& window;
  WindowOpener& opener;
  std::optional<LoadedCast> next;  ///< the user opened it
};

Result<void> playWithWindow(const Options& options, const LoadedCast& loaded, Session& session, Counts& counts,
                            PlayWindow& play) {
  const Cast& cast = loaded.opened.avatars;
  std::vector<HitTarget> targets = loaded.opened.targets;
  prepareWindow(motionsOf(cast), session.character(), cast.size(), play.window);
  WindowSubject subject{session, motionsOf(cast)};
  subject.duration = secondsOf(cast);
  const bool tracked =
      std::any_of(cast.begin(), cast.end(), [](const CastMember& member) { return !member.motion().joints.empty(); });
  subject.treatment = treatmentControl(options.input.performing, tracked);
  subject.treatment.sources = [&](const WindowTreatment& treatment) { return sourcesOf(cast, treatment); };
  subject.sourcesAgain = [&] { return sourcesOf(cast, subject.treatment.first); };
  subject.scene = loaded.request.scene;
  subject.added = loaded.added;
  subject.opener = &play.opener;
  if (!options.record.empty() || !options.events.empty()) subject.atEnd = WindowSubject::AtEnd::kHold;
  if (options.written()) subject.treatment.fix("what is written or sent is as the command says");
  subject.stepped = [&] { counts.add(session, options); };
  subject.sceneChosen = [&](const std::string& scene) { targets = targetsOf(scene); };
  subject.hits = [&] { return counts.hits.scores(); };
  subject.restarted = [&] { counts = Counts{RunStatistics(), TargetHits(targets)}; };  // the report covers the last run
  LORICA_TRY(const WindowEnd end, runInWindow(play.window, subject, options.playing));
  play.next = std::move(subject.next);
  if (end == WindowEnd::kInterrupted) return cancelled();
  return {};
}

Result<DrawnFiles> playHeadless(const Options& options, const Cast& cast, Session& session, Counts& counts) {
  HeadlessRun all{"Playing", motionsOf(cast)};
  for (const CastMember& member : cast) {
    all.frames += member.motion().frameCount();
    all.expected = std::max(all.expected, member.motion().frameCount());
  }
  if (options.playing.frames > 0) all.frames = all.expected = std::min(all.frames, options.playing.frames);
  all.stepped = [&] { counts.add(session, options); };
  all.caption = [&] { return counts.hits.caption(); };
  return runHeadless(all, options.pictures, session);
}

nlohmann::ordered_json toJson(const Options& options, const Cast& cast, const Session& session, const Counts& counts,
                              const DrawnFiles& drawn) {
  const RunStatistics& statistics = counts.statistics;
  const Motion& motion = cast.front().motion();
  const DecompositionFile& file = cast.front().body;
  nlohmann::ordered_json json;
  json["recording"] = motion.name;
  json["format"] = motion.format;
  json["notes"] = motion.notes;
  json["character"] = session.character().name;
  json["parts"] = file.decomposition.parts.size();
  json["error"] = file.errorPerKeyframe.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(file.meanError);
  addCoverTo(json, file.cover);
  json["avatars"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < cast.size(); ++i) {
    const SessionAvatar& avatar = session.avatars()[i];
    nlohmann::ordered_json one;
    one["character"] = avatar.character().name;
    one["recording"] = cast[i].motion().name;
    one["notes"] = cast[i].motion().notes;
    one["parts"] = avatar.body().parts().size();
    one["frames"] = avatar.frameCount();
    one["contacts"] = statistics.contactsOf(i);
    one["selfContacts"] = statistics.selfContactsOf(i);
    one["hash"] = hexDigits(avatar.hash());
    json["avatars"].push_back(std::move(one));
  }
  statistics.addTo(json);
  counts.hits.addTo(json);
  const std::optional<double> delay = session.source().smoothingDelay();
  json["refusedLegs"] = session.source().refusedLegs();
  json["smoothingDelay"] = delay ? nlohmann::ordered_json(*delay) : nlohmann::ordered_json();
  drawn.addTo(options.pictures, json);
  json["hash"] = hexDigits(session.hash());
  return json;
}

std::string partsLine(const DecompositionFile& file) {
  std::string parts = std::to_string(file.decomposition.parts.size());
  if (file.errorPerKeyframe.empty()) return parts;
  return parts + fmt::format("; hulls have {} more volume than the body (mean over {})", percent(file.meanError),
                             counted(std::ssize(file.errorPerKeyframe), "training keyframe"));
}

Report toReport(const Options& options, const Cast& cast, const Session& session, const Counts& counts,
                const DrawnFiles& drawn) {
  const RunStatistics& statistics = counts.statistics;
  const bool one = cast.size() == 1;
  Report report(fmt::format("{} performed {}: {}", one ? session.character().name : counted(std::ssize(cast), "avatar"),
                            motionsOf(cast), counted(statistics.frames(), "frame")));
  if (one) {
    report.line("parts", partsLine(cast.front().body));
    addCoverTo(report, cast.front().body.cover);
  }
  for (std::size_t i = 0; !one && i < cast.size(); ++i) {
    const SessionAvatar& avatar = session.avatars()[i];
    report.line(fmt::format("avatar {}", i + 1),
                fmt::format("{} performs {}: {}, {}, hash {}", avatar.character().name, cast[i].motion().name,
                            counted(std::ssize(avatar.body().parts()), "part"),
                            counted(statistics.contactsOf(i), "contact point"), hexDigits(avatar.hash())));
  }
  statistics.addTrainingTo(report);
  if (const std::optional<double> delay = session.source().smoothingDelay()) {
    report.line("smoothing", fmt::format("joints lag by {:.0f} ms", 1e3 * *delay));
  }
  report.line("contacts",
              fmt::format("{} with {}; {} over all frames", counted(statistics.touches(), "touch", "touches"),
                          counted(statistics.propsTouched(), "prop"), counted(statistics.contacts(), "contact point")));
  if (!one) {
    report.line("among avatars",
                fmt::format("{} of two parts", counted(statistics.avatarTouches(), "touch", "touches")));
  }
  counts.hits.addTo(report);
  statistics.addSelfContactsTo(report);
  report.line("hash", hexDigits(session.hash()));
  drawn.addTo(options.pictures, report);
  report.gap();
  report.line("frame time", "median");
  statistics.addTo(report);
  for (const CastMember& member : cast) {
    for (const std::string& note : member.motion().notes) report.note(note);
  }
  const auto refused = [](const SessionAvatar& avatar) { return avatar.source().refusedLegs(); };
  if (std::any_of(session.avatars().begin(), session.avatars().end(), refused)) report.note(kRefusedLegs);
  return report;
}

/// Runs a session of the cast. Its report is that of the command, unless the user opened something else meanwhile.
/// @param window  null = none
Result<void> playCast(const Options& options, const CommonOptions& common, LoadedCast loaded, PlayWindow* window) {
  const Cast& cast = loaded.opened.avatars;
  LORICA_TRY(const std::shared_ptr<SessionRecorder> recorder,
             startRecorder(options.record, cast, options.body, options.scene, loaded.opened.world));
  LORICA_TRY(Session session, startSession(cast, recorder, std::move(loaded.opened.world)));

  Counts counts{RunStatistics(), TargetHits(loaded.opened.targets)};
  LORICA_TRY(std::shared_ptr<StepWatcher> watcher,
             makePoseOutput(options.out, cast.front().input.subject, options.input.reading.expressions, recorder));
  LORICA_TRY(const std::shared_ptr<EventsOutput> events, makeEventsOutput(options.events, watcher));
  session.watch(events ? events : watcher);
  DrawnFiles drawn;
  const auto play = [&]() -> Result<void> {
    if (window != nullptr) return playWithWindow(options, loaded, session, counts, *window);
    LORICA_TRY(drawn, playHeadless(options, cast, session, counts));
    return {};
  };
  if (Result<void> played = play(); !played) {
    if (recorder) (void)recorder->finish();  // keep what was recorded despite the error
    return played;
  }
  if (window != nullptr && window->next) return {};
  Report report = toReport(options, cast, session, counts, drawn);
  nlohmann::ordered_json json = toJson(options, cast, session, counts, drawn);
  LORICA_TRY_DO(finishEvents(events));
  LORICA_TRY_DO(finishRecorder(recorder, options.record, report, json));
  return publish(common, report, json, options.events == "-");
}

/// Until the user opens nothing else.
Result<void> playInTurn(const Options& options, const CommonOptions& common, PlayWindow play) {
  while (play.next) {
    LoadedCast cast = std::move(*std::exchange(play.next, std::nullopt));
    LORICA_TRY_DO(playCast(options, common, std::move(cast), &play));
  }
  return {};
}

/// Opens the window first: it shows how the rest is loaded.
Result<void> playInWindow(const Options& options, const CommonOptions& common, const CastRequest& request) {
  LORICA_TRY(Window window, openWindow());
  const int threads = common.threadCount();
  LORICA_TRY(std::optional<LoadedCast> loaded,
             loadInWindow<LoadedCast>(window, [&] { return loadCast({request}, threads); }));
  if (!loaded) return {};
  WindowOpener opener(*loaded, threads,
                      options.written() ? "what is written or sent is one session: nothing else can be opened" : "");
  return playInTurn(options, common, {window, opener, std::move(loaded)});
}

Result<void> run(const Options& options, const CommonOptions& common) {
  std::vector<std::filesystem::path> inputs = filesOf(options.input, options.body);
  LORICA_TRY_DO(checkJsonOutput(common, inputs));
  LORICA_TRY_DO(checkWindow(options.window, "--snapshots DIR and --video FILE do not need one"));
  LORICA_TRY_DO(checkSnapshots(options.pictures));
  LORICA_TRY_DO(checkRecord("--record", options.record));
  LORICA_TRY_DO(checkPoseOutput(options.out));
  inputs.emplace_back(options.record);
  LORICA_TRY_DO(checkEvents(options.events, common, inputs));
  CastRequest request{options.input, options.body, options.scene, {}};
  request.input.reading.drawn = options.window || options.pictures.any();
  if (options.window) return playInWindow(options, common, request);
  LORICA_TRY(OpenedCast opened, openCast(request.input, request.body, request.scene, common.threadCount()));
  return playCast(options, common, {std::move(request), std::move(opened), {}}, nullptr);
}

}  // namespace

Result<void> playOpened(const CommonOptions& common, Window& window, WindowOpener& opener, LoadedCast opened) {
  return playInTurn(Options(), common, {window, opener, std::move(opened)});
}

Command addPlay(CommandLine& parent, CommonOptions& common) {
  const auto options = std::make_shared<Options>();
  CommandLine* app = addSubcommand(
      parent, common, "play",
      "Play a motion: the character moves, its hulls follow, and objects around it collide with them.",
      "  lorica play walk\n"
      "      a shipped recording, without pictures: prints contacts and the time of each stage\n"
      "  lorica play walk --window\n"
      "      in a window, which also opens characters, motions, scenes and meshes that are dropped on it\n"
      "  lorica play walk --snapshots pictures --every 15\n"
      "      pictures/frame_0000.png, frame_0015.png, ...; needs no display\n"
      "  lorica play punch_and_kick --scene bowling --video kick.mp4\n"
      "      a video, without a display; `lorica snapshot --video` has more options\n"
      "  lorica play walk.bvh --character hero.glb --window\n"
      "      your own motion and character\n"
      "  lorica play hero.glb --clip Run\n"
      "      a character's own clip\n"
      "  lorica play punch_and_kick --scene bowling\n"
      "      in another scene: boxes, bowling, curtain, sand, targets, or your own scene file\n"
      "  lorica play --scene duel\n"
      "      a scene with avatars of its own, which perform unless a motion is given\n"
      "  lorica play walk --inject dropout=0.1,swap,seed=7\n"
      "      with simulated tracking faults: lost and swapped joints\n"
      "  lorica play walk,wave --character hero.glb,mannequin\n"
      "      two avatars side by side, each with its own motion\n"
      "  lorica play duel.oni --person all\n"
      "      an avatar for each person of a recording, where they stood\n"
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
  return {app, [options, app](const CommonOptions& given) {
            options->input.performing.smoothGiven = smoothingGiven(*app);
            return run(*options, given);
          }};
}

}  // namespace lorica

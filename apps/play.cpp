#include "apps/option_groups.h"
#include "apps/options.h"
#include "apps/report_parts.h"
#include "apps/show.h"
#include "collision/world/prop_overlaps.h"
#include "geometry/counts.h"
#include "geometry/files.h"
#include "geometry/text.h"
#include "viewer/player/monitored_host.h"
#include "viewer/player/window_texts.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

namespace lorica {
namespace {

/// Warns of avatars whose middle is in a static body, which they pass through.
void warnOfWalls(Run& run, Host& host) {
  const std::span<const SessionAvatar> avatars = run.session.avatars();
  for (std::size_t a = 0; a < avatars.size(); ++a) {
    const std::span<const Vec3> points = avatars[a].points();
    const Vec3 middle = std::accumulate(points.begin(), points.end(), Vec3(Vec3::Zero())) / std::ssize(points);
    const std::span<const Prop> props = run.session.world().props();
    const std::optional<std::size_t> around = findStaticAround(props, middle);
    if (!avatars[a].present() || !around) continue;
    const Vec3 at = props[*around].worldFromProp.translation();
    host.warn(
        fmt::format("avatar {} ({}) starts inside the fixed object at ({:.2f}, {:.2f}, {:.2f}) and passes through it",
                    a + 1, avatars[a].character().name, at.x(), at.y(), at.z()));
  }
}

std::string partsLine(const DecompositionFile& file) {
  std::string parts = std::to_string(file.decomposition.parts.size());
  if (file.errorPerKeyframe.empty()) return parts;
  return parts + fmt::format("; hulls have {} more volume than the body (mean over {})", percent(file.meanError),
                             counted(countOf(file.errorPerKeyframe), "training keyframe"));
}

Report playReport(const Run& run, const DrawnFiles& drawn) {
  const Session& session = run.session;
  const RunStatistics& statistics = run.statistics;
  const std::vector<PreparedAvatar>& avatars = run.cast.avatars;
  const Motion& motion = *avatars.front().motion;
  const DecompositionFile& file = avatars.front().body;
  const bool one = avatars.size() == 1;
  Report report(
      fmt::format("{} performed {}: {}", whoOf(run), run.name(), counted(statistics.frames(), "frame")),
      "recording format firstGuess notes character parts error cover avatars frames contacts touches propsTouched "
      "avatarTouches selfContacts training stages targets refusedLegs smoothingDelay snapshots video videoFrames hash");
  report.add("recording", motion.name);
  report.add("format", motion.format);
  report.add("firstGuess", motion.firstGuess);
  report.add("notes", motion.notes);
  report.add("character", session.character().name);
  report.add("parts", "parts", file.decomposition.parts.size(), one ? partsLine(file) : "");
  report.add("error", file.errorPerKeyframe.empty() ? Json() : Json(file.meanError));
  report.add(one ? coverFacts(file.cover) : coverFacts(file.cover).jsonOnly());
  Json all = Json::array();
  for (std::size_t i = 0; i < avatars.size(); ++i) {
    const SessionAvatar& avatar = session.avatars()[i];
    const std::string name = nameOf(run, i), hash = hexDigits(avatar.hash());
    const long long contacts = statistics.contactsOf(i);
    all.push_back({{"character", name},
                   {"recording", avatars[i].source},
                   {"firstGuess", avatars[i].motion->firstGuess},
                   {"notes", avatars[i].motion->notes},
                   {"parts", avatar.body().parts().size()},
                   {"frames", avatar.frameCount()},
                   {"contacts", contacts},
                   {"selfContacts", selfContactsOf(statistics, i)},
                   {"hash", hash}});
    if (one) break;
    report.line(fmt::format("avatar {}", i + 1),
                fmt::format("{} performs {}: {}, {}, hash {}", name, avatars[i].source,
                            counted(countOf(avatar.body().parts()), "part"), counted(contacts, "contact point"), hash));
  }
  report.add("avatars", std::move(all));
  for (std::size_t i = 0; i < avatars.size(); ++i) {
    const std::string& guess = avatars[i].motion->firstGuess;
    if (i == 0 || guess != avatars[i - 1].motion->firstGuess) report.line("first guess", guess);
  }
  report.add(trainingFacts(statistics));
  report.add(smoothingFacts(session, "joints lag by"));
  report.line("contacts",
              fmt::format("{} with {}; {} over all frames", counted(statistics.touches(), "touch", "touches"),
                          counted(statistics.propsTouched(), "prop"), counted(statistics.contacts(), "contact point")));
  if (!one) {
    report.line("among avatars",
                fmt::format("{} of two parts", counted(statistics.avatarTouches(), "touch", "touches")));
  }
  report.add(hitFacts(run.hits));
  report.add(contactFacts(statistics));
  report.add("hash", "hash", hexDigits(session.hash()));
  report.add(drawnFacts(drawn));
  report.add(stageFacts(statistics));
  for (const PreparedAvatar& avatar : avatars) {
    for (const std::string& note : avatar.motion->notes) report.note(note);
  }
  const auto refused = [](const SessionAvatar& avatar) { return avatar.source().refusedLegs(); };
  if (std::any_of(session.avatars().begin(), session.avatars().end(), refused)) report.note(kRefusedLegs);
  return report;
}

/// Runs a session of the cast. Its report is that of the command, unless the user opens something else meanwhile.
/// @return with what the user opened
Result<Showing> playCast(const ShowOptions& options, const CommonOptions& common, Host& host, Cast cast, Screen* screen,
                         WindowOpener* opener) {
  RunSetting setting = options.run;
  if (!setting.record.empty() || !setting.events.empty()) setting.atEnd = AtEnd::kHold;
  if (setting.frames > 0 && !options.window) setting.atEnd = AtEnd::kReturn;
  int frames = 0, expected = 0;
  for (const PreparedAvatar& avatar : cast.avatars) {
    frames += avatar.motion->frameCount();
    expected = std::max(expected, avatar.motion->frameCount());
  }
  if (screen == nullptr && setting.frames == 0) setting.frames = frames;
  setting.expected = std::min(expected, setting.frames);
  LORICA_TRY(const std::unique_ptr<Run> run, Run::start(std::move(cast), setting, host));
  run->first = warnOfWalls;
  LORICA_TRY(Showing showing, show(*run, options.pictures, screen, opener, host));
  if (showing.next) return showing;
  if (showing.end == RunEnd::kInterrupted) return cancelled();
  Report report = playReport(*run, showing.drawn);
  LORICA_TRY_DO(finishAndPublish(*run, common, report));
  return showing;
}

/// Until the user opens nothing else.
Result<void> playInTurn(ShowOptions options, const CommonOptions& common, Host& host, Showing opened, Screen& screen,
                        WindowOpener& opener) {
  while (opened.next) {
    options.run.record = opened.record;
    LORICA_TRY(opened, playCast(options, common, host, std::move(*opened.next), &screen, &opener));
  }
  return {};
}

/// Opens the screen first: it shows how the rest is loaded.
Result<void> playOnScreen(const ShowOptions& options, const CommonOptions& common, Host& host) {
  LORICA_TRY(const std::unique_ptr<Screens> screens,
             Screens::open(options.window, options.serve, options.pictures, host));
  Screen& screen = screens->screen();
  LORICA_TRY(std::optional<Cast> cast, loadOnScreen<Cast>(screen, host, [request = options.request](Host& loading) {
               return prepareSettledCast({request}, loading);
             }));
  if (!cast) return {};
  screens->announce(host);
  WindowOpener opener(*cast, host, options.run.written() ? kWrittenOnce : "");
  opener.recordInto(options.serve.setting.recordings);
  Showing first;
  first.next = std::move(cast);
  first.record = options.run.record;
  return playInTurn(options, common, host, std::move(first), screen, opener);
}

}  // namespace

Result<void> play(const ShowOptions& given, const CommonOptions& common, Host& host) {
  LORICA_TRY_DO(checkOutputs(given.run, given.pictures, common, given.request.files()));
  LORICA_TRY_DO(checkWindow(given.window, "--snapshots DIR and --video FILE do not need one"));
  ShowOptions options = given;
  const bool screen = options.window || options.serve.any();
  options.request.reading.drawn = screen || options.pictures.any();
  if (screen) return playOnScreen(options, common, host);
  LORICA_TRY(Cast cast, prepareCast(options.request, host));
  LORICA_TRY_DO(playCast(options, common, host, std::move(cast), nullptr, nullptr));
  return {};
}

Result<void> playOpened(const CommonOptions& common, Host& host, Screen& screen, WindowOpener& opener, Showing opened) {
  return playInTurn(ShowOptions(), common, host, std::move(opened), screen, opener);
}

Command addPlay(CLI::App& parent, CommonOptions& common) {
  const auto options = std::make_shared<ShowOptions>();
  CLI::App* app = addSubcommand(
      parent, common, "play",
      "Play a recorded motion: a character performs it, and what stands around collides with its hulls.",
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
      "\nWithout --decomposition: 16 parts from 12 keyframes, computed on the first run and then cached, as are the\n"
      "body of a character whose surface is open, and the hull covers of --cover and --hull-vertices. Keyframes come\n"
      "from the character's own clips and, of a humanoid, from the shipped recordings.");
  addMotionOptions(*app, options->request);
  addBodyOptions(*app, options->request.body);
  addSceneOption(*app, options->request.scene);
  addFaultOption(*app, options->request.performing);
  addOutputOptions(*app, options->run);
  addRecordOptions(*app, options->run);
  app->add_flag("--as-fast-as-possible", options->run.hurry,
                "Do not play in real time in a window; without a window this is always so");
  app->add_flag("--self-contacts", options->run.selfContacts,
                "Report overlapping parts of the body that are not neighbours");
  CLI::Option* window =
      app->add_flag("--window", options->window, "Open a window and play in real time; fail if there is no display");
  addServeOptions(*app, options->serve, true);
  addSnapshotOptions(*app, options->pictures, window);
  addTextureOption(*app, options->request.reading.textureSize);
  return {app, [options](const CommonOptions& given, Host& host) { return play(*options, given, host); }};
}

}  // namespace lorica

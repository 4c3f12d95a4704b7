#include "apps/option_groups.h"
#include "apps/options.h"
#include "apps/report_parts.h"
#include "apps/show.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/text.h"
#include "session/prepare/demo_motion.h"
#include "viewer/player/demo_pictures.h"
#include "viewer/player/monitored_host.h"
#include "viewer/player/window_texts.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

namespace lorica {
namespace {

constexpr double kVideoSeconds = 8.0;
constexpr const char* kUsualCharacter = "mannequin";

struct DemoOptions : ShowOptions {
  std::string out = "lorica-demo";
  bool headless = false;
  double seconds = 0.0;  // 0 = not given
};

/// The demo that was played.
struct Show {
  std::unique_ptr<Run> run;
  std::optional<bool> fromCache;
  double decomposing = 0.0;  // [s]
  std::optional<DemoFiles> files = {};

  [[nodiscard]] const DecompositionFile& body() const { return run->cast.avatars.front().body; }
};

Result<Show> startDemo(DemoCast demo, const RunSetting& setting, Host& host) {
  LORICA_TRY(std::unique_ptr<Run> run, Run::start(std::move(demo.cast), setting, host));
  return Show{std::move(run), demo.fromCache, demo.seconds};
}

/// Plays once and draws every frame if a renderer is available.
Result<Show> playForFiles(const DemoOptions& options, Host& host) {
  LORICA_TRY(DemoCast demo, prepareDemo(options.request.character, options.request.scene, host));
  const Motion& motion = *demo.cast.avatars.front().motion;
  const double rate = (motion.frameCount() - 1) / std::max(motion.seconds(), 1e-6);
  Result<DemoPictures> pictures = DemoPictures::create(options.out, rate, host);
  // Without a renderer everything except the pictures still works. The error names the missing package.
  if (!pictures && pictures.error().code != ErrorCode::kNoDisplay) return pictures.error();
  if (!pictures) host.warn(pictures.error().message + "; running the demo without pictures");
  RunSetting setting;
  setting.doing = pictures ? "Drawing the demo:" : "Running the demo:";
  setting.frames = motion.framesIn(options.seconds > 0.0 ? options.seconds : kVideoSeconds);
  LORICA_TRY(Show show, startDemo(std::move(demo), setting, host));
  Run& run = *show.run;
  Shown shown;
  if (pictures) {
    shown.picture = [&]() -> Result<bool> {
      const std::string caption = captionOf(run.name(), run.session, run.seconds());
      LORICA_TRY_DO(pictures->add(run.session, caption, run.seconds(), run.session.frameCount() - 1, setting.frames));
      return true;
    };
  }
  LORICA_TRY(const RunEnd end, play(run, shown, host));
  if (end == RunEnd::kInterrupted) return cancelled();
  if (pictures) {
    LORICA_TRY(show.files, pictures->finish());
  }
  return show;
}

Report demoReport(const Show& show) {
  const DecompositionFile& body = show.body();
  const std::string& character = show.run->session.character().name;
  const RunStatistics& statistics = show.run->statistics;
  Report report(fmt::format("The {} performed {}: {:.1f} s, {}", character, show.run->name(), show.run->seconds(),
                            counted(statistics.frames(), "frame")));
  report.add("recording", show.run->name());
  report.add("character", character);
  report.add("seconds", show.run->seconds());
  const std::string origin = !show.fromCache   ? ""
                             : *show.fromCache ? ", from the cache"
                                               : fmt::format(", computed in {:.1f} s and cached", show.decomposing);
  report.add("parts", "body", body.decomposition.parts.size(),
             fmt::format("{} trained on {}{}", counted(std::ssize(body.decomposition.parts), "convex part"),
                         counted(std::ssize(body.errorPerKeyframe), "keyframe"), origin));
  report.add("error", "error", body.meanError,
             fmt::format("the hulls have {} more volume than the body", percent(body.meanError)));
  report.add("keyframes", body.errorPerKeyframe.size());
  report.add("fromCache", orNull(show.fromCache));
  report.add("decompositionSeconds", show.decomposing);
  report.add(contactFacts(statistics));
  report.add(trainingFacts(statistics));
  report.line("contacts",
              fmt::format("{} with {} of {} boxes and balls", counted(statistics.touches(), "touch", "touches"),
                          statistics.propsTouched(), statistics.propCount()));
  report.add(stageFacts(statistics, "  median"));
  report.add("hash", hexDigits(show.run->session.hash()));
  const DemoFiles files = show.files.value_or(DemoFiles());
  const std::string video = files.video ? files.video->string() : "", sheet = files.contactSheet.string();
  Json snapshots = Json::array();
  for (const std::filesystem::path& file : files.snapshots) snapshots.push_back(file.string());
  if (show.files) report.gap();
  report.add("renderer", orNull(files.renderer));
  report.add("video", "video", orNull(video));
  report.add("snapshots", "pictures", std::move(snapshots),
             show.files
                 ? fmt::format("{}, its counterpart hulls_1.png, ... ({} in total)",
                               (files.contactSheet.parent_path() / "snapshot_1.png").string(), files.snapshots.size())
                 : "");
  report.add("contactSheet", "contact sheet", orNull(sheet));
  for (const std::string& note : show.run->cast.avatars.front().motion->notes) report.note(note);
  return report;
}

/// The window, if it was requested or a display is available, the page, or both; null if the demo is drawn to files.
Result<std::unique_ptr<Screens>> chooseScreens(const DemoOptions& options, Host& host) {
  const bool inWindow = options.window || (!options.headless && !options.serve.any() && displayAvailable());
  if (!inWindow && !options.serve.any()) {
    if (!options.headless)
      host.tell(fmt::format("No display: drawing a video and pictures to {} instead.", options.out));
    return std::unique_ptr<Screens>();
  }
  Result<std::unique_ptr<Screens>> screens = Screens::open(inWindow, options.serve, options.pictures, host);
  if (screens || options.window || options.serve.any()) return screens;
  host.warn(fmt::format("{}; drawing the demo to {} instead", screens.error().message, options.out));
  return std::unique_ptr<Screens>();
}

Result<void> runDemo(const DemoOptions& options, const CommonOptions& common, Host& host) {
  // Fail early.
  LORICA_TRY_DO(checkJsonOutput(common, {}));
  LORICA_TRY_DO(checkWindow(options.window, "`lorica demo --headless` draws a video instead"));
  if (!options.serve.any() && (options.headless || !displayAvailable())) {
    LORICA_TRY_DO(checkOutputFolder(common, "--out", options.out, isOfDemo));
  }
  LORICA_TRY(const std::unique_ptr<Screens> screens, chooseScreens(options, host));
  if (screens == nullptr) {
    LORICA_TRY(const Show show, playForFiles(options, host));
    return publish(common, demoReport(show));
  }
  Screen& screen = screens->screen();
  LORICA_TRY(std::optional<DemoCast> demo, loadOnScreen<DemoCast>(screen, host, [&](Host& loading) {
               return prepareDemo(options.request.character, options.request.scene, loading);
             }));
  if (!demo) return {};
  screens->announce(host);
  CastRequest present;
  present.motion = kDemoCharacterMotion;
  present.reading.drawn = true;
  WindowOpener opener(std::move(present), host, options.run.written() ? kWrittenOnce : "");
  opener.recordInto(options.serve.setting.recordings);
  RunSetting setting = options.run;
  setting.sumUp = true;
  setting.allLayers = true;
  setting.repeated = options.seconds;
  if (options.seconds > 0.0) setting.atEnd = AtEnd::kRepeat;
  if (setting.frames > 0) setting.atEnd = AtEnd::kReturn;
  LORICA_TRY(Show show, startDemo(std::move(*demo), setting, host));
  LORICA_TRY(Showing opened, lorica::show(*show.run, options.pictures, &screen, &opener, host));
  if (opened.end == RunEnd::kInterrupted) return cancelled();
  if (opened.next) return playOpened(common, host, screen, opener, std::move(opened));
  Report report = demoReport(show);
  return finishAndPublish(*show.run, common, report);
}

}  // namespace

Result<void> showDemo(const ShowOptions& options, const CommonOptions& common, Host& host) {
  DemoOptions demo{options};
  if (demo.request.character.empty()) demo.request.character = kUsualCharacter;
  LORICA_TRY_DO(checkOutputs(demo.run, demo.pictures, common, {}));
  return runDemo(demo, common, host);
}

Command addDemo(CLI::App& parent, CommonOptions& common) {
  const auto options = std::make_shared<DemoOptions>();
  options->request.character = kUsualCharacter;
  CLI::App* app = addSubcommand(
      parent, common, "demo", "Show a character kicking and walking among boxes and balls.",
      "  lorica demo\n"
      "      a window if there is a display, which opens what is dropped on it; else a video in lorica-demo/\n"
      "  lorica demo hero.glb\n"
      "      your own character does the same\n"
      "  lorica demo --scene pool\n"
      "      who stands in water kicks floating boxes and balls\n"
      "  lorica demo --headless --out /tmp/pictures\n"
      "      a video (8 s), snapshots and a contact sheet\n"
      "  lorica demo --headless --seconds 2 --json -\n"
      "      a short demo, with its figures as JSON\n"
      "\nThe body has 16 convex parts, trained on 12 keyframes. It is computed on the first run, with progress and\n"
      "Cancel in the window, and cached in $XDG_CACHE_HOME/lorica or ~/.cache/lorica.");
  app->add_option(
      "CHARACTER", options->request.character,
      "A character: a humanoid does all of it, another performs a clip of its own or stands [default: mannequin]");
  addSceneOption(*app, options->request.scene);
  addOption(*app, "--out", options->out, "DIR", "Folder for the video and the pictures [default: lorica-demo]");
  CLI::Option* window = app->add_flag("--window", options->window,
                                      "Open a window and repeat until it is closed; fail if there is no display");
  app->add_flag("--headless", options->headless, "Do not open a window, even if there is a display")->excludes(window);
  addServeOptions(*app, options->serve, true);
  addLookOptions(*app, options->pictures);
  addSeconds(*app, "--seconds", options->seconds,
             "Stop after S seconds [default: 8 for a video, no limit in a window]");
  return {app, [options](const CommonOptions& given, Host& host) { return runDemo(*options, given, host); }};
}

}  // namespace lorica

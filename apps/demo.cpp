#include "apps/option_groups.h"
#include "apps/options.h"
#include "apps/report_parts.h"
#include "apps/show.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/text.h"
#include "player/demo_pictures.h"
#include "player/monitored_host.h"
#include "player/window_texts.h"
#include "prepare/demo_motion.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

namespace lorica {
namespace {

constexpr double kVideoSeconds = 8.0;

struct Options {
  std::string character = "mannequin";
  std::string scene, out = "lorica-demo";
  bool window = false, headless = false;
  double seconds = 0.0;           // 0 = not given
  RunSetting run = {};            // of the page
  SnapshotOptions pictures = {};  // of the window
  ServeOptions serve = {};
};

/// The demo that was played.
struct Show {
  std::unique_ptr<Run> run;
  std::optional<bool> fromCache;
  double decomposing = 0.0;  // [s]
  std::optional<DemoFiles> files = {};

  [[nodiscard]] const DecompositionFile& body() const { return run->cast.avatars.front().body; }
};

Result<Show> start(DemoCast demo, const RunSetting& setting, Host& host) {
  LORICA_TRY(std::unique_ptr<Run> run, Run::start(std::move(demo.cast), setting, host));
  return Show{std::move(run), demo.fromCache, demo.seconds};
}

/// Plays once and draws every frame if a renderer is available.
Result<Show> playForFiles(const Options& options, Host& host) {
  LORICA_TRY(DemoCast demo, prepareDemo(options.character, options.scene, host));
  const Motion& motion = *demo.cast.avatars.front().motion;
  const double rate = (motion.frameCount() - 1) / std::max(motion.seconds(), 1e-6);
  Result<DemoPictures> pictures = DemoPictures::create(options.out, rate, host);
  // Without a renderer everything except the pictures still works. The error names the missing package.
  if (!pictures && pictures.error().code != ErrorCode::kNoDisplay) return pictures.error();
  if (!pictures) host.warn(pictures.error().message + "; running the demo without pictures");
  RunSetting setting;
  setting.doing = pictures ? "Drawing the demo:" : "Running the demo:";
  setting.frames = motion.framesIn(options.seconds > 0.0 ? options.seconds : kVideoSeconds);
  LORICA_TRY(Show show, start(std::move(demo), setting, host));
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

nlohmann::ordered_json toJson(const Show& show) {
  nlohmann::ordered_json json;
  json["recording"] = show.run->name();
  json["character"] = show.run->session.character().name;
  json["seconds"] = show.run->seconds();
  json["parts"] = show.body().decomposition.parts.size();
  json["error"] = show.body().meanError;
  json["keyframes"] = show.body().errorPerKeyframe.size();
  json["fromCache"] = show.fromCache ? nlohmann::ordered_json(*show.fromCache) : nullptr;
  json["decompositionSeconds"] = show.decomposing;
  addStatisticsTo(json, show.run->statistics);
  json["hash"] = hexDigits(show.run->session.hash());
  json["renderer"] = show.files ? nlohmann::ordered_json(show.files->renderer) : nlohmann::ordered_json();
  json["video"] =
      show.files && show.files->video ? nlohmann::ordered_json(show.files->video->string()) : nlohmann::ordered_json();
  json["snapshots"] = nlohmann::ordered_json::array();
  if (show.files) {
    for (const std::filesystem::path& file : show.files->snapshots) json["snapshots"].push_back(file.string());
  }
  json["contactSheet"] =
      show.files ? nlohmann::ordered_json(show.files->contactSheet.string()) : nlohmann::ordered_json();
  return json;
}

Report toReport(const Show& show) {
  const DecompositionFile& body = show.body();
  Report report(fmt::format("The {} performed {}: {:.1f} s, {}", show.run->session.character().name, show.run->name(),
                            show.run->seconds(), counted(show.run->statistics.frames(), "frame")));
  const std::string origin = !show.fromCache   ? ""
                             : *show.fromCache ? ", from the cache"
                                               : fmt::format(", computed in {:.1f} s and cached", show.decomposing);
  report.line("body", fmt::format("{} trained on {}{}", counted(std::ssize(body.decomposition.parts), "convex part"),
                                  counted(std::ssize(body.errorPerKeyframe), "keyframe"), origin));
  report.line("error", fmt::format("the hulls have {} more volume than the body", percent(body.meanError)));
  addTrainingTo(report, show.run->statistics);
  report.line("contacts", fmt::format("{} with {} of {} boxes and balls",
                                      counted(show.run->statistics.touches(), "touch", "touches"),
                                      show.run->statistics.propsTouched(), show.run->statistics.propCount()));
  report.gap();
  report.line("frame time", "  median");
  addStatisticsTo(report, show.run->statistics);
  if (show.files) {
    report.gap();
    if (show.files->video) report.line("video", show.files->video->string());
    const std::filesystem::path folder = show.files->contactSheet.parent_path();
    report.line("pictures", fmt::format("{}, its counterpart hulls_1.png, ... ({} in total)",
                                        (folder / "snapshot_1.png").string(), show.files->snapshots.size()));
    report.line("contact sheet", show.files->contactSheet.string());
  }
  for (const std::string& note : show.run->cast.avatars.front().motion->notes) report.note(note);
  return report;
}

/// The window, if it was requested or a display is available, the page, or both; null if the demo is drawn to files.
Result<std::unique_ptr<Screens>> chooseScreens(const Options& options, Host& host) {
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

Result<void> run(const Options& options, const CommonOptions& common, Host& host) {
  // Fail early.
  LORICA_TRY_DO(checkJsonOutput(common, {}));
  LORICA_TRY_DO(checkWindow(options.window, "`lorica demo --headless` draws a video instead"));
  if (!options.serve.any() && (options.headless || !displayAvailable())) {
    LORICA_TRY_DO(checkOutputFolder(common, "--out", options.out, isOfDemo));
  }
  LORICA_TRY(const std::unique_ptr<Screens> screens, chooseScreens(options, host));
  if (screens == nullptr) {
    LORICA_TRY(const Show show, playForFiles(options, host));
    return publish(common, toReport(show), toJson(show));
  }
  Screen& screen = screens->screen();
  LORICA_TRY(std::optional<DemoCast> demo, loadOnScreen<DemoCast>(screen, host, [&](Host& loading) {
               return prepareDemo(options.character, options.scene, loading);
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
  LORICA_TRY(Show show, start(std::move(*demo), setting, host));
  LORICA_TRY(Showing opened, lorica::show(*show.run, options.pictures, &screen, &opener, host));
  if (opened.end == RunEnd::kInterrupted) return cancelled();
  if (opened.next) return playOpened(common, host, screen, opener, std::move(opened));
  Report report = toReport(show);
  nlohmann::ordered_json json = toJson(show);
  return finishAndPublish(*show.run, common, report, json);
}

}  // namespace

Result<void> showDemo(const ShowOptions& options, const CommonOptions& common, Host& host) {
  Options demo;
  if (!options.request.character.empty()) demo.character = options.request.character;
  demo.window = options.window;
  demo.serve = options.serve;
  demo.pictures = options.pictures;
  demo.run = options.run;
  LORICA_TRY_DO(checkOutputs(demo.run, demo.pictures, common, {}));
  return run(demo, common, host);
}

Command addDemo(CommandLine& parent, CommonOptions& common) {
  const auto options = std::make_shared<Options>();
  CommandLine* app = addSubcommand(
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
  app->addOption(
      "CHARACTER", options->character,
      "A character: a humanoid does all of it, another performs a clip of its own or stands [default: mannequin]");
  addSceneOption(*app, options->scene);
  app->addOption("--out", options->out, "Folder for the video and the pictures [default: lorica-demo]", "DIR");
  Option* window = app->addFlag("--window", options->window,
                                "Open a window and repeat until it is closed; fail if there is no display");
  app->addFlag("--headless", options->headless, "Do not open a window, even if there is a display")->excludes(window);
  addServeOptions(*app, options->serve, true);
  addLookOptions(*app, options->pictures);
  addSeconds(*app, "--seconds", options->seconds,
             "Stop after S seconds [default: 8 for a video, no limit in a window]");
  return {app, [options](const CommonOptions& given, Host& host) { return run(*options, given, host); }};
}

}  // namespace lorica

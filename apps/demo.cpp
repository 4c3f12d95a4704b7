#include "apps/body_choice.h"
#include "apps/demo_pictures.h"
#include "apps/inputs.h"
#include "apps/interrupt.h"
#include "apps/load_in_window.h"
#include "apps/options.h"
#include "apps/performance.h"
#include "apps/play_opened.h"
#include "apps/playback.h"
#include "apps/progress_bar.h"
#include "apps/run_session.h"
#include "apps/run_statistics.h"
#include "apps/standard_streams.h"
#include "geometry/errors.h"
#include "geometry/files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <optional>

namespace lorica {
namespace {

constexpr double kVideoSeconds = 8.0;
constexpr const char* kOwnMotion = "punch_and_kick";  // of a character that is dropped on the window

struct Options {
  std::string out = "lorica-demo";
  bool window = false;
  bool headless = false;
  double seconds = 0.0;  // 0 = not given
};

/// The content of the demo and its results.
struct Show {
  Character character;
  Motion performance;
  CachedDecomposition body;
  RunStatistics statistics;
  double seconds = 0.0;  // played
  std::uint64_t hash = 0;
  std::optional<DemoFiles> files;
};

Result<Show> loadShow(int threads) {
  LORICA_TRY(Motion performance, makePerformance());
  LORICA_TRY(Subject mannequin, readCharacter("mannequin"));
  LORICA_TRY(CachedDecomposition body, defaultDecomposition(mannequin, threads));
  return Show{std::move(*mannequin.character), std::move(performance), std::move(body), {}, 0.0, 0, std::nullopt};
}

/// Plays repeatedly until the window is closed or the time limit is reached.
/// @return what the user opened meanwhile; none if the show is over
Result<std::optional<LoadedCast>> playForPeople(const Options& options, Window& window, WindowOpener& opener,
                                                Show& show) {
  LORICA_TRY(Session session, startDemoSession(show.character, show.body.file, show.performance));
  prepareWindow("demo", show.character, 1, window);
  WindowSubject subject{session, show.performance.name};
  subject.duration = show.performance.seconds();
  subject.opener = &opener;
  subject.treatment = treatmentControl(MotionOptions(), true);
  subject.treatment.sources =
      [&](const WindowTreatment& treatment) -> Result<std::vector<std::unique_ptr<PoseSource>>> {
    LORICA_TRY(std::unique_ptr<PoseSource> source,
               poseSourceOf(show.character, show.performance, treated(MotionOptions(), treatment)));
    std::vector<std::unique_ptr<PoseSource>> sources;
    sources.push_back(std::move(source));
    return sources;
  };
  subject.sourcesAgain = [&] { return subject.treatment.sources(subject.treatment.first); };
  if (options.seconds > 0.0) subject.atEnd = WindowSubject::AtEnd::kRepeat;
  double before = 0.0, seconds = 0.0;  // of earlier repetitions, and of the current one
  subject.stepped = [&] {
    show.statistics.add(session);
    seconds = session.time() - show.performance.firstTime();
    show.seconds = before + seconds;
  };
  subject.restarted = [&] {
    show.statistics.restart();
    before += seconds;
  };
  subject.enough = [&] { return options.seconds > 0.0 && show.seconds >= options.seconds; };
  LORICA_TRY(const WindowEnd end, runInWindow(window, subject, {}));
  show.hash = session.hash();
  if (end == WindowEnd::kInterrupted) return cancelled();
  return std::move(subject.next);
}

/// Plays once and draws every frame if a renderer is available.
Result<void> playForFiles(const Options& options, Show& show) {
  Result<DemoPictures> pictures = DemoPictures::create(options.out);
  // Without a renderer everything except the pictures still works. The error names the missing package.
  if (!pictures && pictures.error().code != ErrorCode::kNoDisplay) return pictures.error();
  if (!pictures) warn(pictures.error().message + "; running the demo without pictures");

  LORICA_TRY(Session session, startDemoSession(show.character, show.body.file, show.performance));
  const double wanted = options.seconds > 0.0 ? options.seconds : kVideoSeconds;
  const double first = show.performance.firstTime();
  int frames = 0;
  for (const SkeletonFrame& frame : show.performance.joints) frames += frame.time - first < wanted - 1e-6 ? 1 : 0;

  ProgressBar bar(pictures ? "Drawing the demo" : "Running the demo", "frames");
  for (int frame = 0; frame < frames; ++frame) {
    if (interrupted()) return cancelled();
    LORICA_TRY(const bool more, session.step());
    if (!more) break;
    show.statistics.add(session);
    show.seconds = session.time() - first;
    if (pictures) {
      const std::string caption = captionOf(show.performance.name, session, show.seconds);
      LORICA_TRY_DO(pictures->add(session, caption, show.seconds, frame, frames));
    }
    bar.update(frame + 1, frames);
  }
  show.hash = session.hash();
  if (!pictures) return {};
  LORICA_TRY(show.files, pictures->finish());
  return {};
}

nlohmann::ordered_json toJson(const Show& show) {
  nlohmann::ordered_json json;
  json["recording"] = show.performance.name;
  json["character"] = show.character.name;
  json["seconds"] = show.seconds;
  json["parts"] = show.body.file.decomposition.parts.size();
  json["error"] = show.body.file.meanError;
  json["keyframes"] = show.body.file.errorPerKeyframe.size();
  json["fromCache"] = show.body.fromCache;
  json["decompositionSeconds"] = show.body.seconds;
  show.statistics.addTo(json);
  json["hash"] = hexDigits(show.hash);
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
  const DecompositionFile& body = show.body.file;
  Report report(fmt::format("The {} performed {}: {:.1f} s, {}", show.character.name, show.performance.name,
                            show.seconds, counted(show.statistics.frames(), "frame")));
  const std::string origin =
      show.body.fromCache ? "from the cache" : fmt::format("computed in {:.1f} s and cached", show.body.seconds);
  report.line("body", fmt::format("{} trained on {}, {}", counted(std::ssize(body.decomposition.parts), "convex part"),
                                  counted(std::ssize(body.errorPerKeyframe), "keyframe"), origin));
  report.line("error", fmt::format("the hulls have {} more volume than the body", percent(body.meanError)));
  show.statistics.addTrainingTo(report);
  report.line("contacts",
              fmt::format("{} with {} of {} boxes and balls", counted(show.statistics.touches(), "touch", "touches"),
                          show.statistics.propsTouched(), show.statistics.propCount()));
  report.gap();
  report.line("frame time", "  median");
  show.statistics.addTo(report);
  if (show.files) {
    report.gap();
    if (show.files->video) report.line("video", show.files->video->string());
    const std::filesystem::path folder = show.files->contactSheet.parent_path();
    report.line("pictures", fmt::format("{}, its counterpart hulls_1.png, ... ({} in total)",
                                        (folder / "snapshot_1.png").string(), show.files->snapshots.size()));
    report.line("contact sheet", show.files->contactSheet.string());
  }
  return report;
}

/// The window, if it was requested or a display is available; none if the demo is drawn to files.
Result<std::optional<Window>> chooseWindow(const Options& options) {
  if (options.headless) return std::optional<Window>();
  if (!options.window && !displayAvailable()) {
    say(fmt::format("No display: drawing a video and pictures to {} instead.\n", options.out));
    return std::optional<Window>();
  }
  Result<Window> window = openWindow();
  if (window) return std::optional<Window>(std::move(*window));
  if (options.window) return window.error();
  warn(fmt::format("{}; drawing the demo to {} instead", window.error().message, options.out));
  return std::optional<Window>();
}

Result<void> run(const Options& options, const CommonOptions& common) {
  // Fail early.
  LORICA_TRY_DO(checkJsonOutput(common, {}));
  LORICA_TRY_DO(checkWindow(options.window, "`lorica demo --headless` draws a video instead"));
  if (options.headless || !displayAvailable()) {
    LORICA_TRY_DO(checkOutputFolder("--out", options.out));
  }
  LORICA_TRY(std::optional<Window> window, chooseWindow(options));
  const auto load = [threads = common.threadCount()] { return loadShow(threads); };
  if (!window) {
    LORICA_TRY(Show show, load());
    LORICA_TRY_DO(playForFiles(options, show));
    return publish(common, toReport(show), toJson(show));
  }
  LORICA_TRY(std::optional<Show> loaded, loadInWindow<Show>(*window, load));
  if (!loaded) return {};
  Show& show = *loaded;
  CastRequest present;
  present.input.motion = kOwnMotion;
  present.input.reading.drawn = true;
  WindowOpener opener(std::move(present), common.threadCount());
  LORICA_TRY(std::optional<LoadedCast> next, playForPeople(options, *window, opener, show));
  if (next) return playOpened(common, *window, opener, std::move(*next));
  return publish(common, toReport(show), toJson(show));
}

}  // namespace

Command addDemo(CommandLine& parent, CommonOptions& common) {
  const auto options = std::make_shared<Options>();
  CommandLine* app = addSubcommand(
      parent, common, "demo", "Show the built-in character kicking and walking among boxes and balls.",
      "  lorica demo\n"
      "      a window if there is a display, which opens what is dropped on it; else a video in lorica-demo/\n"
      "  lorica demo --headless --out /tmp/pictures\n"
      "      a video (8 s), snapshots and a contact sheet\n"
      "  lorica demo --headless --seconds 2 --json -\n"
      "      a short demo, with its figures as JSON\n"
      "\nThe body has 16 convex parts, trained on 12 keyframes. It is computed on the first run, with progress and\n"
      "Cancel in the window, and cached in $XDG_CACHE_HOME/lorica or ~/.cache/lorica.");
  app->addOption("--out", options->out, "Folder for the video and the pictures [default: lorica-demo]")
      ->typeName("DIR");
  Option* window = app->addFlag("--window", options->window,
                                "Open a window and repeat until it is closed; fail if there is no display");
  app->addFlag("--headless", options->headless, "Do not open a window, even if there is a display")->excludes(window);
  addSeconds(*app, "--seconds", options->seconds,
             "Stop after S seconds [default: 8 for a video, no limit in a window]");
  return {app, [options](const CommonOptions& given) { return run(*options, given); }};
}

}  // namespace lorica

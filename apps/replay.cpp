#include "apps/option_groups.h"
#include "apps/options.h"
#include "apps/report_parts.h"
#include "apps/show.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/text.h"
#include "session/prepare/recorded_cast.h"
#include "viewer/player/monitored_host.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

namespace lorica {
namespace {

constexpr int kDiffers = 1;  // exit status

struct ReplayOptions {
  RecordedRequest request;
  RunSetting run;
  SnapshotOptions pictures;
  bool window = false;
};

Report replayReport(const ReplayOptions& options, const Run& run, const DrawnFiles& drawn) {
  const SessionFile& recorded = run.recorded();
  const std::optional<SessionReplay::Difference>& difference = run.comparison->difference();
  const int steps = run.comparison->steps(), all = countOf(recorded.steps);
  Report report(fmt::format("{} replayed {}: {}", whoOf(run), run.name(), counted(steps, "step")));
  report.add("session", options.request.file);
  report.add("source", recorded.header.avatar().source);
  report.add("character", run.session.character().name);
  report.add(avatarFacts(run.session));
  report.add("steps", all);
  report.add("replayed", steps);
  report.add("finished", recorded.finished);
  report.add("same", "result", steps == all && !difference,
             difference ? fmt::format("first difference in step {} at {:.3f} s: {}", difference->step, difference->time,
                                      difference->what)
             : steps == all ? "all steps are bit-identical"
                            : fmt::format("identical up to step {} of {}", steps, all));
  report.add(
      "firstDifference",
      difference ? Json{{"step", difference->step}, {"time", difference->time}, {"what", difference->what}} : Json());
  report.line("user actions", counted(countOf(recorded.actions), "action"));
  const FaultSettings& faults = recorded.header.avatar().faults;
  if (faults.any()) report.line("faults", textOf(faults));
  report.add("notes", recorded.notes);
  report.add(contactFacts(run.statistics).jsonOnly());
  report.add(trainingFacts(run.statistics).jsonOnly());
  report.add(stageFacts(run.statistics).jsonOnly());
  report.add(hitFacts(run.hits));
  report.add(drawnFacts(drawn));
  report.add("hash", "hash", hexDigits(run.session.hash()));
  for (const std::string& note : recorded.notes) report.note("Recording: " + note + ".");
  return report;
}

/// What is dropped on a recorded session is played: a character performs its motion if that ships, else a walk.
CastRequest presentOf(const SessionFile& session) {
  CastRequest present;
  present.motion = "walk";
  const Result<std::filesystem::path> folder = recordingsFolder();
  const std::string& source = session.header.avatar().source;
  std::error_code ignored;
  if (folder && std::filesystem::exists(*folder / (source + ".csv"), ignored)) present.motion = source;
  present.reading.drawn = true;
  return present;
}

/// @param screen   null = none
/// @param differs  set to whether a step differs
Result<void> replay(const ReplayOptions& options, const CommonOptions& common, Host& host, RecordedCast cast,
                    Screen* screen, bool& differs) {
  RunSetting setting = options.run;
  setting.doing = "Replaying";
  setting.unit = "steps";
  setting.frames = countOf(cast.session->steps);
  const SessionHeader& header = cast.session->header;
  LORICA_TRY(const std::unique_ptr<Run> run, Run::start(std::move(cast), setting, host));
  LORICA_TRY_DO(checkReplay(header, options.request.file, run->session));
  WindowOpener opener(presentOf(run->recorded()), host, options.run.written() ? kWrittenOnce : "");
  LORICA_TRY(Showing showing, show(*run, options.pictures, screen, &opener, host));
  if (showing.end == RunEnd::kInterrupted) return cancelled();
  if (showing.next) return playOpened(common, host, *screen, opener, std::move(showing));
  LORICA_TRY_DO(run->finish());
  Report report = replayReport(options, *run, showing.drawn);
  const SessionFile& recorded = run->recorded();
  // A session whose motion ends early is no proof of the steps that were not made.
  const int steps = run->comparison->steps(), all = countOf(recorded.steps);
  differs = run->comparison->difference().has_value() || (showing.end == RunEnd::kOver && steps < all);
  return finishAndPublish(*run, common, report);
}

Result<void> runReplay(const ReplayOptions& given, const CommonOptions& common, Host& host, bool& differs) {
  ReplayOptions options = given;
  const RecordedRequest& request = options.request;
  LORICA_TRY_DO(
      checkOutputs(options.run, options.pictures, common, {request.file, request.character, request.decomposition}));
  LORICA_TRY_DO(checkWindow(options.window, "--snapshots DIR and --video FILE do not need one"));
  options.request.drawn = options.window || options.pictures.any();
  if (!options.window) {
    LORICA_TRY(RecordedCast cast, prepareRecordedCast(request, host));
    return replay(options, common, host, std::move(cast), nullptr, differs);
  }
  // The window comes first: it shows how the rest is loaded.
  LORICA_TRY(Window window, openWindow(options.pictures));
  LORICA_TRY(std::optional<RecordedCast> cast, loadOnScreen<RecordedCast>(window, host, [request](Host& loading) {
               return prepareRecordedCast(request, loading);
             }));
  return cast ? replay(options, common, host, std::move(*cast), &window, differs) : Result<void>();
}

}  // namespace

Command addReplay(CLI::App& parent, CommonOptions& common) {
  const auto options = std::make_shared<ReplayOptions>();
  CLI::App* app = addSubcommand(
      parent, common, "replay",
      "Run a recorded session (.lsession) again, and report the first step that differs, if any.",
      "  lorica record walk.lsession walk\n"
      "      record a session of a shipped recording\n"
      "  lorica replay walk.lsession\n"
      "      run it again: every hull and prop of every step is compared bit by bit\n"
      "  lorica replay walk.lsession --window\n"
      "  lorica replay crash.part.lsession --json - | jq .firstDifference\n"
      "      an incomplete recording of a program that was killed\n"
      "\nExit status: 0 if all steps are identical, 1 if one differs or is missing, 2 if the session cannot be run.\n"
      "The session stores the names and hashes of its character and decomposition; the hashes are checked.");
  app->add_option("SESSION", options->request.file, "Session written by `lorica record` or --record: .lsession")
      ->required();
  addOption(*app, "--character", options->request.character, "FILE", "File of the character, if it was moved");
  addOption(*app, "--decomposition", options->request.decomposition, "FILE.lorica",
            "File of the decomposition, if it was moved");
  addOutputOptions(*app, options->run);
  CLI::Option* window =
      app->add_flag("--window", options->window, "Open a window with a timeline; fail if there is no display");
  addSnapshotOptions(*app, options->pictures, window);
  addTextureOption(*app, options->request.textureSize);
  const auto differs = std::make_shared<bool>(false);
  return {
      app,
      [options, differs](const CommonOptions& given, Host& host) { return runReplay(*options, given, host, *differs); },
      [differs] { return *differs ? kDiffers : 0; }};
}

}  // namespace lorica

#include "apps/body_choice.h"
#include "apps/events_output.h"
#include "apps/inputs.h"
#include "apps/options.h"
#include "apps/pose_output.h"
#include "apps/run_session.h"
#include "apps/run_statistics.h"
#include "apps/scenes.h"
#include "apps/session_files.h"
#include "geometry/files.h"
#include "session/session_replay.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <optional>

namespace lorica {
namespace {

constexpr int kDiffers = 1;  // exit status

struct Options {
  std::string file;
  std::string character;      // empty = as recorded
  std::string decomposition;  // empty = as recorded
  SnapshotOptions pictures;
  PoseOutputOptions out;
  std::string events;   // file or -; empty = none
  int textureSize = 0;  // see CharacterOptions
  bool window = false;
};

/// The recorded character, or the one given by --character.
Result<Subject> findCharacter(const Options& options, const SessionHeader& header, const SessionInputs& inputs) {
  CharacterOptions reading{inputs.boneMap, header.bodyResolution};
  reading.drawn = options.window || options.pictures.any();
  reading.textureSize = options.textureSize;
  reading.expressions = header.expressions;
  reading.hidden = header.hidden;
  reading.ownClip = header.clip;
  Result<Subject> subject = readCharacter(inputs.character, reading);
  if (subject || !options.character.empty()) return subject;
  return Error{subject.error().code, fmt::format("{}: the recorded character {} cannot be read ({}): give its file "
                                                 "with --character",
                                                 options.file, header.character, subject.error().message)};
}

/// The recorded decomposition and cover: the file given by --decomposition, the recorded file, or the default one.
Result<DecompositionFile> findBody(const Options& options, const SessionHeader& header, const SessionInputs& inputs,
                                   const Subject& subject, int threads) {
  BodyOptions body;
  body.decomposition = inputs.decomposition;
  body.cover.tolerance = header.coverTolerance;
  body.cover.hullVertices = header.hullVertices;
  Result<DecompositionFile> file = chooseBody(body, subject, threads);
  if (!file && options.decomposition.empty() && !header.decomposition.empty()) {
    return Error{file.error().code, fmt::format("{}: the recorded decomposition {} cannot be read ({}): give its file "
                                                "with --decomposition",
                                                options.file, header.decomposition, file.error().message)};
  }
  if (file && hashOf(file->cover) != header.coverHash) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{}: the hull cover differs from the recording", options.file)};
  }
  return file;
}

/// @param differs  set to whether a step differs
Result<void> run(const Options& options, const CommonOptions& common, bool& differs) {
  if (Result<void> fine = checkJsonOutput(common, {options.file, options.character, options.decomposition}); !fine) {
    return fine;
  }
  if (Result<void> fine = checkWindow(options.window, "--snapshots DIR and --video FILE do not need one"); !fine)
    return fine;
  if (Result<void> fine = checkSnapshots(options.pictures); !fine) return fine;
  if (Result<void> fine = checkPoseOutput(options.out); !fine) return fine;
  if (Result<void> fine = checkEvents(options.events, common, {options.file, options.character, options.decomposition});
      !fine)
    return fine;
  Result<SessionFile> read = readSession(options.file);
  if (!read) return read.error();
  const auto recorded = std::make_shared<const SessionFile>(std::move(*read));
  const SessionHeader& header = recorded->header;

  const Result<SessionInputs> inputs = inputsOf(*recorded, options.file, options.character, options.decomposition);
  if (!inputs) return inputs.error();
  const Result<Subject> subject = findCharacter(options, header, *inputs);
  if (!subject) return subject.error();
  const Character& character = *subject->character;
  if (hashOf(character) != header.characterHash) {
    return Error{
        ErrorCode::kInvalidArgument,
        fmt::format("{}: recorded with the character {}, but {} has a different mesh, skeleton or weights: give "
                    "the recorded character with --character",
                    options.file, header.character, subject->name)};
  }
  const Result<DecompositionFile> body = findBody(options, header, *inputs, *subject, common.threadCount());
  if (!body) return body.error();
  const auto worldAgain = [&] { return worldOf(inputs->scene, header.scene); };
  const auto sourceAgain = [&]() -> Result<std::unique_ptr<PoseSource>> {
    Result<std::unique_ptr<PoseSource>> source = SessionReplay::source(*recorded, character);
    if (!source) return Error{source.error().code, options.file + ": " + source.error().message};
    return source;
  };
  Result<World> world = worldAgain();
  if (!world) return world.error();
  Result<std::unique_ptr<PoseSource>> source = sourceAgain();
  if (!source) return source.error();
  Result<Session> session = startSession(character, *body, std::move(*source), std::move(*world));
  if (!session) return session.error();
  if (header.springs) {
    const SpringBones springs = subject->file ? subject->file->springs : SpringBones();
    if (Result<void> added = session->setSprings(springs, *header.springs); !added) return added;
  }
  if (Result<void> same = checkReplay(header, options.file, *session); !same) return same;

  std::shared_ptr<SessionReplay> replay;
  std::shared_ptr<EventsOutput> events;
  RunStatistics statistics;
  const auto begin = [&]() -> Result<void> {
    replay = std::make_shared<SessionReplay>(recorded);
    statistics = RunStatistics();
    Result<std::shared_ptr<StepWatcher>> watcher = makePoseOutput(options.out, *subject, header.expressions, replay);
    if (!watcher) return watcher.error();
    if (Result<void> kept = finishEvents(events); !kept) return kept;
    Result<std::shared_ptr<EventsOutput>> written = makeEventsOutput(options.events, *watcher);
    if (!written) return written.error();
    events = std::move(*written);
    session->watch(events ? events : *watcher);
    return {};
  };
  if (Result<void> begun = begin(); !begun) return begun;
  const std::string name = header.source.empty() ? options.file : header.source;
  const auto steps = static_cast<int>(recorded->steps.size());
  DrawnFiles drawn;
  if (options.window) {
    WindowSubject watched{*session, name};
    watched.duration = recorded->steps.back().time - recorded->steps.front().time;
    watched.sourceAgain = sourceAgain;
    watched.worldAgain = worldAgain;
    watched.restarted = [&] { (void)begin(); };  // it could be opened before
    watched.stepped = [&] { statistics.add(*session); };
    PlaybackOptions limit;
    limit.frames = steps;
    if (Result<void> shown = runInOwnWindow(watched, limit); !shown) return shown;
  } else {
    HeadlessRun all{"Replaying", name, "steps", steps};
    all.stepped = [&] { statistics.add(*session); };
    const Result<DrawnFiles> played = runHeadless(all, options.pictures, *session);
    if (!played) return played.error();
    drawn = *played;
  }
  if (Result<void> kept = finishEvents(events); !kept) return kept;

  const std::optional<SessionReplay::Difference>& difference = replay->difference();
  const bool whole = replay->steps() == steps;
  nlohmann::ordered_json json;
  json["session"] = options.file;
  json["source"] = header.source;
  json["character"] = character.name;
  json["steps"] = steps;
  json["replayed"] = replay->steps();
  json["finished"] = recorded->finished;
  json["same"] = whole && !difference;
  json["firstDifference"] = nlohmann::ordered_json();
  if (difference) {
    json["firstDifference"] = {{"step", difference->step}, {"time", difference->time}, {"what", difference->what}};
  }
  json["notes"] = recorded->notes;
  statistics.addTo(json);
  drawn.addTo(options.pictures, json);
  json["hash"] = hexDigits(session->hash());

  Report report(fmt::format("{} replayed {}: {}", character.name, name, counted(replay->steps(), "step")));
  report.line("result", difference ? fmt::format("first difference in step {} at {:.3f} s: {}", difference->step,
                                                 difference->time, difference->what)
                        : whole    ? "all steps are bit-identical"
                                   : fmt::format("identical up to step {} of {}", replay->steps(), steps));
  report.line("user actions", counted(std::ssize(recorded->actions), "action"));
  if (header.faults.any()) report.line("faults", textOf(header.faults));
  drawn.addTo(options.pictures, report);
  report.line("hash", hexDigits(session->hash()));
  for (const std::string& note : recorded->notes) report.note("Recording: " + note + ".");
  differs = difference.has_value();
  return publish(common, report, json, options.events == "-");
}

}  // namespace

Command addReplay(CommandLine& parent, CommonOptions& common) {
  const auto options = std::make_shared<Options>();
  CommandLine* app = addSubcommand(
      parent, common, "replay", "Run a recorded session again and report the first step that differs, if any.",
      "  lorica record walk.lsession walk\n"
      "      record a session of a shipped recording\n"
      "  lorica replay walk.lsession\n"
      "      run it again: every hull and prop of every step is compared bit by bit\n"
      "  lorica replay walk.lsession --window\n"
      "  lorica replay crash.part.lsession --json - | jq .firstDifference\n"
      "      an incomplete recording of a program that was killed\n"
      "\nExit status: 0 if all steps are identical, 1 if one differs, 2 if the session cannot be run.\n"
      "The session stores the names and hashes of its character and decomposition; the hashes are checked.");
  app->addOption("SESSION", options->file, "Session written by `lorica record` or --record: .lsession")
      ->required()
      ->typeName("");
  app->addOption("--character", options->character, "File of the character, if it was moved")->typeName("FILE");
  app->addOption("--decomposition", options->decomposition, "File of the decomposition, if it was moved")
      ->typeName("FILE.lorica");
  addPoseOutputOptions(*app, options->out);
  addEventsOption(*app, options->events);
  Option* window =
      app->addFlag("--window", options->window, "Open a window with a timeline; fail if there is no display");
  addSnapshotOptions(*app, options->pictures, window);
  addTextureOption(*app, options->textureSize);
  const auto differs = std::make_shared<bool>(false);
  return {app, [options, differs](const CommonOptions& given) { return run(*options, given, *differs); },
          [differs] { return *differs ? kDiffers : 0; }};
}

}  // namespace lorica

#include "apps/body_choice.h"
#include "apps/inputs.h"
#include "apps/options.h"
#include "apps/run_session.h"
#include "apps/run_statistics.h"
#include "apps/scenes.h"
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
  bool window = false;
};

/// The character that was recorded, where its file is still to be found.
Result<Subject> findCharacter(const Options& options, const SessionHeader& header) {
  const CharacterOptions reading{header.boneMap, header.bodyResolution};
  if (!options.character.empty()) return readCharacter(options.character, reading);
  Result<Subject> subject = readCharacter(header.character, reading);
  if (subject) return subject;
  return Error{subject.error().code, fmt::format("{}: recorded with the character {}, which cannot be read ({}): name "
                                                 "its file with --character",
                                                 options.file, header.character, subject.error().message)};
}

/// The decomposition and cover that were recorded: a file that is named, the same name as then, or the default one.
Result<DecompositionFile> findBody(const Options& options, const SessionHeader& header, const Subject& subject,
                                   int threads) {
  BodyOptions body;
  body.decomposition = options.decomposition.empty() ? header.decomposition : options.decomposition;
  body.cover.tolerance = header.coverTolerance;
  body.cover.hullVertices = header.hullVertices;
  Result<DecompositionFile> file = chooseBody(body, subject, threads);
  if (!file && options.decomposition.empty() && !header.decomposition.empty()) {
    return Error{file.error().code, fmt::format("{}: recorded with the decomposition {}, which cannot be read ({}): "
                                                "name its file with --decomposition",
                                                options.file, header.decomposition, file.error().message)};
  }
  if (file && hashOf(file->cover) != header.coverHash) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{}: recorded with another cover of the same decomposition", options.file)};
  }
  return file;
}

/// @param differs  written
Result<void> run(const Options& options, const CommonOptions& common, bool& differs) {
  if (Result<void> fine = checkJsonOutput(common, {options.file, options.character, options.decomposition}); !fine) {
    return fine;
  }
  if (Result<void> fine = checkWindow(options.window, "--snapshots DIR and --video FILE need none"); !fine) return fine;
  if (Result<void> fine = checkSnapshots(options.pictures); !fine) return fine;
  Result<SessionFile> read = readSession(options.file);
  if (!read) return read.error();
  const auto recorded = std::make_shared<const SessionFile>(std::move(*read));
  const SessionHeader& header = recorded->header;

  const Result<Subject> subject = findCharacter(options, header);
  if (!subject) return subject.error();
  const Character& character = *subject->character;
  if (hashOf(character) != header.characterHash) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{}: recorded with the character {}, and {} has another mesh, skeleton or weights: name "
                             "the one that was recorded with --character",
                             options.file, header.character, subject->name)};
  }
  const Result<DecompositionFile> body = findBody(options, header, *subject, common.threadCount());
  if (!body) return body.error();
  const auto worldAnew = [&] { return worldOf({recorded->sceneText, header.sceneFolder}, header.scene); };
  const auto sourceAnew = [&]() -> Result<std::unique_ptr<PoseSource>> {
    Result<std::unique_ptr<PoseSource>> source = SessionReplay::source(*recorded, character);
    if (!source) return Error{source.error().code, options.file + ": " + source.error().message};
    return source;
  };
  Result<World> world = worldAnew();
  if (!world) return world.error();
  Result<std::unique_ptr<PoseSource>> source = sourceAnew();
  if (!source) return source.error();
  Result<Session> session = startSession(character, *body, std::move(*source), std::move(*world));
  if (!session) return session.error();
  if (Result<void> same = checkReplay(header, options.file, *session); !same) return same;

  std::shared_ptr<SessionReplay> replay;
  Tally tally;
  const auto begin = [&] {
    replay = std::make_shared<SessionReplay>(recorded);
    session->watch(replay);
    tally = Tally();
  };
  begin();
  const std::string name = header.source.empty() ? options.file : header.source;
  const auto steps = static_cast<int>(recorded->steps.size());
  DrawnFiles drawn;
  if (options.window) {
    WindowSubject watched{*session, name};
    watched.duration = recorded->steps.back().time - recorded->steps.front().time;
    watched.sourceAnew = sourceAnew;
    watched.worldAnew = worldAnew;
    watched.restarted = begin;
    watched.stepped = [&] { tally.add(*session); };
    PlaybackOptions limit;
    limit.frames = steps;
    if (Result<void> shown = runInOwnWindow(watched, limit); !shown) return shown;
  } else {
    HeadlessRun all{"Replaying", name, "steps", steps};
    all.stepped = [&] { tally.add(*session); };
    const Result<DrawnFiles> played = runHeadless(all, options.pictures, *session);
    if (!played) return played.error();
    drawn = *played;
  }

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
  tally.addTo(json);
  drawn.addTo(options.pictures, json);
  json["hash"] = hexDigits(session->hash());

  Report report(fmt::format("{} replayed {}: {}", character.name, name, counted(replay->steps(), "step")));
  report.line("result",
              difference ? fmt::format("step {} at {:.3f} s is the first that differs: {}", difference->step,
                                       difference->time, difference->what)
              : whole    ? "every step came out the same, bit for bit"
                      : fmt::format("the same as far as it went, {} of {}", replay->steps(), counted(steps, "step")));
  report.line("thrown, held", counted(std::ssize(recorded->actions), "action"));
  if (header.faults.any()) report.line("faults", textOf(header.faults));
  drawn.addTo(options.pictures, report);
  report.line("hash", hexDigits(session->hash()));
  for (const std::string& note : recorded->notes) report.note("Of the file: " + note + ".");
  differs = difference.has_value();
  return publish(common, report, json);
}

}  // namespace

Command addReplay(CommandLine& parent, CommonOptions& common) {
  const auto options = std::make_shared<Options>();
  CommandLine* app = addSubcommand(
      parent, common, "replay", "Run a recorded session again, and say the first step that differs, if any.",
      "  lorica record walk.lsession walk\n"
      "      a session of a shipped recording\n"
      "  lorica replay walk.lsession\n"
      "      the same again: every hull and prop of every step is compared, bit for bit\n"
      "  lorica replay walk.lsession --window\n"
      "  lorica replay crash.part.lsession --json - | jq .firstDifference\n"
      "      what was recorded before a program was killed\n"
      "\nExits with 0 where every step is the same, with 1 where one differs, with 2 where the session cannot be run.\n"
      "The session names its character and decomposition; whether what is found is the same, hashes tell.");
  app->addOption("SESSION", options->file, "What `lorica record` or --record wrote: .lsession")
      ->required()
      ->typeName("");
  app->addOption("--character", options->character, "The character's file, where it is no longer where it was")
      ->typeName("FILE");
  app->addOption("--decomposition", options->decomposition, "The decomposition's file, where it is no longer there")
      ->typeName("FILE.lorica");
  Option* window = app->addFlag("--window", options->window, "Watch it in a window, with a timeline");
  addSnapshotOptions(*app, options->pictures, window);
  const auto differs = std::make_shared<bool>(false);
  return {app, [options, differs](const CommonOptions& given) { return run(*options, given, *differs); },
          [differs] { return *differs ? kDiffers : 0; }};
}

}  // namespace lorica

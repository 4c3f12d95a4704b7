#include "apps/options.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "player/events_output.h"
#include "player/load_in_window.h"
#include "player/pose_output.h"
#include "player/run_session.h"
#include "player/run_statistics.h"
#include "player/target_hits.h"
#include "prepare/body.h"
#include "prepare/cast.h"
#include "prepare/scenes.h"
#include "prepare/session_files.h"
#include "prepare/subject.h"
#include "session/recording/session_replay.h"
#include "skinning/look/avatar.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

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
Result<Subject> findCharacter(const Options& options, const AvatarRecord& header, const SessionInputs& inputs) {
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
Result<DecompositionFile> findBody(const Options& options, const AvatarRecord& header, const SessionInputs& inputs,
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
    return invalidArgument("{}: the hull cover differs from the recording", options.file);
  }
  return file;
}

/// An avatar of a recorded session.
struct RecordedPerformer {
  SessionInputs inputs;
  Subject subject;
  DecompositionFile body;
};

/// @param index  of the avatar; --character and --decomposition give those of the first
Result<RecordedPerformer> findPerformer(const Options& options, const SessionFile& recorded, std::size_t index,
                                        int threads) {
  const AvatarRecord& header = recorded.header.avatar(index);
  Options own = options;
  if (index > 0) own.character = own.decomposition = "";
  LORICA_TRY(SessionInputs inputs, inputsOf(recorded, options.file, index, own.character, own.decomposition));
  LORICA_TRY(Subject subject, findCharacter(own, header, inputs));
  if (hashOf(*subject.character) != header.characterHash) {
    return invalidArgument(
        "{}: recorded with the character {}, but {} has a different mesh, skeleton or weights: give the recorded "
        "character with --character",
        options.file, header.character, subject.name);
  }
  std::shared_ptr<const Avatar>& look = subject.character->avatar;
  if (header.color && look != nullptr) look = tinted(*look, *header.color);
  LORICA_TRY(DecompositionFile body, findBody(own, header, inputs, subject, threads));
  return RecordedPerformer{std::move(inputs), std::move(subject), std::move(body)};
}

using Sources = std::vector<std::unique_ptr<PoseSource>>;

Result<Sources> sourcesOf(const Options& options, const SessionFile& recorded,
                          std::span<const RecordedPerformer> performers) {
  Sources sources;
  for (std::size_t i = 0; i < performers.size(); ++i) {
    LORICA_TRY(std::unique_ptr<PoseSource> source,
               prefixed(options.file, SessionReplay::source(recorded, *performers[i].subject.character, i)));
    sources.push_back(std::move(source));
  }
  return sources;
}

/// The session as it was at the start of the recording.
Result<Session> startAgain(const Options& options, const SessionFile& recorded,
                           std::span<const RecordedPerformer> performers, World world) {
  LORICA_TRY(Sources sources, sourcesOf(options, recorded, performers));
  Session session(std::move(world));
  for (std::size_t i = 0; i < performers.size(); ++i) {
    const RecordedPerformer& performer = performers[i];
    const AvatarRecord& header = recorded.header.avatar(i);
    AvatarSetting setting{placeOf(header.place, header.heading)};
    if (header.springs) {
      setting.springs = {performer.subject.file ? performer.subject.file->springs : SpringBones(), *header.springs};
    }
    LORICA_TRY_DO(addAvatar(session, *performer.subject.character, performer.body, std::move(sources[i]), setting));
  }
  LORICA_TRY_DO(checkReplay(recorded.header, options.file, session));
  return session;
}

/// A recorded session that was read.
struct Recorded {
  std::shared_ptr<const SessionFile> session;
  std::vector<RecordedPerformer> performers;
  World world;

  [[nodiscard]] Result<World> worldAgain() const {
    return worldOf(performers.front().inputs.scene, session->header.scene);
  }
};

Result<Recorded> load(const Options& options, int threads) {
  LORICA_TRY(SessionFile read, readSession(options.file));
  auto session = std::make_shared<const SessionFile>(std::move(read));
  std::vector<RecordedPerformer> performers;
  const double count = session->header.avatars.size();
  for (std::size_t i = 0; i < session->header.avatars.size(); ++i) {
    const WorkMonitor::Stage stage(i / count, (i + 1) / count);
    LORICA_TRY(RecordedPerformer performer, findPerformer(options, *session, i, threads));
    performers.push_back(std::move(performer));
  }
  LORICA_TRY(World world, worldOf(performers.front().inputs.scene, session->header.scene));
  return Recorded{std::move(session), std::move(performers), std::move(world)};
}

Result<void> checkOptions(const Options& options, const CommonOptions& common) {
  LORICA_TRY_DO(checkJsonOutput(common, {options.file, options.character, options.decomposition}));
  LORICA_TRY_DO(checkWindow(options.window, "--snapshots DIR and --video FILE do not need one"));
  LORICA_TRY_DO(checkSnapshots(options.pictures));
  LORICA_TRY_DO(checkPoseOutput(options.out));
  return checkEvents(options.events, common, {options.file, options.character, options.decomposition});
}

/// @param window   null = none
/// @param differs  set to whether a step differs
Result<void> replay(const Options& options, const CommonOptions& common, Recorded loaded, Window* window,
                    bool& differs) {
  const std::shared_ptr<const SessionFile>& recorded = loaded.session;
  const std::vector<RecordedPerformer>& performers = loaded.performers;
  const AvatarRecord& header = recorded->header.avatar();
  const Subject& subject = performers.front().subject;
  const Character& character = *subject.character;
  LORICA_TRY(Session session, startAgain(options, *recorded, performers, std::move(loaded.world)));

  std::shared_ptr<SessionReplay> comparison;
  std::shared_ptr<EventsOutput> events;
  RunStatistics statistics;
  const std::vector<HitTarget> targets = targetsOf(performers.front().inputs.scene, recorded->header.scene);
  TargetHits hits(targets);
  const auto count = [&] {
    statistics.add(session);
    hits.add(session);
  };
  const auto begin = [&]() -> Result<void> {
    comparison = std::make_shared<SessionReplay>(recorded);
    statistics = RunStatistics();
    hits = TargetHits(targets);
    LORICA_TRY(std::shared_ptr<StepWatcher> watcher,
               makePoseOutput(options.out, subject, header.expressions, comparison));
    LORICA_TRY_DO(finishEvents(events));
    LORICA_TRY(events, makeEventsOutput(options.events, watcher));
    session.watch(events ? events : watcher);
    return {};
  };
  LORICA_TRY_DO(begin());
  std::vector<std::string> sources;
  for (const AvatarRecord& avatar : recorded->header.avatars) sources.push_back(avatar.source);
  const std::string name = header.source.empty() ? options.file : listed(sources);
  const auto steps = countOf(recorded->steps);
  DrawnFiles drawn;
  if (window != nullptr) {
    prepareWindow(name, character, performers.size(), *window);
    WindowSubject watched{session, name};
    watched.duration = recorded->steps.back().time - recorded->steps.front().time;
    watched.sourcesAgain = [&] { return sourcesOf(options, *recorded, performers); };
    watched.worldAgain = [&] { return loaded.worldAgain(); };
    watched.atEnd = WindowSubject::AtEnd::kHold;
    watched.restarted = [&] { (void)begin(); };  // it could be opened before
    watched.stepped = count;
    watched.hits = [&] { return hits.scores(); };
    PlaybackOptions limit;
    limit.frames = steps;
    LORICA_TRY(const WindowEnd end, runInWindow(*window, watched, limit));
    if (end == WindowEnd::kInterrupted) return cancelled();
  } else {
    HeadlessRun all{"Replaying", name, "steps", steps};
    all.stepped = count;
    all.caption = [&] { return hits.caption(); };
    LORICA_TRY(drawn, runHeadless(all, options.pictures, session));
  }
  LORICA_TRY_DO(finishEvents(events));

  const std::optional<SessionReplay::Difference>& difference = comparison->difference();
  const bool whole = comparison->steps() == steps;
  nlohmann::ordered_json json;
  json["session"] = options.file;
  json["source"] = header.source;
  json["character"] = character.name;
  json["avatars"] = nlohmann::ordered_json::array();
  for (const SessionAvatar& avatar : session.avatars()) {
    json["avatars"].push_back(
        {{"character", avatar.character().name}, {"frames", avatar.frameCount()}, {"hash", hexDigits(avatar.hash())}});
  }
  json["steps"] = steps;
  json["replayed"] = comparison->steps();
  json["finished"] = recorded->finished;
  json["same"] = whole && !difference;
  json["firstDifference"] = nlohmann::ordered_json();
  if (difference) {
    json["firstDifference"] = {{"step", difference->step}, {"time", difference->time}, {"what", difference->what}};
  }
  json["notes"] = recorded->notes;
  statistics.addTo(json);
  hits.addTo(json);
  drawn.addTo(options.pictures, json);
  json["hash"] = hexDigits(session.hash());

  const std::string who = performers.size() == 1 ? character.name : counted(std::ssize(performers), "avatar");
  Report report(fmt::format("{} replayed {}: {}", who, name, counted(comparison->steps(), "step")));
  report.line("result", difference ? fmt::format("first difference in step {} at {:.3f} s: {}", difference->step,
                                                 difference->time, difference->what)
                        : whole    ? "all steps are bit-identical"
                                   : fmt::format("identical up to step {} of {}", comparison->steps(), steps));
  report.line("user actions", counted(std::ssize(recorded->actions), "action"));
  if (header.faults.any()) report.line("faults", textOf(header.faults));
  hits.addTo(report);
  drawn.addTo(options.pictures, report);
  report.line("hash", hexDigits(session.hash()));
  for (const std::string& note : recorded->notes) report.note("Recording: " + note + ".");
  differs = difference.has_value();
  return publish(common, report, json, options.events == "-");
}

/// Opens the window first: it shows how the rest is loaded.
Result<void> replayInWindow(const Options& options, const CommonOptions& common, bool& differs) {
  LORICA_TRY(Window window, openWindow());
  LORICA_TRY(std::optional<Recorded> loaded,
             loadInWindow<Recorded>(window, [&] { return load(options, common.threadCount()); }));
  return loaded ? replay(options, common, std::move(*loaded), &window, differs) : Result<void>();
}

Result<void> run(const Options& options, const CommonOptions& common, bool& differs) {
  LORICA_TRY_DO(checkOptions(options, common));
  if (options.window) return replayInWindow(options, common, differs);
  LORICA_TRY(Recorded loaded, load(options, common.threadCount()));
  return replay(options, common, std::move(loaded), nullptr, differs);
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

#include "acd/decomposition_file.h"
#include "apps/cover.h"
#include "apps/decomposition_cache.h"
#include "apps/inputs.h"
#include "apps/interrupt.h"
#include "apps/options.h"
#include "apps/playback.h"
#include "apps/progress_bar.h"
#include "apps/snapshots.h"
#include "geometry/files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <optional>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr int kSnapshotWidth = 1280;
constexpr int kSnapshotHeight = 720;
constexpr double kCameraDistance = 2.29;  // in heights of the character

struct Options {
  std::string motion;     // empty = the character's own clip
  std::string character;  // empty = the mannequin, or the motion's file where that is a character with a surface
  CharacterOptions reading;
  MotionOptions performing;
  std::string decomposition;
  CoverRequest cover;  // not given = as the file has it
  std::string snapshots;
  int every = 30;
  PlaybackLimit limit;
  bool window = false;
};

/// The decomposition that was asked for, checked against the character, or the default one.
Result<DecompositionFile> chooseDecomposition(const Options& options, const Subject& subject, int threads) {
  const Character& character = *subject.character;
  if (options.decomposition.empty()) {
    Result<DefaultDecomposition> made = defaultDecomposition(subject, threads);
    if (!made) return made.error();
    return std::move(made->file);
  }
  Result<DecompositionFile> read = readDecomposition(options.decomposition);
  if (!read) return read.error();
  if (read->meshHash != topologyHash(character.mesh)) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{}: made from {} with {} vertices, expected one made from {} with {}",
                             options.decomposition, read->source, grouped(read->decomposition.vertexCount),
                             character.name, grouped(std::ssize(character.mesh.vertices)))};
  }
  return read;
}

/// The decomposition with the cover that was asked for; without a request its own, exact where it has none.
Result<DecompositionFile> chooseBody(const Options& options, const Subject& subject, int threads) {
  Result<DecompositionFile> body = chooseDecomposition(options, subject, threads);
  if (!body || !options.cover.given()) return body;
  body->cover.reset();
  if (options.cover.exact()) return body;
  Result<CoverPromise> cover = cachedCover(subject, *body, options.cover, threads);
  if (!cover) return cover.error();
  body->cover = std::move(*cover);
  return body;
}

/// Who plays what.
struct Cast {
  Subject subject;
  Motion motion;
};

/// A character that is the motion's file performs its own clip. Without a motion so does the one named.
Result<Cast> readCast(const Options& options) {
  const std::string& own = options.motion.empty() ? options.character : options.motion;
  if (own.empty()) {
    return Error{ErrorCode::kInvalidArgument,
                 "no motion given, expected one, such as `lorica play walk`, or a character with clips: --character "
                 "hero.glb --clip Run"};
  }
  if (isCharacterFile(own) &&
      (options.character.empty() || options.motion.empty() || options.motion == options.character)) {
    Result<Subject> subject = readSubject(own, options.reading);
    if (subject && subject->character) {
      const Result<const Clip*> clip = findClip(subject->file->clips, options.performing.clip, own);
      if (!clip) return clip.error();
      Motion motion;
      motion.name = subject->name + ((*clip)->name.empty() ? "" : ": " + (*clip)->name);
      motion.bones = framesOf(subject->character->skeleton, **clip);
      motion.fromCharacterFile = true;
      motion.format = subject->file->format;
      motion.notes = subject->file->notes;
      return Cast{std::move(*subject), std::move(motion)};
    }
    // A file of motion alone is performed by another character.
    if (!subject && (options.motion.empty() || subject.error().code != ErrorCode::kBadMesh)) return subject.error();
  }
  Result<Motion> motion = readMotion(own, options.performing);
  if (!motion) return motion.error();
  Result<Subject> subject = readCharacter(options.character.empty() ? "mannequin" : options.character, options.reading);
  if (!subject) return subject.error();
  if (subject->file) {
    motion->notes.insert(motion->notes.end(), subject->file->notes.begin(), subject->file->notes.end());
  }
  return Cast{std::move(*subject), std::move(*motion)};
}

/// Runs all frames without a window, with a picture every so often where pictures are wanted.
/// @return how many pictures were written
Result<int> playHeadless(const Options& options, const Motion& motion, Session& session, Tally& tally) {
  std::optional<SnapshotCamera> pictures;
  if (!options.snapshots.empty()) {
    Result<SnapshotCamera> made = SnapshotCamera::create(kSnapshotWidth, kSnapshotHeight);
    if (!made) return made.error();
    pictures.emplace(std::move(*made));
    std::error_code error;
    fs::create_directories(options.snapshots, error);
    if (error) {
      return Error{ErrorCode::kUnwritable, fmt::format("--snapshots: {}: {}", options.snapshots, error.message())};
    }
  }

  const SessionScene scene(session);
  FollowCamera follow(kCameraDistance);
  int frames = motion.frameCount();
  if (options.limit.frames > 0) frames = std::min(frames, options.limit.frames);
  ProgressBar bar("Playing " + motion.name, "frames");
  int written = 0;
  double previousTime = motion.firstTime();
  for (int frame = 0; frame < frames; ++frame) {
    if (interrupted()) return Error{ErrorCode::kCancelled, "cancelled"};
    const Result<bool> more = session.step();
    if (!more) return more.error();
    if (!*more) break;
    tally.add(session);
    bar.update(frame + 1, frames);
    follow.update(session, session.time() - previousTime);
    previousTime = session.time();
    if (!pictures || frame % options.every != 0) continue;
    SceneOptions show;
    show.caption = captionOf(motion.name, session, session.time() - motion.firstTime());
    const Image image = pictures->draw(scene.of(session), show, follow.camera());
    const fs::path file = fs::path(options.snapshots) / fmt::format("frame_{:04}.png", frame);
    if (Result<void> saved = writePng(file, image); !saved) return saved.error();
    ++written;
  }
  return written;
}

Result<void> playWithWindow(const Options& options, const Motion& motion, Session& session, Tally& tally) {
  Result<Window> window = Window::create("Lorica: " + motion.name, kSnapshotWidth, kSnapshotHeight);
  if (!window) return window.error();
  window->setCamera(windowCamera(session.character().height));
  const Result<bool> stillOpen = playInWindow(*window, session, motion.name, options.limit, tally);
  if (!stillOpen) return stillOpen.error();
  if (*stillOpen) holdInWindow(*window, session, motion.name + "   the end, Esc closes");
  return {};
}

nlohmann::ordered_json toJson(const Motion& motion, const Session& session, const DecompositionFile& file,
                              const Tally& tally, int pictures) {
  nlohmann::ordered_json json;
  json["recording"] = motion.name;
  json["format"] = motion.format;
  json["notes"] = motion.notes;
  json["character"] = session.character().name;
  json["parts"] = file.decomposition.parts.size();
  json["error"] = file.meanError;
  addCoverTo(json, file.cover);
  tally.addTo(json);
  const std::optional<double> delay = session.source().smoothingDelay();
  json["smoothingDelay"] = delay ? nlohmann::ordered_json(*delay) : nlohmann::ordered_json();
  json["snapshots"] = pictures;
  json["hash"] = hexDigits(session.hash());
  return json;
}

Report toReport(const Options& options, const Motion& motion, const Session& session, const DecompositionFile& file,
                const Tally& tally, int pictures) {
  Report report(
      fmt::format("{} performed {}: {}", session.character().name, motion.name, counted(tally.frames(), "frame")));
  report.line("parts",
              fmt::format("{}, {} more volume than the body (mean over {})", file.decomposition.parts.size(),
                          percent(file.meanError), counted(std::ssize(file.errorPerKeyframe), "training keyframe")));
  addCoverTo(report, file.cover);
  tally.addTrainingTo(report);
  if (const std::optional<double> delay = session.source().smoothingDelay()) {
    report.line("smoothing", fmt::format("joints lag by {:.0f} ms", 1e3 * *delay));
  }
  report.line("contacts",
              fmt::format("{}, on {}; {} over all frames", counted(tally.touches(), "touch", "touches"),
                          counted(tally.propsTouched(), "prop"), counted(tally.contacts(), "contact point")));
  report.line("hash", hexDigits(session.hash()));
  if (!options.snapshots.empty()) {
    report.line("pictures", fmt::format("{} in {}", counted(pictures, "PNG file"), options.snapshots));
  }
  report.gap();
  report.line("time a frame", "median");
  tally.addTo(report);
  for (const std::string& note : motion.notes) report.note(note);
  return report;
}

Result<void> run(const Options& options, const CommonOptions& common) {
  if (Result<void> fine = checkJsonOutput(common, {options.motion, options.character, options.decomposition}); !fine) {
    return fine;
  }
  if (options.window && !displayAvailable()) {
    return Error{ErrorCode::kNoDisplay,
                 "--window: there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set); --snapshots DIR needs "
                 "none"};
  }
  if (!options.snapshots.empty()) {
    if (Result<void> fine = checkOutputFolder("--snapshots", options.snapshots); !fine) return fine;
  }
  const Result<Cast> cast = readCast(options);
  if (!cast) return cast.error();
  const auto& [subject, motion] = *cast;
  if (Result<void> fine = checkCover(options.cover, *subject.character); !fine) return fine;
  const Result<DecompositionFile> file = chooseBody(options, subject, common.threadCount());
  if (!file) return file.error();
  Result<Session> session = startSession(*subject.character, *file, motion, options.performing);
  if (!session) return session.error();

  Tally tally;
  int pictures = 0;
  if (options.window) {
    if (Result<void> played = playWithWindow(options, motion, *session, tally); !played) return played;
  } else {
    const Result<int> played = playHeadless(options, motion, *session, tally);
    if (!played) return played.error();
    pictures = *played;
  }
  return publish(common, toReport(options, motion, *session, *file, tally, pictures),
                 toJson(motion, *session, *file, tally, pictures));
}

}  // namespace

Command addPlay(CLI::App& parent, CommonOptions& common) {
  const auto options = std::make_shared<Options>();
  CLI::App* app = addSubcommand(
      parent, common, "play", "Play a motion: the character moves, its hulls follow, boxes and balls bounce.",
      "  lorica play walk\n"
      "      a shipped recording, without pictures: time of each stage, contacts\n"
      "  lorica play walk --window\n"
      "      watch it\n"
      "  lorica play walk --snapshots pictures --every 15\n"
      "      pictures/frame_0000.png, frame_0015.png, ...; needs no display\n"
      "  lorica play walk.bvh --character hero.glb --window\n"
      "      a motion and a character of your own\n"
      "  lorica play hero.glb --clip Run\n"
      "      a character's own clip\n"
      "  lorica decompose mannequin --parts 24 -o body.lorica\n"
      "  lorica play joints.csv --decomposition body.lorica\n"
      "      joints of your own, a decomposition of your own\n"
      "  lorica play walk --hull-vertices 64\n"
      "      hulls of at most 64 vertices, which hold the body in 128 sampled poses\n"
      "  lorica play wave --json - | jq .stages.total.median\n"
      "\nWithout --decomposition: 16 parts from 12 keyframes, computed the first time and then cached. So is what\n"
      "--cover and --hull-vertices ask for. Keyframes come from the character's own clips, else from the shipped\n"
      "recordings.");
  app->add_option("MOTION", options->motion,
                  "Recorded joints, .bvh, a character file with clips, or the name of a shipped recording [default: a "
                  "clip of --character]")
      ->type_name("");
  app->add_option("--character", options->character,
                  "Who performs it: .glb, .gltf, .vrm, .fbx, .dae or mannequin [default: mannequin]")
      ->type_name("FILE");
  addReadingOptions(*app, options->performing);
  addPlayingOptions(*app, options->performing);
  addCharacterOptions(*app, options->reading);
  app->add_option("--decomposition", options->decomposition, "What `lorica decompose -o` wrote")
      ->type_name("FILE.lorica");
  addCover(
      *app, options->cover.tolerance,
      "What the hulls hold: `exact`, the surface in every pose; a length: it may stick out so far before the hulls "
      "of few points are grown [default: as decomposed, else exact]");
  addCount(*app, "--hull-vertices", options->cover.hullVertices, 4,
           "At most so many vertices a hull in every frame, grown to hold the body");
  CLI::Option* snapshots =
      app->add_option("--snapshots", options->snapshots, "Write pictures to this folder")->type_name("DIR");
  addCount(*app, "--every", options->every, 1, "A picture every so many frames [default: 30]")->needs(snapshots);
  addCount(*app, "--frames", options->limit.frames, 1, "Stop after so many frames");
  app->add_flag("--window", options->window, "Watch it in a window, at the recording's pace")->excludes(snapshots);
  return {app, [options](const CommonOptions& given) { return run(*options, given); }};
}

}  // namespace lorica

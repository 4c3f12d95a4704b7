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
constexpr double kCameraDistance = 4.0;  // [m]

struct Options {
  std::string recording;
  std::string character = "mannequin";
  std::string decomposition;
  CoverRequest cover;  // not given = as the file has it
  std::string snapshots;
  int every = 30;
  PlaybackLimit limit;
  bool window = false;
};

/// The decomposition that was asked for, checked against the character, or the default one.
Result<DecompositionFile> chooseDecomposition(const Options& options, const Character& character, int threads) {
  if (options.decomposition.empty()) {
    Result<DefaultDecomposition> made = defaultDecomposition(character, threads);
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
Result<DecompositionFile> chooseBody(const Options& options, const Character& character, int threads) {
  Result<DecompositionFile> body = chooseDecomposition(options, character, threads);
  if (!body || !options.cover.given()) return body;
  body->cover.reset();
  if (options.cover.exact()) return body;
  Result<CoverPromise> cover = cachedCover(character, *body, options.cover, threads);
  if (!cover) return cover.error();
  body->cover = std::move(*cover);
  return body;
}

/// Runs all frames without a window, with a picture every so often where pictures are wanted.
/// @return how many pictures were written
Result<int> playHeadless(const Options& options, const Recording& recording, Session& session, Tally& tally) {
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

  const SessionScene scene(session.body().decomposition());
  FollowCamera follow(kCameraDistance);
  int frames = static_cast<int>(recording.frames.size());
  if (options.limit.frames > 0) frames = std::min(frames, options.limit.frames);
  ProgressBar bar("Playing " + recording.name, "frames");
  int written = 0;
  double previousTime = recording.frames.front().time;
  for (int frame = 0; frame < frames; ++frame) {
    if (interrupted()) return Error{ErrorCode::kCancelled, "cancelled"};
    const Result<bool> more = session.step();
    if (!more) return more.error();
    if (!*more) break;
    tally.add(session);
    bar.update(frame + 1, frames);
    follow.update(session, session.frame().time - previousTime);
    previousTime = session.frame().time;
    if (!pictures || frame % options.every != 0) continue;
    SceneOptions show;
    show.caption = captionOf(recording.name, session, session.frame().time - recording.frames.front().time);
    const Image image = pictures->draw(scene.of(session), show, follow.camera());
    const fs::path file = fs::path(options.snapshots) / fmt::format("frame_{:04}.png", frame);
    if (Result<void> saved = writePng(file, image); !saved) return saved.error();
    ++written;
  }
  return written;
}

Result<void> playWithWindow(const Options& options, const Recording& recording, Session& session, Tally& tally) {
  Result<Window> window = Window::create("Lorica: " + recording.name, kSnapshotWidth, kSnapshotHeight);
  if (!window) return window.error();
  window->setCamera(windowCamera());
  const Result<bool> stillOpen = playInWindow(*window, session, recording.name, options.limit, tally);
  if (!stillOpen) return stillOpen.error();
  if (*stillOpen) holdInWindow(*window, session, recording.name + "   the end, Esc closes");
  return {};
}

nlohmann::ordered_json toJson(const Recording& recording, const Session& session, const DecompositionFile& file,
                              const Tally& tally, int pictures) {
  nlohmann::ordered_json json;
  json["recording"] = recording.name;
  json["character"] = session.character().name;
  json["parts"] = file.decomposition.parts.size();
  json["error"] = file.meanError;
  addCoverTo(json, file.cover);
  tally.addTo(json);
  json["snapshots"] = pictures;
  json["hash"] = hexDigits(session.hash());
  return json;
}

Report toReport(const Options& options, const Recording& recording, const Session& session,
                const DecompositionFile& file, const Tally& tally, int pictures) {
  Report report(
      fmt::format("{} performed {}: {}", session.character().name, recording.name, counted(tally.frames(), "frame")));
  report.line("parts",
              fmt::format("{}, {} more volume than the body (mean over {})", file.decomposition.parts.size(),
                          percent(file.meanError), counted(std::ssize(file.errorPerKeyframe), "training keyframe")));
  addCoverTo(report, file.cover);
  tally.addTrainingTo(report);
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
  return report;
}

Result<void> run(const Options& options, const CommonOptions& common) {
  if (Result<void> fine = checkJsonOutput(common, {options.recording, options.decomposition}); !fine) return fine;
  const Result<Character> character = findCharacter(options.character);
  if (!character) return character.error();
  if (Result<void> fine = checkCover(options.cover, *character); !fine) return fine;
  if (options.window && !displayAvailable()) {
    return Error{ErrorCode::kNoDisplay,
                 "--window: there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set); --snapshots DIR needs "
                 "none"};
  }
  if (!options.snapshots.empty()) {
    if (Result<void> fine = checkOutputFolder("--snapshots", options.snapshots); !fine) return fine;
  }
  const Result<Recording> recording = readRecording(options.recording);
  if (!recording) return recording.error();
  const Result<DecompositionFile> file = chooseBody(options, *character, common.threadCount());
  if (!file) return file.error();
  Result<Session> session = startSession(*character, *file, recording->frames);
  if (!session) return session.error();

  Tally tally;
  int pictures = 0;
  if (options.window) {
    if (Result<void> played = playWithWindow(options, *recording, *session, tally); !played) return played;
  } else {
    const Result<int> played = playHeadless(options, *recording, *session, tally);
    if (!played) return played.error();
    pictures = *played;
  }
  return publish(common, toReport(options, *recording, *session, *file, tally, pictures),
                 toJson(*recording, *session, *file, tally, pictures));
}

}  // namespace

Command addPlay(CLI::App& parent, CommonOptions& common) {
  const auto options = std::make_shared<Options>();
  CLI::App* app = addSubcommand(
      parent, common, "play", "Play recorded joints: the character moves, its hulls follow, boxes and balls bounce.",
      "  lorica play walk\n"
      "      a shipped recording, without pictures: time of each stage, contacts\n"
      "  lorica play walk --window\n"
      "      watch it\n"
      "  lorica play walk --snapshots pictures --every 15\n"
      "      pictures/frame_0000.png, frame_0015.png, ...; needs no display\n"
      "  lorica decompose mannequin --parts 24 -o body.lorica\n"
      "  lorica play joints.csv --decomposition body.lorica\n"
      "      joints of your own, a decomposition of your own\n"
      "  lorica play walk --hull-vertices 64\n"
      "      hulls of at most 64 vertices, which hold the body in 128 sampled poses\n"
      "  lorica play wave --json - | jq .stages.total.median\n"
      "\nWithout --decomposition: 16 parts from 12 keyframes, computed the first time and then cached. So is what\n"
      "--cover and --hull-vertices ask for, from poses of the shipped recordings and random ones.");
  app->add_option("RECORDING", options->recording, "Joint CSV, or the name of a shipped recording")
      ->required()
      ->type_name("");
  app->add_option("--character", options->character, "Who performs it [default: mannequin]")->type_name("NAME");
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

#include "acd/decompose.h"
#include "geometry/text.h"

#include "acd/held_vertices.h"
#include "acd/level_of_detail.h"
#include "apps/decompose_report.h"
#include "apps/option_groups.h"
#include "apps/options.h"
#include "export/mesh_export.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "player/parts_picture.h"
#include "prepare/mesh_subject.h"
#include "prepare/subject_training.h"
#include "viewer/pictures/image_files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <optional>

namespace lorica {
namespace {

constexpr int kCharacterParts = 16;
constexpr int kMeshParts = 256;
constexpr double kMeshConcavity = 0.05;
static_assert(kAuto == kChooseKeyframes, "--keyframes auto is passed on as it is");

/// Rejects, before any work, options that do not fit the input and outputs that cannot be written.
Result<void> check(const DecomposeOptions& options, const CommonOptions& common, const Subject& subject) {
  if (!subject.character && (options.keyframes != 0 || !options.motions.empty())) {
    return invalidArgument("{} is for characters, but {} is a static mesh",
                           options.keyframes != 0 ? "--keyframes" : "--motion", subject.name);
  }
  if (!subject.character && options.cover.tolerance) {
    return invalidArgument("--cover is for characters, but {} is a static mesh", subject.name);
  }
  if (subject.character) {
    LORICA_TRY_DO(checkCover(options.cover, *subject.character));
  }
  if (subject.body && subject.body->made && options.body == "never") {
    return badMesh("{}: its surface is not one closed solid ({}, {}), and --body never was given", subject.name,
                   counted(subject.body->shells, "shell"), counted(subject.body->openEdges, "open edge"));
  }
  if (!options.output.empty()) {
    LORICA_TRY_DO(checkOutput(common, "--output", options.output, ".lorica"));
  }
  if (!options.obj.empty()) {
    LORICA_TRY_DO(checkNotTaken("--export-obj", options.obj, {options.input}));
    LORICA_TRY_DO(checkOutput(common, "--export-obj", options.obj, ".obj"));
  }
  if (!options.picture.empty()) {
    LORICA_TRY_DO(checkOutput(common, "--picture", options.picture, ".png"));
  }
  std::vector<std::filesystem::path> others(options.motions.begin(), options.motions.end());
  others.insert(others.end(), {options.input, options.output, options.obj, options.picture});
  return checkJsonOutput(common, others);
}

/// Says, before any work, which limits give if not all can hold.
void sayWhatGives(const DecomposeOptions& options, const DecomposeSettings& limits, Host& host) {
  std::vector<std::string> kept, given;
  if (!options.cover.exact()) kept.push_back(asTyped(options.cover));
  if (options.maxError > 0.0) given.push_back("--max-error " + percent(limits.maxError));
  if (limits.maxDistance > 0.0) given.push_back(fmt::format("--max-distance {:g}", limits.maxDistance));
  if (options.maxConcavity > 0.0) given.push_back(fmt::format("--max-concavity {:g}", options.maxConcavity));
  if (kept.empty() || given.empty()) return;
  if (limits.maxParts > 0) kept.push_back(fmt::format("--parts {}", limits.maxParts));
  host.warn(fmt::format("hulls of few points are larger: where not all limits can hold, {} will, and {} will not",
                        fmt::join(kept, " and "), fmt::join(given, " and ")));
}

Result<void> run(const DecomposeOptions& options, const CommonOptions& common, Host& host) {
  // Read the input and check the options.
  CharacterOptions reading = options.character;
  reading.body = bodyChoice(options.body);
  LORICA_TRY(const std::vector<Motion> motions, readMotions(options.motions, host));
  reading.suits = [&](const CharacterFile& file) -> Result<void> {
    if (file.isMesh()) return {};
    for (const Motion& motion : motions) {
      LORICA_TRY_DO(checkPerformed(file.character, motion));
    }
    return {};
  };
  LORICA_TRY(const Subject subject, readSubject(options.input, reading, host));
  LORICA_TRY_DO(check(options, common, subject));

  // The poses to fit: one for a mesh, keyframes of motions for a character. Then the poses for choosing a cover.
  DecomposeOutcome outcome;
  outcome.keyframes = Keyframes{subject.mesh.vertices, 1, {}, 0.0};
  outcome.threads = common.threadCount();
  std::optional<CoverPoses> posesToCover;
  std::optional<Training> training;
  if (subject.character) {
    LORICA_TRY(training, trainingMotions(subject, motions, host));
    const std::optional<int> count = options.keyframes != 0 ? std::optional(options.keyframes) : std::nullopt;
    LORICA_TRY(outcome.keyframes, prefixed("--keyframes", trainingKeyframes(*subject.character, *training, count)));
    if (!options.cover.exact() || options.heldOut) {
      LORICA_TRY(posesToCover, coverPoses(*subject.character, training->motions));
    }
  }

  // Decompose and measure.
  DecomposeSettings& settings = outcome.limits;
  outcome.concavityUnit = concavityUnitOf(subject);
  const bool chosen = options.parts > 0 || options.maxError > 0.0 || options.maxDistance > 0.0 ||
                      options.maxConcavity > 0.0 || options.exact;
  settings.maxParts = chosen ? options.parts : subject.character ? kCharacterParts : kMeshParts;
  settings.maxError = options.maxError;
  settings.maxDistance = options.maxDistance;
  settings.maxConcavity = (subject.character || chosen ? options.maxConcavity : kMeshConcavity) * outcome.concavityUnit;
  settings.preset = presetNamed(options.preset);
  settings.candidateEdges = options.candidates;
  settings.planesPerEdge = options.orientations;
  settings.threads = outcome.threads;
  sayWhatGives(options, settings, host);
  const CoverPoses* posesOfCover = posesToCover && !options.cover.exact() ? &*posesToCover : nullptr;
  const FitRequest request{
      subject, outcome.keyframes, posesOfCover, options.cover, !options.obj.empty() || !options.picture.empty(),
      settings};
  LORICA_TRY(Fit found, fitHulls(request, host));
  const Fit& fit = outcome.fit = std::move(found);
  const Decomposition& decomposition = fit.made.decomposition;
  if (fit.cover) {
    outcome.coverVolume = volumeGrowth(*subject.character, decomposition, *posesToCover, *fit.cover);
  }
  if (options.heldOut && subject.character) {
    outcome.heldOut = heldOutError(*subject.character, decomposition, fit.cover, *posesToCover);
  }
  if (!subject.character || !options.obj.empty()) {
    LORICA_TRY_DO(prefixed(subject.name, checkHullsHold(fit.exported, subject.mesh.vertices, verticesToHold(subject))));
  }
  if (host.cancelled()) return cancelled();

  // Write the outputs, each completely or not at all.
  if (!options.output.empty()) {
    LORICA_TRY_DO(writeDecomposition(options.output, fileContent(request, training ? &*training : nullptr, fit)));
  }
  if (!options.obj.empty()) {
    LORICA_TRY_DO(writeMeshes(options.obj, fit.exported.objects));
  }
  if (!options.picture.empty()) {
    LORICA_TRY(SnapshotCamera camera, SnapshotCamera::create(960, 720));
    LORICA_TRY_DO(writePng(options.picture, drawParts(fit.exported.objects, camera)));
  }
  return publish(common, toReport(options, subject, outcome), toJson(options, subject, outcome));
}

}  // namespace

Command addDecompose(CommandLine& parent, CommonOptions& common) {
  const auto options = std::make_shared<DecomposeOptions>();
  CommandLine* app = addSubcommand(
      parent, common, "decompose", "Decompose a mesh or a moving character into nearly convex parts.",
      "  lorica decompose bunny.off --parts 16\n"
      "      16 parts, and how closely their hulls fit the mesh\n"
      "  lorica decompose bunny.off --parts 16 --export-obj hulls.obj\n"
      "      also write each part's hull as an object (o part_0, ...) for other programs\n"
      "  lorica decompose bunny.off --picture parts.png\n"
      "  lorica decompose bunny.off --parts 16 --hull-vertices 32 --export-obj hulls.obj\n"
      "      hulls limited to your engine's vertex count: at most 32 vertices each, slightly larger\n"
      "  lorica decompose bunny.off --parts 16 --preset quality\n"
      "      tighter parts in a few more seconds\n"
      "  lorica decompose bottle.obj\n"
      "      as many parts as it takes to keep it hollow: of at most a concavity of 0.05, CoACD's measure\n"
      "  lorica decompose bunny.off --max-error 5% --parts 64\n"
      "      stop when the hulls have at most 5 % more volume than the mesh, or at 64 parts\n"
      "  lorica decompose bracket.stl --exact\n"
      "      continue until no concave edge is left (Ctrl-C cancels)\n"
      "  lorica decompose mannequin -o body.lorica\n"
      "      16 parts that stay tight in 12 poses of the shipped recordings\n"
      "  lorica decompose hero.glb -o hero.lorica\n"
      "      your own character, trained on its own clips\n"
      "  lorica decompose mannequin --keyframes auto --motion walk --motion dance.csv\n"
      "      trained on the most different poses of both motions\n"
      "  lorica decompose mannequin --hull-vertices 64 -o body.lorica\n"
      "      hulls of at most 64 vertices in every frame, enlarged to contain the body\n"
      "  lorica decompose mannequin --cover 0.002 -o body.lorica\n"
      "      the fewest points that let the surface protrude by at most 2 mm; then the hulls are enlarged\n"
      "  lorica decompose bunny.off --parts 8 --json - | jq .score\n"
      "  lorica decompose scan.ply --parts 16 --export-obj hulls.obj\n"
      "      an open, torn or flipped mesh is repaired, or gets a closed body; the report says which\n"
      "\nThe hulls contain every vertex of the input's surface. Of a mesh, exports have the units and coordinates of\n"
      "the file (glTF: Y up; COLLADA: converted to metres, Y up); of a character, metres, Y up, facing +Z.\n"
      "For a character, --export-obj writes the hulls of its bind pose; with --hull-vertices they are enlarged to\n"
      "contain it. Volumes, score, error and distance are those of the hulls that are exported; for a character\n"
      "those of its live hulls, and volumes, score and error are means over the keyframes. The points of the hull\n"
      "cover are chosen in 128 poses, half of them from the motions and half random within joint limits, and\n"
      "measured in 128 other poses.");
  app->addOption("INPUT", options->input,
                 "Mesh (.off, .obj, .ply, .stl), mesh or character (.glb, .gltf, .vrm, .fbx, .dae), or `mannequin`")
      ->required();
  addCount(*app, "--parts", options->parts, 1,
           "Maximum number of parts; fewer are made if they fit as well [default without limits: 16 for a character, "
           "256 for "
           "a mesh; else none]");
  Option* maxError =
      addShare(*app, "--max-error", options->maxError,
               "Stop when the extra volume of the hulls, relative to the mesh, is at most E: 0.05 or 5%");
  Option* maxDistance = addLength(
      *app, "--max-distance", options->maxDistance,
      "Use the fewest parts with no point of the hulls farther than this from the surface in any keyframe, in "
      "units of the mesh. It gives where --parts or --hull-vertices is in the way; with --max-error, both hold");
  Option* maxConcavity = addShare(
      *app, "--max-concavity", options->maxConcavity,
      "Use the fewest parts whose concavity, as CoACD measures it, is at most E: how far hull and part are from each "
      "other, as a share of half of the mesh's longest side [default: 0.05 for a mesh without another limit]");
  app->addFlag("--exact", options->exact,
               "Cut until every part is convex, but for concave edges less than 0.001 % of the size deep: can take "
               "thousands of parts")
      ->excludes(maxError)
      ->excludes(maxDistance)
      ->excludes(maxConcavity);
  addPresetOption(*app, options->preset);
  addCountOrAuto(*app, "--keyframes", options->keyframes, 1,
                 "Number of poses that a character is trained on, evenly over the motions; `auto` chooses and lists up "
                 "to 12 very different ones [default: 12, or auto for the character's own clips]");
  app->addOption(
         "--motion", options->motions,
         "Take keyframes from this motion; may be repeated [default: the character's own clips, else the shipped "
         "recordings]",
         "FILE")
      ->repeatable();
  addCharacterOptions(*app, options->character);
  addBodyOption(*app, options->body);
  addCount(*app, "--candidates", options->candidates, 1,
           "Concave edges to try for each cut [default: from the preset, 8]");
  addCount(*app, "--orientations", options->orientations, 1,
           "Planes to try at each of these edges [default: from the preset, 3 for fast, else 5]");
  addCover(*app, options->cover.tolerance,
           "Hull cover of a character: `exact` keeps the surface inside the hulls in every pose; a length keeps fewer "
           "points, "
           "so that the surface protrudes by at most this length before the hulls are enlarged [default: exact]");
  addCount(*app, "--hull-vertices", options->cover.hullVertices, 4,
           "Replace each hull by a larger one of at most N vertices, and report the growth; for a character, in every "
           "frame");
  app->addFlag("--held-out", options->heldOut,
               "Also measure the error of a character's hulls in 32 poses that the parts were not trained on");
  app->addOption("-o,--output", options->output, "Write the decomposition, for use with `lorica play`", "FILE.lorica");
  app->addOption("--export-obj", options->obj, "Write the parts' hulls", "FILE.obj");
  app->addOption("--picture", options->picture, "Draw the parts' hulls, each in its colour", "FILE.png");
  return {app, [options](const CommonOptions& given, Host& host) { return run(*options, given, host); }};
}

}  // namespace lorica

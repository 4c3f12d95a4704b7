#include "acd/decompose.h"
#include "acd/decomposition_file.h"
#include "acd/level_of_detail.h"
#include "apps/option_groups.h"
#include "apps/options.h"
#include "apps/report.h"
#include "apps/report_parts.h"
#include "collision/hulls/cover_choice.h"
#include "collision/hulls/frame_hulls.h"
#include "collision/hulls/hull_fit.h"
#include "collision/hulls/mesh_subject.h"
#include "collision/hulls/quality.h"
#include "export/frame_hulls_file.h"
#include "export/mesh_export.h"
#include "geometry/arrays/mesh_sequence.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "session/prepare/body.h"
#include "session/prepare/subject.h"
#include "session/prepare/training_motions.h"
#include "skinning/import/character_file.h"
#include "viewer/pictures/image_files.h"
#include "viewer/player/parts_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {
namespace {

/// What the user asked `lorica decompose` for.
struct DecomposeOptions {
  std::vector<std::string> inputs;  ///< several: the frames of a sequence
  std::string decomposition;        ///< parts that were made before; empty = none
  int parts = 0;                    ///< 0 = not given
  double maxError = 0.0;            ///< 0 = not given
  double maxDistance = 0.0;         ///< 0 = not given
  double maxConcavity = 0.0;        ///< 0 = not given
  bool exact = false;               ///< until no concave edge is left
  int keyframes = 0;                ///< 0 = not given, kAuto = to be chosen
  std::vector<std::string> motions;
  CharacterOptions character;
  std::string body = "auto";
  std::string preset = "fast";
  int candidates = 0;    ///< 0 = the preset's
  int orientations = 0;  ///< 0 = the preset's
  CoverRequest cover;    ///< for a mesh, only the vertex limit is used
  bool heldOut = false;  ///< measure a character's error in other poses too
  std::string output;
  std::string obj;
  std::string picture;
  std::string up = "auto";
  std::string frames, csv;  ///< hulls of all frames, and a table of them

  [[nodiscard]] const std::string& input() const { return inputs.front(); }
};

/// Everything that `lorica decompose` found.
struct DecomposeOutcome {
  Fit fit;
  Keyframes keyframes;
  DecomposeSettings limits;
  double concavityUnit = 0.0;  ///< see concavityUnitOf()
  double coverVolume = 0.0;    ///< of a character's cover, relative to exact hulls: volumeGrowth()
  int threads = 0;
  std::optional<HeldOutError> heldOut = std::nullopt;  ///< if it was asked for
  std::optional<FrameHulls> frames = std::nullopt;     ///< of a sequence, or if they are written
  WrittenFrames written = {};
  std::optional<double> anew = std::nullopt;  ///< error of as many parts of its own, if it has those of another mesh
  UpAxis up = UpAxis::kY;                     ///< in the picture
};

/// How well the hulls fit in all frames.
struct FrameErrors {
  double mean = 0.0, worst = 0.0, unseen = 0.0;
  std::size_t worstAt = 0;  ///< frame
  int unseenCount = 0;      ///< frames that are no keyframes
};

FrameErrors errorsOf(const FrameHulls& frames, PoseView keyframes) {
  FrameErrors errors;
  errors.mean = meanErrorOf(frames.errors);
  const std::vector<int> seen = keyframesAmong(frames, keyframes);
  for (std::size_t f = 0; f < frames.errors.size(); ++f) {
    const double error = frames.errors[f].relative();
    if (error > errors.worst) std::tie(errors.worst, errors.worstAt) = std::pair(error, f);
    if (std::ranges::binary_search(seen, static_cast<int>(f))) continue;
    errors.unseen += error;
    ++errors.unseenCount;
  }
  if (errors.unseenCount > 0) errors.unseen /= errors.unseenCount;
  return errors;
}

/// Figures of all frames.
Facts frameFacts(const DecomposeOptions& options, const DecomposeOutcome& outcome, int vertexCount) {
  Facts facts;
  if (outcome.anew) {
    facts.add("errorAnew", "parts of its own", *outcome.anew,
              fmt::format("{} more volume with as many parts that are made for it", percent(*outcome.anew)));
  }
  if (!outcome.frames) return facts;
  const FrameHulls& frames = *outcome.frames;
  const FrameErrors errors = errorsOf(frames, {outcome.keyframes.positions, vertexCount});
  facts.add("frames", "frames", frames.errors.size(),
            fmt::format("{}, error {}, at most {} (frame {})", frames.errors.size(), percent(errors.mean),
                        percent(errors.worst), errors.worstAt));
  facts.add("frameError", errors.mean);
  if (errors.unseenCount > 0) {
    facts.add(
        "unseenError", "unseen frames", errors.unseen,
        fmt::format("{} in {} that are no keyframes", percent(errors.unseen), counted(errors.unseenCount, "frame")));
    facts.add("unseenFrames", errors.unseenCount);
  }
  Json volumes = Json::array(), hulls = Json::array(), relative = Json::array(), scores = Json::array();
  for (const PoseError& error : frames.errors) {
    volumes.push_back(error.meshVolume);
    hulls.push_back(error.hullVolume);
    relative.push_back(error.relative());
    scores.push_back(error.meshVolume / error.hullVolume);
  }
  facts.add("frameTimes", frames.times);
  facts.add("frameMeshVolumes", std::move(volumes));
  facts.add("frameHullVolumes", std::move(hulls));
  facts.add("frameErrors", std::move(relative));
  facts.add("frameScores", std::move(scores));
  if (!options.frames.empty()) {
    const int moved = countOf(frames.hulls.front()) - outcome.written.rigid;
    facts.add("exportFrames", "hulls of frames", options.frames,
              fmt::format("{} in {}{}", options.frames, counted(outcome.written.files, "file"),
                          outcome.written.rigid > 0 ? fmt::format("; {} moved by a node, {} by morph targets",
                                                                  counted(outcome.written.rigid, "part"), moved)
                                                    : ""));
  }
  if (!options.csv.empty()) facts.add("csv", "table of frames", options.csv, options.csv);
  return facts;
}

/// What the decomposition stopped at: "error", "distance", "limits" if both were given, "parts", "convex", or
/// "vertices": hulls of so few vertices do not get better with more parts.
std::string endedBy(const DecomposeOutcome& outcome) {
  const auto& [fit, keyframes, limits, unit, coverVolume, threads, heldOut, frames, written, anew, up] = outcome;
  const int given = (limits.maxError > 0.0) + (limits.maxDistance > 0.0) + (limits.maxConcavity > 0.0);
  if (given > 0 && fit.met(limits)) {
    return given > 1                   ? "limits"
           : limits.maxError > 0.0     ? "error"
           : limits.maxConcavity > 0.0 ? "concavity"
                                       : "distance";
  }
  if (fit.stalled) return "vertices";
  return countOf(fit.made.decomposition.parts) == limits.maxParts ? "parts" : "convex";
}

/// "the limit of 8 parts was reached; an error of 5.0 % was not"
std::string endingSentence(const DecomposeOutcome& outcome) {
  const auto& [fit, keyframes, limits, unit, coverVolume, threads, heldOut, frames, written, anew, up] = outcome;
  const std::string by = endedBy(outcome);
  const bool reached = by == "error" || by == "distance" || by == "concavity" || by == "limits";
  std::vector<std::string> named;
  if (limits.maxError > 0.0 && fit.errorMet(limits) == reached) {
    named.push_back("an error of " + percent(limits.maxError));
  }
  if (limits.maxDistance > 0.0 && fit.distanceMet(limits) == reached) {
    named.push_back(fmt::format("a distance of {:g}", limits.maxDistance));
  }
  if (limits.maxConcavity > 0.0 && fit.concavityMet(limits) == reached) {
    named.push_back(fmt::format("a concavity of {:.3g}", limits.maxConcavity / unit));
  }
  const std::string these = fmt::format("{} {}", fmt::join(named, " and "), named.size() == 1 ? "was" : "were");
  if (reached) return these + " reached";
  if (by == "parts") return fmt::format("the limit of {} was reached; {} not", counted(limits.maxParts, "part"), these);
  if (by == "vertices") return fmt::format("more parts no longer make such hulls tighter; {} not reached", these);
  return fmt::format("no useful cut is left; {} not reached", these);
}

/// "at most 32, before 2,023; volume +2.5 %, at most +4.4 % (part 7)"
std::string growthInWords(const PartHulls& hulls) {
  if (hulls.totalGrowth == 1.0) {
    return fmt::format("at most {}, unchanged", grouped(hulls.maxVertices));
  }
  const auto worst = std::max_element(hulls.growth.begin(), hulls.growth.end());
  return fmt::format("at most {}, before {}; volume +{}, at most +{} (part {})", grouped(hulls.maxVertices),
                     grouped(hulls.maxVerticesBefore), percent(hulls.totalGrowth - 1.0), percent(*worst - 1.0),
                     worst - hulls.growth.begin());
}

/// Whether hulls in a single pose are simplified: those of a mesh, and those of the exported bind pose. For a character
/// in motion see HullCover.
bool boundsHulls(const DecomposeOptions& options, const Subject& subject) {
  return options.cover.budget().given() && (!subject.character || !options.obj.empty());
}

Report decomposeReport(const DecomposeOptions& options, const Subject& subject, const DecomposeOutcome& outcome) {
  const auto& [fit, keyframes, limits, unit, coverVolume, threads, heldOut, frames, written, anew, up] = outcome;
  const auto& [made, attached, held, hulls, cover, used, quality, distance, concavity, stalled] = fit;
  const bool character = subject.character.has_value();
  Report report(fmt::format("{}: {}", subject.name, counted(made.decomposition.parts.size(), "convex part")),
                "input parts meshVolume hullVolume score error endedBy maxError maxDistance maxConcavity concavity "
                "meanConcavity distance seconds threads vertices repaired walls body attachedVertices hash");
  report.add("input", subject.name);
  report.add("parts", made.decomposition.parts.size());
  report.add("vertices", "mesh", subject.mesh.vertices.size(),
             fmt::format("{}, {}", counted(std::ssize(subject.mesh.vertices), "vertex", "vertices"),
                         counted(std::ssize(subject.mesh.triangles), "triangle")));
  report.add(meshFacts(subject));
  if (!subject.held.empty()) report.add("attachedVertices", attached);
  if (attached > 0 && !character) {
    report.line("attached", fmt::format("{} that no part contains: the hulls were enlarged to hold them",
                                        counted(attached, "vertex", "vertices")));
  }
  const std::string mean = character ? ", mean over the keyframes" : "";
  report.add("meshVolume", "volume", quality.meshVolume,
             fmt::format("{:.6g}, hulls {:.6g}{}", quality.meshVolume, quality.hullVolume, mean));
  report.add("hullVolume", quality.hullVolume);
  const bool walls = subject.rebuilt && subject.rebuilt->shells > 0;
  report.add("error", "error", quality.error,
             walls ? "" : fmt::format("hulls have {} more volume than the mesh{}", percent(quality.error), mean));
  if (character) {
    const std::vector<double>& errors = quality.errorPerKeyframe;
    const auto [best, worst] = std::ranges::minmax(errors);
    report.add("keyframes", "keyframes", errors.size(),
               fmt::format("{}, error from {} to {}", errors.size(), percent(best), percent(worst)));
    report.add("errorPerKeyframe", errors);
  }
  if (!keyframes.chosen.empty()) {
    Json chosen;
    Table table{{"frame", "time [s]", "error", "motion"}, {}, 3};
    for (std::size_t k = 0; k < keyframes.chosen.size(); ++k) {
      const auto& [motion, frame, time] = keyframes.chosen[k];
      chosen.push_back({{"motion", motion}, {"frame", frame}, {"time", time}});
      table.rows.push_back(
          {std::to_string(frame), fmt::format("{:.2f}", time), percent(quality.errorPerKeyframe[k]), motion});
    }
    report.add("chosenKeyframes", std::move(chosen));
    report.table(std::move(table));
  }
  if (heldOut) {
    report.add("heldOutError", "held-out error", heldOut->error,
               fmt::format("{} in {} that the parts were not trained on", percent(heldOut->error),
                           counted(heldOut->poses, "pose")));
    report.add("heldOutPoses", heldOut->poses);
  }
  report.add(frameFacts(options, outcome, countOf(subject.mesh.vertices)));
  if (distance) {
    report.add("distance", "distance", *distance,
               fmt::format("at most {:.4g} from the hulls to the surface of their parts{}", *distance,
                           character ? ", in the worst keyframe" : ""));
  }
  if (concavity) {
    report.add("maxConcavity", limits.maxConcavity / unit);
    report.add("concavity", "concavity", concavity->largest / unit,
               fmt::format("at most {:.4f}, mean of the parts {:.4f}, in halves of the longest side",
                           concavity->largest / unit, concavity->mean / unit));
    report.add("meanConcavity", concavity->mean / unit);
  }
  const bool limited = limits.maxError > 0.0 || limits.maxDistance > 0.0 || limits.maxConcavity > 0.0;
  Json warnings = Json::array();
  if (std::string doubt = doubtAboutHulls(quality.error); !doubt.empty()) warnings.push_back(std::move(doubt));
  report.add("warnings", std::move(warnings));
  report.add("endedBy", "stopped because", endedBy(outcome), limited ? endingSentence(outcome) : "");
  if (limits.maxError > 0.0) report.add("maxError", limits.maxError);
  if (limits.maxDistance > 0.0) report.add("maxDistance", limits.maxDistance);
  report.add("score", "score", quality.score,
             walls ? "" : fmt::format("{:.4f} (Eq. 17: mesh volume / hull volume, 1 is perfect)", quality.score));
  report.add("seconds", "time", made.seconds, fmt::format("{:.2f} s on {}", made.seconds, counted(threads, "thread")));
  report.add("threads", threads);
  report.add("hash", "hash", hexDigits(hashOf(made.decomposition)));
  if (character) report.add(coverFacts(cover, cover ? std::optional(coverVolume) : std::nullopt));
  if (options.cover.hullVertices > 0) report.add("hullVertices", options.cover.hullVertices);
  if (options.cover.hullPlanes > 0) report.add("hullPlanes", "hull planes", options.cover.hullPlanes);
  if (boundsHulls(options, subject)) {
    report.add("hullGrowth", character ? "exported hulls" : "hull vertices", hulls.totalGrowth,
               growthInWords(hulls) + (character ? ", in the bind pose" : ""));
    report.add("hullGrowthPerPart", hulls.growth);
  }
  if (!options.output.empty()) report.add("output", "output", options.output);
  if (!options.obj.empty()) {
    report.add(
        "exportObj", "hulls", options.obj,
        options.obj + (character ? ", in metres, Y up, facing +Z" : ", in the units and coordinates of the input"));
  }
  if (!options.picture.empty()) {
    const char* axis = up == UpAxis::kZ ? ", with Z up (--up y turns it)" : ", with Y up (--up z turns it)";
    report.add("picture", "picture", options.picture, options.picture + axis);
  }
  if (options.output.empty() && options.obj.empty() && options.picture.empty() && options.frames.empty()) {
    report.note("Nothing was written: --picture draws the parts, --export-obj and -o write them.");
  }
  if (!keyframes.chosen.empty()) {
    report.note(fmt::format(
        "These keyframes were chosen: every frame is within {:.2f} m of one of them (root mean square over the body).",
        keyframes.farthest));
  }
  return report;
}

constexpr int kCharacterParts = 16;
constexpr int kMeshParts = 256;
constexpr double kMeshConcavity = 0.05;
static_assert(kAuto == kChooseKeyframes, "--keyframes auto is passed on as it is");

/// The motions whose frames get hulls: all frames of a sequence; of another character, if they are asked for, those
/// that the parts are trained on. Refuses files that cannot be written.
Result<std::vector<SkeletalMotion>> framesToMeasure(const DecomposeOptions& options, const CommonOptions& common,
                                                    const Subject& subject, const Training& training) {
  std::vector<SkeletalMotion> motions;
  for (const Clip& clip : subject.clips()) {
    if (clip.framesPerSecond <= 0.0) continue;
    LORICA_TRY(SkeletalMotion motion, framesOf(subject.character->skeleton, clip));
    motions.push_back(std::move(motion));
  }
  if (motions.empty() && (!options.frames.empty() || !options.csv.empty())) motions = training.motions;
  if (options.frames.empty()) return motions;
  int count = 0;
  for (const SkeletalMotion& motion : motions) count += motion.frameCount();
  for (const std::filesystem::path& file : filesOfFrames(options.frames, count)) {
    LORICA_TRY_DO(checkNotTaken("--export-frames", file, {options.inputs.begin(), options.inputs.end()}));
    LORICA_TRY_DO(checkOutput(common, "--export-frames", file));
  }
  return motions;
}

/// One input, or the frames of a sequence.
Result<Subject> readInputs(const std::vector<std::string>& inputs, const CharacterOptions& reading, Host& host) {
  if (inputs.size() == 1) return readSubject(inputs.front(), reading, host);
  const std::vector<std::filesystem::path> files(inputs.begin(), inputs.end());
  const std::string folder = files.front().parent_path().filename().string();
  Result<MeshSequence> sequence = readMeshSequence(folder.empty() ? "frames" : folder, files);
  if (!sequence) {
    Error error = sequence.error();
    if (error.code == ErrorCode::kBadMesh) error.message += "; several files are one mesh in several poses";
    return error;
  }
  return sequenceSubject(std::move(*sequence), reading, host);
}

/// Rejects, before any work, options that do not fit the input and outputs that cannot be written.
Result<void> checkDecompose(const DecomposeOptions& options, const CommonOptions& common, const Subject& subject) {
  if (!subject.character && (options.keyframes != 0 || !options.motions.empty())) {
    return invalidArgument("{} is for characters, but {} is a static mesh",
                           options.keyframes != 0 ? "--keyframes" : "--motion", subject.name);
  }
  if (!subject.character && options.cover.tolerance) {
    return invalidArgument("--cover is for characters, but {} is a static mesh", subject.name);
  }
  if (subject.character) {
    LORICA_TRY_DO(checkCover(options.cover, *subject.character));
    if (options.cover.hullPlanes > 0 && options.obj.empty()) {
      return invalidArgument(
          "--hull-planes {} is for hulls in one pose, but {} moves: expected --export-obj, or --hull-vertices",
          options.cover.hullPlanes, subject.name);
    }
  }
  if (subject.body && subject.body->made && options.body == "never") {
    return badMesh("{}: its surface is not one closed solid ({}, {}), and --body never was given", subject.name,
                   counted(subject.body->shells, "shell"), counted(subject.body->openEdges, "open edge"));
  }
  if (!options.output.empty()) LORICA_TRY_DO(checkOutput(common, "--output", options.output, ".lorica"));
  if (!options.obj.empty()) {
    LORICA_TRY_DO(checkNotTaken("--export-obj", options.obj, {options.input()}));
    LORICA_TRY_DO(checkOutput(common, "--export-obj", options.obj, ".obj"));
  }
  if (!options.picture.empty()) LORICA_TRY_DO(checkOutput(common, "--picture", options.picture, ".png"));
  if (!options.frames.empty() || !options.csv.empty()) {
    if (!subject.character) {
      return invalidArgument("{} is for what moves, but {} is a static mesh",
                             options.frames.empty() ? "--csv" : "--export-frames", subject.name);
    }
    if (!options.cover.exact() || options.cover.hullPlanes > 0) {
      return invalidArgument("the hulls of frames are exact: expected no {}", asTyped(options.cover));
    }
  }
  if (!options.csv.empty()) LORICA_TRY_DO(checkOutput(common, "--csv", options.csv, ".csv"));
  if (!options.frames.empty()) LORICA_TRY_DO(checkFrameFile(options.frames));
  std::vector<std::filesystem::path> others(options.motions.begin(), options.motions.end());
  others.insert(others.end(), options.inputs.begin(), options.inputs.end());
  others.insert(others.end(), {options.output, options.obj, options.picture, options.csv});
  return checkJsonOutput(common, others);
}

/// Says, before any work, which limits give if not all can hold.
void sayWhatGives(const DecomposeOptions& options, const DecomposeSettings& limits, Host& host) {
  std::vector<std::string> kept, given;
  if (!options.cover.exact() || options.cover.hullPlanes > 0) kept.push_back(asTyped(options.cover));
  if (options.maxError > 0.0) given.push_back("--max-error " + percent(limits.maxError));
  if (limits.maxDistance > 0.0) given.push_back(fmt::format("--max-distance {:g}", limits.maxDistance));
  if (options.maxConcavity > 0.0) given.push_back(fmt::format("--max-concavity {:g}", options.maxConcavity));
  if (kept.empty() || given.empty()) return;
  if (limits.maxParts > 0) kept.push_back(fmt::format("--parts {}", limits.maxParts));
  host.warn(fmt::format("simpler hulls are larger: where not all limits can hold, {} will, and {} will not",
                        fmt::join(kept, " and "), fmt::join(given, " and ")));
}

UpAxis upInPicture(const DecomposeOptions& options, const Subject& subject, std::span<const NamedMesh> parts) {
  const bool known = subject.character || isCharacterFile(options.input());
  if (options.up == "auto") return known ? UpAxis::kY : likelyUp(parts);
  return options.up == "z" ? UpAxis::kZ : UpAxis::kY;
}

Result<void> runDecompose(const DecomposeOptions& options, const CommonOptions& common, Host& host) {
  // Read the input and check the options.
  CharacterOptions reading = options.character;
  reading.body = bodyChoice(options.body);
  LORICA_TRY(const std::vector<Motion> motions, readMotions(options.motions, host));
  reading.suits = [&](const CharacterFile& file) -> Result<void> {
    if (file.isMesh()) return {};
    for (const Motion& motion : motions) LORICA_TRY_DO(checkPerformed(file.character, motion));
    return {};
  };
  LORICA_TRY(const Subject subject, readInputs(options.inputs, reading, host));
  LORICA_TRY_DO(checkDecompose(options, common, subject));

  // The poses to fit: one for a mesh, keyframes of motions for a character. Then the poses for choosing a cover.
  DecomposeOutcome outcome;
  outcome.keyframes = Keyframes{subject.mesh.vertices, 1, {}, 0.0};
  outcome.threads = common.threadCount();
  std::optional<CoverPoses> posesToCover;
  std::optional<Training> training;
  std::vector<SkeletalMotion> frames;  // that get hulls of their own
  if (subject.character) {
    LORICA_TRY(training, trainingMotions(subject, motions));
    const std::optional<int> count = options.keyframes != 0 ? std::optional(options.keyframes) : std::nullopt;
    LORICA_TRY(outcome.keyframes, prefixed("--keyframes", trainingKeyframes(*subject.character, *training, count)));
    LORICA_TRY(frames, framesToMeasure(options, common, subject, *training));
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
  if (options.decomposition.empty()) {
    LORICA_TRY(outcome.fit, fitHulls(request, host));
  } else {
    LORICA_TRY(DecompositionFile given, readDecompositionOf(subject, options.decomposition));
    LORICA_TRY(outcome.fit, fitOf(request, {std::move(given.decomposition), 0.0}, host));
    FitRequest own = request;
    own.settings.maxParts = countOf(outcome.fit.made.decomposition.parts);
    own.settings.maxConcavity = 0.0;
    LORICA_TRY(const Fit anew, fitHulls(own, host));
    outcome.anew = anew.quality.error;
  }
  const Fit& fit = outcome.fit;
  const Decomposition& decomposition = fit.made.decomposition;
  if (fit.cover) outcome.coverVolume = volumeGrowth(*subject.character, decomposition, *posesToCover, *fit.cover);
  if (options.heldOut && subject.character) {
    outcome.heldOut = heldOutError(*subject.character, decomposition, fit.cover, *posesToCover);
  }
  if (!subject.character || !options.obj.empty()) {
    LORICA_TRY_DO(prefixed(subject.name, checkHullsHold(fit.exported, subject.mesh.vertices, verticesToHold(subject))));
  }
  if (!frames.empty()) {
    Task task(host, "Hulls of the frames", "frames");
    LORICA_TRY(outcome.frames, hullsOfFrames(*subject.character, fit.held, frames, settings.threads, task.progress()));
  }
  if (host.cancelled()) return cancelled();
  if (const std::string doubt = doubtAboutHulls(fit.quality.error); !doubt.empty()) host.warn(doubt);

  // Write the outputs, each completely or not at all.
  if (!options.output.empty()) {
    LORICA_TRY_DO(writeDecomposition(options.output, fileContent(request, training ? &*training : nullptr, fit)));
  }
  if (!options.obj.empty()) LORICA_TRY_DO(writeMeshes(options.obj, fit.exported.objects));
  if (!options.picture.empty()) {
    LORICA_TRY(SnapshotCamera camera, SnapshotCamera::create(960, 720));
    outcome.up = upInPicture(options, subject, fit.exported.objects);
    LORICA_TRY_DO(writePng(options.picture, drawParts(fit.exported.objects, outcome.up, camera)));
  }
  if (!options.frames.empty()) {
    LORICA_TRY(outcome.written, writeFrameHulls(options.frames, *outcome.frames, fit.held));
  }
  if (!options.csv.empty()) LORICA_TRY_DO(writeFileAtomically(options.csv, formatFrameTable(*outcome.frames)));
  return publish(common, decomposeReport(options, subject, outcome));
}

}  // namespace

Command addDecompose(CLI::App& parent, CommonOptions& common) {
  const auto options = std::make_shared<DecomposeOptions>();
  CLI::App* app = addSubcommand(
      parent, common, "decompose",
      "Cut a mesh or a moving character into convex parts, for collision in physics engines.",
      "  lorica decompose bunny.off --parts 16\n"
      "      16 parts, and how closely their hulls fit the mesh\n"
      "  lorica decompose bunny.off --parts 16 --export-obj hulls.obj\n"
      "      also write each part's hull as an object (o part_0, ...) for other programs\n"
      "  lorica decompose bunny.off --picture parts.png\n"
      "  lorica decompose bunny.off --parts 16 --hull-vertices 32 --export-obj hulls.obj\n"
      "      hulls limited to your engine's vertex count: at most 32 vertices each, slightly larger\n"
      "  lorica decompose bunny.off --parts 16 --hull-planes 18 --export-obj hulls.obj\n"
      "      hulls of at most 18 flat faces each, for engines and maps that clip with planes\n"
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
      "  lorica decompose 'frames/*.obj' --parts 12 -o horse.lorica --export-frames hulls.glb\n"
      "      a mesh in several poses: parts from its most different frames, hulls of all (docs/SEQUENCES.md)\n"
      "  lorica decompose camel.npz --decomposition horse.lorica --csv errors.csv\n"
      "      the same parts on another motion of the same mesh\n"
      "  lorica decompose bunny.off --parts 8 --json - | jq .score\n"
      "  lorica decompose scan.ply --parts 16 --export-obj hulls.obj\n"
      "      an open, torn or flipped mesh is repaired, or gets a closed body; the report says which\n"
      "\nThe hulls contain every vertex of the input's surface. Of a mesh, exports have the units and coordinates of\n"
      "the file (glTF: Y up; COLLADA: converted to metres, Y up); of a character, metres, Y up, facing +Z.\n"
      "For a character, --export-obj writes the hulls of its bind pose; with --hull-vertices or --hull-planes they are "
      "enlarged to\n"
      "contain it. Volumes, score, error and distance are those of the hulls that are exported; for a character\n"
      "those of its live hulls, and volumes, score and error are means over the keyframes. The points of the hull\n"
      "cover are chosen in 128 poses, half of them from the motions and half random within joint limits, and\n"
      "measured in 128 other poses.");
  app->add_option("INPUT", options->inputs,
                  "Mesh (.off, .obj, .ply, .stl), mesh or character (.glb, .gltf, .vrm, .fbx, .dae), `mannequin`, or a "
                  "mesh in several poses: a folder or 'pattern*.obj' of meshes, .npz, .pc2, .mdd or .npy")
      ->required();
  addCount(*app, "--parts", options->parts, 1,
           "Maximum number of parts; fewer are made if they fit as well [default without limits: 16 for a character, "
           "256 for a mesh; else none]");
  CLI::Option* maxError =
      addShare(*app, "--max-error", options->maxError,
               "Stop when the extra volume of the hulls, relative to the mesh, is at most E: 0.05 or 5%");
  CLI::Option* maxDistance = addLength(
      *app, "--max-distance", options->maxDistance,
      "Use the fewest parts with no point of the hulls farther than this from the surface in any keyframe, in units of "
      "the mesh. It gives where --parts or --hull-vertices is in the way; with --max-error, both hold");
  CLI::Option* maxConcavity = addShare(
      *app, "--max-concavity", options->maxConcavity,
      "Use the fewest parts whose concavity, as CoACD measures it, is at most E: how far hull and part are from each "
      "other, as a share of half of the mesh's longest side [default: 0.05 for a mesh without another limit]");
  app->add_flag("--exact", options->exact,
                "Cut until every part is convex, but for concave edges less than 0.001 % of the size deep: can take "
                "thousands of parts")
      ->excludes(maxError)
      ->excludes(maxDistance)
      ->excludes(maxConcavity);
  addPresetOption(*app, options->preset);
  addCountOrAuto(*app, "--keyframes", options->keyframes, 1,
                 "Number of poses that a character is trained on, evenly over the motions; `auto` chooses and lists up "
                 "to 12 very different ones [default: 12, or auto for the character's own clips]");
  addRepeated(*app, "--motion", options->motions, "FILE",
              "Take keyframes from this motion; may be repeated [default: the character's own clips, else the shipped "
              "recordings]");
  addCharacterOptions(*app, options->character);
  addBodyOption(*app, options->body);
  addCount(*app, "--candidates", options->candidates, 1,
           "Concave edges to try for each cut [default: from the preset, 8]");
  addCount(*app, "--orientations", options->orientations, 1,
           "Planes to try at each of these edges [default: from the preset, 3 for fast, else 5]");
  addCover(
      *app, options->cover.tolerance,
      "Hull cover of a character: `exact` keeps the surface inside the hulls in every pose; a length keeps fewer "
      "points, so that the surface protrudes by at most this length before the hulls are enlarged [default: exact]");
  addCount(*app, "--hull-vertices", options->cover.hullVertices, 4,
           "Replace each hull by a larger one of at most N vertices, and report the growth; for a character, in every "
           "frame");
  addHullPlanes(*app, options->cover.hullPlanes);
  app->add_flag("--held-out", options->heldOut,
                "Also measure the error of a character's hulls in 32 poses that the parts were not trained on");
  addOption(*app, "-o,--output", options->output, "FILE.lorica", "Write the decomposition, for use with `lorica play`");
  addOption(*app, "--export-obj", options->obj, "FILE.obj", "Write the parts' hulls");
  addOption(*app, "--decomposition", options->decomposition, "FILE.lorica",
            "Use these parts, of another mesh with the same triangles, and compare them with as many of its own")
      ->excludes("--parts")
      ->excludes(maxError)
      ->excludes(maxDistance)
      ->excludes(maxConcavity);
  addOption(*app, "--export-frames", options->frames, "FILE",
            "Write the hulls of every frame of a sequence, or of the motions: .obj (a file a frame), .npz, .pc2, or "
            ".glb, which plays them");
  addOption(*app, "--csv", options->csv, "FILE.csv", "Write volumes, error and score of every frame");
  CLI::Option* picture = app->add_option("--picture", options->picture, "Draw the parts' hulls, each in its colour");
  picture->type_name("FILE.png");
  addOption(
      *app, "--up", options->up, "AXIS",
      "Axis that is up in the picture: `auto` = the one on which a mesh stands broad, Y if in doubt [default: auto]")
      ->transform(oneOf({"auto", "y", "z"}))
      ->needs(picture);
  return {app, [options](const CommonOptions& given, Host& host) { return runDecompose(*options, given, host); }};
}

}  // namespace lorica

#include "acd/score.h"
#include "apps/option_groups.h"
#include "apps/options.h"
#include "apps/report_parts.h"
#include "collision/hulls/frame_hulls.h"
#include "collision/hulls/hull_fit.h"
#include "geometry/arrays/mesh_sequence.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/mesh_files.h"
#include "geometry/text.h"
#include "session/prepare/body.h"
#include "session/prepare/motion.h"
#include "session/prepare/subject.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <tuple>

namespace lorica {
namespace {

// Parts are suspicious if their bounding box differs by more than this fraction of the mesh's diagonal, or if they
// leave more than this fraction of its volume uncovered.
constexpr double kBoxesApart = 0.2;
constexpr double kUncovered = 0.5;

struct ScoreOptions {
  std::string mesh;
  std::string parts;
  CharacterOptions reading;  // which meshes are hidden
  int every = 1;             // of a sequence, the frames that are scored
  std::string csv;           // of a sequence, a table of them
};

/// @param label  "surface to hulls"
void add(Report& report, const char* json, const char* label, const Distances& distances) {
  report.add(json, label, {{"mean", distances.mean}, {"most", distances.most}, {"largest", distances.largest}},
             fmt::format("mean {:.4g}, 95 % at most {:.4g}, largest {:.4g}", distances.mean, distances.most,
                         distances.largest));
}

Report scoreReport(const ScoreOptions& options, const Subject& subject, std::size_t partCount, const Score& score) {
  Report report(fmt::format("{} in {}", options.mesh, counted(partCount, "part")));
  report.add(meshFacts(subject));
  report.add("parts", partCount);
  if (subject.rebuilt && subject.rebuilt->shells > 0) {
    for (const char* name : {"score16", "score16StandardError", "score17"}) report.add(name, nullptr);
    report.line("score", "Eq. 16 and 17 are for solids; the distances tell how well thin walls are held");
  } else {
    const char* body = subject.rebuilt ? "; of the closed body that was made" : "";
    report.add("score16", "score, Eq. 16", score.score16,
               fmt::format("{:.4f} +- {:.4f} (intersection over union, overlaps counted repeatedly{})", score.score16,
                           score.score16StandardError, body));
    report.add("score16StandardError", score.score16StandardError);
    report.add("score17", "score, Eq. 17", score.score17,
               fmt::format("{:.4f} (mesh volume / sum of hull volumes{})", score.score17, body));
  }
  report.add("distance", "distance, Eq. 18", score.distance,
             fmt::format("{:.6g}, {:.3f} % of the diagonal (surface to the nearest hull)", score.distance,
                         score.distancePercentDiagonal));
  report.add("distancePercentDiagonal", score.distancePercentDiagonal);
  report.add("uncoveredFraction", score.uncoveredFraction);
  add(report, "surfaceToHulls", "surface to hulls", score.toHulls);
  add(report, "hullsToSurface", "hulls to surface", score.toSurface);
  report.add("concavity", "concavity", score.concavity,
             fmt::format("at most {:.4f}, mean of the parts {:.4f} (CoACD's, in halves of the longest side)",
                         score.concavity, score.meanConcavity));
  report.add("meanConcavity", score.meanConcavity);
  report.line("uncovered",
              fmt::format("{:.2f} % of the mesh's volume is outside all hulls", 100 * score.uncoveredFraction));
  return report;
}

/// A warning if the hulls cover less than half the mesh or extend beyond it; else empty.
std::string doubtAbout(const TriMesh& mesh, std::span<const TriMesh> parts, const Score& score) {
  const Aabb meshBox = surfaceBounds(mesh);
  Aabb partsBox;
  for (const TriMesh& part : parts) {
    for (const Vec3& p : part.vertices) partsBox.extend(p);
  }
  // Hulls that cover a mesh have nearly the same bounds.
  const double apart =
      std::max((meshBox.min - partsBox.min).cwiseAbs().maxCoeff(), (meshBox.max - partsBox.max).cwiseAbs().maxCoeff());
  if (apart <= kBoxesApart * meshBox.diagonal() && score.uncoveredFraction <= kUncovered) return "";
  const auto text = [](const Aabb& box) {
    return fmt::format("({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g})", box.min.x(), box.min.y(), box.min.z(),
                       box.max.x(), box.max.y(), box.max.z());
  };
  return fmt::format(
      "these may be parts of another mesh, or have another position, unit or pose: their bounds are {}, those of the "
      "mesh {}; {} of the mesh is outside all parts",
      text(partsBox), text(meshBox), percent(score.uncoveredFraction));
}

/// The parts of a sequence in every frame: of a decomposition that is carried to all, or a file of parts each.
Result<std::vector<std::vector<TriMesh>>> partsOfFrames(const ScoreOptions& options, const Subject& subject,
                                                        const SkeletalMotion& motion, Host& host) {
  std::vector<std::vector<TriMesh>> frames;
  if (std::filesystem::path(options.parts).extension() != ".lorica") {
    LORICA_TRY(const std::vector<std::filesystem::path> files, meshesOf(options.parts));
    for (const std::filesystem::path& file : files) {
      LORICA_TRY(std::vector<NamedMesh> objects, readObjObjects(file));
      std::vector<TriMesh>& parts = frames.emplace_back();
      for (NamedMesh& object : objects) parts.push_back(std::move(object.mesh));
    }
    if (countOf(frames) == motion.frameCount()) return frames;
    return invalidArgument("{}: {}, expected {}, one for each frame of {}", options.parts,
                           counted(std::ssize(frames), "file"), motion.frameCount(), options.mesh);
  }
  LORICA_TRY(DecompositionFile given, readDecompositionOf(subject, options.parts));
  LORICA_TRY(const Training training, trainingMotions(subject, {}));
  LORICA_TRY(const Keyframes keyframes, trainingKeyframes(*subject.character, training, 1));
  LORICA_TRY(const Fit fit,
             fitOf({subject, keyframes, nullptr, {}, false, {}}, {std::move(given.decomposition), 0.0}, host));
  Task task(host, "Hulls of the frames", "frames");
  LORICA_TRY(FrameHulls hulls,
             hullsOfFrames(*subject.character, fit.held, std::span(&motion, 1), host.threads, task.progress()));
  for (std::vector<ConvexHull>& frame : hulls.hulls) {
    std::vector<TriMesh>& parts = frames.emplace_back();
    for (ConvexHull& hull : frame) parts.push_back({std::move(hull.vertices), std::move(hull.triangles)});
  }
  return frames;
}

/// Scores every frame of a sequence, or some.
Result<void> scoreSequence(const ScoreOptions& options, const CommonOptions& common, const Subject& subject,
                           Host& host) {
  const Character& character = *subject.character;
  LORICA_TRY(const SkeletalMotion motion, framesOf(character.skeleton, subject.file->clips.front()));
  LORICA_TRY(const std::vector<std::vector<TriMesh>> frames, partsOfFrames(options, subject, motion, host));
  ScoreSettings settings;
  settings.volumeSamples = 20'000;
  settings.surfaceSamples = 5'000;
  settings.concavitySamples = 500;
  // Each figure: its name in JSON and CSV, its line, its member.
  constexpr std::array<std::tuple<const char*, const char*, double Score::*>, 6> kFigures = {
      {{"score16", "score, Eq. 16", &Score::score16},
       {"score17", "score, Eq. 17", &Score::score17},
       {"distance", "distance, Eq. 18", &Score::distance},
       {"distancePercentDiagonal", "", &Score::distancePercentDiagonal},
       {"concavity", "concavity", &Score::concavity},
       {"uncoveredFraction", "uncovered", &Score::uncoveredFraction}}};
  std::vector<Score> scores;
  std::string table = "frame,time";
  for (const auto& [name, label, member] : kFigures) table += fmt::format(",{}", name);
  table += "\n";
  Task task(host, "Scoring frames", "frames");
  TriMesh mesh{std::vector<Vec3>(character.mesh.vertices.size()), character.mesh.triangles};
  for (int f = 0; f < motion.frameCount(); f += options.every) {
    poseInFrame(character, motion, f, mesh.vertices);
    LORICA_TRY(const Score judged,
               prefixed(fmt::format("{}: frame {}", options.mesh, f), score(mesh, frames[f], settings)));
    table += fmt::format("{},{}", f, motion.times[f]);
    for (const auto& [name, label, member] : kFigures) table += fmt::format(",{}", judged.*member);
    table += "\n";
    scores.push_back(judged);
    task.update(f + 1, motion.frameCount());
    if (host.cancelled()) return cancelled();
  }
  Report report(fmt::format("{} in {}, {}", options.mesh, counted(std::ssize(frames.front()), "part"),
                            counted(std::ssize(scores), "frame")));
  report.add("frames", scores.size());
  report.add("parts", frames.front().size());
  for (const auto& [name, label, member] : kFigures) {
    double sum = 0.0, least = scores.front().*member, most = least;
    Json all = Json::array();
    for (const Score& one : scores) {
      sum += one.*member;
      least = std::min(least, one.*member);
      most = std::max(most, one.*member);
      all.push_back(one.*member);
    }
    const double mean = sum / static_cast<double>(scores.size());
    report.add(name, label, mean,
               *label == '\0' ? "" : fmt::format("mean {:.4g}, from {:.4g} to {:.4g}", mean, least, most));
    report.add(fmt::format("{}PerFrame", name), std::move(all));
  }
  if (!options.csv.empty()) {
    LORICA_TRY_DO(writeFileAtomically(options.csv, table));
    report.add("csv", "table", options.csv, options.csv);
  }
  return publish(common, report);
}

Result<void> runScore(const ScoreOptions& options, const CommonOptions& common, Host& host) {
  LORICA_TRY_DO(checkJsonOutput(common, {options.mesh, options.parts, options.csv}));
  CharacterOptions reading = options.reading;
  LORICA_TRY(const Subject subject, readSubject(options.mesh, reading, host));
  const bool sequence = subject.character && subject.file && subject.file->format == kSequence;
  if (!options.csv.empty()) LORICA_TRY_DO(checkOutput(common, "--csv", options.csv, ".csv"));
  if (sequence) return scoreSequence(options, common, subject, host);
  if (!options.csv.empty() || options.every > 1) {
    return invalidArgument("{} is for a mesh in several poses, but {} has one",
                           options.csv.empty() ? "--every" : "--csv", options.mesh);
  }
  const TriMesh& mesh = subject.mesh;
  if (std::filesystem::path(options.parts).extension() == ".lorica") {
    return invalidArgument(
        options.parts +
        ": found a decomposition, expected its hulls, written by `lorica decompose --export-obj FILE.obj`");
  }
  LORICA_TRY(std::vector<NamedMesh> objects, readObjObjects(options.parts));
  std::vector<TriMesh> parts;
  parts.reserve(objects.size());
  for (NamedMesh& object : objects) parts.push_back(std::move(object.mesh));

  // Either the mesh or the parts may be rejected: a failure names that file.
  const std::string& file = checkClosedTwoManifold(mesh) ? options.parts : options.mesh;
  std::optional<TriMesh> surface;  // of the file
  if (subject.rebuilt) {
    surface = TriMesh{{mesh.vertices.begin() + subject.rebuilt->firstOriginal, mesh.vertices.end()},
                      subject.rebuilt->original};
  }
  LORICA_TRY(const Score judged, prefixed(file, score(mesh, parts, ScoreSettings(), surface ? &*surface : nullptr)));
  if (host.cancelled()) return cancelled();
  Report report = scoreReport(options, subject, parts.size(), judged);
  if (const std::string doubt = doubtAbout(mesh, parts, judged); !doubt.empty()) {
    host.warn(options.parts + ": " + doubt);
    report.add("warning", doubt);
  }
  return publish(common, report);
}

}  // namespace

Command addScore(CLI::App& parent, CommonOptions& common) {
  const auto options = std::make_shared<ScoreOptions>();
  CLI::App* app = addSubcommand(
      parent, common, "score",
      "Rate how closely convex parts, of Lorica or another program, fit the mesh that they stand for.",
      "  lorica decompose bunny.off --parts 16 --export-obj hulls.obj\n"
      "  lorica score bunny.off hulls.obj\n"
      "      score Lorica's hulls\n"
      "  lorica score bunny.off coacd.obj --json coacd.json\n"
      "      score another program's parts: one `o` or `g` per part\n"
      "  lorica score 'frames/*.obj' horse.lorica --csv scores.csv\n"
      "  lorica score 'frames/*.obj' 'hulls_*.obj'\n"
      "      every frame of a mesh in several poses, with the parts that it was decomposed in, or a file of parts "
      "each\n"
      "\nThe convex hull of each part's vertices is scored by Eq. 16 (sampled, with its standard error), Eq. 17\n"
      "and Eq. 18 of Thul et al. 2018. Scores: 1 is perfect. Distance: 0 is perfect. Distances are measured to the\n"
      "file's own surface. Concavity is CoACD's (Wei et al. 2022): of what a hull holds of the mesh, the larger of\n"
      "the Hausdorff distance to the hull and 0.3 times the radius of a ball as large as the volume between them.");
  app->add_option("MESH", options->mesh,
                  "Mesh (.off, .obj, .ply, .stl, .glb), `mannequin` in its bind pose, or a mesh in several poses")
      ->required();
  app->add_option("PARTS.obj", options->parts,
                  "Parts, one object each; of a mesh in several poses its .lorica, or a folder or 'pattern*.obj' with "
                  "a file for each frame")
      ->required();
  addCount(*app, "--every", options->every, 1, "Of a mesh in several poses, score every N-th frame [default: 1]");
  addOption(*app, "--csv", options->csv, "FILE.csv", "Of a mesh in several poses, write the scores of every frame");
  addWallOptions(*app, options->reading);
  addHideOption(*app, options->reading.hidden);
  return {app, [options](const CommonOptions& given, Host& host) { return runScore(*options, given, host); }};
}

}  // namespace lorica

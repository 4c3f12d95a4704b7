#include "acd/score.h"
#include "apps/option_groups.h"
#include "apps/options.h"
#include "apps/report_parts.h"
#include "geometry/errors.h"
#include "geometry/mesh_files.h"
#include "geometry/text.h"
#include "session/prepare/subject.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

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

Result<void> runScore(const ScoreOptions& options, const CommonOptions& common, Host& host) {
  LORICA_TRY_DO(checkJsonOutput(common, {options.mesh, options.parts}));
  CharacterOptions reading = options.reading;
  LORICA_TRY(const Subject subject, readSubject(options.mesh, reading, host));
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
      parent, common, "score", "Score convex parts of any program against the original mesh.",
      "  lorica decompose bunny.off --parts 16 --export-obj hulls.obj\n"
      "  lorica score bunny.off hulls.obj\n"
      "      score Lorica's hulls\n"
      "  lorica score bunny.off coacd.obj --json coacd.json\n"
      "      score another program's parts: one `o` or `g` per part\n"
      "\nThe convex hull of each part's vertices is scored by Eq. 16 (sampled, with its standard error), Eq. 17\n"
      "and Eq. 18 of Thul et al. 2018. Scores: 1 is perfect. Distance: 0 is perfect. Distances are measured to the\n"
      "file's own surface. Concavity is CoACD's (Wei et al. 2022): of what a hull holds of the mesh, the larger of\n"
      "the Hausdorff distance to the hull and 0.3 times the radius of a ball as large as the volume between them.");
  app->add_option("MESH", options->mesh, "Mesh (.off, .obj, .ply, .stl, .glb), or `mannequin` in its bind pose")
      ->required();
  app->add_option("PARTS.obj", options->parts, "Parts, one object each")->required();
  addWallOptions(*app, options->reading);
  addHideOption(*app, options->reading.hidden);
  return {app, [options](const CommonOptions& given, Host& host) { return runScore(*options, given, host); }};
}

}  // namespace lorica

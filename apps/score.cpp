#include "acd/score.h"
#include "geometry/text.h"

#include "apps/option_groups.h"
#include "apps/options.h"
#include "apps/report_parts.h"
#include "geometry/errors.h"
#include "geometry/mesh_files.h"
#include "prepare/subject.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

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

struct Options {
  std::string mesh;
  std::string parts;
  CharacterOptions reading;  // which meshes are hidden
};

bool hasWalls(const Subject& subject) {
  return subject.rebuilt && subject.rebuilt->shells > 0;
}

nlohmann::ordered_json toJson(const Distances& distances) {
  return {{"mean", distances.mean}, {"most", distances.most}, {"largest", distances.largest}};
}

std::string inWords(const Distances& distances) {
  return fmt::format("mean {:.4g}, 95 % at most {:.4g}, largest {:.4g}", distances.mean, distances.most,
                     distances.largest);
}

nlohmann::ordered_json toJson(const Subject& subject, std::size_t partCount, const Score& score) {
  nlohmann::ordered_json json;
  addMeshTo(json, subject);
  json["parts"] = partCount;
  const bool solid = !hasWalls(subject);
  json["score16"] = solid ? nlohmann::ordered_json(score.score16) : nullptr;
  json["score16StandardError"] = solid ? nlohmann::ordered_json(score.score16StandardError) : nullptr;
  json["score17"] = solid ? nlohmann::ordered_json(score.score17) : nullptr;
  json["distance"] = score.distance;
  json["distancePercentDiagonal"] = score.distancePercentDiagonal;
  json["uncoveredFraction"] = score.uncoveredFraction;
  json["surfaceToHulls"] = toJson(score.toHulls);
  json["hullsToSurface"] = toJson(score.toSurface);
  json["concavity"] = score.concavity;
  json["meanConcavity"] = score.meanConcavity;
  return json;
}

Report toReport(const Options& options, const Subject& subject, std::size_t partCount, const Score& score) {
  Report report(fmt::format("{} in {}", options.mesh, counted(partCount, "part")));
  addMeshTo(report, subject);
  if (hasWalls(subject)) {
    report.line("score", "Eq. 16 and 17 are for solids; the distances tell how well thin walls are held");
  } else {
    const char* of = subject.rebuilt ? "; of the closed body that was made" : "";
    report.line("score, Eq. 16",
                fmt::format("{:.4f} +- {:.4f} (intersection over union, overlaps counted repeatedly{})", score.score16,
                            score.score16StandardError, of));
    report.line("score, Eq. 17", fmt::format("{:.4f} (mesh volume / sum of hull volumes{})", score.score17, of));
  }
  report.line("distance, Eq. 18", fmt::format("{:.6g}, {:.3f} % of the diagonal (surface to the nearest hull)",
                                              score.distance, score.distancePercentDiagonal));
  report.line("surface to hulls", inWords(score.toHulls));
  report.line("hulls to surface", inWords(score.toSurface));
  report.line("concavity", fmt::format("at most {:.4f}, mean of the parts {:.4f} (CoACD's, in halves of the longest "
                                       "side)",
                                       score.concavity, score.meanConcavity));
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

Result<void> run(const Options& options, const CommonOptions& common, Host& host) {
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
  nlohmann::ordered_json json = toJson(subject, parts.size(), judged);
  if (const std::string doubt = doubtAbout(mesh, parts, judged); !doubt.empty()) {
    host.warn(options.parts + ": " + doubt);
    json["warning"] = doubt;
  }
  return publish(common, toReport(options, subject, parts.size(), judged), json);
}

}  // namespace

Command addScore(CommandLine& parent, CommonOptions& common) {
  const auto options = std::make_shared<Options>();
  CommandLine* app = addSubcommand(
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
  app->addOption("MESH", options->mesh, "Mesh (.off, .obj, .ply, .stl, .glb), or `mannequin` in its bind pose")
      ->required();
  app->addOption("PARTS.obj", options->parts, "Parts, one object each")->required();
  addWallOptions(*app, options->reading);
  addHideOption(*app, options->reading.hidden);
  return {app, [options](const CommonOptions& given, Host& host) { return run(*options, given, host); }};
}

}  // namespace lorica

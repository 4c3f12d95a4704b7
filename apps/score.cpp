#include "acd/score.h"

#include "apps/inputs.h"
#include "apps/interrupt.h"
#include "apps/options.h"
#include "geometry/mesh_files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>

namespace lorica {
namespace {

// Parts are doubted when their bounding box is off by more than this share of the mesh's diagonal, or when they leave
// out more than that share of its volume.
constexpr double kBoxesApart = 0.2;
constexpr double kUncovered = 0.5;

struct Options {
  std::string mesh;
  std::string parts;
};

nlohmann::ordered_json toJson(const Subject& subject, std::size_t partCount, const Score& score) {
  nlohmann::ordered_json json;
  if (!subject.mended.empty()) json["mended"] = subject.mended;
  json["parts"] = partCount;
  json["score16"] = score.score16;
  json["score16StandardError"] = score.score16StandardError;
  json["score17"] = score.score17;
  json["distance"] = score.distance;
  json["distancePercentDiagonal"] = score.distancePercentDiagonal;
  json["uncoveredFraction"] = score.uncoveredFraction;
  return json;
}

Report toReport(const Options& options, const Subject& subject, std::size_t partCount, const Score& score) {
  Report report(fmt::format("{} in {}", options.mesh, counted(static_cast<long long>(partCount), "part")));
  if (!subject.mended.empty()) report.line("mended", subject.mended);
  report.line("score, Eq. 16", fmt::format("{:.4f} +- {:.4f} (intersection over union, overlaps counted again)",
                                           score.score16, score.score16StandardError));
  report.line("score, Eq. 17", fmt::format("{:.4f} (mesh volume / sum of hull volumes)", score.score17));
  report.line("distance, Eq. 18", fmt::format("{:.6g}, {:.3f} % of the diagonal (surface to the nearest hull)",
                                              score.distance, score.distancePercentDiagonal));
  report.line("uncovered", fmt::format("{:.2f} % of the mesh's volume lies in no hull", 100 * score.uncoveredFraction));
  return report;
}

/// Half the mesh left out, or hulls that reach where the mesh does not: what to think of it. Empty where all is well.
std::string doubtAbout(const TriMesh& mesh, std::span<const TriMesh> parts, const Score& score) {
  const Aabb meshBox = surfaceBounds(mesh);
  Aabb partsBox;
  for (const TriMesh& part : parts) {
    for (const Vec3& p : part.vertices) partsBox.extend(p);
  }
  // Hulls that cover a mesh end where it ends, give or take how closely they follow it.
  const double apart =
      std::max((meshBox.min - partsBox.min).cwiseAbs().maxCoeff(), (meshBox.max - partsBox.max).cwiseAbs().maxCoeff());
  if (apart <= kBoxesApart * meshBox.diagonal() && score.uncoveredFraction <= kUncovered) return "";
  const auto text = [](const Aabb& box) {
    return fmt::format("({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g})", box.min.x(), box.min.y(), box.min.z(),
                       box.max.x(), box.max.y(), box.max.z());
  };
  return fmt::format(
      "these may be parts of another mesh, in another place, unit or pose: they reach from {}, the mesh from {}, and "
      "{} of it lies in none of them",
      text(partsBox), text(meshBox), percent(score.uncoveredFraction));
}

Result<void> run(const Options& options, const CommonOptions& common) {
  if (Result<void> fine = checkJsonOutput(common, {options.mesh, options.parts}); !fine) return fine;
  const Result<Subject> subject = readSubject(options.mesh);
  if (!subject) return subject.error();
  const TriMesh& mesh = subject->mesh;
  if (std::filesystem::path(options.parts).extension() == ".lorica") {
    return Error{ErrorCode::kInvalidArgument,
                 options.parts +
                     ": a decomposition, expected its hulls, as `lorica decompose --export-obj FILE.obj` "
                     "writes them"};
  }
  Result<std::vector<NamedMesh>> objects = readObjObjects(options.parts);
  if (!objects) return objects.error();
  std::vector<TriMesh> parts;
  for (NamedMesh& object : *objects) parts.push_back(std::move(object.mesh));

  const Result<Score> judged = score(mesh, parts, ScoreSettings());
  if (!judged) {
    // The mesh was refused, or else the parts were: name the file that is meant.
    const std::string& file = checkClosedTwoManifold(mesh) ? options.parts : options.mesh;
    return Error{judged.error().code, file + ": " + judged.error().message};
  }
  if (interrupted()) return Error{ErrorCode::kCancelled, "cancelled"};
  nlohmann::ordered_json json = toJson(*subject, parts.size(), *judged);
  if (const std::string doubt = doubtAbout(mesh, parts, *judged); !doubt.empty()) {
    warn(options.parts + ": " + doubt);
    json["warning"] = doubt;
  }
  return publish(common, toReport(options, *subject, parts.size(), *judged), json);
}

}  // namespace

Command addScore(CommandLine& parent, CommonOptions& common) {
  const auto options = std::make_shared<Options>();
  CommandLine* app = addSubcommand(
      parent, common, "score", "Judge convex parts, ours or a rival's, against the mesh they stand for.",
      "  lorica decompose bunny.off --parts 16 --export-obj hulls.obj\n"
      "  lorica score bunny.off hulls.obj\n"
      "      judge our own hulls\n"
      "  lorica score bunny.off coacd.obj --json rival.json\n"
      "      judge another program's parts: one `o` or `g` a part\n"
      "\nThe hull of each part's vertices is judged: Eq. 16 by sampling, with its standard error, Eq. 17\n"
      "and Eq. 18 of Thul et al. 2018. Scores: 1 is perfect. Distance: 0 is perfect.");
  app->addOption("MESH", options->mesh, "The closed mesh (.off, .obj, .ply, .stl), or `mannequin` in its bind pose")
      ->required()
      ->typeName("");
  app->addOption("PARTS.obj", options->parts, "The parts, one object each")->required()->typeName("");
  return {app, [options](const CommonOptions& given) { return run(*options, given); }};
}

}  // namespace lorica

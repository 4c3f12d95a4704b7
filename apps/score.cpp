#include "acd/score.h"

#include "apps/inputs.h"
#include "apps/interrupt.h"
#include "apps/options.h"
#include "geometry/mesh_files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>

namespace lorica {
namespace {

struct Options {
  std::string mesh;
  std::string parts;
};

nlohmann::ordered_json toJson(std::size_t partCount, const Score& score) {
  nlohmann::ordered_json json;
  json["parts"] = partCount;
  json["score16"] = score.score16;
  json["score16StandardError"] = score.score16StandardError;
  json["score17"] = score.score17;
  json["distance"] = score.distance;
  json["distancePercentDiagonal"] = score.distancePercentDiagonal;
  json["uncoveredFraction"] = score.uncoveredFraction;
  return json;
}

Report toReport(const Options& options, std::size_t partCount, const Score& score) {
  Report report(fmt::format("{} in {}", options.mesh, counted(static_cast<long long>(partCount), "part")));
  report.line("score, Eq. 16", fmt::format("{:.4f} +- {:.4f} (intersection over union, overlaps counted again)",
                                           score.score16, score.score16StandardError));
  report.line("score, Eq. 17", fmt::format("{:.4f} (mesh volume / sum of hull volumes)", score.score17));
  report.line("distance, Eq. 18", fmt::format("{:.6g}, {:.3f} % of the diagonal (surface to the nearest hull)",
                                              score.distance, score.distancePercentDiagonal));
  report.line("uncovered", fmt::format("{:.2f} % of the mesh's volume lies in no hull", 100 * score.uncoveredFraction));
  return report;
}

Result<void> run(const Options& options, const CommonOptions& common) {
  if (Result<void> fine = checkJsonOutput(common, {options.mesh, options.parts}); !fine) return fine;
  const Result<Subject> subject = readSubject(options.mesh);
  if (!subject) return subject.error();
  const TriMesh& mesh = subject->mesh;
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
  return publish(common, toReport(options, parts.size(), *judged), toJson(parts.size(), *judged));
}

}  // namespace

Command addScore(CLI::App& parent, CommonOptions& common) {
  const auto options = std::make_shared<Options>();
  CLI::App* app = addSubcommand(
      parent, common, "score", "Judge convex parts, ours or a rival's, against the mesh they stand for.",
      "  lorica decompose bunny.off --parts 16 --export-obj hulls.obj\n"
      "  lorica score bunny.off hulls.obj\n"
      "      judge our own hulls\n"
      "  lorica score bunny.off coacd.obj --json rival.json\n"
      "      judge another program's parts: one `o` or `g` a part\n"
      "\nThe hull of each part's vertices is judged: Eq. 16 by sampling, with its standard error, Eq. 17\n"
      "and Eq. 18 of Thul et al. 2018. Scores: 1 is perfect. Distance: 0 is perfect.");
  app->add_option("MESH", options->mesh, "The closed mesh (.off, .obj, .ply, .stl), or `mannequin` in its bind pose")
      ->required()
      ->type_name("");
  app->add_option("PARTS.obj", options->parts, "The parts, one object each")->required()->type_name("");
  return {app, [options](const CommonOptions& given) { return run(*options, given); }};
}

}  // namespace lorica

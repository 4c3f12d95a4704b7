#include "apps/decompose_report.h"
#include "geometry/text.h"

#include "acd/decomposition_file.h"
#include "apps/report_parts.h"
#include "geometry/counts.h"
#include "prepare/mesh_subject.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace lorica {
namespace {

/// What the decomposition stopped at: "error", "distance", "limits" if both were given, "parts", "convex", or
/// "vertices": hulls of so few vertices do not get better with more parts.
std::string endedBy(const DecomposeOutcome& outcome) {
  const auto& [fit, keyframes, limits, unit, coverVolume, threads, heldOut] = outcome;
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
  const auto& [fit, keyframes, limits, unit, coverVolume, threads, heldOut] = outcome;
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
std::string sentence(const HullExport& hulls) {
  if (hulls.maxVertices == hulls.maxVerticesBefore) {
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
  return options.cover.hullVertices > 0 && (!subject.character || !options.obj.empty());
}

}  // namespace

nlohmann::ordered_json toJson(const DecomposeOptions& options, const Subject& subject,
                              const DecomposeOutcome& outcome) {
  const auto& [fit, keyframes, limits, unit, coverVolume, threads, heldOut] = outcome;
  const auto& [made, attached, held, hulls, cover, used, quality, distance, concavity, stalled] = fit;
  nlohmann::ordered_json json;
  json["input"] = subject.name;
  json["parts"] = made.decomposition.parts.size();
  json["meshVolume"] = quality.meshVolume;
  json["hullVolume"] = quality.hullVolume;
  json["score"] = quality.score;
  json["error"] = quality.error;
  json["endedBy"] = endedBy(outcome);
  if (limits.maxError > 0.0) json["maxError"] = limits.maxError;
  if (limits.maxDistance > 0.0) json["maxDistance"] = limits.maxDistance;
  if (concavity) {
    json["maxConcavity"] = limits.maxConcavity / unit;
    json["concavity"] = concavity->largest / unit;
    json["meanConcavity"] = concavity->mean / unit;
  }
  if (distance) json["distance"] = *distance;
  json["seconds"] = made.seconds;
  json["threads"] = threads;
  json["vertices"] = subject.mesh.vertices.size();
  addMeshTo(json, subject);
  if (!subject.held.empty()) json["attachedVertices"] = attached;
  json["hash"] = hexDigits(hashOf(made.decomposition));
  if (subject.character) {
    json["keyframes"] = quality.errorPerKeyframe.size();
    json["errorPerKeyframe"] = quality.errorPerKeyframe;
    for (const ChosenFrame& chosen : keyframes.chosen) {
      json["chosenKeyframes"].push_back({{"motion", chosen.motion}, {"frame", chosen.frame}, {"time", chosen.time}});
    }
  }
  if (heldOut) json["heldOutError"] = heldOut->error;
  if (heldOut) json["heldOutPoses"] = heldOut->poses;
  if (subject.character) addCoverTo(json, cover);
  if (cover) json["cover"]["volumeGrowth"] = coverVolume;
  if (options.cover.hullVertices > 0) json["hullVertices"] = options.cover.hullVertices;
  if (boundsHulls(options, subject)) {
    json["hullGrowth"] = hulls.totalGrowth;
    json["hullGrowthPerPart"] = hulls.growth;
  }
  if (!options.output.empty()) json["output"] = options.output;
  if (!options.obj.empty()) json["exportObj"] = options.obj;
  if (!options.picture.empty()) json["picture"] = options.picture;
  return json;
}

Report toReport(const DecomposeOptions& options, const Subject& subject, const DecomposeOutcome& outcome) {
  const auto& [fit, keyframes, limits, unit, coverVolume, threads, heldOut] = outcome;
  const auto& [made, attached, held, hulls, cover, used, quality, distance, concavity, stalled] = fit;
  Report report(fmt::format("{}: {}", subject.name, counted(made.decomposition.parts.size(), "convex part")));
  report.line("mesh", fmt::format("{} vertices, {} triangles", grouped(std::ssize(subject.mesh.vertices)),
                                  grouped(std::ssize(subject.mesh.triangles))));
  addMeshTo(report, subject);
  if (attached > 0 && !subject.character) {
    report.line("attached", fmt::format("{} that no part contains: the hulls were enlarged to hold them",
                                        counted(attached, "vertex", "vertices")));
  }
  const std::string mean = subject.character ? ", mean over the keyframes" : "";
  report.line("volume", fmt::format("{:.6g}, hulls {:.6g}{}", quality.meshVolume, quality.hullVolume, mean));
  const bool walls = subject.rebuilt && subject.rebuilt->shells > 0;
  if (!walls) {
    report.line("error", fmt::format("hulls have {} more volume than the mesh{}", percent(quality.error), mean));
  }
  if (subject.character) {
    const auto [best, worst] = std::minmax_element(quality.errorPerKeyframe.begin(), quality.errorPerKeyframe.end());
    report.line("keyframes", fmt::format("{}, error from {} to {}", quality.errorPerKeyframe.size(), percent(*best),
                                         percent(*worst)));
  }
  if (heldOut) {
    report.line("held-out error", fmt::format("{} in {} that the parts were not trained on", percent(heldOut->error),
                                              counted(heldOut->poses, "pose")));
  }
  if (distance) {
    report.line("distance", fmt::format("at most {:.4g} from the hulls to the surface of their parts{}", *distance,
                                        subject.character ? ", in the worst keyframe" : ""));
  }
  if (concavity) {
    report.line("concavity", fmt::format("at most {:.4f}, mean of the parts {:.4f}, in halves of the longest side",
                                         concavity->largest / unit, concavity->mean / unit));
  }
  if (limits.maxError > 0.0 || limits.maxDistance > 0.0 || limits.maxConcavity > 0.0) {
    report.line("stopped because", endingSentence(outcome));
  }
  if (!walls)
    report.line("score", fmt::format("{:.4f} (Eq. 17: mesh volume / hull volume, 1 is perfect)", quality.score));
  report.line("time", fmt::format("{:.2f} s on {}", made.seconds, counted(threads, "thread")));
  report.line("hash", hexDigits(hashOf(made.decomposition)));
  if (subject.character) addCoverTo(report, cover);
  if (cover) report.line("cover volume", percent(coverVolume) + " more than exact hulls");
  if (boundsHulls(options, subject)) {
    report.line(subject.character ? "exported hulls" : "hull vertices",
                sentence(hulls) + (subject.character ? ", in the bind pose" : ""));
  }
  if (!options.output.empty()) report.line("output", options.output);
  if (!options.obj.empty()) {
    report.line("hulls", options.obj + (subject.character ? ", in metres, Y up, facing +Z"
                                                          : ", in the units and coordinates of the input"));
  }
  if (!options.picture.empty()) report.line("picture", options.picture);
  if (options.output.empty() && options.obj.empty() && options.picture.empty()) {
    report.note("Nothing was written: --picture draws the parts, --export-obj and -o write them.");
  }
  if (!keyframes.chosen.empty()) {
    Table table{{"frame", "time [s]", "error", "motion"}, {}, 3};
    for (std::size_t k = 0; k < keyframes.chosen.size(); ++k) {
      const auto& [motion, frame, time] = keyframes.chosen[k];
      table.rows.push_back(
          {std::to_string(frame), fmt::format("{:.2f}", time), percent(quality.errorPerKeyframe[k]), motion});
    }
    report.table(std::move(table));
    report.note(
        fmt::format("These keyframes were chosen: every frame is within {:.2f} m of one of them (root mean square over "
                    "the body).",
                    keyframes.farthest));
  }
  return report;
}

}  // namespace lorica

#include "apps/cover_options.h"

#include "apps/interrupt.h"
#include "apps/progress_bar.h"
#include "geometry/counts.h"
#include "geometry/errors.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace lorica {
namespace {

// In heights of the character. A smaller tolerance would select most points one by one, in half a minute or more.
constexpr double kLargestTolerance = 0.1;
constexpr double kSmallestTolerance = 1e-4;

bool isExact(const HullCover& cover) {
  return cover.tolerance == 0.0 && cover.maxHullVertices == 0;
}

}  // namespace

Option* addCover(CommandLine& app, std::optional<double>& tolerance, const std::string& description) {
  const TextCheck check = [](std::string& text) -> std::string {
    if (text == "exact") {
      text = "0";
      return "";
    }
    double length = 0.0;
    const char* end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data(), end, length);
    if (error == std::errc() && stopped == end && std::isfinite(length) && length > 0.0) return "";
    return fmt::format("found `{}`, expected exact, or a length above 0 in metres such as 0.002", text);
  };
  return app.addOption("--cover", tolerance, description)->typeName("exact|METRES")->check(check);
}

Result<void> checkCover(const CoverRequest& request, const Character& character) {
  if (request.tolerance && *request.tolerance == 0.0 && request.hullVertices > 0) {
    return invalidArgument("--cover exact and --hull-vertices {} exclude each other, expected only one of them",
                           request.hullVertices);
  }
  const double max = kLargestTolerance * character.height;
  const double min = kSmallestTolerance * character.height;
  if (request.tolerance && *request.tolerance > 0.0 && *request.tolerance < min) {
    return invalidArgument("--cover: found {:g} m, expected exact, or at least {:.2g} m (0.01 % of the height of {})",
                           *request.tolerance, min, character.name);
  }
  if (request.tolerance && *request.tolerance > max) {
    return invalidArgument("--cover: found {:g} m, expected at most {:.3g} m (10 % of the height of {})",
                           *request.tolerance, max, character.name);
  }
  return {};
}

std::string asTyped(const CoverRequest& request) {
  std::string text;
  if (request.tolerance) text = fmt::format("--cover {:g}", *request.tolerance);
  if (request.hullVertices > 0) {
    text += fmt::format("{}--hull-vertices {}", text.empty() ? "" : " ", request.hullVertices);
  }
  return text;
}

Result<HullCover> chooseCoverWithProgress(const Character& character, const Decomposition& decomposition,
                                          const CoverPoses& poses, const CoverRequest& request, int threads) {
  ProgressBar bar("Choosing a hull cover for " + character.name, "parts");
  bar.update(0, countOf(decomposition.parts));
  Result<HullCover> cover = chooseCover(character, decomposition, poses, request, threads, progressOf(bar));
  if (interrupted()) return cancelled();
  if (!cover && cover.error().code == ErrorCode::kInvalidArgument) {
    return invalidArgument(asTyped(request) + ": " + cover.error().message);
  }
  return cover;
}

void addCoverTo(Report& report, const std::optional<HullCover>& cover) {
  if (!cover || isExact(*cover)) {
    report.line("cover", "exact: the surface is inside the hulls in every pose");
    return;
  }
  const auto [fewest, max] = std::minmax_element(cover->points.begin(), cover->points.end(),
                                                 [](const auto& a, const auto& b) { return a.size() < b.size(); });
  const std::string range = fewest->size() == max->size() ? fmt::format("{}", max->size())
                                                          : fmt::format("{} to {}", fewest->size(), max->size());
  std::string chosen = fmt::format("{} points per part, chosen in {}", range, counted(cover->sampledPoses, "pose"));
  if (cover->tolerance > 0.0) chosen += fmt::format(", tolerance {}", millimetres(cover->tolerance));
  if (cover->maxHullVertices > 0) chosen += fmt::format(", at most {} per part", grouped(cover->maxHullVertices));
  report.line("cover", chosen);
  report.line("hulls enlarged", fmt::format("by up to {}; the surface protruded {} before", millimetres(cover->growth),
                                            millimetres(cover->sampledShortfall)));
  if (cover->heldOutPoses > 0) {
    report.line("held-out poses",
                fmt::format("the surface protrudes by at most {} in {}", millimetres(cover->heldOutShortfall),
                            counted(cover->heldOutPoses, "other pose")));
  }
}

void addCoverTo(nlohmann::ordered_json& json, const std::optional<HullCover>& cover) {
  nlohmann::ordered_json& figures = json["cover"];
  const bool exact = !cover || isExact(*cover);
  figures["exact"] = exact;
  if (exact) return;
  figures["tolerance"] = cover->tolerance;
  figures["hullVertices"] = cover->maxHullVertices;
  figures["sampledPoses"] = cover->sampledPoses;
  figures["heldOutPoses"] = cover->heldOutPoses;
  figures["growth"] = cover->growth;
  figures["sampledShortfall"] = cover->sampledShortfall;
  figures["heldOutShortfall"] = cover->heldOutShortfall;
  for (const std::vector<CoverPoint>& points : cover->points) figures["pointsPerPart"].push_back(points.size());
}

}  // namespace lorica

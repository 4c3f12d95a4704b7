#include "apps/cover_options.h"

#include "apps/interrupt.h"
#include "apps/progress_bar.h"
#include "collision/live/choose_cover.h"
#include "collision/live/lifted_point.h"
#include "geometry/convex_hull.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace lorica {
namespace {

constexpr int kVolumeStride = 4;             // a mean over 32 of 128 poses is soon taken, and as good
constexpr double kLargestTolerance = 0.1;    // of the character's height
constexpr double kSmallestTolerance = 1e-4;  // points are taken one by one: most of them, in half a minute and more

bool isExact(const CoverPromise& cover) {
  return cover.tolerance == 0.0 && cover.maxHullVertices == 0;
}

/// "--cover 0.002 --hull-vertices 64", as it was typed.
std::string asTyped(const CoverRequest& request) {
  std::string text;
  if (request.tolerance) text = fmt::format("--cover {:g}", *request.tolerance);
  if (request.hullVertices > 0) {
    text += fmt::format("{}--hull-vertices {}", text.empty() ? "" : " ", request.hullVertices);
  }
  return text;
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
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("--cover exact keeps every point and --hull-vertices {} does not, expected one of them",
                             request.hullVertices)};
  }
  const double most = kLargestTolerance * character.height;
  const double least = kSmallestTolerance * character.height;
  if (request.tolerance && *request.tolerance > 0.0 && *request.tolerance < least) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("--cover: found {:g} m, expected exact, or at least {:.2g} m, a ten-thousandth of the "
                             "height of {}",
                             *request.tolerance, least, character.name)};
  }
  if (request.tolerance && *request.tolerance > most) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("--cover: found {:g} m, expected at most {:.3g} m, a tenth of the height of {}",
                             *request.tolerance, most, character.name)};
  }
  return {};
}

Result<CoverPromise> chooseCoverWithProgress(const Character& character, const Decomposition& decomposition,
                                             const CoverPoses& poses, const CoverRequest& request, int threads) {
  const NothingToCleanUp nothing;  // files are written later
  ProgressBar bar("Covering " + character.name, "parts");
  CoverSettings settings;
  settings.tolerance = request.tolerance.value_or(0.0);
  settings.maxHullVertices = request.hullVertices;
  settings.threads = threads;
  settings.progress = [&bar](int partsDone, int parts) {
    bar.update(partsDone, parts);
    return !interrupted();
  };
  bar.update(0, static_cast<int>(decomposition.parts.size()));
  Result<CoverPromise> cover = chooseCover(decomposition, liftPoints(character, decomposition), poses.sampledView(),
                                           poses.heldOutView(), settings);
  if (interrupted()) return Error{ErrorCode::kCancelled, "cancelled"};
  if (!cover && cover.error().code == ErrorCode::kInvalidArgument) {
    return Error{ErrorCode::kInvalidArgument, asTyped(request) + ": " + cover.error().message};
  }
  return cover;
}

double volumeGrowth(const Character& character, const Decomposition& decomposition, const CoverPoses& poses,
                    const CoverPromise& cover) {
  const std::vector<LiftedPoint> lifted = liftPoints(character, decomposition);
  const CoverPromise exact = coverExactly(decomposition, lifted);
  const auto volume = [&](const CoverPromise& promise, std::span<const Affine3> worldFromModel) {
    double sum = 0.0;
    for (const std::vector<CoverPoint>& chosen : promise.points) {
      std::vector<Vec3> positions;
      positions.reserve(chosen.size());
      for (const CoverPoint& p : chosen) {
        positions.push_back(positionOf(pushed(lifted[static_cast<std::size_t>(p.point)], p.outward), worldFromModel));
      }
      sum += convexHullVolume(positions);
    }
    return sum;
  };
  const BonePoseView view = poses.sampledView();
  double before = 0.0;
  double after = 0.0;
  for (int p = 0; p < view.poseCount(); p += kVolumeStride) {
    before += volume(exact, view.pose(p));
    after += volume(cover, view.pose(p));
  }
  return before > 0.0 ? after / before - 1.0 : 0.0;
}

void addCoverTo(Report& report, const std::optional<CoverPromise>& cover) {
  if (!cover || isExact(*cover)) {
    report.line("cover", "exact: in every pose the surface is inside the hulls");
    return;
  }
  const auto [fewest, most] = std::minmax_element(cover->points.begin(), cover->points.end(),
                                                  [](const auto& a, const auto& b) { return a.size() < b.size(); });
  const std::string range = fewest->size() == most->size() ? fmt::format("{}", most->size())
                                                           : fmt::format("{} to {}", fewest->size(), most->size());
  std::string chosen = fmt::format("{} points a part, chosen in {}", range, counted(cover->sampledPoses, "pose"));
  if (cover->tolerance > 0.0) chosen += fmt::format(", to within {}", millimetres(cover->tolerance));
  if (cover->maxHullVertices > 0) chosen += fmt::format(", at most {} a part", grouped(cover->maxHullVertices));
  report.line("cover", chosen);
  report.line("grown", fmt::format("by at most {}, to hold the surface that stuck out by up to {} in these poses",
                                   millimetres(cover->growth), millimetres(cover->sampledShortfall)));
  if (cover->heldOutPoses > 0) {
    report.line("held out",
                fmt::format("in {}, to measure by, the surface sticks out by at most {}",
                            counted(cover->heldOutPoses, "other pose"), millimetres(cover->heldOutShortfall)));
  }
}

void addCoverTo(nlohmann::ordered_json& json, const std::optional<CoverPromise>& cover) {
  nlohmann::ordered_json& promise = json["cover"];
  const bool exact = !cover || isExact(*cover);
  promise["exact"] = exact;
  if (exact) return;
  promise["tolerance"] = cover->tolerance;
  promise["hullVertices"] = cover->maxHullVertices;
  promise["sampledPoses"] = cover->sampledPoses;
  promise["heldOutPoses"] = cover->heldOutPoses;
  promise["growth"] = cover->growth;
  promise["sampledShortfall"] = cover->sampledShortfall;
  promise["heldOutShortfall"] = cover->heldOutShortfall;
  for (const std::vector<CoverPoint>& points : cover->points) promise["pointsPerPart"].push_back(points.size());
}

}  // namespace lorica

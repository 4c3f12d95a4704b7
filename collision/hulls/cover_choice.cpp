#include "collision/hulls/cover_choice.h"

#include "collision/live/choose_cover.h"
#include "collision/live/lifted_point.h"
#include "geometry/convex_hull.h"
#include "geometry/counts.h"
#include "geometry/errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lorica {
namespace {

// In heights of the character. A smaller tolerance would select most points one by one, in half a minute or more.
constexpr double kLargestTolerance = 0.1;
constexpr double kSmallestTolerance = 1e-4;

constexpr int kVolumeStride = 4;  // 32 of 128 poses give the same mean, four times faster

}  // namespace

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
  for (const auto& [option, limit] :
       {std::pair{"--hull-vertices", request.hullVertices}, {"--hull-planes", request.hullPlanes}}) {
    if (limit > 0) text += fmt::format("{}{} {}", text.empty() ? "" : " ", option, limit);
  }
  return text;
}

Result<HullCover> chooseCover(const Character& character, const Decomposition& decomposition, const CoverPoses& poses,
                              const CoverRequest& request, Host& host) {
  Task task(host, "Choosing a hull cover for " + character.name, "parts");
  task.update(0, countOf(decomposition.parts));
  CoverSettings settings;
  settings.tolerance = request.tolerance.value_or(0.0);
  settings.maxHullVertices = request.hullVertices;
  settings.threads = host.threads;
  settings.progress = task.progress();
  Result<HullCover> cover = chooseCover(decomposition, liftPoints(character, decomposition), poses.sampledView(),
                                        poses.heldOutView(), settings);
  if (host.cancelled()) return cancelled();
  if (!cover && cover.error().code == ErrorCode::kInvalidArgument) {
    return invalidArgument(asTyped(request) + ": " + cover.error().message);
  }
  return cover;
}

double volumeGrowth(const Character& character, const Decomposition& decomposition, const CoverPoses& poses,
                    const HullCover& cover) {
  const std::vector<LiftedPoint> lifted = liftPoints(character, decomposition);
  const HullCover exact = coverExactly(decomposition, lifted);
  const auto volume = [&](const HullCover& chosen, std::span<const Affine3> worldFromModel) {
    double sum = 0.0;
    for (const std::vector<CoverPoint>& points : chosen.points) {
      std::vector<Vec3> positions;
      positions.reserve(points.size());
      for (const CoverPoint& p : points) {
        positions.push_back(positionOf(pushed(lifted[p.point], p.outward), worldFromModel));
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

}  // namespace lorica

#include "apps/hull_fit.h"

#include "acd/held_vertices.h"
#include "apps/cover_options.h"
#include "apps/interrupt.h"
#include "collision/live/attached_vertices.h"

#include <algorithm>
#include <limits>

namespace lorica {
namespace {

constexpr double kRounding = 1e-9;  // share of a limit by which rounding may exceed it

PoseView posesOf(const FitRequest& request) {
  return {request.keyframes.positions, static_cast<int>(request.subject.mesh.vertices.size())};
}

double distanceIn(const FitRequest& request, const Fit& fit) {
  const double limit = request.settings.maxDistance;
  const Decomposition& parts = fit.made.decomposition;
  const double distance = measureDistance(parts, posesOf(request), fit.hulls, 0.1 * limit);
  // Both are upper bounds; the second is tighter near the limit.
  return distance <= limit ? distance : std::min(distance, measureDistance(parts, posesOf(request), fit.hulls, limit));
}

/// Decomposes once, and finds the hulls that are used.
Result<Fit> fitOnce(const FitRequest& request, const DecomposeSettings& settings) {
  const Subject& subject = request.subject;
  Fit fit;
  Result<TimedDecomposition> made = decomposeWithProgress(subject.name, subject.mesh, posesOf(request), settings);
  if (!made) return made.error();
  fit.made = std::move(*made);
  const Decomposition& parts = fit.made.decomposition;
  const std::vector<std::vector<PointIndex>> attached =
      subject.character ? attachedVerticesOf(parts, liftPoints(*subject.character, parts))
                        : assignHeldVertices(parts, subject.mesh.vertices, subject.held);
  for (const std::vector<PointIndex>& own : attached) fit.attached += own.size();
  fit.held = withHeldVertices(parts, attached);
  if (!subject.character || request.exported) {
    fit.exported = exportHulls(fit.held, subject.mesh.vertices, request.cover.hullVertices, settings.threads);
  }
  if (subject.character) {
    const Character& character = *subject.character;
    HullCover cover = coverExactly(parts, liftPoints(character, parts));
    if (request.coverPoses != nullptr) {
      Result<HullCover> chosen =
          chooseCoverWithProgress(character, parts, *request.coverPoses, request.cover, settings.threads);
      if (!chosen) return chosen.error();
      cover = std::move(*chosen);
      fit.cover = cover;
    }
    const BonePoseView bones{request.keyframes.worldFromModel, character.skeleton.jointCount()};
    fit.hulls = liveHulls(character, parts, cover, bones);
  } else {
    std::vector<ConvexHull>& hulls = fit.hulls.emplace_back();
    for (const NamedMesh& object : fit.exported.objects) hulls.push_back(convexHull(object.mesh.vertices));
  }
  fit.quality = measureQuality(subject.mesh, posesOf(request), fit.hulls);
  if (request.settings.maxDistance > 0.0) fit.distance = distanceIn(request, fit);
  return fit;
}

}  // namespace

bool Fit::errorMet(const DecomposeSettings& settings) const {
  return settings.maxError <= 0.0 ||
         *std::ranges::max_element(quality.errorPerKeyframe) <= (1.0 + kRounding) * settings.maxError;
}

bool Fit::distanceMet(const DecomposeSettings& settings) const {
  return settings.maxDistance <= 0.0 || *distance <= (1.0 + kRounding) * settings.maxDistance;
}

Result<Fit> fitHulls(const FitRequest& request) {
  const DecomposeSettings& asked = request.settings;
  const auto met = [&](const Fit& fit) { return fit.errorMet(asked) && fit.distanceMet(asked); };
  // With as many parts as their own hulls need. Hulls that are used need at least as many.
  Result<Fit> best = fitOnce(request, asked);
  if (!best || !request.limited() || met(*best)) return best;
  DecomposeSettings settings = asked;
  settings.maxError = settings.maxDistance = 0.0;
  const int max = asked.maxParts > 0 ? asked.maxParts : std::numeric_limits<int>::max();
  int missed = static_cast<int>(best->made.decomposition.parts.size());
  double seconds = best->made.seconds;
  const auto tryWith = [&](int parts) {
    settings.maxParts = parts;
    Result<Fit> fit = fitOnce(request, settings);
    if (fit) seconds += fit->made.seconds;
    return fit;
  };
  // More and more parts, as long as cuts are left; then the fewest in between.
  while (missed < max && !met(*best)) {
    const int parts = std::min(max, (7 * missed + 4) / 5);
    best = tryWith(parts);
    if (!best) return best;
    if (met(*best) || static_cast<int>(best->made.decomposition.parts.size()) < parts) break;
    missed = parts;
  }
  int enough = static_cast<int>(best->made.decomposition.parts.size());
  while (met(*best) && missed + 1 < enough) {
    const int middle = (missed + enough) / 2;
    Result<Fit> fit = tryWith(middle);
    if (!fit) return fit;
    if (met(*fit)) {
      best = std::move(fit);
      enough = middle;
    } else {
      missed = middle;
    }
  }
  best->made.seconds = seconds;
  return best;
}

}  // namespace lorica

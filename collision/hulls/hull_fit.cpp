#include "collision/hulls/hull_fit.h"

#include "acd/held_vertices.h"
#include "acd/level_of_detail.h"
#include "collision/hulls/file_content.h"
#include "collision/live/attached_vertices.h"
#include "geometry/counts.h"

#include <algorithm>
#include <optional>

namespace lorica {
namespace {

constexpr int kMaxParts = 512;      // unless more are asked for or needed by the parts' own hulls
constexpr double kHelp = 0.97;      // 1.4 times as many parts help if they reduce the excess to this share
constexpr int kPatience = 2;        // steps that do not help, before more parts are given up
constexpr int kNearly = 20;         // the search ends within this fraction of the fewest parts
constexpr double kRounding = 1e-9;  // share of a limit by which rounding may exceed it
constexpr double kSampling = 0.04;  // the same, by which sampled concavities differ

PoseView posesOf(const FitRequest& request) {
  return {request.keyframes.positions, countOf(request.subject.mesh.vertices)};
}

double distanceIn(const FitRequest& request, const Fit& fit) {
  const double limit = request.settings.maxDistance;
  const Decomposition& parts = fit.made.decomposition;
  const double distance = measureDistance(parts, posesOf(request), fit.hulls, 0.1 * limit);
  // Both are upper bounds; the second is tighter near the limit.
  return distance <= limit ? distance : std::min(distance, measureDistance(parts, posesOf(request), fit.hulls, limit));
}

/// Vertices that hulls must hold enlarge them, mostly by very little, and concavity is sampled: the parts leave room
/// for that.
DecomposeSettings withMargin(const FitRequest& request, DecomposeSettings settings) {
  settings.maxConcavity *= 0.99;
  settings.rigid = !request.subject.character && request.keyframes.count == 1;
  return settings;
}

/// Decomposes once, and finds the hulls that are used.
Result<Fit> fitOnce(const FitRequest& request, const DecomposeSettings& settings, Host& host) {
  const Subject& subject = request.subject;
  const Stage whole(host);
  std::optional<Stage> stage(std::in_place, host, 0.0, request.coverPoses != nullptr ? kPartsOfCover : 1.0);
  LORICA_TRY(TimedDecomposition made,
             decomposeWithProgress(subject.name, subject.mesh, posesOf(request), withMargin(request, settings), host));
  stage.reset();
  return fitOf(request, std::move(made), host);
}

}  // namespace

Result<Fit> fitOf(const FitRequest& request, TimedDecomposition made, Host& host) {
  const Subject& subject = request.subject;
  Fit fit;
  fit.made = std::move(made);
  const Decomposition& parts = fit.made.decomposition;
  const std::vector<std::vector<PointIndex>> attached =
      subject.character ? attachedVerticesOf(parts, liftPoints(*subject.character, parts))
                        : assignHeldVertices(parts, subject.mesh.vertices, subject.held);
  for (const std::vector<PointIndex>& own : attached) fit.attached += own.size();
  fit.held = withHeldVertices(parts, attached);
  if (!subject.character || request.exported) {
    fit.exported =
        simplifyHulls(hullsIn(fit.held, subject.mesh.vertices), request.cover.budget(), request.settings.threads);
  }
  if (subject.character) {
    const Character& character = *subject.character;
    HullCover cover = coverExactly(parts, liftPoints(character, parts));
    if (request.coverPoses != nullptr) {
      const Stage stage(host, kPartsOfCover, 1.0);
      LORICA_TRY(HullCover chosen, chooseCover(character, parts, *request.coverPoses, request.cover, host));
      cover = std::move(chosen);
      fit.cover = cover;
    }
    const BonePoseView bones{request.keyframes.worldFromModel, character.skeleton.jointCount()};
    fit.hulls = liveHulls(character, parts, cover, bones);
  } else if (!request.cover.budget().given()) {
    fit.hulls = hullsOfParts(fit.held, posesOf(request));
  } else {
    std::vector<ConvexHull>& hulls = fit.hulls.emplace_back();
    for (const NamedMesh& object : fit.exported.objects) hulls.push_back(convexHull(object.mesh.vertices));
  }
  fit.quality = measureQuality(subject.mesh, posesOf(request), fit.hulls);
  if (request.settings.maxDistance > 0.0) fit.distance = distanceIn(request, fit);
  if (const double limit = request.settings.maxConcavity; limit > 0.0) {
    fit.concavity = measureConcavity(parts, posesOf(request), fit.hulls, limit);
  }
  return fit;
}

bool Fit::errorMet(const DecomposeSettings& settings) const {
  return settings.maxError <= 0.0 ||
         *std::ranges::max_element(quality.errorPerKeyframe) <= (1.0 + kRounding) * settings.maxError;
}

bool Fit::distanceMet(const DecomposeSettings& settings) const {
  return settings.maxDistance <= 0.0 || *distance <= (1.0 + kRounding) * settings.maxDistance;
}

bool Fit::concavityMet(const DecomposeSettings& settings) const {
  return settings.maxConcavity <= 0.0 || concavity->largest <= (1.0 + kSampling) * settings.maxConcavity;
}

double Fit::excess(const DecomposeSettings& settings) const {
  double most = 0.0;
  if (settings.maxError > 0.0) most = *std::ranges::max_element(quality.errorPerKeyframe) / settings.maxError;
  if (settings.maxDistance > 0.0) most = std::max(most, *distance / settings.maxDistance);
  if (settings.maxConcavity > 0.0) most = std::max(most, concavity->largest / settings.maxConcavity);
  return most;
}

Result<Fit> fitHulls(const FitRequest& request, Host& host) {
  const DecomposeSettings& asked = request.settings;
  const auto met = [&](const Fit& fit) { return fit.met(asked); };
  const auto partsOf = [](const Fit& fit) { return countOf(fit.made.decomposition.parts); };
  // With as many parts as their own hulls need. Hulls that are used need at least as many.
  Result<Fit> best = fitOnce(request, asked, host);
  if (!best || !request.limited() || met(*best)) return best;
  DecomposeSettings settings = asked;
  settings.maxError = settings.maxDistance = settings.maxConcavity = 0.0;
  const int max = asked.maxParts > 0 ? asked.maxParts : std::max(kMaxParts, partsOf(*best));
  int missed = partsOf(*best);
  double seconds = best->made.seconds;
  const auto tryWith = [&](int parts) {
    settings.maxParts = parts;
    Result<Fit> fit = fitOnce(request, settings, host);
    if (fit) seconds += fit->made.seconds;
    return fit;
  };
  // More and more parts, as long as they help; then few in between.
  for (int inVain = 0; missed < max && !met(*best);) {
    const int parts = std::min(max, (7 * missed + 4) / 5);
    Result<Fit> fit = tryWith(parts);
    if (!fit && fit.error().code == ErrorCode::kInvalidArgument) {  // so few points do not cover these parts
      best->stalled = true;
      break;
    }
    if (!fit) return fit;
    const bool uncut = partsOf(*fit) < parts;
    inVain = fit->excess(asked) > kHelp * best->excess(asked) ? inVain + 1 : 0;
    if (fit->excess(asked) < best->excess(asked)) best = std::move(fit);
    if (met(*best) || uncut) break;
    missed = parts;
    best->stalled = inVain == kPatience;
    if (best->stalled) break;
  }
  int enough = partsOf(*best);
  while (met(*best) && missed + 1 + missed / kNearly < enough) {
    const int middle = (missed + enough) / 2;
    Result<Fit> fit = tryWith(middle);
    if (!fit && fit.error().code != ErrorCode::kInvalidArgument) return fit;
    if (fit && met(*fit)) {
      best = std::move(fit);
      enough = middle;
    } else {
      missed = middle;
    }
  }
  best->made.seconds = seconds;
  return best;
}

DecompositionFile fileContent(const FitRequest& request, const Training* training, const Fit& fit) {
  const Subject& subject = request.subject;
  const Character* character = subject.character ? &*subject.character : nullptr;
  const UsedHulls hulls = character != nullptr ? fit.hulls : hullsOfParts(fit.held, posesOf(request));
  DecompositionFile content =
      fileContent(subject.name, subject.mesh, character, training, posesOf(request), fit.made.decomposition, hulls);
  content.cover = fit.cover;
  if (character == nullptr && fit.attached > 0) content.cover = coverWithHeldVertices(fit.held);
  return content;
}

}  // namespace lorica

#include "capture/tracking/fit/body_fit.h"

#include "capture/tracking/fit/body_terms.h"

#include <algorithm>
#include <cmath>

namespace lorica::fit {
namespace {

constexpr std::uint8_t kNobody = 255;

/// Whether a point just beside the edge of a flat capsule is outside the image or behind something else.
bool isHiddenBeside(const BodyView& view, const PosedModel& body, const Sample& edge) {
  const Sample beside{edge.capsule, edge.along, 3.0F * edge.aside};
  const BodyView::Sight sight = view.sightOf(ballOf(body, beside).centre);
  return !sight.inside || (!sight.person && sight.seen > 0.0F && sight.seen < sight.depth);
}

}  // namespace

CapsuleSupport BodyFitter::supportOf(const BodyView& view, const Proportions& proportions, const BodyPose& pose,
                                     std::vector<std::uint8_t>* owner) {
  CapsuleSupport support;
  lastCapsule_.resize(std::max(lastCapsule_.size(), view.points().size()));
  poseBody(pose, proportions, body_);
  const auto points = view.points();
  if (owner) owner->assign(points.size(), kNobody);
  const std::size_t n = std::min<std::size_t>(points.size(), 500);
  int unexplained = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const SurfaceMatch m = match(points[i], lastCapsule_[i]);
    const float off = std::abs(m.residual);
    const std::size_t c = m.capsule;
    support.meanDistance += std::min(off, 0.1F);
    unexplained += off > 0.08F ? 1 : 0;
    if (off > 0.1F) continue;
    ++support.points[c];
    support.distance[c] += off;
    support.seen[c] += view.areaOf(points[i]);
    if (owner) (*owner)[i] = m.capsule;
  }
  if (n > 0) {
    support.meanDistance /= n;
    support.unexplained = unexplained / static_cast<float>(n);
  }
  for (std::size_t c = 0; c < kCapsuleCount; ++c) {
    if (support.points[c] == 0) continue;
    support.distance[c] /= support.points[c];
    const Capsule& def = capsuleDefs()[c];
    const float section =
        (def.b - def.a).norm() * (def.radiusA + def.radiusB) * body_.girth[def.node] * body_.girth[def.node];
    support.seen[c] *= static_cast<float>(points.size()) / n / section;
  }
  std::array<int, kCapsuleCount> samples{};
  std::array<float, 2> edges{};
  for (const Sample& sample : samplesOfBody()) {
    const std::size_t c = sample.capsule;
    ++samples[c];
    const Ball ball = ballOf(body_, sample);
    if (capsuleDefs()[c].node == kPelvis && sample.aside != 0.0F) {
      const std::size_t side = sample.aside > 0.0F ? 0 : 1;
      edges[side] += 1.0F;
      support.hiddenSide[side] += isHiddenBeside(view, body_, sample) ? 1.0F : 0.0F;
    }
    const BodyView::Sight sight = view.sightOf(ball.centre);
    if (!sight.inside || (sight.seen > 0.0F && sight.seen < sight.depth - ball.radius - 0.06F)) {
      support.hidden[c] += 1.0F;
      continue;
    }
    support.violation[c] += std::max(0.0F, sight.outside * sight.metresPerBlock + 0.5F * ball.radius);
    if (sight.person) support.violation[c] += std::max(0.0F, sight.seen - (sight.depth - ball.radius) - kFrontSlack);
  }
  for (const std::size_t side : {0, 1}) support.hiddenSide[side] /= edges[side];
  for (std::size_t c = 0; c < kCapsuleCount; ++c) {
    support.hidden[c] /= samples[c];
    support.violation[c] /= samples[c];
  }
  return support;
}

}  // namespace lorica::fit

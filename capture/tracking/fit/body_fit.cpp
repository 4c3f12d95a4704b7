#include "capture/tracking/fit/body_fit.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace lorica::fit {
namespace {

constexpr float kUsualClavicle = 0.10F;  ///< deviation of a collarbone from where the arm takes it [rad]
constexpr float kWornDeviation = 0.03F;  ///< of a head from where its headset says that it is [m]
constexpr float kWornWidth = 0.3F;       ///< much further, and it is another's [m]
constexpr float kUsualEnd = 0.35F;       ///< deviation of wrists and ankles from straight [rad]

Q smallTurn(int axis, float angle) {
  return Q(Eigen::AngleAxisf(angle, V3::Unit(axis)));
}

/// Whether a point just beside the edge of a flat capsule is outside the image or behind something else.
bool isHiddenBeside(const BodyView& view, const PosedModel& body, const Sample& edge) {
  const Sample beside{edge.capsule, edge.along, 3.0F * edge.aside};
  const BodyView::Sight sight = view.sightOf(ballOf(body, beside).centre);
  return !sight.inside || (!sight.person && sight.seen > 0.0F && sight.seen < sight.depth);
}

/// Those that may explain something: all, or all but the legs'.
int fittedCapsules(const BodyView& view) {
  static const int upper = static_cast<int>(
      std::ranges::count_if(capsuleDefs(), [](const Capsule& capsule) { return !isOfLeg(capsule.node); }));
  return view.waistUp() ? upper : kCapsuleCount;
}

}  // namespace

BodyFitter::BodyFitter() {
  lastCapsule_.reserve(4096);
}

void BodyFitter::addPull(int node, const V3& at, const V3& derivative, float residual, float weight) {
  Wrench f;
  f.head<3>() = V3(at - body_.position[kPelvis]).cross(derivative);
  f.tail<3>() = derivative;
  const std::size_t n = node;
  Gram& gram = equations_.gram[n];
  for (int i = 0; i < 6; ++i) {
    const float wi = weight * f[i];
    for (int j = i; j < 6; ++j) gram(j, i) += wi * f[j];
  }
  equations_.force[n] += (weight * residual) * f;
}

SurfaceMatch BodyFitter::match(const BodyView& view, const BodyView::Point& point, int first) const {
  SurfaceMatch best;
  const int count = fittedCapsules(view);
  if (first < count) matchCapsule(body_, first, point.position, point.normal, point.ray, best);
  const CapsuleBalls::Column beyond = body_.balls.beyond(point.position, best.bound);
  for (int i = 0; i < count; ++i) {
    if (i != first && beyond[i] <= 0.0F) matchCapsule(body_, i, point.position, point.normal, point.ray, best);
  }
  return best;
}

float BodyFitter::pointTerm(const BodyView& view, const FitStage& stage, bool linearize) {
  const auto points = view.points();
  const std::size_t n = std::min<std::size_t>(points.size(), stage.points);
  if (n == 0) return 0.0F;
  const float each = kPointCount / n / (kPointDeviation * kPointDeviation);
  const float widthSq = stage.width * stage.width;
  float cost = 0.0F;
  for (std::size_t i = 0; i < n; ++i) {
    const SurfaceMatch m = match(view, points[i], lastCapsule_[i]);
    lastCapsule_[i] = m.capsule;
    const Robust r = robust(m.costSq, widthSq);
    cost += r.cost;
    if (linearize) addPull(body_.capsule[m.capsule].node, m.at, m.pull, m.residual, each * r.weight);
  }
  return each * cost;
}

float BodyFitter::freeSpaceTerm(const BodyView& view, bool linearize) {
  float cost = 0.0F;
  for (const Sample& sample : samplesOfBody()) {
    if (sample.capsule >= fittedCapsules(view)) break;
    const SamplePulls pulls = pullsOf(view, body_, sample);
    const int node = body_.capsule[sample.capsule].node;
    for (int i = 0; i < pulls.count; ++i) {
      const Pull& pull = pulls.pull[i];
      cost += pull.cost;
      if (linearize) addPull(node, pulls.at, pull.derivative, pull.residual, pull.weight);
    }
  }
  return cost;
}

float BodyFitter::collisionTerm(const BodyView& view, bool linearize) {
  float cost = 0.0F;
  int known = -1;
  Ball ball{};
  for (const CollisionPair& pair : collisionPairs()) {
    const Sample& sample = samplesOfBody()[pair.sample];
    if (std::max(sample.capsule, pair.capsule) >= fittedCapsules(view)) continue;
    if (pair.sample != known) {
      ball = ballOf(body_, sample);
      known = pair.sample;
    }
    const Pull pull = collisionOf(body_, ball, pair.capsule);
    cost += pull.cost;
    if (linearize && pull.cost > 0.0F) {
      const int node = body_.capsule[sample.capsule].node;
      addPull(node, ball.centre, pull.derivative, pull.residual, pull.weight);
    }
  }
  return cost;
}

/// A head outside the image is where the headset is.
float BodyFitter::headTerm(const BodyView& view, bool linearize) {
  if (!view.headOutside()) return 0.0F;
  const V3 head = headOf(body_);
  const V3 off = head - view.worn()->head;
  const Robust r = robust(off.squaredNorm(), kWornWidth * kWornWidth);
  const float weight = 1.0F / (kWornDeviation * kWornDeviation);
  if (linearize) {
    for (int i = 0; i < 3; ++i) addPull(kNeck, head, V3::Unit(i), off[i], weight * r.weight);
  }
  return weight * r.cost;
}

float BodyFitter::poseTerm(const BodyPose& pose, bool linearize) {
  const auto& nodes = nodeDefs();
  float cost = 0.0F;
  constexpr float kNudge = 0.01F;
  const float each = 1.0F / (kLimitDeviation * kLimitDeviation);
  for (const BallLimit& limit : ballLimits()) {
    const std::size_t n = limit.node;
    const int dof = nodes[n].firstDof;
    const V3 excess = excessOf(limit, pose.turn[n]);
    cost += each * excess.squaredNorm();
    if (linearize && excess.squaredNorm() > 0.0F) {
      M3 jacobian;
      for (int i = 0; i < 3; ++i) {
        jacobian.col(i) = (excessOf(limit, smallTurn(i, kNudge) * pose.turn[n]) - excess) / kNudge;
      }
      equations_.matrix.block<3, 3>(dof, dof) += each * jacobian.transpose() * jacobian;
      equations_.gradient.segment<3>(dof) += each * jacobian.transpose() * excess;
    }
    if (limit.usual > 0.0F) {
      const float w = 1.0F / (limit.usual * limit.usual);
      const V3 v = vectorOf(pose.turn[n]);
      cost += w * v.squaredNorm();
      if (linearize) {
        equations_.matrix.diagonal().segment<3>(dof).array() += w;
        equations_.gradient.segment<3>(dof) += w * v;
      }
    }
  }
  for (std::size_t n = kLeftClavicle; n < kNodeCount; ++n) {
    const NodeDef& def = nodes[n];
    if (def.dofCount != 2) continue;
    const bool clavicle = n == kLeftClavicle || n == kRightClavicle;
    const float usual = clavicle ? kUsualClavicle : kUsualEnd;
    const float w = 1.0F / (usual * usual);
    const std::array<float, 2> rest = {0.0F, clavicle ? protractionOf(pose, n) : 0.0F};
    for (std::size_t i = 0; i < 2; ++i) {
      const float a = pose.angle[n][i] - rest[i];
      cost += w * a * a;
      if (!linearize) continue;
      const int dof = def.firstDof + i;
      equations_.matrix(dof, dof) += w;
      equations_.gradient[dof] += w * a;
    }
  }
  return cost;
}

float BodyFitter::restTerm(const BodyView& view, const BodyPose& pose, bool linearize) {
  const auto& nodes = nodeDefs();
  float cost = 0.0F;
  for (int i = 0; i < kFitLimbCount; ++i) {
    const auto limb = static_cast<Limb>(i);
    if (view.waistUp() && isOfLeg(upperNodeOf(limb))) continue;
    const LimbRest rest = restOf(limb, pose);
    cost += rest.cost();
    if (!linearize) continue;
    const int upper = nodes[upperNodeOf(limb)].firstDof, lower = nodes[lowerNodeOf(limb)].firstDof;
    equations_.matrix.diagonal().segment<3>(upper).array() += rest.weight;
    equations_.gradient.segment<3>(upper) += rest.weight * rest.turn;
    equations_.matrix(lower, lower) += rest.weight;
    equations_.gradient[lower] += rest.weight * rest.bend;
  }
  return cost;
}

float BodyFitter::priorTerm(const BodyPose& pose, const PosePrior& prior, bool linearize) {
  const Step off = stepBetween(prior.pose, pose);
  const Step pull = prior.stiffness.cwiseProduct(off);
  if (linearize) {
    equations_.matrix.diagonal() += prior.stiffness;
    equations_.gradient += pull;
  }
  return pull.dot(off);
}

void BodyFitter::assemble() {
  const auto& nodes = nodeDefs();
  // Children come after their parents.
  for (std::size_t n = kNodeCount - 1; n > 0; --n) {
    const std::size_t parent = nodes[n].parent;
    equations_.gram[parent].triangularView<Eigen::Lower>() += equations_.gram[n];
    equations_.force[parent] += equations_.force[n];
  }
  for (std::size_t n = 0; n < kNodeCount; ++n) {
    const NodeDef& def = nodes[n];
    const Gram gram = equations_.gram[n].selfadjointView<Eigen::Lower>();
    for (int i = 0; i < def.dofCount; ++i) {
      const int dof = def.firstDof + i;
      const Twist& twist = body_.twist[dof];
      Wrench t;
      t.head<3>() = twist.turn;
      t.tail<3>() = twist.move;
      equations_.gradient[dof] += t.dot(equations_.force[n]);
      const Wrench pulled = gram * t;
      for (int j = 0; j <= i; ++j) {
        const Twist& other = body_.twist[def.firstDof + j];
        equations_.matrix(dof, def.firstDof + j) += other.turn.dot(pulled.head<3>()) + other.move.dot(pulled.tail<3>());
      }
      for (int above = def.parent; above >= 0; above = nodes[above].parent) {
        const NodeDef& upper = nodes[above];
        for (int j = 0; j < upper.dofCount; ++j) {
          const Twist& other = body_.twist[upper.firstDof + j];
          equations_.matrix(dof, upper.firstDof + j) +=
              other.turn.dot(pulled.head<3>()) + other.move.dot(pulled.tail<3>());
        }
      }
    }
  }
}

/// The degrees of freedom of the legs, the last ones, do not move.
void BodyFitter::holdLegs() {
  const int first = nodeDefs()[kLeftThigh].firstDof, count = kDofCount - first;
  equations_.matrix.bottomRows(count).setZero();
  equations_.matrix.diagonal().tail(count).setOnes();
  equations_.gradient.tail(count).setZero();
}

FitCost BodyFitter::evaluate(const BodyView& view, const BodyPose& pose, const PosePrior& prior, const FitStage& stage,
                             bool linearize) {
  if (linearize) {
    for (Gram& gram : equations_.gram) gram.setZero();
    for (Wrench& force : equations_.force) force.setZero();
    equations_.matrix.setZero();
    equations_.gradient.setZero();
  }
  FitCost cost;
  cost.points = pointTerm(view, stage, linearize);
  cost.freeSpace = freeSpaceTerm(view, linearize);
  cost.body = collisionTerm(view, linearize);
  cost.body += headTerm(view, linearize);
  cost.body += poseTerm(pose, linearize);
  cost.rest = restTerm(view, pose, linearize);
  cost.prior = priorTerm(pose, prior, linearize);
  if (linearize) assemble();
  if (linearize && view.waistUp()) holdLegs();
  return cost;
}

FitCost BodyFitter::costOf(const BodyView& view, const Proportions& proportions, const PosePrior& prior,
                           const FitStage& stage, const BodyPose& pose) {
  lastCapsule_.resize(std::max(lastCapsule_.size(), view.points().size()));
  poseBody(pose, proportions, body_);
  return evaluate(view, pose, prior, stage, false);
}

FitCost BodyFitter::fit(const BodyView& view, const Proportions& proportions, const PosePrior& prior,
                        std::span<const FitStage> stages, BodyPose& pose) {
  lastCapsule_.resize(std::max(lastCapsule_.size(), view.points().size()));
  FitCost cost;
  float damping = 1e-3F;
  for (const FitStage& stage : stages) {
    poseBody(pose, proportions, body_);
    cost = evaluate(view, pose, prior, stage, true);
    for (int step = 0; step < stage.steps; ++step) {
      Eigen::Matrix<float, kDofCount, kDofCount> damped = equations_.matrix;
      damped.diagonal().array() *= 1.0F + damping;
      damped.diagonal().array() += 0.1F;
      const Step gradient = equations_.gradient;
      const Eigen::LDLT<Eigen::Matrix<float, kDofCount, kDofCount>, Eigen::Lower> solver(damped);
      Step delta = -solver.solve(gradient);
      if (!delta.allFinite()) break;
      const float largest = delta.cwiseAbs().maxCoeff();
      if (largest > 0.5F) delta *= 0.5F / largest;
      const Equations before = equations_;
      const BodyPose tried = stepped(pose, delta);
      poseBody(tried, proportions, body_);
      const FitCost next = evaluate(view, tried, prior, stage, true);
      if (next.total() < cost.total()) {
        const float gain = cost.total() - next.total();
        pose = tried;
        cost = next;
        damping = std::max(1e-5F, damping * 0.3F);
        if (gain < 2e-3F * cost.total() && largest < 0.01F) break;
      } else {
        equations_ = before;
        damping = std::min(1e3F, std::max(damping, 1e-3F) * 8.0F);
        if (largest < 1e-3F) break;
      }
    }
  }
  return cost;
}

void BodyFitter::refineProportions(const BodyView& view, const std::array<float, kProportionCount>& deviation,
                                   BodyPose& pose, Proportions& proportions) {
  constexpr int kAll = kDofCount + kProportionCount;
  constexpr float kNudge = 0.01F;
  const FitStage stage{0.05F, 600, 1};
  PosePrior prior;
  prior.pose = pose;
  prior.stiffness.setConstant(100.0F);
  lastCapsule_.resize(std::max(lastCapsule_.size(), view.points().size()));
  poseBody(pose, proportions, body_);
  const FitCost before = evaluate(view, pose, prior, stage, true);
  Eigen::Matrix<float, kAll, kAll> matrix = Eigen::Matrix<float, kAll, kAll>::Zero();
  Eigen::Matrix<float, kAll, 1> gradient = Eigen::Matrix<float, kAll, 1>::Zero();
  matrix.topLeftCorner<kDofCount, kDofCount>() = equations_.matrix;
  gradient.head<kDofCount>() = equations_.gradient;

  static thread_local std::array<PosedModel, kProportionCount> nudged;
  for (std::size_t k = 0; k < kProportionCount; ++k) {
    Proportions other = proportions;
    other.factor[k] += kNudge;
    poseBody(pose, other, nudged[k]);
  }
  const auto points = view.points();
  const std::size_t n = std::min<std::size_t>(points.size(), stage.points);
  if (n == 0) return;
  const float each = kPointCount / n / (kPointDeviation * kPointDeviation);
  const auto& nodes = nodeDefs();
  for (std::size_t i = 0; i < n; ++i) {
    const SurfaceMatch m = match(view, points[i], lastCapsule_[i]);
    const Robust r = robust(m.costSq, stage.width * stage.width);
    const float weight = each * r.weight;
    const std::size_t c = m.capsule;
    const float here = distanceTo(body_, body_.capsule[c], points[i].position).distance;
    Eigen::Matrix<float, kProportionCount, 1> row;
    for (std::size_t k = 0; k < kProportionCount; ++k) {
      row[k] = (distanceTo(nudged[k], nudged[k].capsule[c], points[i].position).distance - here) / kNudge;
    }
    matrix.bottomRightCorner<kProportionCount, kProportionCount>() += weight * row * row.transpose();
    gradient.tail<kProportionCount>() += (weight * m.residual) * row;
    const V3 moment = V3(m.at - body_.position[kPelvis]).cross(m.pull);
    for (int node = body_.capsule[c].node; node >= 0; node = nodes[node].parent) {
      const NodeDef& def = nodes[node];
      for (int d = def.firstDof; d < def.firstDof + def.dofCount; ++d) {
        const Twist& twist = body_.twist[d];
        const float j = twist.turn.dot(moment) + twist.move.dot(m.pull);
        matrix.block<kProportionCount, 1>(kDofCount, d) += (weight * j) * row;
      }
    }
  }
  for (std::size_t k = 0; k < kProportionCount; ++k) {
    const int d = kDofCount + k;
    // Bodies differ by about a tenth; girths and single lengths are tied to the overall size.
    const float usual = k == kSize || k == kHeadSize ? 0.15F : (k >= kTrunkGirth ? 0.10F : 0.04F);
    const float toUsual = 1.0F / (usual * usual);
    matrix(d, d) += 1.0F / (deviation[k] * deviation[k]) + toUsual;
    gradient[d] += toUsual * (proportions.factor[k] - 1.0F);
  }
  matrix.diagonal().array() += 0.1F;
  const Eigen::LDLT<Eigen::Matrix<float, kAll, kAll>, Eigen::Lower> solver(matrix);
  const Eigen::Matrix<float, kAll, 1> delta = -solver.solve(gradient);
  if (!delta.allFinite() || delta.head<kDofCount>().cwiseAbs().maxCoeff() > 0.3F) return;
  Proportions next = proportions;
  for (std::size_t k = 0; k < kProportionCount; ++k) {
    const float step = std::clamp(delta[kDofCount + k], -0.05F, 0.05F);
    next.factor[k] = std::clamp(next.factor[k] + step, 0.55F, 1.8F);
  }
  const BodyPose tried = stepped(pose, delta.head<kDofCount>());
  poseBody(tried, next, body_);
  const FitCost after = evaluate(view, tried, prior, stage, false);
  if (after.plausible() < before.plausible()) {
    pose = tried;
    proportions = next;
  }
}

CapsuleSupport BodyFitter::supportOf(const BodyView& view, const Proportions& proportions, const BodyPose& pose) {
  CapsuleSupport support;
  lastCapsule_.resize(std::max(lastCapsule_.size(), view.points().size()));
  poseBody(pose, proportions, body_);
  const auto points = view.points();
  const std::size_t n = std::min<std::size_t>(points.size(), 500);
  int unexplained = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const SurfaceMatch m = match(view, points[i], lastCapsule_[i]);
    const float off = std::abs(m.residual);
    const std::size_t c = m.capsule;
    support.meanDistance += std::min(off, 0.1F);
    unexplained += off > 0.08F ? 1 : 0;
    if (off > 0.1F) continue;
    ++support.points[c];
    support.distance[c] += off;
    support.seen[c] += view.areaOf(points[i]);
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

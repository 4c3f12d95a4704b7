#include "skinning/springs/spring_simulation.h"

#include "geometry/counts.h"
#include "skinning/springs/spring_collider.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lorica {

namespace {

constexpr double kLongestFrame = 0.25;    // [s]
constexpr double kFastestBody = 25.0;     // [m/s]; World takes faster parts for jumps too
constexpr double kTimeTolerance = 1e-6;   // of frames that should be a whole number of steps apart [s]
constexpr double kShortestSpring = 1e-9;  // [m]

/// World lengths for a length in each joint's frame at rest: the mean over the axes of the scales above and of its own.
std::vector<double> scalesOf(const Skeleton& skeleton) {
  std::vector<double> scales;
  scales.reserve(skeleton.joints().size());
  for (const Joint& joint : skeleton.joints()) {
    const double above = joint.parent == kNoJoint ? 1.0 : scales[joint.parent];
    scales.push_back(above * std::cbrt(std::abs(joint.rest.scale.prod())));
  }
  return scales;
}

/// Moves a point to a distance from another one; unchanged where there is no direction.
void putAtDistance(const Vec3& head, double length, Vec3& tail) {
  const Vec3 along = tail - head;
  const double norm = along.norm();
  if (norm > 0.0) tail = head + along * (length / norm);
}

}  // namespace

Result<SpringSimulation> SpringSimulation::create(const Skeleton& skeleton, SpringBones springs) {
  LORICA_TRY_DO(checkSprings(skeleton, springs));
  (void)orderConstraints(skeleton, springs.constraints);
  return SpringSimulation(skeleton, std::move(springs));
}

SpringSimulation::SpringSimulation(const Skeleton& skeleton, SpringBones springs)
    : skeleton_(skeleton), springs_(std::move(springs)), springOf_(skeleton.joints().size(), -1) {
  const std::vector<double> scales = scalesOf(skeleton);
  for (SpringCollider& collider : springs_.colliders) collider.radius *= scales[collider.joint];
  for (SpringChain& chain : springs_.chains) {
    const std::size_t begin = colliders_.size();
    for (const int g : chain.colliderGroups) {
      const std::vector<int>& group = springs_.colliderGroups[g];
      colliders_.insert(colliders_.end(), group.begin(), group.end());
    }
    chainRoots_.push_back(joints_.size());
    for (SpringJoint& joint : chain.joints) {
      for (double* length : {&joint.stiffness, &joint.gravityPower, &joint.hitRadius}) *length *= scales[joint.joint];
      springOf_[joint.joint] = countOf(joints_);
      joints_.push_back(joint);
      constants_.push_back({chain.center, begin, colliders_.size(), joint.tail.normalized(),
                            skeleton_.joint(joint.joint).rest.rotation});
    }
  }
  states_.resize(joints_.size());
  tails_.assign(joints_.size(), Vec3::Zero());
  rootPositions_.assign(chainRoots_.size(), Vec3::Zero());
  last_ = restPose(skeleton_);
  between_ = last_;
  worldFromJoint_.assign(skeleton_.joints().size(), Affine3::Identity());
  orderJoints();
  startAtRest();
}

/// Joints that swing, their colliders and centres, and the ancestors of all these, by a depth-first search. Where
/// springs depend on each other in a circle through colliders, the one found last uses its collider where the last step
/// left it.
void SpringSimulation::orderJoints() {
  enum class Mark : char { kNew, kOpen, kDone };
  std::vector<Mark> marks(springOf_.size(), Mark::kNew);
  struct Entry {
    JointIndex joint;
    std::size_t next;
  };
  std::vector<Entry> stack;
  const auto dependency = [&](JointIndex joint, std::size_t n) -> std::optional<JointIndex> {
    if (n == 0) return skeleton_.joint(joint).parent;
    if (springOf_[joint] < 0) return std::nullopt;
    const Spring& spring = constants_[springOf_[joint]];
    if (n == 1) return spring.center;
    const std::size_t c = spring.collidersBegin + n - 2;
    if (c >= spring.collidersEnd) return std::nullopt;
    return springs_.colliders[colliders_[c]].joint;
  };
  for (const SpringJoint& spring : joints_) {
    if (marks[spring.joint] != Mark::kNew) continue;
    marks[spring.joint] = Mark::kOpen;
    stack.push_back({spring.joint, 0});
    while (!stack.empty()) {
      const std::optional<JointIndex> needed = dependency(stack.back().joint, stack.back().next++);
      if (!needed) {
        marks[stack.back().joint] = Mark::kDone;
        order_.push_back(stack.back().joint);
        stack.pop_back();
      } else if (*needed != kNoJoint && marks[*needed] == Mark::kNew) {
        marks[*needed] = Mark::kOpen;
        stack.push_back({*needed, 0});
      }
    }
  }
}

/// Computes a joint's place from its parent's, in the pose `between_`.
void SpringSimulation::place(JointIndex joint) {
  JointTransform local = between_[joint];
  if (springOf_[joint] >= 0) local.rotation = states_[springOf_[joint]].rotation;
  const JointIndex parent = skeleton_.joint(joint).parent;
  const Affine3 parentFromJoint = local.matrix();
  worldFromJoint_[joint] = parent == kNoJoint ? parentFromJoint : worldFromJoint_[parent] * parentFromJoint;
}

void SpringSimulation::startAtRest() {
  for (std::size_t s = 0; s < joints_.size(); ++s) states_[s].rotation = constants_[s].rest;
  for (const JointIndex joint : order_) place(joint);
  for (std::size_t s = 0; s < joints_.size(); ++s) {
    tails_[s] = worldFromJoint_[joints_[s].joint] * joints_[s].tail;
    const JointIndex center = constants_[s].center;
    states_[s].current = center == kNoJoint ? tails_[s] : worldFromJoint_[center].inverse() * tails_[s];
    states_[s].previous = states_[s].current;
  }
  owed_ = 0.0;
}

void SpringSimulation::interpolate(std::span<const JointTransform> pose, double share) {
  if (share >= 1.0) {
    for (const JointIndex j : order_) between_[j] = pose[j];
    return;
  }
  for (const JointIndex j : order_) {
    between_[j].translation = last_[j].translation + share * (pose[j].translation - last_[j].translation);
    between_[j].rotation = last_[j].rotation.slerp(share, pose[j].rotation);
    between_[j].scale = last_[j].scale + share * (pose[j].scale - last_[j].scale);
  }
}

/// Compares where the chains begin with the last frame.
bool SpringSimulation::jumped(std::span<const JointTransform> pose, double seconds) {
  if (!(seconds >= 0.0 && seconds <= kLongestFrame)) return true;
  interpolate(pose, 1.0);
  for (const JointIndex joint : order_) place(joint);
  const double farthest = kFastestBody * std::max(seconds, kSpringStepSeconds);
  bool far = false;
  for (std::size_t c = 0; c < chainRoots_.size(); ++c) {
    const Vec3 position = worldFromJoint_[joints_[chainRoots_[c]].joint].translation();
    if (!((position - rootPositions_[c]).norm() <= farthest)) far = true;
    rootPositions_[c] = position;
  }
  return far;
}

void SpringSimulation::advance(std::span<JointTransform> pose, double seconds, SpringObstacles* obstacles) {
  LORICA_CHECK(pose.size() == last_.size(), "the pose belongs to another skeleton");
  for (std::size_t s = 0; s < joints_.size(); ++s) pose[joints_[s].joint].rotation = states_[s].rotation;
  applyConstraints(skeleton_, springs_.constraints, pose);

  const bool far = jumped(pose, seconds);  // notes where the chains are, so it runs in the first frame too
  if (!started_ || far) {
    interpolate(pose, 1.0);
    startAtRest();
    for (std::size_t c = 0; c < chainRoots_.size(); ++c) {
      rootPositions_[c] = worldFromJoint_[joints_[chainRoots_[c]].joint].translation();
    }
    started_ = true;
  } else {
    const double due = owed_ + seconds;
    const int steps = std::floor((due + kTimeTolerance) / kSpringStepSeconds);
    for (int n = 1; n <= steps; ++n) {
      const double left = due - n * kSpringStepSeconds;  // from this step to the frame
      const double share = left > kTimeTolerance && seconds > 0.0 ? 1.0 - left / seconds : 1.0;
      interpolate(pose, std::max(share, 0.0));
      if (obstacles) obstacles->moveTo(std::max(share, 0.0));
      step(1.0, obstacles);
    }
    owed_ = due - steps * kSpringStepSeconds;
    if (owed_ > kTimeTolerance) {
      interpolate(pose, 1.0);
      if (obstacles) obstacles->moveTo(1.0);
      step(owed_ / kSpringStepSeconds, obstacles);
    }
  }
  for (const JointIndex j : order_) last_[j] = pose[j];
  for (std::size_t s = 0; s < joints_.size(); ++s) pose[joints_[s].joint].rotation = states_[s].rotation;
}

/// @param share  of a step; less than 1 leaves the momentum as it was after the last whole step
void SpringSimulation::step(double share, SpringObstacles* obstacles) {
  for (const JointIndex joint : order_) {
    place(joint);
    if (springOf_[joint] >= 0) swing(springOf_[joint], share, obstacles);
  }
}

void SpringSimulation::swing(std::size_t spring, double share, SpringObstacles* obstacles) {
  const SpringJoint& joint = joints_[spring];
  const Spring& constant = constants_[spring];
  State& state = states_[spring];
  const JointIndex parent = skeleton_.joint(joint.joint).parent;

  // 1. The joint as it would be at rest below its moved parent.
  JointTransform local = between_[joint.joint];
  local.rotation = constant.rest;
  const Affine3 atRest =
      parent == kNoJoint ? Affine3(local.matrix()) : Affine3(worldFromJoint_[parent] * local.matrix());
  const Vec3 head = atRest.translation();
  const Vec3 restTail = atRest.linear() * joint.tail;
  const double length = restTail.norm();
  if (!(length > kShortestSpring) || !std::isfinite(length)) return;  // a scale of 0 somewhere above

  // 2. Momentum, stiffness and gravity.
  const Vec3 momentum = (state.current - state.previous) * (1.0 - joint.dragForce);
  Vec3 from = state.current;
  Vec3 to = state.current + momentum;
  if (constant.center != kNoJoint) {
    from = worldFromJoint_[constant.center] * from;
    to = worldFromJoint_[constant.center] * to;
  }
  to += restTail * (joint.stiffness * kSpringStepSeconds / length) +
        joint.gravityDir * (joint.gravityPower * kSpringStepSeconds);
  Vec3 tail = from + share * (to - from);
  putAtDistance(head, length, tail);

  // 3. Colliders, one after the other.
  for (std::size_t c = constant.collidersBegin; c < constant.collidersEnd; ++c) {
    const SpringCollider& collider = springs_.colliders[colliders_[c]];
    if (const auto hit = hitCollider(collider, worldFromJoint_[collider.joint], tail, joint.hitRadius)) {
      tail += hit->depth * hit->direction;
      putAtDistance(head, length, tail);
    }
  }
  if (obstacles) obstacles->pushOut(spring, head, length, tail);

  // 4. The rotation that brings the tail there. A scale of 0 along one axis has no inverse: such a joint keeps still.
  const Mat3 jointFromWorld = atRest.linear().inverse();
  const Vec3 direction = jointFromWorld * (tail - head);
  if (!direction.allFinite() || !(direction.squaredNorm() > 0.0)) return;
  state.rotation = constant.rest * rotationBetween(constant.axis, direction);
  tails_[spring] = tail;
  if (share >= 1.0) {
    state.previous = state.current;
    state.current = constant.center == kNoJoint ? tail : Vec3(worldFromJoint_[constant.center].inverse() * tail);
  }
  place(joint.joint);
}

}  // namespace lorica

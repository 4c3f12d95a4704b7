#pragma once

#include "skinning/springs/spring_bones.h"

#include <cstddef>
#include <span>
#include <vector>

namespace lorica {

/// Length of a step of the springs [s].
inline constexpr double kSpringStepSeconds = 1.0 / 60.0;

/// Bodies that tails stay out of besides the colliders of the file, such as hulls and props.
class SpringObstacles {
 public:
  virtual ~SpringObstacles() = default;

  /// Called before each step. @param share  of the way from the last frame, 0, to this one, 1
  virtual void moveTo(double share) = 0;

  /// Moves a tail out of the obstacles, along the sphere around its head.
  /// @param spring  index into SpringSimulation::joints()
  /// @param head    world [m]
  /// @param length  from head to tail [m]
  /// @param tail    world [m], input and output
  virtual void pushOut(std::size_t spring, const Vec3& head, double length, Vec3& tail) = 0;
};

/// Swings the joints of a character: hair, ribbons, skirts with bones. Also applies its node constraints.
///
/// Each step moves every tail as VRMC_springBone 1.0 describes (section "SpringBone Algorithm"): it keeps its momentum
/// less the drag, is pulled towards its rest direction by stiffness x step and along gravity by gravityPower x step, is
/// put back to its distance from the joint, and is pushed out of colliders. How a spring behaves depends on the length
/// of the step, so steps always have 1/60 s, at which authors tune their models. The body's pose is interpolated to the
/// instant of each step. Where a frame lies between two steps, the tails are moved on by that share of a step, for this
/// frame only. Equal inputs give equal bits. Method and departures: docs/SPRINGS.md.
class SpringSimulation {
 public:
  /// @return the simulation, at rest; or the error of checkSprings()
  static Result<SpringSimulation> create(const Skeleton& skeleton, SpringBones springs);

  /// Moves the springs to a new frame. Allocates nothing.
  ///
  /// The first frame starts at rest, and so does a frame after a jump: a negative time, more than 0.25 s, or a chain
  /// that moved faster than 25 m/s.
  /// @param pose       local transforms of the skeleton. Input: the frame's pose; rotations of joints that swing or
  /// follow
  ///                   others are ignored. Output: the same with their rotations
  /// @param seconds    since the last frame
  /// @param obstacles  null = none
  void advance(std::span<JointTransform> pose, double seconds, SpringObstacles* obstacles = nullptr);

  /// Starts at rest in the next frame.
  void reset() { started_ = false; }

  [[nodiscard]] const SpringBones& springs() const { return springs_; }  ///< what is simulated
  /// The joints that swing, of all chains in order.
  [[nodiscard]] std::span<const SpringJoint> joints() const { return joints_; }
  /// Their tails in the last frame, world [m].
  [[nodiscard]] std::span<const Vec3> tails() const { return tails_; }

 private:
  /// What a step needs to know about one of joints().
  struct Spring {
    JointIndex center = kNoJoint;
    std::size_t collidersBegin = 0, collidersEnd = 0;  ///< in colliders_
    Vec3 axis = Vec3::UnitY();                         ///< direction of the tail in the joint's frame
    Quat rest = Quat::Identity();
  };
  struct State {
    Vec3 current = Vec3::Zero(), previous = Vec3::Zero();  ///< tails after the last two steps, relative to the centre
    Quat rotation = Quat::Identity();                      ///< of the joint
  };

  SpringSimulation(const Skeleton& skeleton, SpringBones springs);
  void orderJoints();
  void startAtRest();
  [[nodiscard]] bool jumped(std::span<const JointTransform> pose, double seconds);
  void interpolate(std::span<const JointTransform> pose, double share);
  void place(JointIndex joint);
  void step(double share, SpringObstacles* obstacles);
  void swing(std::size_t spring, double share, SpringObstacles* obstacles);

  Skeleton skeleton_;
  SpringBones springs_;
  std::vector<SpringJoint> joints_;
  std::vector<Spring> constants_;        ///< one for each of joints_
  std::vector<int> colliders_;           ///< of all chains
  std::vector<JointIndex> order_;        ///< joints that matter here, each after those that it depends on
  std::vector<int> springOf_;            ///< of each joint of the skeleton, or -1
  std::vector<std::size_t> chainRoots_;  ///< first of joints_ in each chain

  std::vector<State> states_;
  std::vector<Vec3> tails_;
  std::vector<Vec3> rootPositions_;  ///< of the chains in the last frame
  Pose last_, between_;              ///< the last frame's input; the input at the instant of a step
  std::vector<Affine3> worldFromJoint_;
  double owed_ = 0.0;  ///< time from the last step to the last frame [s]
  bool started_ = false;
};

}  // namespace lorica

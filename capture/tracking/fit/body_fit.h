#pragma once

#include "capture/tracking/fit/body_terms.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica::fit {

/// One stage of a fit: robust width, number of points, maximum number of steps.
struct FitStage {
  float width;  ///< residuals much larger than this have no further influence [m]
  int points;
  int steps;
};

/// Prior knowledge, independent of the image: a pose, and 1 / deviation^2 for each degree of freedom.
struct PosePrior {
  BodyPose pose;
  Step stiffness = Step::Zero();
};

/// Cost of a pose. Each part is a sum of squares over squared deviations; the image terms are robust.
struct FitCost {
  float points = 0.0F;     ///< distance of the seen points from the body, scaled to 600 points
  float freeSpace = 0.0F;  ///< body in front of the seen surface, or outside the person's outline
  float body = 0.0F;       ///< joint limits, self-collision, floor, usual poses, a head that a headset knows
  float rest = 0.0F;       ///< limbs away from rest
  float prior = 0.0F;
  [[nodiscard]] float image() const { return points + freeSpace; }
  [[nodiscard]] float plausible() const { return points + freeSpace + body + rest; }
  [[nodiscard]] float total() const { return points + freeSpace + body + rest + prior; }
};

/// What the camera saw of each capsule.
struct CapsuleSupport {
  std::array<int, kCapsuleCount> points{};
  std::array<float, kCapsuleCount> seen{};      ///< area of its points divided by the area of its middle section
  std::array<float, kCapsuleCount> distance{};  ///< mean absolute [m]
  /// Mean over its samples of how far they lie where the body cannot be [m].
  std::array<float, kCapsuleCount> violation{};
  std::array<float, kCapsuleCount> hidden{};  ///< fraction of its samples hidden behind something else
  std::array<float, 2> hiddenSide{};  ///< fraction of the left and right edge of the pelvis that something else hides
  float meanDistance = 0.0F;          ///< over all points, each clamped to 0.1 m [m]
  float unexplained = 0.0F;           ///< fraction of points farther than 0.08 m
};

/// Fits the body to a view by damped least squares (Levenberg-Marquardt). Steps that do not lower the true cost are
/// rejected. Of whom the view shows no more than the waist up, the legs stay as they are and explain nothing.
///
/// Every term pulls at points of the body along lines, so its part of the normal equations is a 6 x 6 matrix of
/// wrenches at a node. The matrices of a subtree are summed before they are projected onto the degrees of freedom, as
/// in the composite rigid body algorithm (Featherstone 1983). A point then costs 21 sums, not 43 * 43 / 2.
class BodyFitter {
 public:
  BodyFitter();

  /// @param pose  initial value; receives the result
  FitCost fit(const BodyView& view, const Proportions& proportions, const PosePrior& prior,
              std::span<const FitStage> stages, BodyPose& pose);

  /// Evaluates a pose without changing it.
  FitCost costOf(const BodyView& view, const Proportions& proportions, const PosePrior& prior, const FitStage& stage,
                 const BodyPose& pose);

  /// One step of pose and proportions together.
  /// @param deviation  how far each proportion may move from its present value
  void refineProportions(const BodyView& view, const std::array<float, kProportionCount>& deviation, BodyPose& pose,
                         Proportions& proportions);

  CapsuleSupport supportOf(const BodyView& view, const Proportions& proportions, const BodyPose& pose);

 private:
  using Gram = Eigen::Matrix<float, 6, 6>;
  using Wrench = Eigen::Matrix<float, 6, 1>;
  struct Equations {
    std::array<Gram, kNodeCount> gram;
    std::array<Wrench, kNodeCount> force;
    Eigen::Matrix<float, kDofCount, kDofCount> matrix;
    Step gradient;
  };
  [[nodiscard]] SurfaceMatch match(const BodyView& view, const BodyView::Point& point, int first) const;
  FitCost evaluate(const BodyView& view, const BodyPose& pose, const PosePrior& prior, const FitStage& stage,
                   bool linearize);
  void addPull(int node, const V3& at, const V3& derivative, float residual, float weight);
  float pointTerm(const BodyView& view, const FitStage& stage, bool linearize);
  float freeSpaceTerm(const BodyView& view, bool linearize);
  float collisionTerm(const BodyView& view, bool linearize);
  float headTerm(const BodyView& view, bool linearize);
  float poseTerm(const BodyPose& pose, bool linearize);
  float restTerm(const BodyView& view, const BodyPose& pose, bool linearize);
  void holdLegs();
  float priorTerm(const BodyPose& pose, const PosePrior& prior, bool linearize);
  void assemble();

  PosedModel body_;
  Equations equations_;
  std::vector<std::uint8_t> lastCapsule_;  ///< of each point
};

}  // namespace lorica::fit

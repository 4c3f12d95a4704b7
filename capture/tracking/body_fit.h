#pragma once

#include "capture/tracking/body_terms.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica::fit {

/// One stage of a fit: a robust width, how many points, how many steps at most.
struct FitStage {
  float width;  ///< residuals much larger than this count no further [m]
  int points;
  int steps;
};

/// What is expected before the image is looked at: a pose, and for each degree of freedom 1 / deviation^2.
struct PosePrior {
  BodyPose pose;
  Step stiffness = Step::Zero();
};

/// What a pose costs. Each part is a sum of squares over squared deviations, robust where the image is concerned.
struct FitCost {
  float points = 0.0F;     ///< distance of what was seen from the body, as if of 600 points
  float freeSpace = 0.0F;  ///< body before what was seen, or beside the person's outline
  float body = 0.0F;       ///< limits, self-collision, floor, usual poses
  float prior = 0.0F;
  [[nodiscard]] float image() const { return points + freeSpace; }
  [[nodiscard]] float plausible() const { return points + freeSpace + body; }
  [[nodiscard]] float total() const { return points + freeSpace + body + prior; }
};

/// What the camera saw of each capsule.
struct CapsuleSupport {
  std::array<int, kCapsuleCount> points{};
  std::array<float, kCapsuleCount> seen{};       ///< area of its points over that of its middle section
  std::array<float, kCapsuleCount> distance{};   ///< mean absolute [m]
  std::array<float, kCapsuleCount> violation{};  ///< mean over its samples of how far it is where it cannot be [m]
  std::array<float, kCapsuleCount> hidden{};     ///< share of its samples behind something else
  float meanDistance = 0.0F;                     ///< of all points, none further than 0.1 m [m]
  float unexplained = 0.0F;                      ///< share of points further than 0.08 m
};

/// Fits the body to a view: damped least squares (Levenberg-Marquardt) that takes a step only if the true cost falls.
///
/// Every term pulls at places of the body along lines, so its part of the normal equations is a 6 x 6 matrix of
/// wrenches at a node; those of a subtree are summed before they meet the degrees of freedom, as in the composite
/// rigid body algorithm (Featherstone 1983). A point then costs 21 sums, not 43 * 43 / 2.
class BodyFitter {
 public:
  BodyFitter();

  /// @param pose  where to start; written
  FitCost fit(const BodyView& view, const Proportions& proportions, const PosePrior& prior,
              std::span<const FitStage> stages, BodyPose& pose);

  /// Of a pose as it is.
  FitCost costOf(const BodyView& view, const Proportions& proportions, const PosePrior& prior, const FitStage& stage,
                 const BodyPose& pose);

  /// One step of pose and proportions together.
  /// @param deviation  how far each proportion may go from where it is
  void refineProportions(const BodyView& view, const std::array<float, kProportionCount>& deviation, BodyPose& pose,
                         Proportions& proportions);

  /// @param owner  of each of the view's points the capsule, or 255 where it is further than 0.1 m from all; may be
  /// null
  CapsuleSupport supportOf(const BodyView& view, const Proportions& proportions, const BodyPose& pose,
                           std::vector<std::uint8_t>* owner = nullptr);

 private:
  using Gram = Eigen::Matrix<float, 6, 6>;
  using Wrench = Eigen::Matrix<float, 6, 1>;
  struct Equations {
    std::array<Gram, kNodeCount> gram;
    std::array<Wrench, kNodeCount> force;
    Eigen::Matrix<float, kDofCount, kDofCount> matrix;
    Step gradient;
  };
  [[nodiscard]] SurfaceMatch match(const BodyView::Point& point, int first) const;
  FitCost evaluate(const BodyView& view, const BodyPose& pose, const PosePrior& prior, const FitStage& stage,
                   bool linearize);
  void addPull(int node, const V3& at, const V3& derivative, float residual, float weight);
  float pointTerm(const BodyView& view, const FitStage& stage, bool linearize);
  float freeSpaceTerm(const BodyView& view, bool linearize);
  float collisionTerm(bool linearize);
  float poseTerm(const BodyPose& pose, bool linearize);
  float priorTerm(const BodyPose& pose, const PosePrior& prior, bool linearize);
  void assemble();

  PosedBody body_;
  Equations equations_;
  std::vector<std::uint8_t> lastCapsule_;  ///< of each point
};

}  // namespace lorica::fit

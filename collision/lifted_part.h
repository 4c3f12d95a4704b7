#pragma once

#include "collision/lifted_point.h"
#include "collision/point_row.h"
#include "geometry/math.h"

#include <array>
#include <span>
#include <vector>

namespace lorica {

/// The lifted points of one part, packed so that a frame's bones give all of them in microseconds.
///
/// The part has a frame of its own: its origin is the mean of its points in every pose, its axes follow the best-fit
/// rotation from the bind pose. What is left in it is deformation only, so a part whose bones move as one stays as it
/// is, to the last digit, and need not be looked at.
class LiftedPart {
 public:
  /// @param points  at least one, over joints below jointCount of the character
  explicit LiftedPart(std::span<const LiftedPoint> points);

  [[nodiscard]] std::size_t pointCount() const { return order_.size(); }
  /// For each row that evaluate() writes, which of the points it is.
  [[nodiscard]] std::span<const std::int32_t> order() const { return order_; }
  /// Largest distance of a point from the mean, in the bind pose [m].
  [[nodiscard]] double radius() const { return radius_; }

  /// Best-fit rigid motion from the bind pose, from the bones alone: mean and covariance of lifted points are lifted.
  /// @param previous  rotation to stay near where the points leave it open
  [[nodiscard]] Isometry3 place(std::span<const Affine3> worldFromModel, const Mat3& previous) const;

  /// Takes a pose, as seen in the part's own frame.
  /// @param tick  length of a step of the grid [m]
  /// @return whether any point may have moved by more than a quarter of a step since the last pose that was taken;
  ///         where not, the pose is not taken and the rows of before still hold
  bool take(std::span<const Affine3> worldFromModel, const Isometry3& worldFromPart, double tick);

  /// Points in the pose taken, in the part's own frame, rounded to whole steps. The same on every instruction set.
  /// @param rows  rowCount() of them, written; those from pointCount() on are padding
  /// @return the largest absolute coordinate, in steps
  [[nodiscard]] float evaluate(std::span<PointRow> rows) const;
  [[nodiscard]] std::size_t rowCount() const { return rowCount_; }

  /// Bytes held.
  [[nodiscard]] std::size_t memory() const;

  /// One bone's terms of a few points, by coordinate.
  struct alignas(64) Terms {
    static constexpr std::size_t kPoints = 16;
    std::array<float, kPoints> x{}, y{}, z{};  ///< moment about the part's mean [m]
    std::array<float, kPoints> weight{};
  };
  /// A run of points that follow the same bones. Its rows beyond the last point are overwritten by the next group.
  struct Group {
    std::uint32_t firstRow = 0;
    std::uint32_t blocks = 0;      ///< of Terms::kPoints points
    std::uint32_t firstTerms = 0;  ///< blocks x bones of them
    std::uint32_t firstBone = 0;   ///< in groupBones_
    std::uint32_t bones = 0;
  };

 private:
  /// What the part needs of one bone: worldFromModel times these gives the bone's share of the sums over all points.
  struct BoneSums {
    JointIndex joint = 0;
    Vec3 meanMoment = Vec3::Zero();  ///< about the bind mean, as all moments here
    double meanWeight = 0.0;
    Eigen::Matrix<double, 4, 3> spread =
        Eigen::Matrix<double, 4, 3>::Zero();  ///< sum of (moment, weight) x bind offset
  };
  /// partFromWorld * worldFromModel of one bone, about the bind mean, in steps: three rows of four.
  using BoneMatrix = Eigen::Matrix<float, 3, 4, Eigen::RowMajor>;

  std::vector<std::int32_t> order_;
  std::vector<BoneSums> bones_;
  std::vector<BoneMatrix> taken_;  ///< one a bone
  std::vector<BoneMatrix> next_;   ///< scratch
  std::vector<Group> groups_;
  std::vector<std::uint32_t> groupBones_;  ///< indices into bones_
  std::vector<Terms> terms_;
  Vec3 bindMean_ = Vec3::Zero();
  double radius_ = 0.0;
  std::size_t rowCount_ = 0;
};

}  // namespace lorica

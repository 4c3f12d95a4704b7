#pragma once

#include "collision/live/lifted_point.h"
#include "collision/live/point_row.h"
#include "geometry/math.h"

#include <array>
#include <span>
#include <vector>

namespace lorica {

/// Four columns of x, y, z and a fourth number.
template <class Number>
struct alignas(4 * sizeof(Number)) FourColumns {
  std::array<std::array<Number, 4>, 4> column{};
};

/// The lifted points of one part, packed such that a frame's bones give all of them in microseconds. Immutable: any
/// number of characters may share one.
///
/// The part has its own frame: the origin is the mean of its points in the current pose, and the axes follow the
/// best-fit rotation from the bind pose, fitRotation(). In this frame only deformation is left, so a part whose bones
/// move as one stays the same to the last digit and need not be processed.
class LiftedPart {
 public:
  /// @param points   at least one, over joints below jointCount of the character
  /// @param carriers  for each joint of a shape (see Shapes) the joint that it hangs at, kNoJoint for others; empty =
  ///                 the character has no shapes. A shape whose weight is 0 takes no time.
  explicit LiftedPart(std::span<const LiftedPoint> points, std::span<const JointIndex> carriers = {});

  [[nodiscard]] std::size_t pointCount() const { return order_.size(); }
  /// The index of the point in each row that evaluate() writes.
  [[nodiscard]] std::span<const std::int32_t> order() const { return order_; }
  /// Largest distance of a point from the mean, in the bind pose [m].
  [[nodiscard]] double radius() const { return radius_; }

  /// Mean and covariance of lifted points are lifted too: a pose's bones give them independently of the number of
  /// points.
  struct Moments {
    Vec3 mean;        ///< world [m]
    Mat3 covariance;  ///< sum of (position about the mean) x (bind position about its mean)^T
  };
  [[nodiscard]] Moments momentsOf(std::span<const Affine3> worldFromModel) const;

  /// The last pose taken by one character: for each bone of the part partFromWorld * worldFromModel, about the bind
  /// mean, in steps; if there are shapes, followed by what evaluate() uses: theirs less their carriers', others as they
  /// are.
  using TakenPose = std::vector<FourColumns<float>>;
  /// The state before the first pose.
  [[nodiscard]] TakenPose noPose() const;

  /// Takes a pose, as seen in the part's own frame.
  /// @param tick  length of a step of the grid [m]
  /// @return whether any point may have moved by more than a quarter of a step since the last pose taken; if not, the
  /// pose is not taken and the previous rows stay valid
  bool take(std::span<const Affine3> worldFromModel, const Isometry3& worldFromPart, double tick,
            TakenPose& taken) const;

  /// Points in the pose taken, in the part's own frame, rounded to whole steps. The same on every instruction set.
  /// @param rows  rowCount() of them, written; those from pointCount() on are padding
  /// @return the largest absolute coordinate, in steps
  [[nodiscard]] float evaluate(const TakenPose& taken, std::span<PointRow> rows) const;
  [[nodiscard]] std::size_t rowCount() const { return rowCount_; }

  /// Memory in bytes.
  [[nodiscard]] std::size_t memory() const;

  /// Points with the same bones are stored in blocks of this size; a Lane holds one number of each.
  static constexpr std::size_t kBlock = 16;
  struct alignas(64) Lane {
    std::array<float, kBlock> of{};
  };
  /// A run of points that follow the same bones. Its rows beyond the last point are overwritten by the next group.
  ///
  /// Most points are mesh vertices: every bone moves the same position of the bind pose, so a block is x, y, z (about
  /// the part's mean, in metres) and a weight for each bone. A blend of differently weighted vertices has its own
  /// position for each bone: a block is x, y, z of the moment and the weight, bone after bone.
  struct Group {
    std::uint32_t firstRow = 0;
    std::uint32_t blocks = 0;
    std::uint32_t firstLane = 0;
    std::uint32_t firstBone = 0;  ///< in groupBones_
    std::uint32_t bones = 0;
    bool onePosition = false;  ///< x, y, z are stored once
    bool shapes = false;       ///< some of its bones are shapes
  };
  [[nodiscard]] static std::size_t lanesOfBlock(std::size_t bones, bool onePosition) {
    return onePosition ? 3 + bones : 4 * bones;
  }

 private:
  std::vector<std::int32_t> order_;
  std::vector<JointIndex> joints_;       ///< the part's bones
  std::vector<std::uint32_t> carriers_;  ///< of each bone: its carrier's index, or its own; empty = no shapes
  /// For each bone, the factors of its matrix in sums over all points, moments in model space: columns 0 to 2, (moment,
  /// weight) times the offset from the bind mean; column 3, the mean of (moment, weight).
  std::vector<FourColumns<double>> sums_;
  Vec3 offsetSum_ = Vec3::Zero();  ///< sum of weight times offset over all points: 0 if weights sum to one
  double weightMean_ = 1.0;        ///< 1 if weights sum to one
  std::vector<Group> groups_;
  std::vector<std::uint32_t> groupBones_;  ///< indices into joints_
  std::vector<Lane> lanes_;
  Vec3 bindMean_ = Vec3::Zero();
  double radius_ = 0.0;
  std::size_t rowCount_ = 0;
};

}  // namespace lorica

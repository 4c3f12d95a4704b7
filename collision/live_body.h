#pragma once

#include "acd/decomposition.h"
#include "geometry/convex_hull.h"
#include "geometry/math.h"

#include <span>
#include <vector>

namespace lorica {

/// One part of the avatar in the current frame, as physics and pictures see it.
struct LivePart {
  ConvexHull hull;                                  ///< world space [m]
  Isometry3 worldFromPart = Isometry3::Identity();  ///< best-fit rigid motion from the first frame
  Isometry3 previousWorldFromPart = Isometry3::Identity();
  std::vector<Vec3> residual;  ///< hull vertices in the part's own frame: worldFromPart^-1 * hull.vertices [m]
};

/// The body that physics can touch: a decomposition carried to each frame.
class LiveBody {
 public:
  explicit LiveBody(Decomposition decomposition);

  /// Carries the decomposition to a pose: points, hulls and rigid motions.
  /// @param posed  vertexCount positions of the mesh in this frame [m]
  void update(std::span<const Vec3> posed);

  [[nodiscard]] const Decomposition& decomposition() const { return decomposition_; }
  [[nodiscard]] std::span<const LivePart> parts() const { return parts_; }
  [[nodiscard]] std::span<const Vec3> points() const { return points_; }

  /// Time of the three steps of the last update [us].
  struct Timing {
    double transfer = 0, hulls = 0, motion = 0;
  };
  [[nodiscard]] const Timing& timing() const { return timing_; }

 private:
  Decomposition decomposition_;
  std::vector<Vec3> points_;
  std::vector<LivePart> parts_;
  std::vector<std::vector<Vec3>> firstPoints_;
  Timing timing_;
  bool started_ = false;
};

}  // namespace lorica

#pragma once

#include "acd/decomposition.h"
#include "geometry/convex_hull.h"
#include "geometry/math.h"

#include <span>
#include <vector>

namespace lorica {

/// One part of the avatar in the current frame, as physics and pictures see it.
///
/// A part's own frame has the world's axes and its origin at the mean of the part's points, both in the first frame.
/// Worn this way, the body of physics carries what is rigid in the motion, with its velocity, and only what is left
/// goes into the shape.
struct LivePart {
  ConvexHull hull;  ///< world space [m]; pointOfVertex counts in Part::points. No triangles while the part is flat
  Isometry3 worldFromPart = Isometry3::Identity();          ///< best-fit rigid motion since the first frame
  Isometry3 previousWorldFromPart = Isometry3::Identity();  ///< the same one frame ago; in the first frame, the same
  std::vector<Vec3> residual;  ///< hull vertices in the part's own frame: worldFromPart^-1 * hull.vertices [m]
};

/// The body that physics can touch: a decomposition carried to each frame.
class LiveBody {
 public:
  explicit LiveBody(Decomposition decomposition);

  /// Carries the decomposition to a pose: points, hulls and rigid motions. The first call sets the parts' own frames.
  /// @param posed  vertexCount positions of the mesh in this frame [m]
  void update(std::span<const Vec3> posed);

  [[nodiscard]] const Decomposition& decomposition() const { return decomposition_; }
  [[nodiscard]] std::span<const LivePart> parts() const { return parts_; }
  /// Mesh vertices and cut points in this frame, pointCount() of them [m].
  [[nodiscard]] std::span<const Vec3> points() const { return points_; }

  /// Time of the three steps of the last update [us].
  struct Timing {
    double transfer = 0, hulls = 0, motion = 0;
  };
  [[nodiscard]] const Timing& timing() const { return timing_; }

 private:
  void fitMotions();

  Decomposition decomposition_;
  std::vector<Vec3> points_;
  std::vector<LivePart> parts_;
  std::vector<std::vector<Vec3>> firstPoints_;  ///< of each part, in its own frame
  std::vector<std::vector<Vec3>> partPoints_;   ///< of each part, in this frame
  Timing timing_;
  bool started_ = false;
};

}  // namespace lorica

#pragma once

#include "geometry/math.h"

#include <BulletCollision/CollisionShapes/btConvexInternalShape.h>

#include <span>
#include <vector>

namespace lorica {

/// A part's hull for Bullet: the convex hull of points that may all change in every frame. The most frequent query, the
/// support point of a direction, is answered exactly, with SIMD instructions. Internal.
class PartShape : public btConvexInternalAabbCachingShape {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// The shape type in Bullet.
  static constexpr int kType = CUSTOM_CONVEX_SHAPE_TYPE;

  /// @param margin  inflation of the hull [m]
  explicit PartShape(btScalar margin);

  /// Reserves memory so that setPoints() with up to `count` points allocates nothing.
  void reserve(std::size_t count);
  /// @param points  in the part's frame, at least one [m]
  void setPoints(std::span<const Vec3> points);
  /// Bounds of the points, without the margin.
  [[nodiscard]] const btVector3& low() const { return low_; }
  [[nodiscard]] const btVector3& high() const { return high_; }

  btVector3 localGetSupportingVertexWithoutMargin(const btVector3& direction) const override;
  void batchedUnitVectorGetSupportingVertexWithoutMargin(const btVector3* directions, btVector3* points,
                                                         int count) const override;
  void calculateLocalInertia(btScalar mass, btVector3& inertia) const override;
  const char* getName() const override { return "PartShape"; }

 private:
  std::vector<float> coordinates_;  ///< all x, then all y, then all z
  int stride_ = 0;                  ///< points, rounded up to whole blocks
  btVector3 low_{0, 0, 0}, high_{0, 0, 0};
};

}  // namespace lorica

#include "collision/world/part_shape.h"

#include "collision/live/extent_kernel.h"
#include "geometry/counts.h"
#include "geometry/result.h"

#include <algorithm>

namespace lorica {

PartShape::PartShape(btScalar margin) {
  m_shapeType = kType;
  setMargin(margin);
}

void PartShape::reserve(std::size_t count) {
  coordinates_.reserve(3 * (count + kSupportBlock));
}

void PartShape::setPoints(std::span<const Vec3> points) {
  LORICA_CHECK(!points.empty(), "a shape needs at least one point");
  const int count = countOf(points);
  stride_ = (count + kSupportBlock - 1) / kSupportBlock * kSupportBlock;
  coordinates_.resize(3 * static_cast<std::size_t>(stride_));
  for (int axis = 0; axis < 3; ++axis) {
    float* row = coordinates_.data() + static_cast<std::ptrdiff_t>(axis) * stride_;
    float low = points[0][axis];
    float high = low;
    for (int i = 0; i < count; ++i) {
      row[i] = points[i][axis];
      low = std::min(low, row[i]);
      high = std::max(high, row[i]);
    }
    std::fill(row + count, row + stride_, row[0]);
    low_[axis] = low;
    high_[axis] = high;
  }
  const btVector3 margin(getMargin(), getMargin(), getMargin());
  setCachedLocalAabb(low_ - margin, high_ + margin);
}

btVector3 PartShape::localGetSupportingVertexWithoutMargin(const btVector3& direction) const {
  const float* x = coordinates_.data();
  const float* y = x + stride_;
  const float* z = y + stride_;
  const int i = supportIndex(x, y, z, stride_, direction.x(), direction.y(), direction.z());
  return {x[i], y[i], z[i]};
}

void PartShape::batchedUnitVectorGetSupportingVertexWithoutMargin(const btVector3* directions, btVector3* points,
                                                                  int count) const {
  for (int i = 0; i < count; ++i) points[i] = localGetSupportingVertexWithoutMargin(directions[i]);
}

void PartShape::calculateLocalInertia(btScalar /*mass*/, btVector3& inertia) const {
  inertia.setZero();  // parts are kinematic
}

}  // namespace lorica

#pragma once

#include "collision/live/live_body.h"

#include <memory>
#include <span>

namespace lorica {

/// A convex solid: everything within a radius of the convex hull of points. One point makes a ball, two a capsule,
/// eight corners a box.
struct RoundedShape {
  std::span<const Vec3> points;  ///< world [m], at least one
  double radius = 0.0;           ///< 0 or more [m]
};

/// A part of a body and a shape that overlap.
struct ShapeContact {
  PartIndex part = 0;              ///< of the body
  Vec3 position = Vec3::Zero();    ///< centre of the overlap at its deepest point, world [m]
  Vec3 direction = Vec3::UnitX();  ///< unit, from the part to the shape
  double depth = 0.0;              ///< if the shape moves this far along the direction, they just touch [m]
};

/// Finds the parts of a body that a shape overlaps.
class ShapeContactQuery {
 public:
  /// @param body  whose frames are queried
  explicit ShapeContactQuery(const LiveBody& body);
  ~ShapeContactQuery();
  ShapeContactQuery(ShapeContactQuery&&) noexcept;
  ShapeContactQuery& operator=(ShapeContactQuery&&) noexcept;

  /// The overlaps in a frame, sorted by part. The depth is the minimum translation that separates the two, to within
  /// 0.2 mm and 1 %; overlaps below 0.1 mm may be missed. Parts with flat hulls overlap nothing. Allocates nothing,
  /// unless the shape has more points than those before.
  /// @param parts  of the body, with LiveDetail::kFaces
  std::span<const ShapeContact> find(std::span<const LivePart> parts, const RoundedShape& shape);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lorica

#pragma once

#include "collision/live/live_body.h"

#include <memory>
#include <span>

namespace lorica {

/// Two non-neighbouring parts of one body that overlap.
struct SelfContact {
  PartIndex first = 0;             ///< smaller than `second`
  PartIndex second = 0;            ///< no neighbour of it
  Vec3 position = Vec3::Zero();    ///< centre of the overlap at its deepest point, world [m]
  Vec3 direction = Vec3::UnitX();  ///< unit, from the first part to the second
  double depth = 0.0;              ///< if the second part moves this far along the direction, they just touch [m]
};

/// Finds parts of a body that overlap but should not: a hand in the thigh, shins through each other.
///
/// Neighbours are excluded because their hulls always overlap. Neighbours are parts that share a point of the
/// decomposition, as the two sides of a cut do, and parts whose hulls are within 5 mm of each other in the rest pose.
/// Method: docs/LIVE_HULLS.md.
class SelfContactQuery {
 public:
  /// @param body  whose frames are queried
  /// @param rest  vertices of its mesh in the rest pose: a character's bind pose [m]
  SelfContactQuery(const LiveBody& body, std::span<const Vec3> rest);
  ~SelfContactQuery();
  SelfContactQuery(SelfContactQuery&&) noexcept;
  SelfContactQuery& operator=(SelfContactQuery&&) noexcept;

  /// Whether overlaps of these two are no contact: they share a point of the decomposition, or touch in the bind pose.
  [[nodiscard]] bool areNeighbours(PartIndex a, PartIndex b) const;

  /// The overlaps in a frame, sorted by first, then second part. The depth is the minimum translation that separates
  /// the two, to within 0.2 mm and 1 %; overlaps below 0.1 mm may be missed. Parts with flat hulls overlap nothing.
  /// Allocates nothing.
  /// @param parts  of the body, with LiveDetail::kFaces
  std::span<const SelfContact> find(std::span<const LivePart> parts);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lorica

#pragma once

#include "collision/live/live_body.h"

#include <memory>
#include <span>
#include <vector>

namespace lorica {

/// Two parts of one body that overlap though they are not neighbours.
struct SelfContact {
  PartIndex first = 0, second = 0;  ///< first < second
  Vec3 place = Vec3::Zero();        ///< the middle of the overlap where it is deepest, world [m]
  Vec3 direction = Vec3::UnitX();   ///< unit, from the first part to the second
  double depth = 0.0;               ///< moved so far along the direction, the second just touches the first [m]
};

/// Asks a body which of its parts overlap that should not: a hand in the thigh, shins through each other.
///
/// Neighbours are left out, for their hulls always overlap: parts that share a point of the decomposition, which those
/// on both sides of a cut do, and parts whose hulls are within 5 mm of each other in the rest pose.
/// How: docs/LIVE_HULLS.md.
class SelfContactQuery {
 public:
  /// @param body  of which frames are asked about
  /// @param rest  vertices of its mesh in the rest pose: a character's bind pose [m]
  SelfContactQuery(const LiveBody& body, std::span<const Vec3> rest);
  ~SelfContactQuery();
  SelfContactQuery(SelfContactQuery&&) noexcept;
  SelfContactQuery& operator=(SelfContactQuery&&) noexcept;

  [[nodiscard]] bool areNeighbours(PartIndex a, PartIndex b) const;

  /// The overlaps in a frame, by first, then second part. The depth is the least that parts the two, to within 0.2 mm
  /// and 1 %; overlaps below 0.1 mm may be missed. Parts with flat hulls overlap nothing. Allocates nothing.
  /// @param parts  of the body, with LiveDetail::kFaces
  std::span<const SelfContact> find(std::span<const LivePart> parts);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lorica

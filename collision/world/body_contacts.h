#pragma once

#include "acd/decomposition.h"
#include "collision/live/live_part.h"

#include <cstddef>
#include <memory>
#include <span>

namespace lorica {

/// A body among others in one frame.
struct BodyInWorld {
  std::span<const LivePart> parts;  ///< with LiveDetail::kFaces; none: the body is not there
  std::span<const double> masses;   ///< of each part [kg]
};

/// Two parts of different bodies that overlap.
struct BodyContact {
  int firstBody = 0;                     ///< smaller than secondBody
  int secondBody = 0;                    ///< index in what was asked
  PartIndex firstPart = 0;               ///< of the first body
  PartIndex secondPart = 0;              ///< of the second body
  Vec3 position = Vec3::Zero();          ///< centre of the overlap at its deepest point, world [m]
  Vec3 direction = Vec3::UnitX();        ///< unit, from the first part to the second
  double depth = 0.0;                    ///< if the second part moves this far along the direction, they just touch [m]
  Vec3 relativeVelocity = Vec3::Zero();  ///< of the second part as seen from the first, at the position [m/s]
  double strength = 0.0;                 ///< speed of approach x mass of the lighter part, see closingSpeed() [N s]
};

/// Finds parts of different bodies that overlap. The bodies do not yield: they follow people.
///
/// Broad phase: bodies in the order of their smallest x, then the parts in the overlap of two bodies' boxes. Narrow
/// phase: as for contacts of a body with itself (SelfContactQuery), with the same accuracy.
class BodyContactQuery {
 public:
  /// Pairs of parts that are examined in one frame at most. A hundred crowded avatars have some 3,000.
  static constexpr std::size_t kMaxPairs = 40'000;

  BodyContactQuery();
  ~BodyContactQuery();
  BodyContactQuery(BodyContactQuery&&) noexcept;
  BodyContactQuery& operator=(BodyContactQuery&&) noexcept;

  /// The overlaps in a frame, sorted by first and second body, then first and second part. Parts with flat hulls
  /// overlap nothing. Allocates nothing once the most bodies and contacts of a frame have been seen.
  /// @param seconds  since the last frame, above 0
  std::span<const BodyContact> find(std::span<const BodyInWorld> bodies, double seconds);

  /// Whether the last frame had more pairs than kMaxPairs; the rest was left out, the same in every run.
  [[nodiscard]] bool tooMany() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lorica

#pragma once

#include "acd/decomposition.h"
#include "acd/hull_cover.h"
#include "collision/live/lifted_point.h"
#include "geometry/result.h"
#include "skinning/character.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// Data common to all live bodies of one decomposition: created once, immutable, shared by any number of LiveBody. A
/// body itself holds only what depends on its own pose.
class BodyPlan {
 public:
  /// For a character.
  /// @param decomposition  made from the character's mesh
  /// @param cover          made from the same decomposition and character; none = the posed surface is covered exactly
  ///                       in every pose, coverExactly()
  /// @return the plan; or kInvalidArgument if the decomposition or the cover does not fit the character
  static Result<std::shared_ptr<const BodyPlan>> create(Decomposition decomposition, const Character& character,
                                                        std::optional<HullCover> cover = std::nullopt);
  /// For a mesh sequence.
  /// @return the plan; or kInvalidArgument if the decomposition is inconsistent
  static Result<std::shared_ptr<const BodyPlan>> create(Decomposition decomposition);

  ~BodyPlan();
  BodyPlan(const BodyPlan&) = delete;
  BodyPlan& operator=(const BodyPlan&) = delete;

  [[nodiscard]] const Decomposition& decomposition() const { return decomposition_; }  ///< the parts that move
  /// How far the surface is guaranteed to be inside the hulls
  [[nodiscard]] const HullCover& coverage() const { return cover_; }
  /// Points that form a part's hull.
  [[nodiscard]] std::span<const PointIndex> candidates(PartIndex part) const;
  /// Memory in bytes, without the decomposition and the hull cover.
  [[nodiscard]] std::size_t memory() const;

 private:
  friend class LiveBody;
  struct PartPlan;
  explicit BodyPlan(Decomposition decomposition);
  void lift(std::span<const LiftedPoint> lifted, std::span<const JointIndex> carriers);

  Decomposition decomposition_;
  HullCover cover_;
  std::vector<PartPlan> parts_;
};

}  // namespace lorica

#pragma once

#include "acd/decomposition.h"
#include "acd/hull_cover.h"
#include "collision/live/lifted_part.h"
#include "skinning/character.h"

#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// What all live bodies of one decomposition have in common: made once, never changed, shared by any number of
/// LiveBody. What a body costs beside it is what follows its own pose.
class BodyPlan {
 public:
  /// For a character whose posed surface is to be covered exactly, in every pose: coverExactly().
  /// @param decomposition  made from the character's mesh
  BodyPlan(Decomposition decomposition, const Character& character);
  /// For a character's body of few points, which keeps what a promise says.
  /// @param cover  made from the same decomposition and character
  BodyPlan(Decomposition decomposition, const Character& character, CoverPromise cover);
  /// For a mesh sequence.
  explicit BodyPlan(Decomposition decomposition);

  struct PartPlan {
    std::vector<PointIndex> candidates;  ///< points that the hull is made of, in the order of the frame's rows
    std::optional<LiftedPart> lifted;    ///< of a character
  };

  [[nodiscard]] const Decomposition& decomposition() const { return decomposition_; }
  [[nodiscard]] const CoverPromise& coverage() const { return cover_; }
  [[nodiscard]] std::span<const PartPlan> parts() const { return parts_; }
  /// Bytes held, beside the decomposition and the promise.
  [[nodiscard]] std::size_t memory() const;

 private:
  void lift(std::span<const LiftedPoint> lifted);

  Decomposition decomposition_;
  CoverPromise cover_;
  std::vector<PartPlan> parts_;
};

}  // namespace lorica

#pragma once

#include "acd/decomposition.h"
#include "collision/live/live_part.h"
#include "skinning/character.h"

#include <vector>

namespace lorica {

/// Tells which joint moves a place on the body most.
///
/// The place is taken to be where it is nearest to its part's hull. A corner of the hull is a point of the body that
/// joints move with known weights; inside a face the weights are blended as the corners are. The joint with the largest
/// weight it is, of equal ones the first.
class ContactBones {
 public:
  /// @param decomposition  made from the character's mesh
  ContactBones(const Decomposition& decomposition, const Character& character);

  /// Allocates nothing.
  /// @param part   of a body of that decomposition
  /// @param place  world [m]
  /// @return kNoJoint for a part without faces
  [[nodiscard]] JointIndex at(const LivePart& part, const Vec3& place);

 private:
  struct Share {
    JointIndex joint = 0;
    double weight = 0.0;
  };
  std::vector<Share> shares_;             // of all points
  std::vector<std::size_t> sharesBegin_;  // of each point, and the end
  std::vector<double> weights_;           // scratch, of each joint
};

}  // namespace lorica

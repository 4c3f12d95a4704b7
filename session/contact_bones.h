#pragma once

#include "acd/decomposition.h"
#include "collision/live/live_part.h"
#include "skinning/character.h"

#include <memory>
#include <vector>

namespace lorica {

/// Finds the joint with the most influence on a position on the body.
///
/// The position is projected to the nearest point of its part's hull. Each vertex of the hull is a point of the body
/// with known joint weights; inside a face, the weights are interpolated barycentrically. The joint with the largest
/// weight is returned, the first one if several are equal.
///
/// Copies share the weights.
class ContactBones {
 public:
  /// @param decomposition  made from the character's mesh
  ContactBones(const Decomposition& decomposition, const Character& character);

  /// Allocates nothing.
  /// @param part      of a body of that decomposition
  /// @param position  world [m]
  /// @return kNoJoint for a part without faces
  [[nodiscard]] JointIndex at(const LivePart& part, const Vec3& position);

 private:
  struct Share {
    JointIndex joint = 0;
    double weight = 0.0;
  };
  struct Points {
    std::vector<Share> shares;       // of all points
    std::vector<std::size_t> begin;  // of each point, and the end
  };
  std::shared_ptr<const Points> points_;
  std::vector<double> weights_;  // scratch, of each joint
};

}  // namespace lorica

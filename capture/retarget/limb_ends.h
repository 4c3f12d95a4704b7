#pragma once

#include "skinning/character.h"

#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// A character's mesh in its rest pose, told apart by the joint that each vertex follows most.
class RestMesh {
 public:
  explicit RestMesh(const Character& character);

  /// The vertices of all joints that are marked [m], world.
  /// @param marked  one a joint
  [[nodiscard]] std::vector<Vec3> pointsOf(const std::vector<bool>& marked) const;
  [[nodiscard]] bool carriesVertices(JointIndex joint) const;

 private:
  std::vector<Vec3> point_;
  std::vector<JointIndex> follows_;  ///< one a vertex
  std::vector<bool> carries_;        ///< one a joint
};

/// The end of the hand: as far from the limb's last joint as the limb's vertices reach, along the line to their middle.
/// @return nothing where there are no vertices, or they lie about the joint
[[nodiscard]] std::optional<Vec3> armEnd(std::span<const Vec3> points, const Vec3& lastJoint);

/// The ankle: a tenth of the leg above the sole, on the line down the leg's shaft; the foot that sticks out of the
/// shaft does not count.
/// @param above  how much of the leg lies above its last joint [m]
[[nodiscard]] std::optional<Vec3> legEnd(std::span<const Vec3> points, const Vec3& lastJoint, double above);

/// Few of the points, such that with them all others stay above a floor that tilts by less than about 50 degrees.
[[nodiscard]] std::vector<Vec3> solePoints(std::span<const Vec3> points);

}  // namespace lorica

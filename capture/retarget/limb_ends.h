#pragma once

#include "skinning/character.h"

#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// A character's mesh in its rest pose, grouped by the joint with the largest weight at each vertex.
class RestMesh {
 public:
  explicit RestMesh(const Character& character);

  /// Returns the vertices of all marked joints [m], world.
  /// @param marked  one per joint
  [[nodiscard]] std::vector<Vec3> pointsOf(const std::vector<bool>& marked) const;
  [[nodiscard]] bool carriesVertices(JointIndex joint) const;

 private:
  std::vector<Vec3> point_;
  std::vector<JointIndex> follows_;  ///< one per vertex
  std::vector<bool> carries_;        ///< one per joint
};

/// The end of the hand: on the line from the limb's last joint to the centroid of its vertices, at the largest extent
/// of the vertices along that line.
/// @return nullopt if there are no vertices or they surround the joint
[[nodiscard]] std::optional<Vec3> armEnd(std::span<const Vec3> points, const Vec3& lastJoint);

/// The ankle: a tenth of the leg above the sole, on the line down the leg's shaft; the protruding foot is not part of
/// the shaft.
/// @param above  length of the leg above its last joint [m]
[[nodiscard]] std::optional<Vec3> legEnd(std::span<const Vec3> points, const Vec3& lastJoint, double above);

/// A small subset of the points. If the subset is above a floor that tilts by less than about 50 degrees, so are all
/// points.
[[nodiscard]] std::vector<Vec3> solePoints(std::span<const Vec3> points);

}  // namespace lorica

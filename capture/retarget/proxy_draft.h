#pragma once

#include "capture/retarget/proxy_skeleton.h"
#include "geometry/counts.h"
#include "skinning/character.h"
#include "skinning/humanoid/humanoid_words.h"

#include <array>
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

/// A skeleton under construction: the original joints with their indices, then the added ones.
struct SkeletonDraft {
  std::vector<Joint> joints;   ///< a parent may come after its child
  std::vector<Quat> rotation;  ///< world, at rest
  std::vector<Affine3> world;  ///< at rest
  std::array<JointIndex, kHumanBoneCount> jointOf{};

  explicit SkeletonDraft(const Skeleton& skeleton);

  [[nodiscard]] JointIndex operator[](HumanBone bone) const { return jointOf[ordinalOf(bone)]; }
  [[nodiscard]] Vec3 position(JointIndex joint) const { return world[joint].translation(); }
  [[nodiscard]] bool isBelowOrSame(JointIndex joint, JointIndex ancestor) const;
};

/// A proxy skeleton under construction, whose joints keep their original rest. Internal to proxy_skeleton.cpp.
struct ProxyDraft : SkeletonDraft {
  const Character& character;
  RestMesh mesh;
  std::vector<JointName> names;
  std::vector<ProxySkeleton::Substitute> substitutes;
  std::vector<ProxySkeleton::Stray> strays;

  explicit ProxyDraft(const Character& made);

  /// The vertices that follow one joint of the character [m], world.
  [[nodiscard]] std::vector<Vec3> pointsOf(JointIndex joint) const;

  /// Adds the missing bones of one limb. @return whether it succeeded
  bool complete(std::size_t limb);
  /// Attaches joints that carry vertices but do not move with their limb to the nearest bone, with all below them:
  /// those outside the hips, and controls on the hips or the trunk that carry the mesh of a hand or foot.
  void attachStrays();

 private:
  /// Whether a joint hangs on the hips or the trunk, in no limb, and carries no bone.
  [[nodiscard]] bool isOnTrunk(JointIndex joint) const;
  void name(HumanBone bone, JointIndex joint);
  JointIndex add(HumanBone bone, JointIndex parent, const Vec3& where);
  [[nodiscard]] std::vector<Vec3> pointsBelow(JointIndex top) const;
  [[nodiscard]] JointIndex findEnd(std::size_t limb, JointIndex last, const std::optional<Vec3>& meshEnd) const;
  void nameToes(HumanBone toes, JointIndex foot);
  [[nodiscard]] JointIndex nearestBone(const Vec3& point) const;
  [[nodiscard]] JointIndex bareEndNear(JointIndex control, const Vec3& point) const;
};

/// Joint order: parents before children, otherwise unchanged. @param joints  a parent may come after its child
[[nodiscard]] std::vector<JointIndex> parentsFirst(std::span<const Joint> joints);

}  // namespace lorica

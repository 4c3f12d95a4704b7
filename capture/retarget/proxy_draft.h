#pragma once

#include "capture/retarget/limb_ends.h"
#include "capture/retarget/proxy_skeleton.h"
#include "skinning/humanoid/humanoid_words.h"

#include <array>
#include <optional>
#include <vector>

namespace lorica {

/// A proxy skeleton under construction: the character's joints with their original indices, then the added ones.
/// Internal to proxy_skeleton.cpp.
struct ProxyDraft {
  const Character& character;
  RestMesh mesh;
  std::vector<JointName> names;
  std::vector<Joint> joints;  ///< a parent may come after its child; rest is the original one
  std::vector<Quat> rotation;
  std::vector<Affine3> world;
  std::array<JointIndex, kHumanBoneCount> jointOf{};
  std::vector<ProxySkeleton::Substitute> substitutes;
  std::vector<ProxySkeleton::Stray> strays;

  explicit ProxyDraft(const Character& of);

  [[nodiscard]] JointIndex operator[](HumanBone bone) const { return jointOf[static_cast<std::size_t>(bone)]; }
  [[nodiscard]] Vec3 position(JointIndex joint) const { return world[static_cast<std::size_t>(joint)].translation(); }
  [[nodiscard]] bool isBelowOrSame(JointIndex joint, JointIndex ancestor) const;
  /// The vertices that follow one joint of the character [m], world.
  [[nodiscard]] std::vector<Vec3> pointsOf(JointIndex joint) const;

  /// Adds the missing bones of one limb. @return whether it succeeded
  bool complete(std::size_t limb);
  /// Attaches joints that carry vertices but do not move with their limb to the nearest bone, with all below them:
  /// those outside the hips, and controls on the hips or the trunk that carry the mesh of a hand or foot.
  void attachStrays();
  /// Joint order: parents before children, otherwise unchanged.
  [[nodiscard]] std::vector<JointIndex> order() const;

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

}  // namespace lorica

#pragma once

#include "capture/retarget/mirrored_axes.h"
#include "capture/retarget/retarget_rig.h"
#include "geometry/result.h"
#include "skinning/character.h"
#include "skinning/clip.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

struct ProxyDraft;

/// A retargetable skeleton that substitutes for one that is not: for example that of a game character whose feet are
/// children of the root, used as IK targets, or whose limbs have one joint each.
///
/// A hand or foot attached elsewhere is attached to its limb here, with all joints below it. Candidates are the joint
/// of that bone; a joint with a matching name near the limb's end; or a joint outside the hips at the limb's end. If
/// there is none, a joint without influence is added at the end of the limb's mesh. A limb without a lower bone gets a
/// joint halfway to its end. When mapped back, that limb is straight and points at its end in the proxy; the hips are
/// raised if this would put the sole below the floor, y = 0.
///
/// A joint that carries vertices but is not below the hips would stay behind when the body walks: the IK foot of a rig
/// whose leg ends in a bone of the same name without a mesh. It is attached to the nearest bone. So is a control on the
/// hips or the trunk that carries the mesh of a hand or foot.
///
/// The soles of a rig are estimates. Where the mesh of a foot reaches farther, the foot is levelled until it is not
/// below the floor; if that is not enough, the hips are raised.
///
/// Negative scales that mirror the axes of joints are undone in the proxy.
///
/// If a skeleton can be retargeted as is, the proxy equals that skeleton. Keeps no state between frames but has buffers
/// for one frame: use one instance per thread.
class ProxySkeleton {
 public:
  /// A bone of the proxy that the character lacks or has elsewhere.
  struct Substitute {
    HumanBone bone;
    JointIndex joint = kNoJoint;  ///< the character's joint that is attached to the limb; kNoJoint if one is added
    JointIndex on = kNoJoint;     ///< the last joint of the character's limb
  };

  /// A joint that carries vertices outside the hips, or those of a hand or foot that hangs elsewhere.
  struct Stray {
    JointIndex joint = kNoJoint;  ///< of the character
    JointIndex on = kNoJoint;     ///< the bone that it is attached to; kNoJoint: none is near, it stays behind
  };

  /// @param character  with its humanoid bones, checkCharacter() passed
  /// @return the proxy; or an error with the missing bones if hips, spine or an upper limb is missing, or if a limb
  /// without an end has no mesh
  static Result<ProxySkeleton> create(const Character& character);

  [[nodiscard]] const Skeleton& skeleton() const { return skeleton_; }
  /// Whether the proxy is the character's own skeleton.
  [[nodiscard]] bool isOwn() const { return proxyOf_.empty(); }
  [[nodiscard]] std::span<const Substitute> substitutes() const { return substitutes_; }
  [[nodiscard]] std::span<const Stray> strays() const { return strays_; }

  /// The proxy joint that corresponds to a joint of the character.
  [[nodiscard]] JointIndex proxyOf(JointIndex own) const { return proxyOf_.empty() ? own : proxyOf_[own]; }

  /// Writes the character's pose that looks like a pose of the proxy. Joints attached elsewhere keep their rest scale.
  /// Allocates nothing.
  /// @param proxyPose  skeleton().jointCount() local transforms
  /// @param pose       the character's jointCount local transforms, written
  void mapBack(std::span<const JointTransform> proxyPose, std::span<JointTransform> pose);
  /// Maps back a motion of skeleton(), frame by frame.
  [[nodiscard]] SkeletalMotion mapBack(SkeletalMotion motion);

 private:
  /// A limb whose lower joint the character lacks.
  struct StiffLimb {
    JointIndex upper, lower, end;  ///< of the proxy
    Vec3 along;                    ///< unit, from upper to end at rest, in the upper joint's frame
  };
  struct SolePoint {
    JointIndex joint;  ///< of the proxy
    Vec3 position;     ///< in the joint
  };

  /// A foot whose mesh reaches below the estimated sole when it is pitched.
  struct Foot {
    JointIndex joint = kNoJoint;    ///< of the proxy
    Quat level = Quat::Identity();  ///< its rotation at rest, world
    double floor = 0.0;             ///< height that its mesh may reach down to [m]
    std::vector<SolePoint> points;
  };

  ProxySkeleton() = default;
  /// Of a character without mirrored axes.
  static Result<ProxySkeleton> createStraight(const Character& character);
  /// The feet that need levelling, by the proxy's rig.
  [[nodiscard]] static std::vector<Foot> longFeet(const ProxyDraft& draft, const RetargetRig& rig,
                                                  std::span<const JointIndex> proxyOf);
  void makeBuffers();
  void levelFeet();
  void raiseHips();
  void stiffen(std::span<const JointTransform> proxyPose);

  Skeleton own_;  ///< without mirrored axes
  std::optional<MirroredAxes> mirrored_;
  Skeleton skeleton_;
  std::vector<Substitute> substitutes_;
  std::vector<Stray> strays_;
  std::vector<JointIndex> proxyOf_;  ///< one per joint of the character
  std::vector<bool> sameParent_;     ///< one per joint of the character: its local transform equals the proxy's
  std::vector<StiffLimb> stiff_;
  std::vector<SolePoint> soles_;  ///< of legs without feet or shins of their own
  std::vector<Foot> feet_;
  Affine3 hipsParentFromWorld_ = Affine3::Identity();

  Pose shown_;  ///< of the proxy, with stiff limbs straightened
  std::vector<Quat> proxyRotation_, ownRotation_;
  std::vector<Affine3> worldFromProxy_, worldFromOwn_;
};

/// A sentence for each joint of a character that a humanoid's motion leaves behind although it carries a part of the
/// mesh.
[[nodiscard]] std::vector<std::string> leftBehind(const Character& character);

/// The joint above each of a character's: in its proxy if it needs one, where hands and feet hang on their limbs;
/// kNoJoint = none. What moves or weighs a body part by part uses these.
[[nodiscard]] std::vector<JointIndex> parentsOf(const Character& character);

/// Whether a character can perform any humanoid's motion, if necessary through a proxy skeleton.
[[nodiscard]] bool canPerform(const Character& character);

}  // namespace lorica

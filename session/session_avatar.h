#pragma once

#include "acd/hull_cover.h"
#include "acd/training_range.h"
#include "collision/live/lifted_point.h"
#include "collision/live/live_body.h"
#include "collision/live/part_bones.h"
#include "collision/world/prop.h"
#include "collision/world/self_contact.h"
#include "session/aligned_source.h"
#include "session/contact_bones.h"
#include "session/pose_source.h"
#include "skinning/character.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

class SessionSprings;
struct SpringBones;
enum class SpringMode : std::uint8_t;

/// Time of each stage of an avatar's frame [us]; retarget includes smoothing and forward kinematics, but not the time
/// that the source waited for joints; springs includes node constraints and is 0 if there are none.
struct AvatarTimes {
  /// @{
  /// Of a stage [s].
  double retarget = 0, springs = 0, motion = 0, points = 0, hulls = 0;
  /// @}
};

/// One avatar of a session: a character, what moves it, and its body.
class SessionAvatar {
 public:
  ~SessionAvatar();
  SessionAvatar(SessionAvatar&&) noexcept;
  SessionAvatar& operator=(SessionAvatar&&) noexcept;
  /// @param source    poses of the character's skeleton
  /// @param cover     made from the same decomposition and character; without one the hulls cover the body exactly
  /// @param training  of the same decomposition, for trainingDistance()
  /// @return the avatar, or an error if the decomposition belongs to another mesh, or the cover or training range to
  ///         another decomposition
  static Result<SessionAvatar> create(Character character, Decomposition decomposition,
                                      std::unique_ptr<PoseSource> source, std::optional<HullCover> cover = std::nullopt,
                                      std::optional<TrainingRange> training = std::nullopt);

  /// An avatar of the same kind with another source: they share the character and the constants of the body. It has no
  /// springs.
  [[nodiscard]] SessionAvatar another(std::unique_ptr<PoseSource> source) const;

  /// Where it performs. Call it before the avatar is added to a session.
  /// @param worldFromMotion  rigid: moves and turns the poses of the source
  void setPlace(const Isometry3& worldFromMotion);

  [[nodiscard]] const Character& character() const { return kind_->character; }  ///< shared by all avatars of its kind
  [[nodiscard]] const PoseSource& source() const { return source_.source(); }    ///< where its poses come from
  /// Whether it is there. While it is not, it keeps its last pose, is not drawn and touches nothing.
  [[nodiscard]] bool present() const { return source_.present(); }
  /// Null if there are none.
  [[nodiscard]] const SessionSprings* springs() const { return springs_.get(); }
  /// Local transforms of the character's joints, without springs.
  [[nodiscard]] std::span<const JointTransform> pose() const { return source_.pose(); }
  /// One for each joint, in this frame [m]
  [[nodiscard]] std::span<const Affine3> worldFromJoint() const { return worldFromJoint_; }
  /// The posed mesh vertices and cut points, pointCount() in total [m]. Only rendering needs them; they are computed on
  /// demand.
  [[nodiscard]] std::span<const Vec3> points() const;
  [[nodiscard]] const LiveBody& body() const { return body_; }  ///< its parts and their hulls
  /// Its parts in this frame; none while it is not there.
  [[nodiscard]] std::span<const LivePart> partsInWorld() const;
  /// Distance of this frame's pose from the poses that trained the decomposition [m], see acd/training_range.h. None
  /// before the first frame and without a training range. Computed on demand from the bones, without skinning;
  /// allocates nothing.
  [[nodiscard]] std::optional<double> trainingDistance() const;
  /// Whether the pose is outside the training range.
  [[nodiscard]] bool outsideKnownRange() const;
  /// Of the decomposition; none = not known
  [[nodiscard]] const std::optional<TrainingRange>& training() const { return kind_->training; }
  /// Overlapping parts of the body that are not neighbours in the bind pose. Computed on demand; the first call creates
  /// the query, later calls allocate nothing.
  [[nodiscard]] std::span<const SelfContact> selfContacts() const;
  /// Whether two parts are neighbours, whose overlaps are no contacts: see SelfContactQuery.
  [[nodiscard]] bool areNeighbours(PartIndex a, PartIndex b) const { return contactQuery().areNeighbours(a, b); }
  /// The bone that moves a point on a part of this frame, see ContactBones.
  [[nodiscard]] JointIndex boneAt(PartIndex part, const Vec3& position) const;
  /// Number of frames in which it was there.
  [[nodiscard]] int frameCount() const { return frameCount_; }
  /// Chained XXH3 hash of the shapes and poses of its parts in all frames in which it was there.
  [[nodiscard]] std::uint64_t hash() const { return hash_; }
  [[nodiscard]] const AvatarTimes& times() const { return times_; }  ///< of the last step

 private:
  friend class Session;  // moves it through the frames

  /// What avatars of one kind share.
  struct Kind {
    Character character;
    std::optional<TrainingRange> training;
    std::vector<LiftedPoint> probes;  ///< of the training range
  };
  using JointsOfParts = std::vector<std::vector<JointShare>>;
  SessionAvatar(std::shared_ptr<const Kind> kind, LiveBody body, JointsOfParts joints, ContactBones bones,
                std::unique_ptr<PoseSource> source);

  /// Poses the character and moves its body, from the pose of the source.
  /// @param seconds  since the last frame, as the source says
  void update(double seconds, std::span<const Prop> props);
  void addToHash();
  [[nodiscard]] Result<void> setSprings(const SpringBones& springs, SpringMode mode);
  void setBody(std::shared_ptr<const BodyPlan> plan);
  void restart(std::unique_ptr<PoseSource> source);
  void passTrustOn();
  [[nodiscard]] SelfContactQuery& contactQuery() const;

  std::shared_ptr<const Kind> kind_;
  std::optional<Isometry3> place_;
  AlignedSource source_;
  LiveBody body_;
  JointsOfParts jointsOfPart_;
  mutable ContactBones contactBones_;  // has scratch
  mutable std::optional<SelfContactQuery> selfContacts_;
  mutable std::vector<Vec3> probePositions_;  // scratch
  std::unique_ptr<SessionSprings> springs_;
  std::vector<Affine3> worldFromJoint_, worldFromModel_;
  mutable std::vector<Vec3> points_;  // of the frame pointsFrame_
  mutable int pointsFrame_ = -1;
  AvatarTimes times_;
  int frameCount_ = 0;
  bool wasPresent_ = false;  // in the last frame
  std::uint64_t hash_ = 0;
};

}  // namespace lorica

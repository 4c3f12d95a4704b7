#pragma once

#include "acd/hull_cover.h"
#include "acd/training_range.h"
#include "collision/live/lifted_point.h"
#include "collision/live/live_body.h"
#include "collision/world/self_contact.h"
#include "collision/world/world.h"
#include "session/contact_bones.h"
#include "session/part_bones.h"
#include "session/pose_source.h"
#include "session/session_springs.h"
#include "session/step_watcher.h"
#include "session/world_action.h"
#include "skinning/character.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace lorica {

/// Time of each stage of one frame [us]; retarget includes smoothing and forward kinematics, but not the time that the
/// source waited for joints; springs includes node constraints; springs and particles are 0 if there are none.
struct StageTimes {
  double retarget = 0, springs = 0, motion = 0, points = 0, hulls = 0, physics = 0, particles = 0;
  [[nodiscard]] double total() const { return retarget + springs + motion + points + hulls + physics + particles; }
};

/// Chained XXH3 hashes of the exact results of all frames so far.
struct SessionHashes {
  std::uint64_t hulls = 0;      ///< shapes and poses of the parts
  std::uint64_t props = 0;      ///< poses and velocities
  std::uint64_t particles = 0;  ///< positions; 0 if there are none

  [[nodiscard]] bool operator==(const SessionHashes&) const = default;
};

/// The pipeline of a frame without rendering: source -> pose -> hulls -> contacts. Used by tests, benchmarks, snapshots
/// and the window.
class Session {
 public:
  /// @param source    poses of the character's skeleton
  /// @param cover     made from the same decomposition and character; without one the hulls cover the body exactly
  /// @param training  of the same decomposition, for trainingDistance()
  /// @return the session, or an error if the decomposition belongs to another mesh, or the cover or training range to
  ///         another decomposition
  static Result<Session> create(Character character, Decomposition decomposition, std::unique_ptr<PoseSource> source,
                                World world, std::optional<HullCover> cover = std::nullopt,
                                std::optional<TrainingRange> training = std::nullopt);

  /// Runs one frame. Physics advances by the time between frames, clamped to 1 ms to 0.1 s; by 1/30 s in the first.
  /// @return false at the end of the stream, or the error of the source
  [[nodiscard]] Result<bool> step();

  /// Queues an action that is applied to the world at the start of the next step, in order. Actions that are not
  /// possible then are skipped, see canBeDone().
  void act(const WorldAction& action) { actions_.push_back(action); }

  /// Adds springs and constraints to the character, or replaces them. They move after the source and before the hulls,
  /// and start at rest in the next step, after a restart, and after a jump in time or place, see SpringSimulation.
  /// @return success, or an error if they do not fit the character
  [[nodiscard]] Result<void> setSprings(const SpringBones& springs, SpringMode mode);

  /// Restarts as if it were just created, with another source for the same character and another world.
  void restart(std::unique_ptr<PoseSource> source, World world);
  /// Continues with another body of the same character, such as another level of detail, in the pose of this frame. The
  /// change itself does not push props. Hashes differ from then on.
  /// @param plan  made for the session's character; its points must have the same indices as those of the previous
  ///              body, unless there is no training range and no caller has kept point indices
  void setBody(std::shared_ptr<const BodyPlan> plan);
  /// Continues in another world. Queued actions that were not applied yet are dropped.
  void setWorld(World world);

  [[nodiscard]] const Character& character() const { return character_; }
  [[nodiscard]] const PoseSource& source() const { return *source_; }
  /// Null if there are none.
  [[nodiscard]] const SessionSprings* springs() const { return springs_ ? &*springs_ : nullptr; }
  /// Time of this frame [s].
  [[nodiscard]] double time() const { return time_; }
  /// Local transforms of the character's joints, without springs.
  [[nodiscard]] std::span<const JointTransform> pose() const { return pose_; }
  [[nodiscard]] std::span<const Affine3> worldFromJoint() const { return worldFromJoint_; }
  /// The posed mesh vertices and cut points, pointCount() in total [m]. Only rendering needs them; they are computed on
  /// demand.
  [[nodiscard]] std::span<const Vec3> points() const;
  [[nodiscard]] const LiveBody& body() const { return body_; }
  /// Distance of this frame's pose from the poses that trained the decomposition [m], see acd/training_range.h. None
  /// before the first frame and without a training range. Computed on demand from the bones, without skinning;
  /// allocates nothing.
  [[nodiscard]] std::optional<double> trainingDistance() const;
  /// Whether the pose is outside the training range.
  [[nodiscard]] bool outsideKnownRange() const;
  [[nodiscard]] const std::optional<TrainingRange>& training() const { return training_; }
  /// Overlapping parts of the body that are not neighbours in the bind pose. Computed on demand; the first call creates
  /// the query, later calls allocate nothing.
  [[nodiscard]] std::span<const SelfContact> selfContacts() const;
  [[nodiscard]] const World& world() const { return world_; }
  [[nodiscard]] World& world() { return world_; }
  [[nodiscard]] const StageTimes& times() const { return times_; }
  [[nodiscard]] int frameCount() const { return frameCount_; }
  [[nodiscard]] const SessionHashes& hashes() const { return hashes_; }
  /// One hash of all of hashes().
  [[nodiscard]] std::uint64_t hash() const;

  /// Sets the watcher for all steps from the next one on, replacing the previous one; null = none.
  void watch(std::shared_ptr<StepWatcher> watcher) { watcher_ = std::move(watcher); }

 private:
  Session(Character character, LiveBody body, std::unique_ptr<PoseSource> source, World world,
          std::optional<TrainingRange> training);
  Character character_;
  std::unique_ptr<PoseSource> source_;
  LiveBody body_;
  World world_;
  void passTrustOn();
  void doActions();
  void addToHashes();

  std::vector<WorldAction> actions_;  // of the next step

  std::vector<std::vector<JointShare>> jointsOfPart_;
  ContactBones contactBones_;
  mutable std::optional<SelfContactQuery> selfContacts_;
  std::optional<TrainingRange> training_;
  std::vector<LiftedPoint> probes_;           // of the training range
  mutable std::vector<Vec3> probePositions_;  // scratch
  double time_ = 0.0;
  Pose pose_;  // of the source
  std::optional<SessionSprings> springs_;
  std::vector<Affine3> worldFromJoint_, worldFromModel_;
  mutable std::vector<Vec3> points_;  // of the frame pointsFrame_
  mutable int pointsFrame_ = -1;
  StageTimes times_;
  int frameCount_ = 0;
  SessionHashes hashes_;
  std::shared_ptr<StepWatcher> watcher_;
};

}  // namespace lorica

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
#include "session/step_watcher.h"
#include "session/world_action.h"
#include "skinning/character.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace lorica {

/// Time of each stage of one frame [us]; retarget includes smoothing and forward kinematics, and not what the source
/// waited for its joints; particles are 0 where there are none.
struct StageTimes {
  double retarget = 0, motion = 0, points = 0, hulls = 0, physics = 0, particles = 0;
  [[nodiscard]] double total() const { return retarget + motion + points + hulls + physics + particles; }
};

/// What all frames so far left behind, bit for bit: XXH3, each over the same before it.
struct SessionHashes {
  std::uint64_t hulls = 0;      ///< shapes and places of the parts
  std::uint64_t props = 0;      ///< their places and velocities
  std::uint64_t particles = 0;  ///< 0 where there are none

  [[nodiscard]] bool operator==(const SessionHashes&) const = default;
};

/// The headless frame: source -> pose -> hulls -> contacts. Tests, benchmarks, pictures and the window run this.
class Session {
 public:
  /// @param source    poses of the character's skeleton
  /// @param cover     made from the same decomposition and character; without one the body covers exactly
  /// @param training  of the same decomposition, for trainingDistance()
  /// @return the session, or that the decomposition fits another mesh, the cover or the training another decomposition
  static Result<Session> create(Character character, Decomposition decomposition, std::unique_ptr<PoseSource> source,
                                World world, std::optional<CoverPromise> cover = std::nullopt,
                                std::optional<TrainingRange> training = std::nullopt);

  /// Runs one frame. Physics moves by the time between frames, held between 1 ms and 0.1 s; the first takes 1/30 s.
  /// @return false at the end of the stream, or what the source says is wrong with its data
  [[nodiscard]] Result<bool> step();

  /// Does something to the world at the begin of the next step, after what was asked for before it. What cannot be
  /// done then, see canBeDone(), is passed over.
  void act(const WorldAction& action) { actions_.push_back(action); }

  /// Begins anew as if it were just created, with another source of the same character and another world.
  void restart(std::unique_ptr<PoseSource> source, World world);
  /// Goes on with another body of the same character, such as another level of detail, in the pose of this frame. Its
  /// parts strike nothing by taking the place of others. The same frames give another hash from then on.
  /// @param plan  made for the session's character; its points are numbered as those of the body before, or there is
  ///              neither a training range nor anyone who kept their numbers
  void setBody(std::shared_ptr<const BodyPlan> plan);
  /// Goes on in another world. What was asked of the old one by act() and was not done yet is forgotten.
  void setWorld(World world);

  [[nodiscard]] const Character& character() const { return character_; }
  [[nodiscard]] const PoseSource& source() const { return *source_; }
  /// Of this frame [s].
  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] std::span<const Affine3> worldFromJoint() const { return worldFromJoint_; }
  /// The posed mesh and the cut points, pointCount() of them [m]. Physics needs neither: they are computed for
  /// pictures, when asked for.
  [[nodiscard]] std::span<const Vec3> points() const;
  [[nodiscard]] const LiveBody& body() const { return body_; }
  /// How far this frame's pose is from the poses that trained the decomposition [m], see acd/training_range.h. None
  /// before the first frame and where the training is not known. Comes from the bones, needs no skin and allocates
  /// nothing; computed when asked for.
  [[nodiscard]] std::optional<double> trainingDistance() const;
  /// Whether the pose is farther from training than what counts as known.
  [[nodiscard]] bool outsideKnownRange() const;
  [[nodiscard]] const std::optional<TrainingRange>& training() const { return training_; }
  /// Parts of the body that overlap in this frame though they are not neighbours in the bind pose. Computed when asked
  /// for; the first time makes the query, later ones allocate nothing.
  [[nodiscard]] std::span<const SelfContact> selfContacts() const;
  [[nodiscard]] const World& world() const { return world_; }
  [[nodiscard]] World& world() { return world_; }
  [[nodiscard]] const StageTimes& times() const { return times_; }
  [[nodiscard]] int frameCount() const { return frameCount_; }
  [[nodiscard]] const SessionHashes& hashes() const { return hashes_; }
  /// Of all of them.
  [[nodiscard]] std::uint64_t hash() const;

  /// From the next step on someone stands beside the session; null = nobody. One at a time.
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
  std::vector<LiftedPoint> probes_;           // of the training range, by the bones
  mutable std::vector<Vec3> probePositions_;  // scratch
  double time_ = 0.0;
  Pose pose_;
  std::vector<Affine3> worldFromJoint_, worldFromModel_;
  mutable std::vector<Vec3> points_;  // of the frame pointsFrame_
  mutable int pointsFrame_ = -1;
  StageTimes times_;
  int frameCount_ = 0;
  SessionHashes hashes_;
  std::shared_ptr<StepWatcher> watcher_;
};

}  // namespace lorica

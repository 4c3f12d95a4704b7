#pragma once

#include "acd/cover.h"
#include "acd/training_range.h"
#include "collision/lifted_point.h"
#include "collision/live_body.h"
#include "collision/world.h"
#include "session/part_bones.h"
#include "session/pose_source.h"
#include "session/world_action.h"
#include "skinning/character.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace lorica {

/// Time of each stage of one frame [us]; retarget includes smoothing and forward kinematics, and not what the source
/// waited for its joints.
struct StageTimes {
  double retarget = 0, motion = 0, points = 0, hulls = 0, physics = 0;
  [[nodiscard]] double total() const { return retarget + motion + points + hulls + physics; }
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
  [[nodiscard]] const World& world() const { return world_; }
  [[nodiscard]] World& world() { return world_; }
  [[nodiscard]] const StageTimes& times() const { return times_; }
  [[nodiscard]] int frameCount() const { return frameCount_; }
  /// XXH3 over the shapes and places of all parts in all frames so far, bit for bit.
  [[nodiscard]] std::uint64_t hash() const { return hash_; }

 private:
  Session(Character character, LiveBody body, std::unique_ptr<PoseSource> source, World world,
          std::optional<TrainingRange> training);
  Character character_;
  std::unique_ptr<PoseSource> source_;
  LiveBody body_;
  World world_;
  void passTrustOn();
  void doActions();

  std::vector<WorldAction> actions_;  // of the next step

  std::vector<std::vector<JointShare>> jointsOfPart_;
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
  std::uint64_t hash_ = 0;
};

}  // namespace lorica

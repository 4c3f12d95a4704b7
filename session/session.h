#pragma once

#include "collision/live/body_plan.h"
#include "collision/world/body_contacts.h"
#include "collision/world/world.h"
#include "geometry/result.h"
#include "session/session_avatar.h"
#include "session/world_action.h"
#include "skinning/character.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// Finds parts of different avatars of a session that overlap, see BodyContactQuery. Internal to Session.
class AvatarContacts {
 public:
  /// The overlaps in a frame; the bodies' numbers are those of the avatars. Allocates nothing once the most avatars and
  /// contacts of a frame have been seen.
  /// @param seconds  since the last frame, above 0
  std::span<const BodyContact> find(std::span<const SessionAvatar> avatars, double seconds);

 private:
  /// The masses of an avatar's parts.
  struct Masses {
    std::shared_ptr<const BodyPlan> plan;
    std::shared_ptr<const std::vector<double>> values;  ///< avatars of one plan share them
  };
  void weigh(std::span<const SessionAvatar> avatars);

  BodyContactQuery query_;
  std::vector<Masses> masses_;
  std::vector<BodyInWorld> bodies_;
};

/// Time of each stage of one frame [us], of all avatars together; retarget includes smoothing and forward kinematics,
/// but not the time that the sources waited for joints; springs includes node constraints; springs and particles are 0
/// if there are none.
struct StageTimes {
  /// @{
  /// Of a stage [s].
  double retarget = 0, springs = 0, motion = 0, points = 0, hulls = 0, physics = 0, particles = 0;
  /// @}
  /// [s]
  [[nodiscard]] double total() const { return retarget + springs + motion + points + hulls + physics + particles; }
};

/// Chained XXH3 hashes of the exact results of all frames so far.
struct SessionHashes {
  std::uint64_t hulls = 0;      ///< of all avatars, see SessionAvatar::hash()
  std::uint64_t props = 0;      ///< poses and velocities
  std::uint64_t particles = 0;  ///< positions; 0 if there are none

  [[nodiscard]] bool operator==(const SessionHashes&) const = default;
};

class Session;

/// Observes the steps of a session, to record or to replay it. See Session::watch().
class StepWatcher {
 public:
  virtual ~StepWatcher() = default;

  /// Called before a step; may call Session::act().
  virtual void beforeStep(Session& session) = 0;
  /// Called after a step. @param done  the actions that were applied in it, in order
  /// @return an error is returned by Session::step()
  [[nodiscard]] virtual Result<void> afterStep(const Session& session, std::span<const WorldAction> done) = 0;
  /// Called when the session restarts or continues with another body or world: the watched run has ended.
  virtual void sessionChanged() = 0;
};

/// The pipeline of a frame without rendering: sources -> poses -> hulls -> contacts, for any number of avatars in one
/// world. Used by tests, benchmarks, snapshots and the window.
///
/// The first avatar whose source has not ended leads: its frames are those of the session. See AlignedSource.
class Session {
 public:
  /// A session without avatars.
  explicit Session(World world) : world_(std::move(world)) {}
  /// A session of one avatar, see SessionAvatar::create().
  static Result<Session> create(Character character, Decomposition decomposition, std::unique_ptr<PoseSource> source,
                                World world, std::optional<HullCover> cover = std::nullopt,
                                std::optional<TrainingRange> training = std::nullopt);

  /// Adds an avatar, which joins in the next step. @return its index in avatars()
  int addAvatar(SessionAvatar avatar);

  /// Runs one frame. Physics advances by the time between frames, clamped to 1 ms to 0.1 s; by 1/30 s in the first.
  /// @return false at the end of all sources, or the error of one
  [[nodiscard]] Result<bool> step();

  /// Queues an action that is applied to the world at the start of the next step, in order. Actions that are not
  /// possible then are skipped, see canBeDone().
  void act(const WorldAction& action) { actions_.push_back(action); }

  /// Adds springs and constraints to a character, or replaces them. They move after the source and before the hulls,
  /// and start at rest in the next step, after a restart, and after a jump in time or place, see SpringSimulation.
  /// @return success, or an error if they do not fit the character
  [[nodiscard]] Result<void> setSprings(const SpringBones& springs, SpringMode mode, int avatar = 0);

  /// Restarts as if it were just created, with other sources for the same characters and another world.
  /// @param sources  one for each avatar
  void restart(std::vector<std::unique_ptr<PoseSource>> sources, World world);
  /// The same with one avatar.
  void restart(std::unique_ptr<PoseSource> source, World world);
  /// Continues with another body of the same character, such as another level of detail, in the pose of this frame. The
  /// change itself does not push props. Hashes differ from then on.
  /// @param plan  made for the avatar's character; its points must have the same indices as those of the previous
  ///              body, unless there is no training range and no caller has kept point indices
  void setBody(std::shared_ptr<const BodyPlan> plan, int avatar = 0);
  /// Continues in another world. Queued actions that were not applied yet are dropped.
  void setWorld(World world);

  /// In the order in which they were added
  [[nodiscard]] std::span<const SessionAvatar> avatars() const { return avatars_; }
  /// @param index  in avatars()
  [[nodiscard]] const SessionAvatar& avatar(int index = 0) const { return avatars_[index]; }
  /// Time of this frame [s].
  [[nodiscard]] double time() const { return time_; }
  /// Overlapping parts of different avatars in this frame. Computed on demand: by the first call of a frame, or, if
  /// they were asked for in the frame before, by step() while physics runs, and then part of its time. The first call
  /// creates the query, later calls allocate nothing once the most avatars and contacts of a frame have been seen.
  [[nodiscard]] std::span<const BodyContact> avatarContacts() const;

  /// @{
  /// Of the first avatar, see SessionAvatar.
  [[nodiscard]] const Character& character() const { return avatar().character(); }
  [[nodiscard]] const PoseSource& source() const { return avatar().source(); }
  [[nodiscard]] const SessionSprings* springs() const { return avatar().springs(); }
  [[nodiscard]] std::span<const JointTransform> pose() const { return avatar().pose(); }
  [[nodiscard]] std::span<const Affine3> worldFromJoint() const { return avatar().worldFromJoint(); }
  [[nodiscard]] std::span<const Vec3> points() const { return avatar().points(); }
  [[nodiscard]] const LiveBody& body() const { return avatar().body(); }
  [[nodiscard]] std::optional<double> trainingDistance() const { return avatar().trainingDistance(); }
  [[nodiscard]] bool outsideKnownRange() const { return avatar().outsideKnownRange(); }
  [[nodiscard]] const std::optional<TrainingRange>& training() const { return avatar().training(); }
  [[nodiscard]] std::span<const SelfContact> selfContacts() const { return avatar().selfContacts(); }
  /// @}

  [[nodiscard]] const World& world() const { return world_; }  ///< props, particles and contacts
  [[nodiscard]] World& world() { return world_; }              ///< to add props before the first step; later see act()
  [[nodiscard]] const StageTimes& times() const { return times_; }       ///< of the last step
  [[nodiscard]] int frameCount() const { return frameCount_; }           ///< steps so far
  [[nodiscard]] const SessionHashes& hashes() const { return hashes_; }  ///< of all steps so far
  /// One hash of all of hashes().
  [[nodiscard]] std::uint64_t hash() const;

  /// Sets the watcher for all steps from the next one on, replacing the previous one; null = none.
  void watch(std::shared_ptr<StepWatcher> watcher) { watcher_ = std::move(watcher); }

 private:
  [[nodiscard]] Result<std::optional<double>> readPoses();
  void moveAvatars(double seconds);
  void doActions();
  void addToHashes();
  void findAvatarContacts(int frame) const;

  std::vector<SessionAvatar> avatars_;
  World world_;
  std::vector<WorldAction> actions_;  // of the next step
  std::vector<std::span<const LivePart>> partsOfAvatars_;
  double time_ = 0.0, seconds_ = 0.0;  // of this frame
  StageTimes times_;
  int frameCount_ = 0;
  SessionHashes hashes_;
  std::shared_ptr<StepWatcher> watcher_;
  mutable std::optional<AvatarContacts> avatarContacts_;
  mutable std::span<const BodyContact> found_;  // in the frame contactsFrame_
  mutable int contactsFrame_ = 0;
};

}  // namespace lorica

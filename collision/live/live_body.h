#pragma once

#include "acd/decomposition.h"
#include "acd/hull_cover.h"
#include "collision/live/body_plan.h"
#include "collision/live/live_part.h"
#include "collision/live/moving_hull.h"
#include "geometry/math.h"
#include "skinning/character.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// What a body keeps up to date.
enum class LiveDetail : std::uint8_t {
  kFaces,    ///< hulls with vertices and faces
  kSupport,  ///< points only, for support(): LivePart::shape stays empty
};

/// The body that physics can touch: a decomposition carried to each frame. Updating allocates nothing.
///
/// A skinned character's body is carried by its bones alone: the mesh need not be skinned. A mesh sequence without
/// bones is carried by its vertex positions. How: docs/LIVE_HULLS.md.
///
/// Copies share the plan, so a hundred characters of one kind hold its constants once, and have room for any frame too.
class LiveBody {
 public:
  /// A body in no pose yet.
  /// @param plan  not null
  explicit LiveBody(std::shared_ptr<const BodyPlan> plan, LiveDetail detail = LiveDetail::kFaces);
  LiveBody(const LiveBody& other);
  LiveBody& operator=(const LiveBody& other);
  LiveBody(LiveBody&&) noexcept = default;
  LiveBody& operator=(LiveBody&&) noexcept = default;
  ~LiveBody() = default;
  /// A character's body that covers the posed surface exactly, in every pose: coverExactly().
  /// @param decomposition  made from the character's mesh
  LiveBody(Decomposition decomposition, const Character& character, LiveDetail detail = LiveDetail::kFaces);
  /// A character's body of few points, which keeps what a promise says.
  /// @param cover  made from the same decomposition and character
  LiveBody(Decomposition decomposition, const Character& character, CoverPromise cover,
           LiveDetail detail = LiveDetail::kFaces);
  /// A body of a mesh sequence.
  explicit LiveBody(Decomposition decomposition);

  /// Carries a character's body to a pose.
  /// @param worldFromModel  for each joint: where it takes the bind pose, worldFromJoint * jointFromModel
  void update(std::span<const Affine3> worldFromModel);
  /// Carries a mesh sequence's body to a frame. The first one gives the parts their own frames, with the world's axes.
  /// @param posed  vertexCount positions of the mesh [m]
  void update(std::span<const Vec3> posed);

  /// Sets LivePart::trust, until it is set again.
  void setTrust(PartIndex part, double trust) { parts_[static_cast<std::size_t>(part)].trust = trust; }

  [[nodiscard]] const Decomposition& decomposition() const { return plan_->decomposition(); }
  [[nodiscard]] std::span<const LivePart> parts() const { return parts_; }
  /// What is promised of the surface being inside the hulls. A mesh sequence is covered exactly.
  [[nodiscard]] const CoverPromise& coverage() const { return plan_->coverage(); }
  /// The point of a part's hull farthest along a direction, in world space [m], whatever the detail. A scan of all the
  /// part's points with vector instructions: 64 take 10 ns, 1,000 take 0.1 us, and no answer of before can mislead it.
  /// @param direction  world, of any length
  [[nodiscard]] Vec3 support(PartIndex part, const Vec3& direction) const;
  /// How many points of a part are looked at for its hull.
  [[nodiscard]] std::size_t candidateCount(PartIndex part) const;

  /// Time of the steps of the last update [us].
  struct Timing {
    double motion = 0;  ///< best-fit rigid motions
    double points = 0;  ///< bones or vertices to hull candidates
    double hulls = 0;   ///< candidates to hulls
  };
  [[nodiscard]] const Timing& timing() const { return timing_; }
  [[nodiscard]] const std::shared_ptr<const BodyPlan>& plan() const { return plan_; }
  /// Bytes held, beside the plan: room for any frame, most of which is never touched.
  [[nodiscard]] std::size_t memory() const;

 private:
  /// What is kept of a part from frame to frame.
  struct Track {
    std::vector<PointRow> rows;             ///< of the candidates, in the part's own frame, in whole ticks
    double tick = 0.0;                      ///< [m]
    bool moved = false;                     ///< the rows are not those of the frame before
    std::optional<MovingHull> hull;         ///< where faces are wanted
    LiftedPart::TakenPose taken;            ///< of a character
    std::vector<Vec3> firstPoints, points;  ///< of a mesh sequence: in the first frame about their mean, and now
  };
  static void readRows(Track& track, const Isometry3& worldFromPart);
  void reshape(const BodyPlan::PartPlan& plan, Track& track, LivePart& part);
  void reshapeAll();

  std::shared_ptr<const BodyPlan> plan_;
  LiveDetail detail_ = LiveDetail::kFaces;
  std::vector<Track> tracks_;
  std::vector<LivePart> parts_;
  std::vector<Vec3> meshPoints_;               ///< of a mesh sequence: vertices and cut points [m]
  std::vector<Mat3> covariances_, rotations_;  ///< scratch, of the parts
  Timing timing_;
  bool started_ = false;
};

}  // namespace lorica

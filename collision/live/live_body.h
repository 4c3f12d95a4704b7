#pragma once

#include "acd/decomposition.h"
#include "acd/hull_cover.h"
#include "collision/live/body_plan.h"
#include "collision/live/live_part.h"
#include "geometry/math.h"
#include "geometry/result.h"
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

/// The body that physics can touch: a decomposition moved to each frame. Updating does not allocate.
///
/// A skinned character's body is moved by its bones alone, so the mesh need not be skinned. A mesh sequence without
/// bones is moved by its vertex positions. Method: docs/LIVE_HULLS.md.
///
/// Copies share the plan, so a hundred characters of one kind store its constants once. A copy has capacity for any
/// frame too.
class LiveBody {
 public:
  /// A body without a pose.
  /// @param plan  not null
  explicit LiveBody(std::shared_ptr<const BodyPlan> plan, LiveDetail detail = LiveDetail::kFaces);
  LiveBody(const LiveBody& other);
  LiveBody& operator=(const LiveBody& other);
  LiveBody(LiveBody&&) noexcept;
  LiveBody& operator=(LiveBody&&) noexcept;
  ~LiveBody();
  /// A character's body: BodyPlan::create(), then a body without a pose.
  static Result<LiveBody> create(Decomposition decomposition, const Character& character,
                                 std::optional<HullCover> cover = std::nullopt, LiveDetail detail = LiveDetail::kFaces);
  /// A body of a mesh sequence.
  static Result<LiveBody> create(Decomposition decomposition);

  /// Moves a character's body to a pose.
  /// @param worldFromModel  for each joint the transform from the bind pose, worldFromJoint * jointFromModel
  void update(std::span<const Affine3> worldFromModel);
  /// Moves a mesh sequence's body to a frame. The first frame defines the parts' own frames, with the world's axes.
  /// @param posed  vertexCount positions of the mesh [m]
  void update(std::span<const Vec3> posed);

  /// Sets LivePart::trust; it stays until set again.
  void setTrust(PartIndex part, double trust) { parts_[part].trust = trust; }

  [[nodiscard]] const Decomposition& decomposition() const { return plan_->decomposition(); }  ///< the parts that move
  /// In this frame, in the order of the decomposition
  [[nodiscard]] std::span<const LivePart> parts() const { return parts_; }
  /// The hull cover: how far the surface is guaranteed to be inside the hulls. A mesh sequence is covered exactly.
  [[nodiscard]] const HullCover& coverage() const { return plan_->coverage(); }
  /// The point of a part's hull farthest along a direction, in world space [m], for any LiveDetail. Scans all the
  /// part's points with vector instructions (64 take 10 ns, 1,000 take 0.1 us), so the result does not depend on
  /// earlier queries.
  /// @param direction  world, of any length
  [[nodiscard]] Vec3 support(PartIndex part, const Vec3& direction) const;
  /// Number of points considered for a part's hull.
  [[nodiscard]] std::size_t candidateCount(PartIndex part) const;

  /// Durations of the steps of the last update [us].
  struct Timing {
    double motion = 0;  ///< best-fit rigid motions
    double points = 0;  ///< bones or vertices to hull candidates
    double hulls = 0;   ///< candidates to hulls
  };
  [[nodiscard]] const Timing& timing() const { return timing_; }  ///< of the last frame
  /// Shared by all bodies of its kind.
  [[nodiscard]] const std::shared_ptr<const BodyPlan>& plan() const { return plan_; }
  /// Memory in bytes, without the plan. It suffices for any frame; most of it is never touched.
  [[nodiscard]] std::size_t memory() const;

 private:
  struct Track;  ///< state of a part that is kept from frame to frame
  static void readRows(Track& track, const Isometry3& worldFromPart);
  static void reshape(const BodyPlan::PartPlan& plan, Track& track, LivePart& part);
  void reshapeAll();

  std::shared_ptr<const BodyPlan> plan_;
  LiveDetail detail_ = LiveDetail::kFaces;
  std::vector<Track> tracks_;
  std::vector<LivePart> parts_;
  std::vector<Vec3> meshPoints_;               ///< mesh sequences only: vertices and cut points [m]
  std::vector<Mat3> covariances_, rotations_;  ///< scratch, per part
  Timing timing_;
  bool started_ = false;
};

}  // namespace lorica

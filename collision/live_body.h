#pragma once

#include "acd/cover.h"
#include "acd/decomposition.h"
#include "collision/lifted_part.h"
#include "collision/live_part.h"
#include "collision/moving_hull.h"
#include "geometry/math.h"
#include "skinning/character.h"

#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// The body that physics can touch: a decomposition carried to each frame. Updating allocates nothing.
///
/// A skinned character's body is carried by its bones alone: the mesh need not be skinned. A mesh sequence without
/// bones is carried by its vertex positions. How: docs/LIVE_HULLS.md.
class LiveBody {
 public:
  /// A character's body that covers the posed surface exactly, in every pose: coverExactly().
  /// @param decomposition  made from the character's mesh
  LiveBody(Decomposition decomposition, const Character& character);
  /// A character's body of few points, which keeps what a promise says.
  /// @param cover  made from the same decomposition and character
  LiveBody(Decomposition decomposition, const Character& character, CoverPromise cover);
  /// A body of a mesh sequence.
  explicit LiveBody(Decomposition decomposition);

  /// Carries a character's body to a pose.
  /// @param worldFromModel  for each joint: where it takes the bind pose, worldFromJoint * jointFromModel
  void update(std::span<const Affine3> worldFromModel);
  /// Carries a mesh sequence's body to a frame. The first one gives the parts their own frames, with the world's axes.
  /// @param posed  vertexCount positions of the mesh [m]
  void update(std::span<const Vec3> posed);

  [[nodiscard]] const Decomposition& decomposition() const { return decomposition_; }
  [[nodiscard]] std::span<const LivePart> parts() const { return parts_; }
  /// What is promised of the surface being inside the hulls. A mesh sequence is covered exactly.
  [[nodiscard]] const CoverPromise& coverage() const { return cover_; }
  /// How many points of a part are looked at for its hull.
  [[nodiscard]] std::size_t candidateCount(PartIndex part) const;

  /// Time of the steps of the last update [us].
  struct Timing {
    double motion = 0;  ///< best-fit rigid motions
    double points = 0;  ///< bones or vertices to hull candidates
    double hulls = 0;   ///< candidates to hulls
  };
  [[nodiscard]] const Timing& timing() const { return timing_; }
  /// Bytes held, beside the decomposition.
  [[nodiscard]] std::size_t memory() const;

 private:
  /// What is kept of a part from frame to frame.
  struct Track {
    explicit Track(std::vector<PointIndex> chosen)
        : candidates(std::move(chosen)), hull(static_cast<int>(candidates.size())) {}

    std::vector<PointIndex> candidates;  ///< one a row
    std::vector<PointRow> rows;          ///< in the part's own frame, in whole ticks
    double tick = 0.0;                   ///< [m]
    bool moved = false;                  ///< the rows are not those of the frame before
    MovingHull hull;
    std::optional<LiftedPart> lifted;       ///< of a character
    std::vector<Vec3> firstPoints, points;  ///< of a mesh sequence: in the first frame about their mean, and now
  };
  void addTracks(std::span<const LiftedPoint> lifted);
  void addTrack(Track track);
  void readRows(Track& track, const Isometry3& worldFromPart);
  void reshape(Track& track, LivePart& part);
  void reshapeAll();

  Decomposition decomposition_;
  CoverPromise cover_;
  std::vector<Track> tracks_;
  std::vector<LivePart> parts_;
  std::vector<Vec3> meshPoints_;                ///< of a mesh sequence: vertices and cut points [m]
  std::vector<VertexIndex> vertexOfCandidate_;  ///< scratch
  Timing timing_;
  bool started_ = false;
};

}  // namespace lorica

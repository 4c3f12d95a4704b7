#pragma once

#include "acd/concavity.h"
#include "acd/decomposition.h"
#include "geometry/counts.h"

#include <initializer_list>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// The mesh being cut, in all keyframes: its vertices, then the cut points in order of creation.
struct CutContext {
  const TriMesh& mesh;
  std::vector<std::vector<Vec3>> points;  ///< keyframe, PointIndex
  std::vector<CutPoint> cutPoints;
  std::vector<std::vector<Vec3>> normals;  ///< keyframe, mesh triangle: unit; zero for triangles without area
  std::vector<double> onPlane;             ///< for each keyframe, points up to this distance are on a plane [m]
  std::vector<double> noise;               ///< for each keyframe, how inexact files and arithmetic leave positions [m]
  std::vector<double> meshVolume;          ///< [m^3]

  CutContext(const TriMesh& closedMesh, PoseView keyframes);
  [[nodiscard]] std::size_t keyframeCount() const { return points.size(); }
  [[nodiscard]] PointIndex pointCount() const { return countOf(points[0]); }
  /// Adds new cut points and computes their positions in every keyframe (Eq. 12).
  void addCutPoints(std::span<const CutPoint> added);
};

/// A part with the measurements that the search needs.
struct Piece {
  Part part;
  std::vector<Crease> creases;
  std::vector<double> volume;  ///< of the part in each keyframe [m^3]
  std::vector<double> hullVolume;
  std::vector<std::vector<PointIndex>> hullPoints;  ///< vertices of its hull in each keyframe, ascending
  std::vector<bool> convex;  ///< in each keyframe: its hull is no larger, or only as far as positions are inexact
  mutable std::optional<double> excess;  ///< over the limits of single parts, once it was asked for

  /// The error (Eq. 3) in one keyframe [m^3].
  [[nodiscard]] double error(std::size_t k) const { return hullVolume[k] - volume[k]; }
  [[nodiscard]] double totalError() const;
  /// The keyframe with the largest error; of equal ones the first.
  [[nodiscard]] std::size_t worstKeyframe() const;
  [[nodiscard]] double totalHullVolume() const;
};

/// Measures a part in every keyframe, keyframes in parallel.
[[nodiscard]] Piece measure(Part part, const CutContext& context);

/// The vertices of the hulls of pieces in a keyframe, piece by piece [m].
[[nodiscard]] std::vector<Vec3> hullPointsOf(std::initializer_list<const Piece*> pieces, std::size_t keyframe,
                                             const CutContext& context);

/// Whether two boxes are no farther apart than a margin.
[[nodiscard]] bool overlap(const Aabb& a, const Aabb& b, double margin);

/// Of its hull in each keyframe.
[[nodiscard]] std::vector<Aabb> boxesOf(const Piece& piece, const CutContext& context);

/// Merges the triangles of several parts, without the caps that two of them share.
[[nodiscard]] Part unite(std::span<const Part* const> parts);

}  // namespace lorica

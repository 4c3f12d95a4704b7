#pragma once

#include "acd/concavity.h"
#include "acd/decomposition.h"

#include <span>
#include <vector>

namespace lorica {

/// The mesh being cut, in all keyframes: its vertices, then the cut points in the order of their creation.
struct Workshop {
  const TriMesh& mesh;
  std::vector<std::vector<Vec3>> points;  ///< keyframe, PointIndex
  std::vector<CutPoint> cutPoints;
  std::vector<std::vector<Vec3>> normals;  ///< keyframe, mesh triangle: unit, zero for those without area
  std::vector<double> onPlane;             ///< distance up to which a point lies on a plane, for each keyframe [m]
  std::vector<double> meshVolume;          ///< [m^3]

  Workshop(const TriMesh& closedMesh, PoseView keyframes);
  [[nodiscard]] std::size_t keyframeCount() const { return points.size(); }
  [[nodiscard]] PointIndex pointCount() const { return static_cast<PointIndex>(points[0].size()); }
  /// Carries new cut points to every keyframe (Eq. 12).
  void addCutPoints(std::span<const CutPoint> added);
};

/// A part with what the search needs of it.
struct Workpiece {
  Part part;
  std::vector<Crease> creases;
  std::vector<double> volume;  ///< of the part in each keyframe [m^3]
  std::vector<double> hullVolume;
  std::vector<std::vector<PointIndex>> hullPoints;  ///< corners of its hull in each keyframe, ascending

  /// Eq. 3 in one keyframe [m^3].
  [[nodiscard]] double error(std::size_t k) const { return hullVolume[k] - volume[k]; }
  [[nodiscard]] double totalError() const;
  [[nodiscard]] double totalHullVolume() const;
};

/// Measures a part in every keyframe, keyframes in parallel.
[[nodiscard]] Workpiece measure(Part part, const Workshop& shop);

/// All triangles of several parts as one, without the caps that two of them share.
[[nodiscard]] Part unite(std::span<const Part* const> parts);

}  // namespace lorica

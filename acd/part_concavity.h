#pragma once

#include "geometry/convex_hull.h"
#include "geometry/triangle_tree.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// The weight of volume in partConcavity().
inline constexpr double kConcavityVolumeWeight = 0.3;

/// The length in which concavities are measured: half of the longest side of a mesh's bounds, as CoACD scales meshes
/// [m].
[[nodiscard]] double concavityUnit(std::span<const Vec3> points);

/// The planes of a hull's faces, without faces too thin to have a direction.
class HullPlanes {
 public:
  explicit HullPlanes(const ConvexHull& hull);
  [[nodiscard]] std::size_t count() const { return normals_.size(); }
  [[nodiscard]] const Vec3& normal(std::size_t i) const { return normals_[i]; }
  [[nodiscard]] double offset(std::size_t i) const { return offsets_[i]; }
  /// Whether one plane has the whole triangle at most `enough` below it [m]: then no point of it lies deeper.
  [[nodiscard]] bool holdsNear(const std::array<Vec3, 3>& triangle, double enough);
  /// How deep a point of the hull lies below its surface [m]; 0 if that is at most `enough`.
  [[nodiscard]] double depth(const Vec3& p, double enough);

 private:
  std::vector<Vec3> normals_;
  std::vector<double> offsets_;
  std::size_t last_ = 0;
};

/// The share of partConcavity() that the volume between hull and part has [m]. @param empty  that volume [m^3]
[[nodiscard]] double emptyConcavity(double empty);

/// How far a part is from convex, as CoACD measures it (Wei et al. 2022, Eq. 2 to 4, as its program computes them): the
/// larger of the Hausdorff distance between the surfaces of part and hull, and 0.3 times the radius of a ball as large
/// as the volume between them [m].
///
/// From hull to part, it is at most a hundredth too large, see hullDistance(); from part to hull, it is that of points
/// at most `ignoreBelow` / 4 apart.
/// @param hull         of the part
/// @param points       positions that the triangles index
/// @param triangles    of the closed part
/// @param ignoreBelow  concavities up to this need not be told apart [m]
/// @param enough       nor those above this [m]
[[nodiscard]] double partConcavity(const ConvexHull& hull, std::span<const Vec3> points,
                                   std::span<const Triangle> triangles, double ignoreBelow, double enough = kInfinity);

/// The surface of a solid that lies in a hull. Internal to score().
[[nodiscard]] TriMesh clippedToHull(const TriMesh& solid, const ConvexHull& hull);

/// How concave the part of a solid in a hull is, as CoACD measures it, see partConcavity(), whichever program made the
/// hull. The part is the intersection of solid and hull. So where the hull's surface is in the solid, both have the
/// same surface.
/// @param solid  closed
/// @param tree   of its triangles
/// @param samples  points on each of both surfaces
/// @return [m]; 0 for a degenerate hull
[[nodiscard]] double hullConcavity(const TriMesh& solid, const TriangleTree& tree, const ConvexHull& hull, int samples,
                                   std::uint64_t seed);

}  // namespace lorica

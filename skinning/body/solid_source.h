#pragma once

#include "geometry/triangle_tree.h"
#include "skinning/body/limbs.h"
#include "skinning/body/weld.h"

#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

namespace lorica {

/// The role of a triangle in the body.
enum class TriangleRole : std::uint8_t {
  kSkin,    ///< outside on one side, inside on the other
  kHidden,  ///< inside on both sides: eyes, teeth, a torso under a coat, the end of a sleeve
  kSheet,   ///< outside on both sides: capes, hair cards, a loose skirt
};

/// The extents of a piece of skin.
struct Thickness {
  double area = 0.0;    ///< [m^2]
  double min = 0.0;     ///< smallest extent: the diameter of a tube [m]
  double middle = 0.0;  ///< second extent: the diameter of a tube, the width of a blade [m]
  double length = 0.0;  ///< largest extent [m]
};

/// The input of a solid. Triangles keep their order and are oriented consistently and outward.
class SolidSource {
 public:
  /// @param welded  without duplicate triangles, at least one triangle
  /// @param known   must outlive it: it is large
  SolidSource(const Character& character, const Limbs& known, Welded welded);

  TriMesh mesh;
  std::vector<std::vector<Influence>> influences;  ///< one list per vertex
  const Limbs& limbs;
  std::vector<JointIndex> jointOfTriangle;  ///< the joint that moves each triangle most
  std::vector<TriangleRole> roles;
  std::vector<std::int32_t> patchOfTriangle;
  std::vector<Thickness> ofJoint;       ///< of the skin that each joint moves most
  std::vector<Thickness> ofPatch;       ///< of the skin in each patch
  std::optional<TriangleTree> tree;     ///< of all triangles
  std::optional<TriangleTree> winding;  ///< of all triangles except sheets

  std::size_t openEdges = 0;
  std::size_t nonManifoldEdges = 0;
  std::size_t turnedPatches = 0;
  std::size_t turnedTriangles = 0;
  std::size_t sheetPatches = 0;
  bool onlySheets = false;  ///< every patch is one; they count as skin then
  double sheetShare = 0.0;  ///< fraction of the area

  /// The winding number of one of the two trees.
  [[nodiscard]] double windingAt(const TriangleTree& solid, const Vec3& p) const;
  /// Whether winding numbers took too much work, because everything lies around everything: they are 0 from then on.
  [[nodiscard]] bool crowded() const;

  [[nodiscard]] bool isSkin(std::int32_t triangle) const { return roles[triangle] == TriangleRole::kSkin; }
  [[nodiscard]] std::array<Vec3, 3> corners(std::size_t triangle) const;

 private:
  mutable std::atomic<std::size_t> looked_ = 0;
};

/// The voxel edge for a character: four voxels across thin parts, but limited to give about 7,000 to 14,000 vertices.
/// @return [m]
[[nodiscard]] double chooseResolution(const SolidSource& source);

}  // namespace lorica

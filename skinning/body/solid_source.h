#pragma once

#include "skinning/body/limbs.h"
#include "skinning/body/triangle_tree.h"
#include "skinning/body/weld.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace lorica {

/// What a triangle is to the body.
enum class TriangleRole : std::uint8_t {
  kSkin,    ///< outside on one side, inside on the other
  kHidden,  ///< inside on both sides: of eyes, teeth, a torso under a coat, the end of a sleeve
  kSheet,   ///< outside on both sides: capes, cards of hair, a skirt that hangs free
};

/// How thick a piece of skin is.
struct Thickness {
  double area = 0.0;    ///< [m^2]
  double least = 0.0;   ///< across, where it is thinnest: of a tube its diameter [m]
  double middle = 0.0;  ///< the next direction: of a tube the same, of a blade its width [m]
  double length = 0.0;  ///< the third [m]
};

/// What a solid is made of. Triangles as they came, turned to face alike and outward.
class SolidSource {
 public:
  /// @param welded  without duplicate triangles, at least one triangle
  SolidSource(const Character& character, Limbs known, Welded welded);

  TriMesh mesh;
  std::vector<std::vector<Influence>> influences;  ///< of the vertices
  Limbs limbs;
  std::vector<JointIndex> jointOfTriangle;  ///< what moves each most
  std::vector<TriangleRole> roles;
  std::vector<std::int32_t> patchOfTriangle;
  std::vector<Thickness> ofJoint;       ///< of the skin that each joint moves most
  std::vector<Thickness> ofPatch;       ///< of the skin in each patch
  std::optional<TriangleTree> tree;     ///< of all triangles
  std::optional<TriangleTree> winding;  ///< of those that are no sheets

  std::size_t openEdges = 0;
  std::size_t crowdedEdges = 0;
  std::size_t turnedPatches = 0;
  std::size_t turnedTriangles = 0;
  std::size_t sheetPatches = 0;
  double sheetShare = 0.0;  ///< of the area

  [[nodiscard]] bool isSkin(std::int32_t triangle) const {
    return roles[static_cast<std::size_t>(triangle)] == TriangleRole::kSkin;
  }
  [[nodiscard]] std::array<Vec3, 3> corners(std::size_t triangle) const;
};

/// The edge of a voxel for a character: four across what is thin, but none so fine that more than some 14,000 vertices
/// come of it, nor so coarse that less than 7,000 do.
/// @return [m]
[[nodiscard]] double chooseResolution(const SolidSource& source);

}  // namespace lorica

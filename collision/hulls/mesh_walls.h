#pragma once

#include "collision/hulls/subject.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// A thin wall has this thickness, as a share of the longest side of the mesh's bounds, but at most half of the
/// narrowest gap.
inline constexpr double kWallShare = 0.01;

/// A closed body for a mesh with thin walls.
struct WallBody {
  TriMesh mesh;  ///< closed two-manifold without the file's vertices
  RebuiltMesh figures;
};

/// Adds another mesh to a mesh.
void append(TriMesh& mesh, const TriMesh& other);

/// "3 thin walls of 0.0124, 82 % of the surface; 1 piece is solid"
[[nodiscard]] std::string wallsInWords(const RebuiltMesh& body);

/// A sheet of a character gets a wall, which takes parts of its own, if it has at least this share of the surface.
inline constexpr double kWorthAWall = 0.02;

/// The triangles of a character's surface, and which of them get walls: by the rules of makeWalls(), but pieces around
/// sealed space are told apart however many there are, and small sheets get none unless everything does.
struct WallTriangles {
  TriMesh mesh;  ///< without repeats
  std::vector<bool> which;
};
[[nodiscard]] WallTriangles trianglesOfWalls(const TriMesh& mesh, const CharacterOptions& options);

/// An error if the thickness of walls is more than an eighth of the longest side.
[[nodiscard]] Result<void> checkThickness(const std::string& name, double thickness, std::span<const Vec3> vertices);

/// Makes thin walls of the pieces of a mesh that are sheets; of more than 512 one common shell, see makeShellBody().
/// Pieces that are closed, or nearly so, stay solid. Those
/// around space that cannot be reached from outside get a body, see makeMeshBody(). Copies of triangles are dropped.
/// @param options  walls, thickness, bodyResolution
/// @return nothing if no piece is a sheet
[[nodiscard]] Result<std::optional<WallBody>> makeWalls(const TriMesh& mesh, const CharacterOptions& options,
                                                        const BodySettings& settings);

}  // namespace lorica

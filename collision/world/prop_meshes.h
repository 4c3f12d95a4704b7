#pragma once

#include "acd/decomposition.h"
#include "collision/world/prop.h"
#include "geometry/result.h"
#include "geometry/tri_mesh.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

namespace lorica {

/// Decomposes a closed mesh into at most `parts` convex parts. Callers that use a cache or show progress supply their
/// own.
/// @param name  of the mesh's file, for progress bars and messages
using MeshDecomposer = std::function<Result<Decomposition>(const std::string& name, const TriMesh& mesh, int parts)>;

/// Runs decompose() on the mesh with the default settings.
[[nodiscard]] Result<Decomposition> decomposePropMesh(const std::string& name, const TriMesh& mesh, int parts);

/// Limits of mesh props.
inline constexpr std::size_t kMaxPropMeshBytes = std::size_t{8} << 20;
inline constexpr double kSmallestProp = 0.01, kLargestProp = 20.0;  ///< each side of its bounding box [m]

/// How to make a prop from a mesh file.
struct PropMeshRequest {
  std::filesystem::path file;  ///< see readMesh()
  double scale = 1.0;          ///< metres per unit of the file
  Vec3 size = Vec3::Zero();    ///< sides of its bounding box [m], used instead of the scale; 0 = use the scale
  int parts = 1;               ///< 1 = convex hull of any mesh; more = maximum number of parts of a closed mesh
  bool limited = true;         ///< to kMaxPropMeshBytes and kMaxPropVertices, since a scene file of others names it

  bool operator==(const PropMeshRequest&) const = default;
};

/// Reads a mesh and makes the shape of a prop, with the centre of the bounding box at the origin. A mesh with
/// non-manifold edges (more than two triangles) is repaired, see repairClosedMesh(). The mass is distributed evenly in
/// the mesh, or, with one part, in its hull.
/// @return the shape, or an error with file, element, found and expected
[[nodiscard]] Result<std::shared_ptr<const PropMeshShape>> readPropMesh(const PropMeshRequest& request,
                                                                        const MeshDecomposer& decomposer);

}  // namespace lorica

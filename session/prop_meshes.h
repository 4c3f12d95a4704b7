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

/// Cuts a closed mesh into at most so many convex parts. Who has a cache or shows progress gives its own.
/// @param name  of the mesh's file, for bars and sentences
using MeshDecomposer = std::function<Result<Decomposition>(const std::string& name, const TriMesh& mesh, int parts)>;

/// decompose() of the mesh as it is, preset fast.
[[nodiscard]] Result<Decomposition> decomposePropMesh(const std::string& name, const TriMesh& mesh, int parts);

/// What a mesh prop may be made of.
inline constexpr std::size_t kMostPropMeshBytes = std::size_t{8} << 20;
inline constexpr std::size_t kMostPropVertices = 20000;
inline constexpr int kMostPropParts = 32;
inline constexpr double kSmallestProp = 0.01, kLargestProp = 20.0;  ///< each side of the box around it [m]

/// How a mesh file becomes a prop.
struct PropMeshRequest {
  std::filesystem::path file;  ///< see readMesh()
  double scale = 1.0;          ///< metres for one unit of the file
  Vec3 size = Vec3::Zero();    ///< sides of the box around it, instead of a scale [m]; 0 = by the scale
  int parts = 1;               ///< 1 = its convex hull, whatever the mesh; more = at most so many, of a closed mesh

  bool operator==(const PropMeshRequest&) const = default;
};

/// Reads a mesh and makes a prop's shape of it, with the middle of the box around it at the origin. A mesh whose edges
/// have more than two triangles is mended, see repairClosedMesh(). Mass is spread evenly in the mesh, or, with one
/// part, in its hull.
/// @return the shape, or a sentence with file, element, found and expected
[[nodiscard]] Result<std::shared_ptr<const PropMeshShape>> readPropMesh(const PropMeshRequest& request,
                                                                        const MeshDecomposer& decomposer);

}  // namespace lorica

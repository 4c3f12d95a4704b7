#pragma once

#include "geometry/math.h"
#include "skinning/look/material.h"

#include <cstddef>
#include <string>
#include <vector>

namespace lorica {

/// A picture of a character file, still encoded as PNG, JPEG or WebP.
struct StoredPicture {
  std::string name;              ///< for messages: "image 3 'hair'"
  std::vector<std::byte> bytes;  ///< empty if it was not available
};

/// Consecutive triangles with one material.
struct LookGroup {
  std::string mesh;               ///< name of the file's mesh
  int material = 0;               ///< index into Look::materials
  std::size_t firstTriangle = 0;  ///< of the mesh
  std::size_t triangleCount = 0;  ///< consecutive ones
  bool flat = false;              ///< the file has no normals: each triangle is flat
};

/// How a character looks, beside its mesh as read from the file. Arrays of vertices are as long as mesh.vertices, or
/// empty if no vertex has the property.
struct Look {
  std::vector<Vec3f> normals;  ///< unit length, in model space; zero in flat groups
  std::vector<Eigen::Vector4f>
      tangents;                         ///< direction of u, and the sign of the bitangent; zero = from the coordinates
  std::vector<Eigen::Vector2f> uv[2];   ///< texture coordinates, (0, 0) is the upper left corner of a picture
  std::vector<Eigen::Vector4f> colors;  ///< factor of the base colour, linear RGBA
  std::vector<LookGroup> groups;        ///< in the order of mesh.triangles, all of them
  std::vector<Material> materials;      ///< in the order of the file
  std::vector<StoredPicture> pictures;  ///< as the file has them, undecoded

  /// Whether there is anything to draw but the shape: a mesh file, for example, has no materials.
  [[nodiscard]] bool given() const { return !groups.empty(); }
};

}  // namespace lorica

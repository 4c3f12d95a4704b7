#pragma once

#include "skinning/look/avatar.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

inline constexpr int kAvatarInfluences = 8;  ///< of a vertex; of more the heaviest are kept

/// What of an avatar's vertex changes with its expression.
struct AvatarShape {
  Vec3f position;  ///< in the bind pose [m]
  Vec3f normal;    ///< zero: flat triangles
};

/// What of an avatar's vertex never changes.
struct AvatarVertex {
  Eigen::Vector4f tangent;  ///< zero: from the texture coordinates
  Eigen::Vector4f uv;       ///< both sets
  Eigen::Vector4f color;    ///< linear RGBA
  std::array<std::uint16_t, kAvatarInfluences> joints;
  std::array<float, kAvatarInfluences> weights;  ///< sum to 1
};

/// A vertex in its pose.
struct AvatarPosed {
  Vec3f position;           ///< world [m]
  Vec3f normal;             ///< unit length; zero: flat triangles
  Eigen::Vector4f tangent;  ///< as AvatarVertex::tangent, turned
};

/// An avatar's vertices for the GPU, in the order of its mesh.
struct AvatarMesh {
  std::vector<AvatarShape> shapes;
  std::vector<AvatarVertex> vertices;
  std::vector<std::uint32_t> indices;  ///< three for each triangle of the mesh
  bool fewInfluences = true;           ///< no vertex has more than four
};

[[nodiscard]] AvatarMesh makeAvatarMesh(const Avatar& avatar);

/// The skinning matrices as a texture of floats: three texels a joint, its first three rows.
/// @param worldFromModel  one per joint
/// @param rows            written; resized only if the number of joints changes
void fillJointRows(std::span<const Affine3> worldFromModel, std::vector<Eigen::Vector4f>& rows);

/// Linear blend skinning as the vertex shader does it. A software renderer skins in each pass anew, so that doing it
/// once here is faster.
/// @param jointRows  see fillJointRows()
/// @param posed      written; as many as vertices
void poseAvatar(std::span<const AvatarShape> shapes, std::span<const AvatarVertex> vertices,
                std::span<const Eigen::Vector4f> jointRows, std::span<AvatarPosed> posed);

}  // namespace lorica

#pragma once

#include "viewer/renderer/avatar_mesh.h"
#include "viewer/renderer/avatar_shaders.h"
#include "viewer/renderer/gpu.h"

#include <array>
#include <memory>
#include <vector>

namespace lorica {

struct AvatarProgram {
  shaders::AvatarVariant variant;
  GLuint program = 0;  ///< 0: the driver cannot compile it
};

/// A group of an avatar's triangles with its material.
struct AvatarGroup {
  const Material* material = nullptr;  ///< of AvatarGpu::avatar
  std::size_t firstIndex = 0;
  GLsizei indexCount = 0;
  bool flat = false;
  GLuint surface = 0;                                       ///< uniform buffer, of AvatarGpu::surfaces
  std::array<GLuint, shaders::kAvatarSlots> textures = {};  ///< 0 = none
  std::uint32_t available = 0;                              ///< bits by AvatarSlot: there is a texture
  Vec3 center{0, 0, 0};                                     ///< in the bind pose [m]
  JointIndex joint = 0;                                     ///< moves the centre
};

struct AvatarTexture {
  TextureUse use;
  bool srgb = false;
  GLuint texture = 0;
};

/// Consecutive groups that cast shadows alike.
struct AvatarCasters {
  std::size_t group = 0;  ///< the first
  GLsizei indexCount = 0;
};

/// An avatar on the GPU, kept as long as it exists.
struct AvatarGpu {
  std::weak_ptr<const Avatar> avatar;
  GLuint vertexArray = 0, shapeBuffer = 0, vertexBuffer = 0, indexBuffer = 0;
  GLuint jointTexture = 0;
  StreamBuffer jointBuffer, posedBuffer;
  std::vector<GLuint> surfaces;                    ///< uniform buffers, by material
  std::vector<shaders::SurfaceUniforms> uniforms;  ///< in them
  std::vector<AvatarShape> shapes;                 ///< as uploaded last
  std::vector<AvatarShape> bindShapes;
  std::vector<AvatarVertex> vertices;  ///< kept only if they are skinned on the CPU
  std::vector<AvatarPosed> posed;      ///< of this picture
  std::vector<AvatarGroup> groups;
  std::vector<AvatarCasters> casters;
  std::vector<AvatarTexture> textures;
  std::vector<Eigen::Vector4f> jointRows;  ///< of this picture
  std::vector<std::size_t> blended;        ///< groups by distance, scratch
  std::vector<double> distances;           ///< of groups, scratch
  float opacity = 1.0f;                    ///< of this picture
  bool fewInfluences = true;
  bool shadowEachPixel = true;
  bool posedOnCpu = false;  ///< the vertex buffers hold the pose: shaders do not skin
  bool reshaped = false;    ///< `shapes` differ from bindShapes
  bool inUse = false;       ///< filled for an avatar, which may no longer exist
  bool shown = false;       ///< in this picture
};

}  // namespace lorica

#pragma once

#include "viewer/avatar_mesh.h"
#include "viewer/avatar_shaders.h"
#include "viewer/gpu.h"

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
  GLuint surface = 0;                                       ///< uniform buffer
  std::array<GLuint, shaders::kAvatarSlots> textures = {};  ///< 0 = none
  Vec3 center{0, 0, 0};                                     ///< in the bind pose [m]
  JointIndex joint = 0;                                     ///< moves the centre
};

struct AvatarTexture {
  TextureUse use;
  bool srgb = false;
  GLuint texture = 0;
};

/// An avatar on the GPU, kept as long as it exists.
struct AvatarGpu {
  std::weak_ptr<const Avatar> avatar;
  GLuint vertexArray = 0, shapeBuffer = 0, vertexBuffer = 0, indexBuffer = 0;
  GLuint jointTexture = 0;
  StreamBuffer jointBuffer;
  std::vector<AvatarShape> shapes;  ///< as uploaded last
  std::vector<AvatarShape> bindShapes;
  std::vector<AvatarGroup> groups;
  std::vector<AvatarTexture> textures;
  std::vector<Eigen::Vector4f> jointRows;  ///< of this picture
  std::vector<std::size_t> blended;        ///< groups by distance, scratch
  std::vector<double> distances;           ///< of groups, scratch
  bool fewInfluences = true;
  bool shadowEachPixel = true;
  bool reshaped = false;  ///< `shapes` differ from bindShapes
};

}  // namespace lorica

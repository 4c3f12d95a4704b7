#pragma once

#include "viewer/gpu.h"

namespace lorica {

/// The framebuffers of a renderer: the multisampled picture, the same resolved, the shadow map, and the contact
/// shadow with a second texture to blur through.
struct Targets {
  static constexpr int kShadowSize = 768;
  static constexpr int kContactSize = 256;

  int width = 0;
  int height = 0;
  int samples = 0;
  GLuint picture = 0, pictureColor = 0, pictureDepth = 0;
  GLuint resolved = 0, resolvedColor = 0;
  GLuint shadow = 0, shadowMap = 0;
  GLuint contact[2] = {}, contactMap[2] = {};

  /// @return success, or kNoDisplay when the driver refuses a framebuffer
  [[nodiscard]] Result<void> create(Gpu& gpu);
  /// Takes a new size [pixels]; does nothing when it is the present one.
  void resize(const Gpu& gpu, int newWidth, int newHeight);
};

}  // namespace lorica

#pragma once

#include "viewer/gpu.h"
#include "viewer/renderer.h"

namespace lorica {

/// The framebuffers of a renderer: the multisampled picture, the same resolved, the shadow map, and the contact
/// shadow with a second texture to blur through.
struct Targets {
  static constexpr int kContactSize = 256;

  int width = 0;  ///< of the finished picture [pixels]
  int height = 0;
  int drawnWidth = 0;  ///< of the picture before it is enlarged to that
  int drawnHeight = 0;
  int samples = 0;
  int shadowSize = 0;  ///< texels on a side
  GLuint picture = 0, pictureColor = 0, pictureDepth = 0;
  GLuint resolved = 0, resolvedColor = 0;
  GLuint shadow = 0, shadowMap = 0;
  GLuint contact[2] = {}, contactMap[2] = {};

  /// @return success, or kNoDisplay when the driver refuses a framebuffer
  [[nodiscard]] Result<void> create(Gpu& gpu);
  /// Takes effect with the next resize().
  void setQuality(const Gpu& gpu, RenderQuality newQuality);
  /// Takes a new size [pixels]; does nothing when it is the present one.
  void resize(const Gpu& gpu, int newWidth, int newHeight);

  RenderQuality quality = RenderQuality::kHigh;
};

}  // namespace lorica

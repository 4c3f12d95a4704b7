#pragma once

#include "viewer/renderer/gpu.h"
#include "viewer/renderer/renderer.h"

namespace lorica {

/// The framebuffers of a renderer: the multisampled picture, the resolved picture, the shadow map, and the contact
/// shadow with a second texture for blurring.
struct Targets {
  static constexpr int kContactSize = 256;

  int width = 0;  ///< of the finished picture [pixels]
  int height = 0;
  int drawnWidth = 0;  ///< of the picture before it is enlarged [pixels]
  int drawnHeight = 0;
  int samples = 0;
  int shadowSize = 0;  ///< texels per side
  GLuint picture = 0, pictureColor = 0, pictureDepth = 0;
  GLuint resolved = 0, resolvedColor = 0;
  GLuint shadow = 0, shadowMap = 0;
  GLuint contact[2] = {}, contactMap[2] = {};

  /// @return success, or kNoDisplay if the driver does not support a framebuffer
  [[nodiscard]] Result<void> create(Gpu& gpu);
  /// Takes effect at the next resize().
  void setQuality(const Gpu& gpu, RenderQuality newQuality);
  /// Sets a new size [pixels]; does nothing if it is the current one.
  void resize(const Gpu& gpu, int newWidth, int newHeight);

  RenderQuality quality = RenderQuality::kHigh;
};

}  // namespace lorica

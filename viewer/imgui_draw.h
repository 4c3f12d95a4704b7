#pragma once

#include "viewer/gpu.h"

struct ImDrawData;
struct ImFontAtlas;

namespace lorica {

/// Draws what Dear ImGui made, through a function table of our own: the packaged backends bind libGL, which we do not.
class ImguiDraw {
 public:
  /// @param functions  of the current context, as at every later call
  explicit ImguiDraw(const GlFunctions& functions) : gpu_(functions) {}
  /// @return success, or what the driver refused
  [[nodiscard]] Result<void> create();

  /// Takes the atlas's picture to the GPU and gives the atlas its texture.
  void takeFont(ImFontAtlas& atlas);

  /// Draws over what is in the bound framebuffer. Coordinates are pixels of it, from its upper left.
  void draw(const ImDrawData& data, int width, int height);

 private:
  Gpu gpu_;
  GLuint program_ = 0, vertexArray_ = 0, indices_ = 0, font_ = 0;
  GLint pixels_ = -1;
  StreamBuffer vertices_;
};

}  // namespace lorica

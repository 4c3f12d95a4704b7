#pragma once

#include "viewer/renderer/gpu.h"

struct ImDrawData;
struct ImFontAtlas;

namespace lorica {

/// Renders the output of Dear ImGui through Lorica's function table: the packaged backends link libGL, Lorica does not.
class ImguiDraw {
 public:
  /// @param functions  of the current context, which must also be current in all later calls
  explicit ImguiDraw(const GlFunctions& functions) : gpu_(functions) {}
  /// @return success, or the driver's error
  [[nodiscard]] Result<void> create();

  /// Uploads the atlas's image to the GPU and sets the texture of the atlas.
  void takeFont(ImFontAtlas& atlas);

  /// Draws over the contents of the bound framebuffer. Coordinates are in its pixels, from the upper left.
  void draw(const ImDrawData& data, int width, int height);

 private:
  Gpu gpu_;
  GLuint program_ = 0, vertexArray_ = 0, indices_ = 0, font_ = 0;
  GLint pixels_ = -1;
  StreamBuffer vertices_;
};

}  // namespace lorica

#include "viewer/window/first_picture.h"

#include <algorithm>

namespace lorica {
namespace {

struct Color {
  float red, green, blue;  // sRGB
};

constexpr Color kSky{0.85f, 0.87f, 0.89f}, kPanel{0.14f, 0.16f, 0.19f}, kBar{0.26f, 0.30f, 0.37f};

void fill(const GlFunctions& gl, const Color& color, int left, int bottom, int width, int height) {
  gl.Scissor(left, bottom, width, height);
  gl.ClearColor(color.red, color.green, color.blue, 1.0f);
  gl.Clear(GL_COLOR_BUFFER_BIT);
}

}  // namespace

void drawFirstPicture(const GlFunctions& gl, int width, int height) {
  gl.Enable(GL_SCISSOR_TEST);
  fill(gl, kSky, 0, 0, width, height);
  // Where the panels show what is loading.
  const int margin = std::max(1, height / 72), panelWidth = width / 4 + 2 * margin;
  const int left = (width - panelWidth) / 2, bottom = height - 5 * margin;
  fill(gl, kPanel, left, bottom, panelWidth, 4 * margin);
  fill(gl, kBar, left + margin, bottom + margin, panelWidth - 2 * margin, 2 * margin);
  gl.Disable(GL_SCISSOR_TEST);
}

}  // namespace lorica

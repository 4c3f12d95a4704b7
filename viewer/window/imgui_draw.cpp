#include "viewer/window/imgui_draw.h"

#include <imgui.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace lorica {
namespace {

constexpr const char* kVertexShader = R"(#version 330 core
uniform vec4 pixels;  // 2 / width, 2 / height
layout(location = 0) in vec2 place;
layout(location = 1) in vec2 texel;
layout(location = 2) in vec4 color;
out vec2 fragmentTexel;
out vec4 fragmentColor;
void main() {
  fragmentTexel = texel;
  fragmentColor = color;
  gl_Position = vec4(place.x * pixels.x - 1.0, 1.0 - place.y * pixels.y, 0.0, 1.0);
}
)";

constexpr const char* kFragmentShader = R"(#version 330 core
uniform sampler2D font;
in vec2 fragmentTexel;
in vec4 fragmentColor;
out vec4 result;
void main() {
  result = vec4(fragmentColor.rgb, fragmentColor.a * texture(font, fragmentTexel).r);
}
)";

/// Clamps a position in pixels to 0 to `size`.
GLint inside(float value, int size) {
  return static_cast<GLint>(std::clamp(value, 0.0f, static_cast<float>(size)));
}

ImTextureID idOf(GLuint texture) {
  return reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture));
}

}  // namespace

Result<void> ImguiDraw::create() {
  const GlFunctions& gl = gpu_.gl;
  const Result<GLuint> program = gpu_.makeProgram("panels", kVertexShader, kFragmentShader);
  if (!program.ok()) return program.error();
  program_ = program.value();
  pixels_ = gl.GetUniformLocation(program_, "pixels");
  gl.UseProgram(program_);
  gl.Uniform1i(gl.GetUniformLocation(program_, "font"), 0);

  vertexArray_ = gpu_.makeVertexArray();
  vertices_.id = gpu_.makeBuffer();
  indices_ = gpu_.makeBuffer();
  font_ = gpu_.makeTexture(GL_LINEAR);
  gl.BindVertexArray(vertexArray_);
  gl.BindBuffer(GL_ARRAY_BUFFER, vertices_.id);
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  const auto attribute = [&](GLuint index, GLint size, GLenum type, GLboolean normalized, std::size_t at) {
    gl.EnableVertexAttribArray(index);
    gl.VertexAttribPointer(index, size, type, normalized, sizeof(ImDrawVert), reinterpret_cast<const void*>(at));
  };
  attribute(0, 2, GL_FLOAT, GL_FALSE, offsetof(ImDrawVert, pos));
  attribute(1, 2, GL_FLOAT, GL_FALSE, offsetof(ImDrawVert, uv));
  attribute(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(ImDrawVert, col));
  gl.BindVertexArray(0);
  return {};
}

void ImguiDraw::takeFont(ImFontAtlas& atlas) {
  unsigned char* coverage = nullptr;
  int width = 0, height = 0;
  atlas.GetTexDataAsAlpha8(&coverage, &width, &height);
  const GlFunctions& gl = gpu_.gl;
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, font_);
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_R8, width, height, 0, GL_RED, GL_UNSIGNED_BYTE, coverage);
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 4);
  atlas.SetTexID(idOf(font_));
}

void ImguiDraw::draw(const ImDrawData& data, int width, int height) {
  static_assert(sizeof(ImDrawIdx) == 2);
  const GlFunctions& gl = gpu_.gl;
  gl.Viewport(0, 0, width, height);
  gl.Disable(GL_DEPTH_TEST);
  gl.Disable(GL_CULL_FACE);
  gl.Enable(GL_BLEND);
  gl.BlendEquation(GL_FUNC_ADD);
  gl.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  gl.Enable(GL_SCISSOR_TEST);
  gl.UseProgram(program_);
  gl.Uniform4f(pixels_, 2.0f / static_cast<float>(width), 2.0f / static_cast<float>(height), 0.0f, 0.0f);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, font_);
  gl.BindVertexArray(vertexArray_);
  for (int n = 0; n < data.CmdListsCount; ++n) {
    const ImDrawList& list = *data.CmdLists[n];
    gpu_.upload(vertices_, list.VtxBuffer.Data, static_cast<std::size_t>(list.VtxBuffer.size_in_bytes()));
    gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, list.IdxBuffer.size_in_bytes(), list.IdxBuffer.Data, GL_STREAM_DRAW);
    for (const ImDrawCmd& command : list.CmdBuffer) {
      const GLint left = inside(command.ClipRect.x, width), right = inside(command.ClipRect.z, width);
      const GLint top = inside(command.ClipRect.y, height), bottom = inside(command.ClipRect.w, height);
      if (right <= left || bottom <= top || command.ElemCount == 0) continue;
      gl.Scissor(left, height - bottom, right - left, bottom - top);
      gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(command.ElemCount), GL_UNSIGNED_SHORT,
                      reinterpret_cast<const void*>(command.IdxOffset * sizeof(ImDrawIdx)));
    }
  }
  gl.BindVertexArray(0);
  gl.Disable(GL_SCISSOR_TEST);
  gl.Disable(GL_BLEND);
}

}  // namespace lorica

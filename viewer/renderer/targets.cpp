#include "viewer/renderer/renderer_impl.h"

#include "geometry/errors.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lorica {
namespace {

struct Settings {
  int samples, shadowSize;
  double scale;  // ratio of the drawn picture's sides to the finished one's
};

Settings settingsOf(RenderQuality quality) {
  switch (quality) {
    case RenderQuality::kHigh:
      return {4, 1024, 1.0};
    case RenderQuality::kMedium:
      return {0, 768, 1.0};
    case RenderQuality::kLow:
      return {0, 512, 0.6};
  }
  return {};
}

}  // namespace

Result<void> Targets::create(Gpu& gpu) {
  const GlFunctions& gl = gpu.gl;
  shadowMap = gpu.makeTexture(GL_LINEAR);
  setQuality(gpu, quality);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  // Everything outside the map is lit.
  const GLfloat far[] = {1, 1, 1, 1};
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
  gl.TexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, far);
  shadow = gpu.makeFramebuffer();
  gl.BindFramebuffer(GL_FRAMEBUFFER, shadow);
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, shadowMap, 0);
  gl.DrawBuffer(GL_NONE);
  gl.ReadBuffer(GL_NONE);
  if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    return noDisplay("the OpenGL driver does not support 16-bit depth textures for shadows");
  }

  for (int i = 0; i < 2; ++i) {
    contactMap[i] = gpu.makeTexture(GL_LINEAR);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_R8, kContactSize, kContactSize, 0, GL_RED, GL_UNSIGNED_BYTE, nullptr);
    // There is no contact shadow outside the texture, whatever its border texels contain.
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
    contact[i] = gpu.makeFramebuffer();
    gl.BindFramebuffer(GL_FRAMEBUFFER, contact[i]);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, contactMap[i], 0);
    if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
      return noDisplay("the OpenGL driver cannot draw into an 8-bit texture");
    }
  }

  picture = gpu.makeFramebuffer();
  pictureColor = gpu.makeRenderbuffer();
  pictureDepth = gpu.makeRenderbuffer();
  resolved = gpu.makeFramebuffer();
  resolvedColor = gpu.makeRenderbuffer();
  resize(gpu, 16, 16);
  for (const GLuint framebuffer : {picture, resolved}) {
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    const GLenum status = gl.CheckFramebufferStatus(GL_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE) {
      return noDisplay("the OpenGL driver does not support a framebuffer with {} samples (0x{:x})", samples, status);
    }
  }
  return {};
}

void Targets::setQuality(const Gpu& gpu, RenderQuality newQuality) {
  const GlFunctions& gl = gpu.gl;
  quality = newQuality;
  const Settings settings = settingsOf(quality);
  GLint max = 0;
  gl.GetIntegerv(GL_MAX_SAMPLES, &max);
  samples = max >= settings.samples ? settings.samples : 0;
  shadowSize = settings.shadowSize;
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, shadowMap);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT16, shadowSize, shadowSize, 0, GL_DEPTH_COMPONENT,
                GL_UNSIGNED_SHORT, nullptr);
  width = height = 0;
}

void Targets::resize(const Gpu& gpu, int newWidth, int newHeight) {
  if (newWidth == width && newHeight == height) return;
  width = newWidth;
  height = newHeight;
  const double scale = settingsOf(quality).scale;
  drawnWidth = std::max<int>(1, std::lround(scale * width));
  drawnHeight = std::max<int>(1, std::lround(scale * height));
  const GlFunctions& gl = gpu.gl;
  for (const auto& [renderbuffer, format] : {std::pair{pictureColor, GL_RGBA8}, {pictureDepth, GL_DEPTH_COMPONENT24}}) {
    gl.BindRenderbuffer(GL_RENDERBUFFER, renderbuffer);
    gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, drawnWidth, drawnHeight);
  }
  gl.BindRenderbuffer(GL_RENDERBUFFER, resolvedColor);
  gl.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
  gl.BindFramebuffer(GL_FRAMEBUFFER, picture);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, pictureColor);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, pictureDepth);
  gl.BindFramebuffer(GL_FRAMEBUFFER, resolved);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, resolvedColor);
}

}  // namespace lorica

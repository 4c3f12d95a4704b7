#pragma once

#include "geometry/result.h"
#include "viewer/renderer/image.h"
#include "viewer/renderer/scene.h"

#include <cstdint>
#include <memory>
#include <string>

namespace lorica {

/// A current OpenGL 3.3 core context without a window: OSMesa, or EGL surfaceless if OSMesa is missing, both loaded at
/// run time. Only one may exist at a time; used only from the thread that created it.
class OffscreenContext {
 public:
  /// @param eglOnly  for what is drawn for another program
  /// @return the context, or kNoDisplay with what was tried and which package to install
  static Result<OffscreenContext> create(bool eglOnly = false);
  ~OffscreenContext();
  OffscreenContext(OffscreenContext&&) noexcept;
  OffscreenContext& operator=(OffscreenContext&&) noexcept;
  /// "OSMesa 22.3.6" or "EGL surfaceless, ...".
  [[nodiscard]] std::string description() const;
  using GetProc = void* (*)(const char*);  ///< how OpenGL's functions are found by their names
  [[nodiscard]] GetProc getProc() const;   ///< of this context

 private:
  struct Impl;
  explicit OffscreenContext(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Rendering quality. Costs: docs/PICTURES.md.
enum class RenderQuality : std::uint8_t {
  kHigh,    ///< anti-aliased edges, fine shadows
  kMedium,  ///< no anti-aliasing
  kLow,     ///< also rendered at a lower resolution and enlarged; text stays sharp
};

/// Draws scenes in the current OpenGL 3.3 core context; the same code is used in a window and off screen.
class Renderer {
 public:
  using GetProc = void* (*)(const char*);  ///< how OpenGL's functions are found by their names
  /// Needs a current context of OpenGL.
  static Result<Renderer> create(GetProc getProc);
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Sets the quality from the next draw() on. The default is high.
  void setQuality(RenderQuality quality);
  [[nodiscard]] RenderQuality quality() const;  ///< see setQuality()

  /// Draws into the renderer's own framebuffer of this size.
  void draw(const Scene& scene, const SceneOptions& options, const Camera& camera, int width, int height);
  /// Draws what the last draw() drew from another eye near by, in the same size: hulls in the same order, meshes and
  /// shadows as they are.
  void drawAgain(const Scene& scene, const SceneOptions& options, const Camera& camera);
  /// The picture of the last draw().
  [[nodiscard]] Image readBack();
  /// Copies the picture of the last draw() to a framebuffer, which is the window's if it is number 0: all of it, or of
  /// another aspect the middle.
  void present(int width, int height, unsigned framebuffer = 0);

 private:
  struct Impl;
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lorica

#pragma once

#include "viewer/image.h"
#include "viewer/scene.h"

#include <cstdint>
#include <memory>
#include <string>

namespace lorica {

/// A current OpenGL 3.3 core context without a window: OSMesa first, EGL surfaceless where OSMesa is missing,
/// both loaded at run time. One at a time, used from the thread that made it.
class OffscreenContext {
 public:
  /// @return the context, or kNoDisplay with what was tried and which package helps
  static Result<OffscreenContext> create();
  ~OffscreenContext();
  OffscreenContext(OffscreenContext&&) noexcept;
  OffscreenContext& operator=(OffscreenContext&&) noexcept;
  /// "OSMesa 22.3.6" or "EGL surfaceless, ...".
  [[nodiscard]] std::string description() const;
  using GetProc = void* (*)(const char*);
  [[nodiscard]] GetProc getProc() const;

 private:
  struct Impl;
  explicit OffscreenContext(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// How good a picture looks and what it costs; docs/PICTURES.md has the figures.
enum class RenderQuality : std::uint8_t {
  kHigh,    ///< smoothed edges, fine shadows
  kMedium,  ///< edges as the pixels fall
  kLow,     ///< and drawn smaller than it is shown; text stays sharp
};

/// Draws scenes with whatever OpenGL 3.3 core context is current; the same code under a window and off screen.
class Renderer {
 public:
  using GetProc = void* (*)(const char*);
  static Result<Renderer> create(GetProc getProc);
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// From the next draw() on. A new renderer's is high.
  void setQuality(RenderQuality quality);
  [[nodiscard]] RenderQuality quality() const;

  /// Draws into a framebuffer of its own of this size.
  void draw(const Scene& scene, const SceneOptions& options, const Camera& camera, int width, int height);
  /// What draw() drew last.
  [[nodiscard]] Image readBack();
  /// Copies what draw() drew last to the window's framebuffer (number 0).
  void present(int windowWidth, int windowHeight);

 private:
  struct Impl;
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lorica

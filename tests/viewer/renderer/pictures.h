#pragma once

#include "geometry/tri_mesh.h"
#include "viewer/renderer/renderer.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <optional>
#include <string>

namespace lorica::test {

/// A renderer with its context, destroyed in the right order.
class Studio {
 public:
  /// @param kind  "osmesa", "egl", or empty for the first one available
  /// @return nothing if this machine cannot draw off screen that way; `why` is the reason
  static std::unique_ptr<Studio> open(const std::string& kind, std::string& why);

  [[nodiscard]] Image draw(const Scene& scene, const SceneOptions& options, const Camera& camera, int width,
                           int height);
  /// What draw() drew last, see Renderer::drawAgain().
  [[nodiscard]] Image drawAgain(const Scene& scene, const SceneOptions& options, const Camera& camera);
  void setQuality(RenderQuality quality) { renderer_->setQuality(quality); }
  [[nodiscard]] std::string description() const { return context_->description(); }

  /// How many objects of OpenGL exist.
  struct Objects {
    int buffers = 0;
    int textures = 0;
  };
  [[nodiscard]] Objects objects() const;

 private:
  std::optional<OffscreenContext> context_;
  std::optional<Renderer> renderer_;
};

/// Declares `const std::unique_ptr<Studio> name`, or skips the test with the reason.
#define LORICA_REQUIRE_STUDIO(name, kind)                              \
  std::string name##Missing;                                           \
  const auto name = ::lorica::test::Studio::open(kind, name##Missing); \
  if (name == nullptr) GTEST_SKIP() << "cannot draw off screen: " << name##Missing

/// A camera on the +Z axis that looks along -Z at height 1 m, 4 m from the origin.
[[nodiscard]] Camera frontCamera();

/// Position of a point in the picture of frontCamera() [pixels from the top left], by similar triangles.
[[nodiscard]] std::array<double, 2> seenAt(const Vec3& point, int width, int height);

[[nodiscard]] std::array<int, 3> pixelAt(const Image& image, int x, int y);

/// Number of pixels in which a channel differs by more than `tolerance`.
[[nodiscard]] int differingPixels(const Image& a, const Image& b, int tolerance);

/// A part whose hull is the box.
[[nodiscard]] LivePart boxPart(const Vec3& min, const Vec3& max);

}  // namespace lorica::test

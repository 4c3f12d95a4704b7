#include "tests/viewer/renderer/pictures.h"

#include "tests/support/meshes.h"

#include <cmath>
#include <cstdlib>

namespace lorica::test {

std::unique_ptr<Studio> Studio::open(const std::string& kind, std::string& why) {
  setenv("LORICA_OFFSCREEN", kind.c_str(), 1);
  auto studio = std::make_unique<Studio>();
  Result<OffscreenContext> context = OffscreenContext::create();
  unsetenv("LORICA_OFFSCREEN");
  if (!context.ok()) {
    why = context.error().message;
    return nullptr;
  }
  studio->context_.emplace(std::move(context).value());
  Result<Renderer> renderer = Renderer::create(studio->context_->getProc());
  if (!renderer.ok()) {
    ADD_FAILURE() << renderer.error().message;  // an existing context must suffice
    why = renderer.error().message;
    return nullptr;
  }
  studio->renderer_.emplace(std::move(renderer).value());
  return studio;
}

Image Studio::drawAgain(const Scene& scene, const SceneOptions& options, const Camera& camera) {
  renderer_->drawAgain(scene, options, camera);
  return renderer_->readBack();
}

Image Studio::draw(const Scene& scene, const SceneOptions& options, const Camera& camera, int width, int height) {
  renderer_->draw(scene, options, camera, width, height);
  return renderer_->readBack();
}

Studio::Objects Studio::objects() const {
  using IsObject = unsigned char (*)(unsigned int);
  const auto isBuffer = reinterpret_cast<IsObject>(context_->getProc()("glIsBuffer"));
  const auto isTexture = reinterpret_cast<IsObject>(context_->getProc()("glIsTexture"));
  Objects count;
  for (unsigned int name = 1; name < 4096; ++name) {
    count.buffers += isBuffer(name) != 0;
    count.textures += isTexture(name) != 0;
  }
  return count;
}

Camera frontCamera() {
  Camera camera;
  camera.eye = {0.0, 1.0, 4.0};
  camera.target = {0.0, 1.0, 0.0};
  return camera;
}

std::array<double, 2> seenAt(const Vec3& point, int width, int height) {
  const double scale = 0.5 * height / std::tan(0.5 * frontCamera().verticalFov) / (4.0 - point.z());
  return {0.5 * width + scale * point.x(), 0.5 * height - scale * (point.y() - 1.0)};
}

std::array<int, 3> pixelAt(const Image& image, int x, int y) {
  const std::size_t i = (static_cast<std::size_t>(y) * image.width + static_cast<std::size_t>(x)) * 4;
  return {image.rgba.at(i), image.rgba.at(i + 1), image.rgba.at(i + 2)};
}

int differingPixels(const Image& a, const Image& b, int tolerance) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  if (a.rgba.size() != b.rgba.size()) return -1;
  int count = 0;
  for (std::size_t i = 0; i < a.rgba.size(); i += 4) {
    bool differs = false;
    for (std::size_t c = 0; c < 4; ++c) differs |= std::abs(a.rgba[i + c] - b.rgba[i + c]) > tolerance;
    count += differs;
  }
  return count;
}

LivePart boxPart(const Vec3& min, const Vec3& max) {
  const TriMesh box = makeBox(min, max);
  LivePart part;
  part.shape.vertices = box.vertices;
  part.shape.triangles = box.triangles;
  part.shape.volume = (max - min).prod();
  return part;
}

}  // namespace lorica::test

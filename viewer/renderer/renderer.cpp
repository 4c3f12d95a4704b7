#include "viewer/renderer/renderer.h"

#include "viewer/renderer/renderer_impl.h"

#include <algorithm>
#include <cmath>

namespace lorica {

using shaders::Pass;

Renderer::Renderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

Result<Renderer> Renderer::create(GetProc getProc) {
  LORICA_TRY(const GlFunctions functions, loadGlFunctions(getProc));
  auto impl = std::make_unique<Impl>(functions);
  LORICA_TRY_DO(impl->createPrograms());
  LORICA_TRY_DO(impl->targets.create(impl->gpu));
  impl->createMeshes();
  return Renderer(std::move(impl));
}

void Renderer::setQuality(RenderQuality quality) {
  if (quality != impl_->targets.quality) impl_->targets.setQuality(impl_->gpu, quality);
}

RenderQuality Renderer::quality() const {
  return impl_->targets.quality;
}

void Renderer::draw(const Scene& scene, const SceneOptions& options, const Camera& camera, int width, int height) {
  Impl& i = *impl_;
  const GlFunctions& gl = i.gl;
  i.targets.resize(i.gpu, std::max(width, 1), std::max(height, 1));
  i.setup = setUpFrame(scene, options, camera, i.targets.drawnWidth, i.targets.drawnHeight, i.targets.shadowSize);

  // First upload everything that changes with the frame, one upload per buffer.
  i.uploadFrame();
  i.uploadFigures(scene, options);
  i.uploadOverlays(scene, options, camera.eye);
  i.uploadContacts(options.contacts ? scene.contacts : std::span<const Contact>());
  const UnhiddenView view{camera.eye, scene.unhidden};
  for (std::size_t shape = 0; shape < i.propShapes.size(); ++shape) {
    PropShapeGpu& target = i.propShapes[shape];
    target.instances.clear();
    if (!options.props) continue;
    makePropInstances(scene.props, static_cast<PropShape>(shape), target.instances, view);
    if (!target.instances.empty()) i.gpu.upload(target.instanceBuffer, target.instances);
  }

  i.uploadMeshProps(scene.props, options.props, view);

  // Shadow map.
  gl.BindFramebuffer(GL_FRAMEBUFFER, i.targets.shadow);
  gl.Viewport(0, 0, i.targets.shadowSize, i.targets.shadowSize);
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthFunc(GL_LEQUAL);
  gl.DepthMask(GL_TRUE);
  gl.Disable(GL_BLEND);
  gl.Disable(GL_CULL_FACE);
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  // Closed surfaces cast shadows with the faces that face away from the light, so that lit faces do not shadow
  // themselves.
  gl.Enable(GL_CULL_FACE);
  gl.CullFace(GL_FRONT);
  i.drawCasters(Pass::kShadow);
  gl.Disable(GL_CULL_FACE);
  if (options.particles && !i.drawsSurface(scene)) i.drawGrainShadows(scene);
  if (options.ground) i.drawContactShadow();
  i.drawView(scene, options, camera.eye);
}

void Renderer::drawAgain(const Scene& scene, const SceneOptions& options, const Camera& camera) {
  Impl& i = *impl_;
  const FrameSetup first = i.setup;
  const Targets& t = i.targets;
  i.setup = setUpFrame(scene, options, camera, t.drawnWidth, t.drawnHeight, t.shadowSize, &first);
  i.uploadFrame();
  i.drawView(scene, options, camera.eye);
}

void Renderer::Impl::uploadFrame() {
  gl.BindBuffer(GL_UNIFORM_BUFFER, frameBlock);
  gl.BufferSubData(GL_UNIFORM_BUFFER, 0, sizeof(FrameUniforms), &setup.uniforms);
  gl.BindBufferBase(GL_UNIFORM_BUFFER, 0, frameBlock);
}

/// Draws what is uploaded, with the shadows that are drawn already.
void Renderer::Impl::drawView(const Scene& scene, const SceneOptions& options, const Vec3& eye) {
  // Opaque objects from near to far, so that covered pixels are not shaded.
  gl.BindFramebuffer(GL_FRAMEBUFFER, targets.picture);
  gl.Viewport(0, 0, targets.drawnWidth, targets.drawnHeight);
  gl.Enable(GL_DEPTH_TEST);
  transparent = options.transparent;
  const bool sky = !options.background && !options.transparent;
  const Vec3f background = options.transparent ? Vec3f(Vec3f::Zero()) : options.background.value_or(Vec3f::Zero());
  gl.ClearColor(background.x(), background.y(), background.z(), options.transparent ? 0.0f : 1.0f);
  gl.Clear(sky ? GL_DEPTH_BUFFER_BIT : GL_DEPTH_BUFFER_BIT | GL_COLOR_BUFFER_BIT);
  gl.ActiveTexture(GL_TEXTURE1);
  gl.BindTexture(GL_TEXTURE_2D, targets.contactMap[0]);
  gl.ActiveTexture(GL_TEXTURE2);
  gl.BindTexture(GL_TEXTURE_2D, targets.shadowMap);
  gl.CullFace(GL_BACK);
  drawSkins(options, false);
  drawAvatarOpaque();
  gl.Enable(GL_CULL_FACE);
  drawProps(Pass::kLit);
  const bool surface = drawsSurface(scene);
  if (options.particles && !surface) drawGrains(scene);
  if (options.ground) drawFloor();
  gl.Disable(GL_CULL_FACE);
  if (sky) {
    use(skyProgram);
    gl.BindVertexArray(skyVertexArray);
    gl.DrawElements(GL_TRIANGLES, skyIndexCount, GL_UNSIGNED_INT, nullptr);
  }
  if (options.particles && surface) drawWater(scene);
  drawFading([&] { drawSkins(options, true); });
  drawAvatarBlended(eye);

  // Translucent hulls.
  gl.DepthMask(GL_FALSE);
  gl.Enable(GL_BLEND);
  blendOver();
  use(overlayProgram);
  if (hulls.count > 0) draw(hulls);

  // The avatar passes through static bodies: what of it is in one shines through.
  if (insides.count > 0) {
    gl.DepthFunc(GL_GREATER);
    draw(insides);
    gl.DepthFunc(GL_LEQUAL);
  }

  // Contacts: faint if something is in front of them.
  for (const GLenum where : {GL_GREATER, GL_LEQUAL}) {
    if (contacts.count == 0) break;
    gl.DepthFunc(where);
    use(markerProgram, 1.0f, 1.0f, 1.0f, where == GL_GREATER ? 0.45f : 1.0f);
    draw(contacts);
  }
  gl.DepthMask(GL_TRUE);

  // What stands before an avatar, last: what is behind shines through, whatever it is.
  if (options.props && anyPropFades()) {
    gl.Enable(GL_CULL_FACE);
    drawFading([&] { drawProps(Pass::kLit, true); });
    gl.Disable(GL_CULL_FACE);
    gl.Enable(GL_BLEND);
  }

  // Bones are visible through everything, but hide one another.
  if (bones.count > 0) {
    gl.Clear(GL_DEPTH_BUFFER_BIT);
    use(overlayProgram);
    draw(bones);
  }
  gl.Disable(GL_BLEND);

  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, targets.picture);
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, targets.resolved);
  const bool sameSize = targets.drawnWidth == targets.width && targets.drawnHeight == targets.height;
  gl.BlitFramebuffer(0, 0, targets.drawnWidth, targets.drawnHeight, 0, 0, targets.width, targets.height,
                     GL_COLOR_BUFFER_BIT, sameSize ? GL_NEAREST : GL_LINEAR);
  gl.BindFramebuffer(GL_FRAMEBUFFER, targets.resolved);
  gl.Viewport(0, 0, targets.width, targets.height);
  drawPanel(caption, options.caption, false);
  drawPanel(panel, options.panel, true);
  if (scene.inset != nullptr && scene.inset->width > 0) drawInset(*scene.inset);
}

Image Renderer::readBack() {
  const Targets& t = impl_->targets;
  Image image = readPixels(impl_->gl, t.resolved, t.width, t.height);
  for (std::size_t k = 0; k < image.rgba.size(); k += 4) {
    if (!impl_->transparent) {  // the edges of grains have changed alpha
      image.rgba[k + 3] = 255;
      continue;
    }
    const int alpha = image.rgba[k + 3];  // which colours are multiplied with
    for (std::size_t c = k; alpha > 0 && c < k + 3; ++c) {
      image.rgba[c] = std::min((image.rgba[c] * 255 + alpha / 2) / alpha, 255);
    }
  }
  return image;
}

void Renderer::present(int width, int height, unsigned framebuffer) {
  const Targets& t = impl_->targets;
  const GlFunctions& gl = impl_->gl;
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, t.resolved);
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
  const bool sameSize = width == t.width && height == t.height;
  const int left = std::max(0, (t.width - int(std::lround(1.0 * t.height * width / height))) / 2);
  const int bottom = std::max(0, (t.height - int(std::lround(1.0 * t.width * height / width))) / 2);
  gl.BlitFramebuffer(left, bottom, t.width - left, t.height - bottom, 0, 0, width, height, GL_COLOR_BUFFER_BIT,
                     sameSize ? GL_NEAREST : GL_LINEAR);
}

}  // namespace lorica

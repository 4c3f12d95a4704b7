#include "viewer/renderer/renderer_impl.h"
#include "viewer/renderer/text.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace lorica {
namespace {

using shaders::Pass;
constexpr float kContactSoftness = 0.05f;  // standard deviation of the contact shadow's blur [m]

constexpr float kNearGrain = 2.0f;     // grains of at least this radius are drawn as balls [pixels]
constexpr float kShadowTexels = 2.0f;  // minimum width of a grain's shadow: grains behind it need not be drawn
constexpr float kNone = std::numeric_limits<float>::infinity();

int cellsIn(int pixels, float cell) {
  return std::max<int>(1, pixels / std::max(cell, 1.0f));
}

}  // namespace

void Renderer::Impl::uploadFigures(const Scene& scene, const SceneOptions& options) {
  shownAvatars.clear();
  skinCount = 0;
  for (AvatarGpu& known : avatars) {
    if (known.inUse && known.avatar.expired()) releaseAvatar(known);
    known.shown = false;
  }
  scene.eachFigure([&](const SceneFigure& figure) {
    if (options.skin && !uploadAvatar(figure, options) && !figure.triangles.empty()) uploadSkin(figure, options);
  });
}

void Renderer::Impl::uploadSkin(const SceneFigure& figure, const SceneOptions& options) {
  if (skinCount == skins.size()) createSkin(skins.emplace_back());
  SkinGpu& skin = skins[skinCount++];
  const bool changed = skin.mesh.update(figure.vertices, figure.triangles, figure.partOfTriangle);
  gl.BindVertexArray(skin.vertices.vertexArray);
  upload(skin.vertices, skin.mesh.vertices());
  if (changed) {
    const std::vector<std::uint32_t>& indices = skin.mesh.indices();
    gpu.upload(skin.colors, skin.mesh.colors());
    gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, indices.size() * sizeof(std::uint32_t), indices.data(), GL_STATIC_DRAW);
  }
  options.colorSkinByPart ? gl.EnableVertexAttribArray(2) : gl.DisableVertexAttribArray(2);
  skin.indexCount = glCount(skin.mesh.indices().size());
  skin.opacity = figure.opacity;
}

void Renderer::Impl::useSkinProgram(const SkinGpu& skin, Pass pass) {
  const bool fades = skin.opacity < 1.0f;
  const bool coarse = pass == Pass::kLit && skin.mesh.triangleCount() < kFineTriangles;
  if (fades) return use(fadingSkinProgram[passIndex(pass)], skin.opacity);
  use(coarse ? coarseSkinProgram : skinProgram[passIndex(pass)]);
}

/// Draws the skins in the colours of the parts or of clay. @param fading  those that fade, or the others
void Renderer::Impl::drawSkins(const SceneOptions& options, bool fading) {
  if (!options.colorSkinByPart) {
    const Vec3f clay = SkinMesh::clay();
    gl.VertexAttrib3f(2, clay.x(), clay.y(), clay.z());
  }
  for (const SkinGpu& skin : std::span(skins).first(skinCount)) {
    if ((skin.opacity < 1.0f) != fading) continue;
    enable(GL_CULL_FACE, skin.mesh.closed());
    useSkinProgram(skin, Pass::kLit);
    gl.BindVertexArray(skin.vertices.vertexArray);
    gl.DrawElements(GL_TRIANGLES, skin.indexCount, GL_UNSIGNED_INT, nullptr);
  }
}

void Renderer::Impl::uploadOverlays(const Scene& scene, const SceneOptions& options, const Vec3& eye) {
  const std::vector<OverlayVertex> none;
  const std::vector<OverlayVertex>* joints = &none;
  figureParts.clear();
  scene.eachFigure([&](const SceneFigure& figure) {
    figureParts.push_back({figure.parts, figure.opacity, figure.colors});
    if (!options.bones || figure.skeleton == nullptr) return;
    joints = &overlay.bones(*figure.skeleton, figure.worldFromJoint, eye, figure.opacity, joints != &none);
  });
  const bool bodies = options.skin || options.hulls;
  upload(hulls, options.hulls ? overlay.hulls(figureParts, eye) : none);
  upload(insides, bodies && options.props ? overlay.insides(figureParts, scene.props, eye) : none);
  upload(bones, *joints);
}

void Renderer::Impl::uploadContacts(std::span<const Contact> shown) {
  markers.clear();
  for (const Contact& contact : shown) {
    const Vec3f center = contact.point.cast<float>();
    for (const auto& [x, y] :
         {std::pair{-1.0f, -1.0f}, {1.0f, -1.0f}, {1.0f, 1.0f}, {-1.0f, -1.0f}, {1.0f, 1.0f}, {-1.0f, 1.0f}}) {
      markers.push_back({center, {x, y}});
    }
  }
  upload(contacts, markers);
}

bool Renderer::Impl::anyPropFades() const {
  const auto fades = [](const PropShapeGpu& shape) {
    return std::ranges::any_of(shape.instances, [](const PropInstance& prop) { return prop.opacity < 1.0f; });
  };
  return std::ranges::any_of(propShapes, fades) || std::ranges::any_of(meshProps, fades, &MeshPropGpu::gpu);
}

void Renderer::Impl::drawProps(Pass pass, bool fading) {
  use(propProgram[passIndex(pass)], fading ? 1.0f : 0.0f);
  for (const PropShapeGpu& shape : propShapes) drawPropShape(shape);
  for (const MeshPropGpu& mesh : meshProps) drawPropShape(mesh.gpu);
}

void Renderer::Impl::drawPropShape(const PropShapeGpu& shape) {
  if (shape.instances.empty()) return;
  gl.BindVertexArray(shape.vertexArray);
  gl.DrawElementsInstanced(GL_TRIANGLES, shape.indexCount, GL_UNSIGNED_INT, nullptr, glCount(shape.instances.size()));
}

/// Draws the shadow casters: the skin, or the hulls if no skin is shown, and the props.
void Renderer::Impl::drawCasters(Pass pass) {
  drawAvatarCasters(pass);
  gl.PolygonOffset(kCasterSlope, kCasterUnits);
  for (const SkinGpu& skin : std::span(skins).first(skinCount)) {
    if (!skin.mesh.closed()) {
      gl.Disable(GL_CULL_FACE);
      gl.Enable(GL_POLYGON_OFFSET_FILL);
    }
    useSkinProgram(skin, pass);
    gl.BindVertexArray(skin.vertices.vertexArray);
    gl.DrawElements(GL_TRIANGLES, skin.indexCount, GL_UNSIGNED_INT, nullptr);
    gl.Disable(GL_POLYGON_OFFSET_FILL);
    if (pass == Pass::kShadow) gl.Enable(GL_CULL_FACE);
  }
  if (skinCount == 0 && shownAvatars.empty() && hulls.count > 0) {
    use(skinProgram[passIndex(pass)]);
    draw(hulls);
  }
  if (pass == Pass::kShadow) gl.Enable(GL_CULL_FACE);
  drawProps(pass);
}

/// Draws the proximity to the floor of the lowest surface over each point, blurred in both directions.
void Renderer::Impl::drawContactShadow() {
  gl.BindFramebuffer(GL_FRAMEBUFFER, targets.contact[0]);
  gl.Viewport(0, 0, Targets::kContactSize, Targets::kContactSize);
  gl.ClearColor(0, 0, 0, 0);
  gl.Clear(GL_COLOR_BUFFER_BIT);
  gl.Disable(GL_DEPTH_TEST);
  gl.Enable(GL_BLEND);
  gl.BlendFunc(GL_ONE, GL_ONE);
  gl.BlendEquation(GL_MAX);
  drawCasters(Pass::kContact);
  gl.BlendEquation(GL_FUNC_ADD);
  gl.Disable(GL_BLEND);
  gl.BindVertexArray(emptyVertexArray);
  gl.ActiveTexture(GL_TEXTURE0);
  // The filter's own standard deviation is 1.41 texels; taps more than three texels apart would be visible.
  const float texel = 2.0f * setup.uniforms.contactArea.z() / Targets::kContactSize;
  const float step = std::clamp(kContactSoftness / (1.41f * texel), 1.0f, 3.0f) / Targets::kContactSize;
  for (const int from : {0, 1}) {
    gl.BindFramebuffer(GL_FRAMEBUFFER, targets.contact[1 - from]);
    gl.BindTexture(GL_TEXTURE_2D, targets.contactMap[from]);
    use(blurProgram, from == 0 ? step : 0.0f, from == 0 ? 0.0f : step);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
  }
}

/// The floor consists of four plain strips around the part that shadows can reach, because shadow map lookups are
/// costly.
void Renderer::Impl::drawFloor() {
  const float x = setup.uniforms.floorFade.x(), z = setup.uniforms.floorFade.y(), h = setup.floorHalfSide;
  const float xs[] = {x - h, setup.shadedMin.x(), setup.shadedMax.x(), x + h};
  const float zs[] = {z - h, setup.shadedMin.y(), setup.shadedMax.y(), z + h};
  std::array<Eigen::Vector2f, 30> corners;
  std::size_t n = 0;
  const auto rectangle = [&](float x0, float x1, float z0, float z1) {
    for (const auto& [px, pz] : {std::pair{x0, z0}, {x0, z1}, {x1, z1}, {x0, z0}, {x1, z1}, {x1, z0}}) {
      corners[n++] = {px, pz};
    }
  };
  rectangle(xs[1], xs[2], zs[1], zs[2]);
  rectangle(xs[0], xs[3], zs[0], zs[1]);
  rectangle(xs[0], xs[3], zs[2], zs[3]);
  rectangle(xs[0], xs[1], zs[1], zs[2]);
  rectangle(xs[2], xs[3], zs[1], zs[2]);
  gpu.upload(floor.buffer, corners.data(), sizeof(corners));
  gl.BindVertexArray(floor.vertexArray);
  use(nearFloorProgram);
  gl.DrawArrays(GL_TRIANGLES, 0, 6);
  use(farFloorProgram);
  gl.DrawArrays(GL_TRIANGLES, 6, 24);
}

void Renderer::Impl::drawFlat(int left, int bottom, int width, int height) {
  const float sx = 2.0f / targets.width, sy = 2.0f / targets.height;
  use(panelProgram, left * sx - 1.0f, bottom * sy - 1.0f, (left + width) * sx - 1.0f, (bottom + height) * sy - 1.0f);
  gl.Disable(GL_DEPTH_TEST);
  gl.Enable(GL_BLEND);
  gl.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl.BindVertexArray(emptyVertexArray);
  gl.DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  gl.Disable(GL_BLEND);
}

/// One texel per pixel.
void Renderer::Impl::drawPanel(PanelGpu& target, const std::string& whole, bool top) {
  if (whole.empty()) return;
  const int lineHeight = std::clamp(targets.height / 34, 12, 48);
  // A plate is wider than its text by the height of a line, and is half of that away from the side.
  const std::string text = top ? whole : fittedText(whole, lineHeight, targets.width - 2 * lineHeight);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, target.texture);
  if (text != target.text || lineHeight != target.lineHeight) {
    const Image image = drawTextPanel(text, lineHeight);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, image.width, image.height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                  image.rgba.data());
    target = {target.texture, text, lineHeight, image.width, image.height};
  }
  const int margin = lineHeight / 2;
  drawFlat(margin, top ? targets.height - target.height - margin : margin, target.width, target.height);
}

void Renderer::Impl::drawInset(const Image& image) {
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, insetTexture);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, image.width, image.height, 0, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  const int width = targets.width / 4;
  const int height = width * image.height / image.width;
  const int margin = std::clamp(targets.height / 34, 12, 48) / 2;
  drawFlat(targets.width - width - margin, margin, width, height);
}

/// The GPU data of a shape, uploaded if it is new. Data of shapes that no longer exist is reused.
MeshPropGpu& Renderer::Impl::meshPropOf(const std::shared_ptr<const PropMeshShape>& shape) {
  for (MeshPropGpu& known : meshProps) {
    if (known.shape.lock() == shape) return known;
  }
  auto position =
      std::find_if(meshProps.begin(), meshProps.end(), [](const MeshPropGpu& known) { return known.shape.expired(); });
  const PropMesh mesh = makeCreasedMesh(shape->shown);
  if (position == meshProps.end()) {
    position = meshProps.emplace(meshProps.end());
    createPropShape(position->gpu, mesh);
  } else {
    fillPropShape(position->gpu, mesh);
  }
  position->shape = shape;
  return *position;
}

void Renderer::Impl::uploadMeshProps(std::span<const Prop> props, bool shown, const UnhiddenView& view) {
  for (MeshPropGpu& mesh : meshProps) mesh.gpu.instances.clear();
  if (!shown) return;
  for (const Prop& prop : props) {
    if (prop.shape != PropShape::kMesh || prop.mesh == nullptr || !prop.worldFromProp.matrix().allFinite()) continue;
    const Eigen::Matrix4f m = prop.worldFromProp.matrix().cast<float>();
    meshPropOf(prop.mesh).gpu.instances.push_back({m.col(0).head<3>(), m.col(1).head<3>(), m.col(2).head<3>(),
                                                   m.col(3).head<3>(), Vec3f::Ones(), 0.0f, prop.color,
                                                   view.opacityOf(prop)});
  }
  for (MeshPropGpu& mesh : meshProps) {
    if (!mesh.gpu.instances.empty()) gpu.upload(mesh.gpu.instanceBuffer, mesh.gpu.instances);
  }
}

bool Renderer::Impl::uploadGrains(const Scene& scene, const GrainView& view, float margin) {
  grainVertices.clear();
  for (const std::uint32_t i : grainList.choose(scene.particles, view, margin)) {
    const GrainLook look = lookOfGrain(i);
    grainVertices.push_back(
        {scene.particles[i] + scene.particleRadius * look.shift, look.brightness * scene.particleColor, look.size});
  }
  upload(grains, grainVertices);
  return !grainVertices.empty();
}

void Renderer::Impl::drawGrainShadows(const Scene& scene) {
  if (scene.particles.empty() || !(scene.particleRadius > 0.0f)) return;
  GrainView view;
  view.clipFromWorld = 2.0f * setup.uniforms.shadowFromWorld;
  view.clipFromWorld.col(3).array() -= 1.0f;
  view.clipFromWorld.row(3) << 0.0f, 0.0f, 0.0f, 1.0f;
  view.depthFromWorld << -setup.uniforms.toLight.head<3>(), 0.0f;
  view.columns = view.rows = cellsIn(targets.shadowSize, kShadowTexels);
  const float margin = software ? 2.0f * scene.particleRadius : kNone;
  if (!uploadGrains(scene, view, margin)) return;
  use(grainShadowProgram, scene.particleRadius, kShadowTexels, std::min(maxPointSize, 64.0f));
  gl.Enable(GL_PROGRAM_POINT_SIZE);
  draw(grains, GL_POINTS);
}

void Renderer::Impl::drawGrains(const Scene& scene) {
  if (scene.particles.empty() || !(scene.particleRadius > 0.0f)) return;
  const bool near = setup.grainPixels >= kNearGrain;
  GrainView view;
  view.clipFromWorld = setup.uniforms.clipFromWorld;
  view.depthFromWorld = view.clipFromWorld.row(3).transpose();
  // A ball does not cover the corners of its square.
  const float cell = (near ? 0.7f : 1.0f) * setup.grainPixels;
  view.columns = cellsIn(targets.drawnWidth, cell);
  view.rows = cellsIn(targets.drawnHeight, cell);
  const float margin = software ? 3.0f * scene.particleRadius : kNone;
  if (!uploadGrains(scene, view, margin)) return;
  use(near ? nearGrainProgram : farGrainProgram, scene.particleRadius, 1.0f, maxPointSize);
  gl.Enable(GL_PROGRAM_POINT_SIZE);
  if (near && targets.samples > 0) gl.Enable(GL_SAMPLE_ALPHA_TO_COVERAGE);
  draw(grains, GL_POINTS);
  gl.Disable(GL_SAMPLE_ALPHA_TO_COVERAGE);
}

}  // namespace lorica

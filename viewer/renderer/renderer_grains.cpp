#include "viewer/renderer/frame_setup.h"
#include "viewer/renderer/renderer_impl.h"

#include <algorithm>
#include <limits>

namespace lorica {
namespace {

using shaders::Pass;

constexpr float kNearGrain = 2.0f;     // grains of at least this radius are drawn as balls [pixels]
constexpr float kShadowTexels = 2.0f;  // minimum width of a grain's shadow: grains behind it need not be drawn
constexpr float kNone = std::numeric_limits<float>::infinity();

int cellsIn(int pixels, float cell) {
  return std::max<int>(1, pixels / std::max(cell, 1.0f));
}

}  // namespace

bool Renderer::Impl::uploadGrains(const Scene& scene, const GrainView& view, float margin) {
  grainVertices.clear();
  for (const std::uint32_t i : grains.choose(scene.particles, view, margin)) {
    const GrainLook look = lookOfGrain(i);
    grainVertices.push_back(
        {scene.particles[i] + scene.particleRadius * look.shift, look.brightness * scene.particleColor, look.size});
  }
  if (!grainVertices.empty()) gpu.upload(grainBuffer, grainVertices);
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
  gl.UseProgram(grainShadowProgram);
  gl.Uniform4f(grainShadowUniform, scene.particleRadius, kShadowTexels, std::min(maxPointSize, 64.0f), 0.0f);
  gl.Enable(GL_PROGRAM_POINT_SIZE);
  gl.BindVertexArray(grainVertexArray);
  gl.DrawArrays(GL_POINTS, 0, glCount(grainVertices.size()));
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
  gl.UseProgram(near ? nearGrainProgram : farGrainProgram);
  gl.Uniform4f(near ? nearGrainUniform : farGrainUniform, scene.particleRadius, 1.0f, maxPointSize, 0.0f);
  gl.Enable(GL_PROGRAM_POINT_SIZE);
  if (near && targets.samples > 0) gl.Enable(GL_SAMPLE_ALPHA_TO_COVERAGE);
  gl.BindVertexArray(grainVertexArray);
  gl.DrawArrays(GL_POINTS, 0, glCount(grainVertices.size()));
  gl.Disable(GL_SAMPLE_ALPHA_TO_COVERAGE);
}

}  // namespace lorica

#include "viewer/renderer/water.h"

#include "viewer/renderer/renderer_impl.h"

#include <algorithm>

namespace lorica {
namespace {

constexpr int kCoarse = 3;         // cells of the list to one of the water's, in each direction
constexpr float kNoWater = 1e6f;   // depth where there is none [m]
constexpr float kFoamFrom = 0.7f;  // that a drop is faster or slower than those around it [m/s]
constexpr float kFoamTo = 2.2f;
constexpr float kDropSize = 1.7f;                       // radius of what is drawn to that of a drop, so that they join
constexpr float kAloneSize = 0.5f, kJoinedSize = 0.1f;  // size of a drop by itself, and for each beside it
constexpr int kSmoothPasses = 2;

int coarse(int fine) {
  return (fine + kCoarse - 1) / kCoarse;
}

}  // namespace

std::int32_t WaterCells::cellOf(std::int32_t fine, int fineColumns) const {
  return fine / fineColumns / kCoarse * columns_ + fine % fineColumns / kCoarse;
}

const std::vector<DropVertex>& WaterCells::make(std::span<const Vec3f> centers, std::span<const Vec3f> velocities,
                                                std::span<const std::uint32_t> chosen, const GrainList& list,
                                                const GrainView& view, float spacing, const Eigen::Vector2f& across) {
  columns_ = coarse(view.columns);
  rows_ = coarse(view.rows);
  const std::size_t cells = static_cast<std::size_t>(columns_) * rows_;
  thickness_.assign(cells, 0.0f);
  count_.assign(cells, 0.0f);
  velocity_.assign(cells, Vec3f::Zero());
  const bool moves = velocities.size() == centers.size();
  const float perDrop = spacing * spacing * spacing * cells / across.prod();
  for (std::size_t i = 0; i < centers.size(); ++i) {
    if (list.cells()[i] < 0) continue;
    const std::int32_t cell = cellOf(list.cells()[i], view.columns);
    const float depth = std::max(list.depths()[i], spacing);
    thickness_[cell] += perDrop / (depth * depth);
    count_[cell] += 1.0f;
    if (moves) velocity_[cell] += velocities[i];
  }
  drops_.clear();
  for (const std::uint32_t i : chosen) {
    const std::int32_t cell = cellOf(list.cells()[i], view.columns);
    const float apart = moves ? (velocities[i] - velocity_[cell] / count_[cell]).norm() : 0.0f;
    drops_.push_back({centers[i], std::clamp((apart - kFoamFrom) / (kFoamTo - kFoamFrom), 0.0f, 1.0f),
                      std::min(kAloneSize + kJoinedSize * (count_[cell] - 1.0f), 1.0f)});
  }
  // Cells hold few drops: each becomes the mean of itself and its neighbours, first along rows, then along columns.
  const auto blur = [this](int lines, int lineStep, int length, int step) {
    sharp_ = thickness_;
    for (int k = 0; k < lines; ++k) {
      for (int i = 0; i < length; ++i) {
        const int at = k * lineStep + i * step;
        const float before = sharp_[i > 0 ? at - step : at], after = sharp_[i + 1 < length ? at + step : at];
        thickness_[at] = 0.25f * (before + after) + 0.5f * sharp_[at];
      }
    }
  };
  blur(rows_, columns_, columns_, 1);
  blur(columns_, 1, rows_, columns_);
  return drops_;
}

void WaterTargets::resize(Gpu& gpu, int pictureWidth, int pictureHeight, int divisor) {
  const GlFunctions& gl = gpu.gl;
  if (surface[0] == 0) {
    for (GLuint* map : {&surfaceMap[0], &surfaceMap[1], &normalMap, &depthMap}) *map = gpu.makeTexture(GL_NEAREST);
    for (GLuint* map : {&behindMap, &thicknessMap}) *map = gpu.makeTexture(GL_LINEAR);
    for (GLuint* framebuffer : {&surface[0], &surface[1], &normals, &behind}) *framebuffer = gpu.makeFramebuffer();
  }
  if (behindWidth == pictureWidth && behindHeight == pictureHeight) return;
  behindWidth = pictureWidth;
  behindHeight = pictureHeight;
  width = (pictureWidth + divisor - 1) / divisor;
  height = (pictureHeight + divisor - 1) / divisor;
  const auto allocate = [&](GLuint framebuffer, GLuint map, GLint format, GLenum pixel, GLenum type, GLenum attachment,
                            int columns, int rows) {
    gl.ActiveTexture(GL_TEXTURE0);
    gl.BindTexture(GL_TEXTURE_2D, map);
    gl.TexImage2D(GL_TEXTURE_2D, 0, format, columns, rows, 0, pixel, type, nullptr);
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, map, 0);
  };
  for (int i = 0; i < 2; ++i)
    allocate(surface[i], surfaceMap[i], GL_RG32F, GL_RG, GL_FLOAT, GL_COLOR_ATTACHMENT0, width, height);
  allocate(normals, normalMap, GL_RGBA32F, GL_RGBA, GL_FLOAT, GL_COLOR_ATTACHMENT0, width, height);
  allocate(behind, behindMap, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, GL_COLOR_ATTACHMENT0, behindWidth, behindHeight);
  allocate(behind, depthMap, GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, GL_DEPTH_ATTACHMENT,
           behindWidth, behindHeight);
}

/// Water as a surface, after van der Laan, Green and Sainz, "Screen Space Fluid Rendering with Curvature Flow" (2009):
/// balls leave their depth, which is smoothed as in Truong and Yuksel, "A Narrow-Range Filter for Screen-Space Fluid
/// Rendering" (2018); then the picture behind is seen through it.
void Renderer::Impl::drawWater(const Scene& scene) {
  if (scene.particles.empty() || !(scene.particleRadius > 0.0f)) return;
  GrainView view;
  view.clipFromWorld = setup.uniforms.clipFromWorld;
  view.depthFromWorld = view.clipFromWorld.row(3).transpose();
  const float cell = std::max(setup.grainPixels, 1.0f);
  view.columns = std::max<int>(1, targets.drawnWidth / cell);
  view.rows = std::max<int>(1, targets.drawnHeight / cell);
  const float radius = kDropSize * scene.particleRadius;
  const std::vector<std::uint32_t>& chosen = grainList.choose(scene.particles, view, 2.0f * radius);
  if (chosen.empty()) return;
  const FrameUniforms& u = setup.uniforms;
  const Eigen::Vector2f across =
      2.0f * kBeside * Eigen::Vector2f(u.rayRight.head<3>().norm(), u.rayUp.head<3>().norm());
  const std::vector<DropVertex>& shown = waterCells.make(scene.particles, scene.particleVelocities, chosen, grainList,
                                                         view, 2.0f * scene.particleRadius, across);
  // The CPU draws half as many pixels in each direction.
  water.resize(gpu, targets.drawnWidth, targets.drawnHeight, software ? 2 : 1);
  const float scale = 1.0f * water.height / targets.drawnHeight;

  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, targets.picture);
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, water.behind);
  gl.BlitFramebuffer(0, 0, targets.drawnWidth, targets.drawnHeight, 0, 0, targets.drawnWidth, targets.drawnHeight,
                     GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT, GL_NEAREST);

  // The nearest depth of each pixel, and the most foam.
  gl.Viewport(0, 0, water.width, water.height);
  gl.BindFramebuffer(GL_FRAMEBUFFER, water.surface[0]);
  gl.Disable(GL_DEPTH_TEST);
  gl.ClearColor(kNoWater, 0.0f, 0.0f, 0.0f);
  gl.Clear(GL_COLOR_BUFFER_BIT);
  gl.Enable(GL_BLEND);
  gl.BlendFunc(GL_ONE, GL_ONE);
  gl.BlendEquation(GL_MIN);
  upload(drops, shown);
  use(dropProgram, radius, scale, maxPointSize);
  gl.Enable(GL_PROGRAM_POINT_SIZE);
  draw(drops, GL_POINTS);
  gl.BlendEquation(GL_FUNC_ADD);
  gl.Disable(GL_BLEND);

  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindVertexArray(emptyVertexArray);
  for (int pass = 0; pass < 2 * kSmoothPasses; ++pass) {
    gl.BindFramebuffer(GL_FRAMEBUFFER, water.surface[1 - pass % 2]);
    gl.BindTexture(GL_TEXTURE_2D, water.surfaceMap[pass % 2]);
    use(smoothProgram, pass % 2 == 0 ? 1.0f : 0.0f, pass % 2 == 0 ? 0.0f : 1.0f, radius, scale);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
  }
  gl.BindFramebuffer(GL_FRAMEBUFFER, water.normals);
  gl.BindTexture(GL_TEXTURE_2D, water.surfaceMap[0]);
  use(waterNormalProgram);
  gl.DrawArrays(GL_TRIANGLES, 0, 3);

  gl.BindFramebuffer(GL_FRAMEBUFFER, targets.picture);
  gl.Viewport(0, 0, targets.drawnWidth, targets.drawnHeight);
  gl.BindTexture(GL_TEXTURE_2D, water.normalMap);
  gl.ActiveTexture(GL_TEXTURE3);
  gl.BindTexture(GL_TEXTURE_2D, water.behindMap);
  gl.ActiveTexture(GL_TEXTURE4);
  gl.BindTexture(GL_TEXTURE_2D, water.depthMap);
  gl.ActiveTexture(GL_TEXTURE5);
  gl.BindTexture(GL_TEXTURE_2D, water.thicknessMap);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_R32F, waterCells.columns(), waterCells.rows(), 0, GL_RED, GL_FLOAT,
                waterCells.thickness().data());
  const Vec3f& tint = scene.particleColor;
  use(waterProgram, tint.x(), tint.y(), tint.z(), kBeside);
  gl.Enable(GL_DEPTH_TEST);
  gl.DrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace lorica

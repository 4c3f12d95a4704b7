#include "viewer/renderer/renderer_impl.h"

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace lorica {
namespace {

using shaders::Pass;
constexpr std::array<Pass, 3> kPasses = {Pass::kLit, Pass::kShadow, Pass::kContact};

const void* offset(std::size_t bytes) {
  return reinterpret_cast<const void*>(bytes);
}

}  // namespace

Result<void> Renderer::Impl::createPrograms() {
  struct Entry {
    Program* program;
    const char* name;
    shaders::Sources sources;
    const char* uniform = nullptr;
  };
  std::vector<Entry> entries = {
      {&coarseSkinProgram,
       "coarse skin",
       {shaders::skinVertex(Pass::kLit, true), shaders::surfaceFragment(Pass::kLit, true)}},
      {&skyProgram, "sky", shaders::sky()},
      {&farFloorProgram, "far floor", shaders::ground(false)},
      {&nearFloorProgram, "near floor", shaders::ground(true)},
      {&overlayProgram, "overlay", shaders::overlay()},
      {&markerProgram, "markers", shaders::markers(), "tint"},
      {&grainShadowProgram, "grain shadows", shaders::grains(Pass::kShadow, false), "grain"},
      {&farGrainProgram, "far grains", shaders::grains(Pass::kLit, false), "grain"},
      {&nearGrainProgram, "near grains", shaders::grains(Pass::kLit, true), "grain"},
      {&dropProgram, "drops", shaders::drops(), "grain"},
      {&smoothProgram, "water's smoothing", shaders::waterSmoothing(), "direction"},
      {&waterNormalProgram, "water's normals", shaders::waterNormals()},
      {&waterProgram, "water", shaders::water(), "water"},
      {&blurProgram, "blur", shaders::blur(), "stride"},
      {&panelProgram, "panel", shaders::panel(), "rectangle"},
  };
  for (const Pass pass : kPasses) {
    const std::size_t i = passIndex(pass);
    const std::string fragment = shaders::surfaceFragment(pass, true);
    entries.push_back(
        {&skinProgram[i], "skin", {shaders::skinVertex(pass, false), shaders::surfaceFragment(pass, false)}});
    entries.push_back({&fadingSkinProgram[i],
                       "fading skin",
                       {shaders::skinVertex(pass, true), shaders::fading(fragment, pass == Pass::kLit)},
                       "opacity"});
    entries.push_back(
        {&propProgram[i],
         "props",
         {shaders::propVertex(pass), pass == Pass::kLit ? shaders::fading(fragment, true, "flat in") : fragment},
         "which"});
  }
  for (const auto& [program, name, sources, uniform] : entries) {
    LORICA_TRY(program->id, gpu.makeProgram(name, sources.vertex, sources.fragment));
    use(*program);
    // In the order of their units; the first is the pass's own texture.
    for (GLint unit = 0;
         const char* map : {"source", "contactMap", "shadowMap", "behind", "behindDepth", "thickness"}) {
      if (const GLint i = gl.GetUniformLocation(program->id, map); i >= 0) gl.Uniform1i(i, unit);
      ++unit;
    }
    if (uniform != nullptr) program->uniform = gl.GetUniformLocation(program->id, uniform);
  }
  return {};
}

void Renderer::Impl::attribute(GLuint index, GLint size, GLenum type, GLboolean normalized, std::size_t stride,
                               std::size_t at) {
  gl.EnableVertexAttribArray(index);
  gl.VertexAttribPointer(index, size, type, normalized, glCount(stride), offset(at));
}

void Renderer::Impl::attributes(std::size_t stride, std::initializer_list<Attribute> fields) {
  for (GLuint index = 0; const Attribute& field : fields) {
    attribute(index++, field.size, field.type, field.type == GL_FLOAT ? GL_FALSE : GL_TRUE, stride, field.at);
  }
}

void Renderer::Impl::createStream(VertexStream& stream, std::size_t stride, std::initializer_list<Attribute> fields) {
  stream.vertexArray = gpu.makeVertexArray();
  stream.buffer.id = gpu.makeBuffer();
  gl.BindVertexArray(stream.vertexArray);
  gl.BindBuffer(GL_ARRAY_BUFFER, stream.buffer.id);
  attributes(stride, fields);
}

void Renderer::Impl::fillPropShape(PropShapeGpu& shape, const PropMesh& mesh) {
  shape.indexCount = glCount(mesh.indices.size());
  gl.BindVertexArray(shape.vertexArray);
  gl.BindBuffer(GL_ARRAY_BUFFER, shape.vertexBuffer);
  gl.BufferData(GL_ARRAY_BUFFER, mesh.vertices.size() * sizeof(PropMesh::Vertex), mesh.vertices.data(), GL_STATIC_DRAW);
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, shape.indexBuffer);
  gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, mesh.indices.size() * sizeof(std::uint32_t), mesh.indices.data(),
                GL_STATIC_DRAW);
}

void Renderer::Impl::createPropShape(PropShapeGpu& shape, const PropMesh& mesh) {
  shape.vertexArray = gpu.makeVertexArray();
  shape.vertexBuffer = gpu.makeBuffer();
  shape.indexBuffer = gpu.makeBuffer();
  shape.instanceBuffer.id = gpu.makeBuffer();
  fillPropShape(shape, mesh);
  attributes(sizeof(PropMesh::Vertex),
             {{3, offsetof(PropMesh::Vertex, corner)}, {3, offsetof(PropMesh::Vertex, normal)}});
  gl.BindBuffer(GL_ARRAY_BUFFER, shape.instanceBuffer.id);
  const Attribute fields[] = {{3, offsetof(PropInstance, x)},       {3, offsetof(PropInstance, y)},
                              {3, offsetof(PropInstance, z)},       {3, offsetof(PropInstance, origin)},
                              {4, offsetof(PropInstance, extents)}, {4, offsetof(PropInstance, color)}};
  static_assert(offsetof(PropInstance, opacity) == offsetof(PropInstance, color) + 3 * sizeof(float));
  static_assert(offsetof(PropInstance, bevel) == offsetof(PropInstance, extents) + 3 * sizeof(float));
  GLuint index = 2;
  for (const Attribute& field : fields) {
    attribute(index, field.size, GL_FLOAT, GL_FALSE, sizeof(PropInstance), field.at);
    gl.VertexAttribDivisor(index, 1);
    ++index;
  }
}

/// A grid over the picture with the sky's colour at its vertices, so that the gradient costs nothing per pixel.
void Renderer::Impl::createSky() {
  constexpr std::uint32_t kColumns = 8, kRows = 32;
  std::vector<Eigen::Vector2f> positions;
  std::vector<std::uint32_t> indices;
  for (std::uint32_t row = 0; row <= kRows; ++row) {
    for (std::uint32_t column = 0; column <= kColumns; ++column) {
      positions.emplace_back(2.0f * column / kColumns - 1.0f, 2.0f * row / kRows - 1.0f);
      if (row == kRows || column == kColumns) continue;
      const std::uint32_t a = row * (kColumns + 1) + column, b = a + 1, c = b + kColumns + 1, d = c - 1;
      indices.insert(indices.end(), {a, b, c, a, c, d});
    }
  }
  skyIndexCount = glCount(indices.size());
  skyVertexArray = gpu.makeVertexArray();
  gl.BindVertexArray(skyVertexArray);
  gl.BindBuffer(GL_ARRAY_BUFFER, gpu.makeBuffer());
  gl.BufferData(GL_ARRAY_BUFFER, positions.size() * sizeof(positions[0]), positions.data(), GL_STATIC_DRAW);
  attribute(0, 2, GL_FLOAT, GL_FALSE, sizeof(Eigen::Vector2f), 0);
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, gpu.makeBuffer());
  gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, indices.size() * sizeof(std::uint32_t), indices.data(), GL_STATIC_DRAW);
}

void Renderer::Impl::createSkin(SkinGpu& skin) {
  createStream(skin.vertices, sizeof(SkinMesh::Vertex),
               {{3, offsetof(SkinMesh::Vertex, position)}, {3, offsetof(SkinMesh::Vertex, normal)}});
  skin.colors.id = gpu.makeBuffer();
  skin.indices = gpu.makeBuffer();
  gl.BindBuffer(GL_ARRAY_BUFFER, skin.colors.id);
  attribute(2, 3, GL_FLOAT, GL_FALSE, sizeof(Vec3f), 0);
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, skin.indices);
}

void Renderer::Impl::createMeshes() {
  emptyVertexArray = gpu.makeVertexArray();
  frameBlock = gpu.makeBuffer();
  gl.BindBuffer(GL_UNIFORM_BUFFER, frameBlock);
  gl.BufferData(GL_UNIFORM_BUFFER, sizeof(FrameUniforms), nullptr, GL_STREAM_DRAW);

  for (VertexStream* stream : {&hulls, &insides, &bones}) {
    createStream(*stream, sizeof(OverlayVertex),
                 {{3, offsetof(OverlayVertex, position)},
                  {3, offsetof(OverlayVertex, other)},
                  {4, offsetof(OverlayVertex, normal), GL_BYTE},
                  {4, offsetof(OverlayVertex, color), GL_UNSIGNED_BYTE}});
  }
  for (std::size_t shape = 0; shape < propShapes.size(); ++shape) {
    createPropShape(propShapes[shape], makePropMesh(static_cast<PropShape>(shape)));
  }

  createStream(floor, sizeof(Eigen::Vector2f), {{2, 0}});
  createStream(contacts, sizeof(MarkerVertex),
               {{3, offsetof(MarkerVertex, center)}, {2, offsetof(MarkerVertex, corner)}});
  createStream(grains, sizeof(GrainVertex), {{3, offsetof(GrainVertex, center)}, {4, offsetof(GrainVertex, color)}});
  createStream(drops, sizeof(DropVertex), {{3, offsetof(DropVertex, center)}, {2, offsetof(DropVertex, foam)}});
  GLfloat pointSizes[2] = {1.0f, 1.0f};
  gl.GetFloatv(GL_POINT_SIZE_RANGE, pointSizes);
  maxPointSize = std::min(pointSizes[1], 256.0f);
  const auto* renderer = reinterpret_cast<const char*>(gl.GetString(GL_RENDERER));
  const std::string_view name = renderer != nullptr ? renderer : "";
  software = name.find("llvmpipe") != std::string_view::npos || name.find("softpipe") != std::string_view::npos;

  createSky();
  caption.texture = gpu.makeTexture(GL_NEAREST);
  panel.texture = gpu.makeTexture(GL_NEAREST);
  insetTexture = gpu.makeTexture(GL_LINEAR);
}

}  // namespace lorica

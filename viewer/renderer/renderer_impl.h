#pragma once

#include "viewer/renderer/avatar_mesh.h"
#include "viewer/renderer/avatar_shaders.h"
#include "viewer/renderer/frame_setup.h"
#include "viewer/renderer/gpu.h"
#include "viewer/renderer/grain_list.h"
#include "viewer/renderer/overlay_mesh.h"
#include "viewer/renderer/prop_mesh.h"
#include "viewer/renderer/renderer.h"
#include "viewer/renderer/shaders.h"
#include "viewer/renderer/skin_mesh.h"
#include "viewer/renderer/water.h"

#include <array>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// The framebuffers of a renderer: the multisampled picture, the resolved picture, the shadow map, and the contact
/// shadow with a second texture for blurring.
struct Targets {
  static constexpr int kContactSize = 256;

  int width = 0;  ///< of the finished picture [pixels]
  int height = 0;
  int drawnWidth = 0;  ///< of the picture before it is enlarged [pixels]
  int drawnHeight = 0;
  int samples = 0;
  int shadowSize = 0;  ///< texels per side
  GLuint picture = 0, pictureColor = 0, pictureDepth = 0;
  GLuint resolved = 0, resolvedColor = 0;
  GLuint shadow = 0, shadowMap = 0;
  GLuint contact[2] = {}, contactMap[2] = {};

  /// @return success, or kNoDisplay if the driver does not support a framebuffer
  [[nodiscard]] Result<void> create(Gpu& gpu);
  /// Takes effect at the next resize().
  void setQuality(const Gpu& gpu, RenderQuality newQuality);
  /// Sets a new size [pixels]; does nothing if it is the current one.
  void resize(const Gpu& gpu, int newWidth, int newHeight);

  RenderQuality quality = RenderQuality::kHigh;
};

/// Skins with fewer triangles look up shadows per pixel, because they are too coarse for a lookup per vertex.
inline constexpr std::size_t kFineTriangles = 8000;

/// A program and its one uniform of four numbers, if it has one.
struct Program {
  GLuint id = 0;
  GLint uniform = -1;
};

struct AvatarProgram {
  shaders::AvatarVariant variant;
  Program program;  ///< 0: the driver cannot compile it
};

/// A group of an avatar's triangles with its material.
struct AvatarGroup {
  const Material* material = nullptr;  ///< of AvatarGpu::avatar
  std::size_t firstIndex = 0;
  GLsizei indexCount = 0;
  bool flat = false;
  GLuint surface = 0;                                       ///< uniform buffer, of AvatarGpu::surfaces
  std::array<GLuint, shaders::kAvatarSlots> textures = {};  ///< 0 = none
  std::uint32_t available = 0;                              ///< bits by AvatarSlot: there is a texture
  Vec3 center{0, 0, 0};                                     ///< in the bind pose [m]
  JointIndex joint = 0;                                     ///< moves the centre
};

struct AvatarTexture {
  TextureUse use;
  bool srgb = false;
  GLuint texture = 0;
};

/// Consecutive groups that cast shadows alike.
struct AvatarCasters {
  std::size_t group = 0;  ///< the first
  GLsizei indexCount = 0;
};

/// An avatar on the GPU, kept as long as it exists.
struct AvatarGpu {
  std::weak_ptr<const Avatar> avatar;
  GLuint vertexArray = 0, shapeBuffer = 0, vertexBuffer = 0, indexBuffer = 0;
  GLuint jointTexture = 0;
  StreamBuffer jointBuffer, posedBuffer;
  std::vector<GLuint> surfaces;                    ///< uniform buffers, by material
  std::vector<shaders::SurfaceUniforms> uniforms;  ///< in them
  std::vector<AvatarShape> shapes;                 ///< as uploaded last
  std::vector<AvatarShape> bindShapes;
  std::vector<AvatarVertex> vertices;  ///< kept only if they are skinned on the CPU
  std::vector<AvatarPosed> posed;      ///< of this picture
  std::vector<AvatarGroup> groups;
  std::vector<AvatarCasters> casters;
  std::vector<AvatarTexture> textures;
  std::vector<Eigen::Vector4f> jointRows;  ///< of this picture
  std::vector<std::size_t> blended;        ///< groups by distance, scratch
  std::vector<double> distances;           ///< of groups, scratch
  float opacity = 1.0f;                    ///< of this picture
  bool fewInfluences = true;
  bool shadowEachPixel = true;
  bool posedOnCpu = false;  ///< the vertex buffers hold the pose: shaders do not skin
  bool reshaped = false;    ///< `shapes` differ from bindShapes
  bool inUse = false;       ///< filled for an avatar, which may no longer exist
  bool shown = false;       ///< in this picture
};

struct GrainVertex {
  Vec3f center;
  Vec3f color;  ///< linear RGB
  float size;   ///< to the radius of all
};

struct MarkerVertex {
  Vec3f center;
  Eigen::Vector2f corner;
};

/// One shape of prop on the GPU.
struct PropShapeGpu {
  GLuint vertexArray = 0;
  GLuint vertexBuffer = 0, indexBuffer = 0;
  GLsizei indexCount = 0;
  StreamBuffer instanceBuffer;
  std::vector<PropInstance> instances;
};

/// The GPU data of a mesh shape, kept as long as the shape exists.
struct MeshPropGpu {
  std::weak_ptr<const PropMeshShape> shape;
  PropShapeGpu gpu;
};

/// A text panel as a texture, redrawn only if its text or size changes.
struct PanelGpu {
  GLuint texture = 0;
  std::string text;
  int lineHeight = 0;
  int width = 0;
  int height = 0;
};

/// Lit faces that cast shadows are moved away from the light, so that they do not shadow themselves: by so many times
/// their slope in a texel, and smallest steps of the depth. With the shaders' offset along the normal that is enough
/// for all texels that a lookup reads, at any slope.
inline constexpr float kCasterSlope = 2.0f, kCasterUnits = 8.0f;

inline std::size_t passIndex(shaders::Pass pass) {
  return static_cast<std::size_t>(pass);
}
inline GLsizei glCount(std::size_t n) {
  return static_cast<GLsizei>(n);
}

/// Vertices that change from picture to picture.
struct VertexStream {
  GLuint vertexArray = 0;
  StreamBuffer buffer;
  GLsizei count = 0;  ///< in this picture
};

/// The skin of a figure on the GPU.
struct SkinGpu {
  SkinMesh mesh;
  VertexStream vertices;
  StreamBuffer colors;
  GLuint indices = 0;
  GLsizei indexCount = 0;
  float opacity = 1.0f;
};

/// The state of a Renderer: created by renderer_setup.cpp; filled and drawn by renderer_passes.cpp in the order given
/// by renderer.cpp.
struct Renderer::Impl {
  explicit Impl(const GlFunctions& functions) : gpu(functions), gl(gpu.gl) {}

  Gpu gpu;
  const GlFunctions& gl;
  Targets targets;

  std::array<Program, 3> skinProgram, fadingSkinProgram, propProgram;  // by Pass
  Program coarseSkinProgram, skyProgram, farFloorProgram, nearFloorProgram, overlayProgram, markerProgram;
  Program blurProgram, panelProgram, grainShadowProgram, farGrainProgram, nearGrainProgram;
  Program dropProgram, smoothProgram, waterNormalProgram, waterProgram;
  GLuint frameBlock = 0, emptyVertexArray = 0;
  FrameSetup setup{};  ///< of the last picture

  std::vector<SkinGpu> skins;
  std::size_t skinCount = 0;  ///< of `skins`: drawn in this picture

  std::deque<AvatarGpu> avatars;
  std::vector<AvatarProgram> avatarPrograms;
  std::vector<AvatarGpu*> shownAvatars;  ///< avatars in this picture
  AvatarGpu* avatar = nullptr;           ///< that is being filled or drawn
  std::vector<HullFigure> figureParts;

  OverlayMesh overlay;
  VertexStream hulls, insides, bones, contacts, floor, grains, drops;

  std::array<PropShapeGpu, kPropShapeCount> propShapes;
  std::vector<MeshPropGpu> meshProps;
  GLuint skyVertexArray = 0;
  GLsizei skyIndexCount = 0;
  std::vector<MarkerVertex> markers;
  PanelGpu caption, panel;
  GLuint insetTexture = 0;

  GrainList grainList;
  std::vector<GrainVertex> grainVertices;
  WaterCells waterCells;
  WaterTargets water;
  bool software = false;      ///< software rendering on the CPU: each grain is costly
  float maxPointSize = 1.0f;  ///< of the driver [pixels]
  bool transparent = false;   ///< the last picture

  Result<void> createPrograms();
  void createMeshes();
  void attribute(GLuint index, GLint size, GLenum type, GLboolean normalized, std::size_t stride, std::size_t at);
  /// A vertex's member. Whole numbers stand for -1 or 0 to 1.
  struct Attribute {
    GLint size;      ///< number of components
    std::size_t at;  ///< [bytes]
    GLenum type = GL_FLOAT;
  };
  /// From index 0 on, of the buffer that is bound.
  void attributes(std::size_t stride, std::initializer_list<Attribute> fields);
  void createStream(VertexStream& stream, std::size_t stride, std::initializer_list<Attribute> fields);
  template <typename Vertex>
  void upload(VertexStream& stream, const std::vector<Vertex>& vertices) {
    if (!vertices.empty()) gpu.upload(stream.buffer, vertices);
    stream.count = glCount(vertices.size());
  }
  void draw(const VertexStream& stream, GLenum mode = GL_TRIANGLES) {
    gl.BindVertexArray(stream.vertexArray);
    gl.DrawArrays(mode, 0, stream.count);
  }
  void use(const Program& program) { gl.UseProgram(program.id); }
  /// Sets its uniform, too.
  void use(const Program& program, float x, float y = 0.0f, float z = 0.0f, float w = 0.0f) {
    gl.UseProgram(program.id);
    gl.Uniform4f(program.uniform, x, y, z, w);
  }
  void enable(GLenum capability, bool on) { on ? gl.Enable(capability) : gl.Disable(capability); }
  void createSky();
  void createPropShape(PropShapeGpu& shape, const PropMesh& mesh);
  void fillPropShape(PropShapeGpu& shape, const PropMesh& mesh);
  MeshPropGpu& meshPropOf(const std::shared_ptr<const PropMeshShape>& shape);
  void uploadMeshProps(std::span<const Prop> props, bool shown, const UnhiddenView& view);
  void drawPropShape(const PropShapeGpu& shape);
  [[nodiscard]] bool anyPropFades() const;

  /// Uploads all figures: avatars to `shownAvatars`, the rest to `skins`.
  void uploadFigures(const Scene& scene, const SceneOptions& options);
  void createSkin(SkinGpu& skin);
  void uploadSkin(const SceneFigure& figure, const SceneOptions& options);
  /// @return false if the figure is not drawn as an avatar
  bool uploadAvatar(const SceneFigure& figure, const SceneOptions& options);
  /// Makes an avatar the one that is drawn next.
  void bindAvatar(AvatarGpu& next);
  void useSkinProgram(const SkinGpu& skin, shaders::Pass pass);
  /// Blends colours over what is there, by their alpha; so does the picture's own alpha.
  void blendOver() { gl.BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA); }
  void drawSkins(const SceneOptions& options, bool fading);
  /// What fades hides what of it is behind: its depth comes first, then its colour, blended over what is there.
  template <typename Draw>
  void drawFading(const Draw& draw) {
    gl.ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    draw();
    gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl.Enable(GL_BLEND);
    blendOver();
    draw();
    gl.Disable(GL_BLEND);
  }
  AvatarGpu& avatarGpuOf(const std::shared_ptr<const Avatar>& drawn);
  void fillAvatar(AvatarGpu& made, const Avatar& drawn);
  void releaseAvatar(AvatarGpu& made);
  void reshapeAvatar(const SceneFigure& figure);
  void recolorAvatar(const SceneFigure& figure);
  [[nodiscard]] GLuint avatarTexture(AvatarGpu& made, const Avatar& drawn, const TextureUse& use, bool srgb);
  [[nodiscard]] Program avatarProgram(shaders::AvatarVariant variant);
  /// @param indexCount  0 = the group's; more = with the groups after it
  void drawAvatarGroup(const AvatarGroup& group, shaders::AvatarVariant::Draw draw, GLsizei indexCount = 0);
  void drawAvatarCasters(shaders::Pass pass);
  void drawAvatarOpaque();
  void drawOpaqueGroups();
  void drawAvatarBlended(const Vec3& eye);
  void drawBlendedGroups(const Vec3& eye);
  void uploadFrame();
  void drawView(const Scene& scene, const SceneOptions& options, const Vec3& eye);
  void drawCasters(shaders::Pass pass);
  void drawContactShadow();
  /// @param fading  of the lit pass: those that are seen through, or the others
  void drawProps(shaders::Pass pass, bool fading = false);
  void drawGrainShadows(const Scene& scene);
  void drawGrains(const Scene& scene);
  /// @return whether any is visible
  bool uploadGrains(const Scene& scene, const GrainView& view, float margin);
  /// Whether particles are drawn as one surface.
  [[nodiscard]] bool drawsSurface(const Scene& scene) const {
    return scene.water && targets.quality != RenderQuality::kLow;
  }
  void drawWater(const Scene& scene);
  void drawFloor();
  /// Hulls, parts inside static bodies and bones.
  void uploadOverlays(const Scene& scene, const SceneOptions& options, const Vec3& eye);
  void uploadContacts(std::span<const Contact> shown);
  /// Draws a text panel: at the top unchanged, at the bottom wrapped to fit.
  void drawPanel(PanelGpu& target, const std::string& whole, bool top);
  void drawInset(const Image& image);
  /// Draws the bound texture onto the resolved picture; coordinates in pixels from the lower left.
  void drawFlat(int left, int bottom, int width, int height);
};

}  // namespace lorica

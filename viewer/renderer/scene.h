#pragma once

#include "acd/decomposition.h"
#include "collision/live/live_part.h"
#include "collision/world/world.h"
#include "geometry/math.h"
#include "geometry/tri_mesh.h"
#include "skinning/look/avatar.h"
#include "skinning/skeleton.h"
#include "viewer/renderer/image.h"

#include <memory>
#include <optional>
#include <span>
#include <string>

namespace lorica {

/// The light on avatars: a key light from above and the left of a figure that faces +Z, and a sky over a ground around
/// it. Linear RGB; a white surface that faces the key light and is lit by nothing else has its colour.
struct AvatarLight {
  Vec3f key{0.98f, 0.95f, 0.90f};     ///< of the sun, linear RGB
  Vec3f sky{0.40f, 0.42f, 0.46f};     ///< from above, linear RGB
  Vec3f ground{0.27f, 0.26f, 0.25f};  ///< from below, linear RGB
};

/// A figure in a picture, borrowed from the caller.
struct SceneFigure {
  int number = 0;                             ///< of its avatar among those of the session
  std::span<const Vec3> vertices;             ///< posed mesh [m]
  std::span<const Triangle> triangles;        ///< of the mesh
  std::span<const PartIndex> partOfTriangle;  ///< its colour, see partColor(); empty = one colour
  std::span<const LivePart> parts;            ///< hull overlay
  std::span<const PartIndex> colors = {};     ///< of each part, see partColor(); empty = as they are numbered
  const Skeleton* skeleton = nullptr;         ///< drawn as bones with worldFromJoint
  std::span<const Affine3> worldFromJoint;    ///< one for each joint [m]
  std::shared_ptr<const Avatar> avatar;       ///< drawn instead of the mesh; null = none
  std::span<const Affine3> worldFromModel;    ///< of the avatar's joints, see computeWorldFromModel()
  std::span<const Vec3> avatarPositions;      ///< of the avatar's vertices in the bind pose, changed by an expression
  std::span<const Vec3f> avatarNormals;       ///< with them; both empty = as in the avatar
  std::span<const Material> avatarMaterials;  ///< changed by an expression; empty = as in the avatar
  std::span<const float> expressions = {};    ///< weight of each expression of the avatar's face
  float opacity = 1.0f;                       ///< 0 to 1, of the surface and of what is drawn over it
};

/// The contents of one picture, borrowed from the caller: a figure, if there is one, and what is around it.
/// Independent of sessions and files.
struct Scene : SceneFigure {
  std::span<const SceneFigure> others;             ///< further figures
  std::span<const Prop> props;                     ///< of the world
  std::span<const Contact> contacts;               ///< of this frame, as markers
  std::span<const Vec3f> particles;                ///< centres of grains or drops [m]
  float particleRadius = 0.0f;                     ///< of all particles [m]
  Vec3f particleColor{0.60f, 0.45f, 0.26f};        ///< of all particles, linear RGB: dry sand
  bool water = false;                              ///< drawn as one surface, unless the quality is low
  std::span<const Vec3f> particleVelocities = {};  ///< [m/s]: water foams where they differ; empty = nowhere
  const Image* inset = nullptr;       ///< opaque, at the lower right, a quarter of the picture's width; null = none
  double time = 0.0;                  ///< of moving textures [s]
  std::optional<Aabb> unhidden = {};  ///< props between the eye and this are drawn see-through; none = all are solid

  /// Calls visit(const SceneFigure&) for each figure.
  template <typename Visit>
  void eachFigure(const Visit& visit) const {
    visit(static_cast<const SceneFigure&>(*this));
    for (const SceneFigure& figure : others) visit(figure);
  }
};

/// The layers of a scene that are drawn.
struct SceneOptions {
  bool skin = true;                 ///< the mesh or the avatar
  bool colorSkinByPart = true;      ///< shows the mesh even if there is an avatar
  bool hulls = true;                ///< translucent faces with edges
  bool bones = false;               ///< lines from joint to joint
  bool props = true;                ///< of Scene::props
  bool contacts = true;             ///< of Scene::contacts
  bool particles = true;            ///< of Scene::particles
  bool ground = true;               ///< the floor with its grid, at y = 0
  std::string caption;              ///< one line of text at the lower left; empty = none
  std::string panel;                ///< lines of text at the upper left; empty = none
  AvatarLight light;                ///< on avatars
  std::optional<Vec3f> background;  ///< sRGB, instead of the sky
  bool transparent = false;         ///< instead of both: the picture's alpha says what is drawn
  bool dark = false;                ///< sky and floor of a dark room
};

/// Where a picture is seen from; Y is up in it.
struct Camera {
  Vec3 eye{1.8, 1.6, 3.6};      ///< world [m]
  Vec3 target{0.0, 0.95, 0.0};  ///< what is looked at, world [m]
  double verticalFov = 0.6;     ///< [rad]
  /// Where in the picture the target is: from its middle to the right and up, in half widths and half heights.
  Eigen::Vector2d targetAt = Eigen::Vector2d::Zero();
  Vec3 up = Vec3::UnitY();  ///< what the picture's upward edges lie along, as far as it is not along the view
  double aspect = 0.0;      ///< width per height of what is seen; 0 = of the picture, whose pixels are square
  double nearest = 0.0;     ///< what is nearer is not drawn [m]; 0 = by the distance of the target
};

/// Distinct colour of a part, the same in every picture; linear RGB.
[[nodiscard]] Vec3f partColor(PartIndex part);

}  // namespace lorica

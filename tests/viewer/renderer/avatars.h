#pragma once

#include "skinning/look/avatar.h"
#include "viewer/renderer/image.h"
#include "viewer/renderer/scene.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace lorica::test {

/// An avatar of a few triangles, made by hand. Joints form a chain whose bind matrices are the identity.
class AvatarMaker {
 public:
  explicit AvatarMaker(int joints = 1);

  /// @return the index of the material that the next shapes get
  int material(const Material& material);
  /// A picture of these texels, row by row from the top.
  TextureUse picture(int width, int height, std::vector<std::array<std::uint8_t, 4>> texels);
  /// A picture of one colour.
  TextureUse picture(std::array<std::uint8_t, 4> texel) { return picture(1, 1, {texel}); }

  struct Quad {
    Vec3 center{0, 1, 0};
    double half = 0.5;            ///< of a side [m]
    bool facesAway = false;       ///< its front is at -Z, and its texture upright from there
    std::optional<Vec3f> normal;  ///< else that of its front; zero = none
    Eigen::Vector4f tangent{0, 0, 0, 0};
    float uLeft = 0, uRight = 1, vTop = 0, vBottom = 1;
    Eigen::Vector4f color{1, 1, 1, 1};
  };
  /// A square across the Z axis with the last material, in a group of its own. Left and right are as seen from +Z, or
  /// from -Z if it faces away.
  void add(const Quad& quad);
  /// A sphere with its true normals; texture coordinates are zero.
  void addSphere(const Vec3& center, double radius, int rings, int segments);

  /// A cone around the Y axis without ends, as a skirt is, with its true normals.
  void addSkirt(const Vec3& center, double radiusAbove, double radiusBelow, double height, int segments);

  /// Influences of all vertices: each vertex gets `count` joints, from a fixed generator.
  void spreadInfluences(int count, std::uint32_t seed);

  Avatar avatar;

 private:
  void group(std::size_t firstTriangle);
  VertexIndex vertex(const Vec3& position, const Vec3f& normal);
};

/// A maker's avatar in a pose, and what a scene of it borrows.
class AvatarOnStage {
 public:
  explicit AvatarOnStage(Avatar avatar);

  std::shared_ptr<const Avatar> avatar;
  std::vector<Affine3> worldFromModel;  ///< the identity at first
  [[nodiscard]] Scene scene() const;

 private:
  std::vector<LivePart> around_;
};

/// Only the avatar, in front of black, lit by nothing but what `light` says.
[[nodiscard]] SceneOptions onBlack(const AvatarLight& light = {});

/// No light at all.
[[nodiscard]] AvatarLight dark();

/// Towards the key light.
[[nodiscard]] Vec3 towardsLight();

/// IEC 61966-2-1: linear to a byte, and back.
[[nodiscard]] int byteOf(double linear);
[[nodiscard]] double linearOf(int byte);

}  // namespace lorica::test

#pragma once

#include "acd/decomposition.h"
#include "collision/live/live_part.h"
#include "collision/live/posed_skin.h"
#include "geometry/math.h"

#include <cstddef>
#include <span>
#include <vector>

namespace lorica {

/// A ray, or a segment if it ends; or a ball or capsule that is swept along it.
struct HullRay {
  Vec3 origin = Vec3::Zero();      ///< world [m]
  Vec3 direction = Vec3::UnitZ();  ///< of any length above 0
  double reach = kInfinity;        ///< where it ends [m]
  double radius = 0.0;             ///< of a ball or capsule [m]
  Vec3 half = Vec3::Zero();  ///< from the middle of a capsule, which moves along the ray, to an end of its axis [m]

  /// A ball or capsule moves along the ray
  [[nodiscard]] bool swept() const { return radius != 0.0 || half != Vec3::Zero(); }
};

/// Where a ray enters the hull of a part, or what is swept touches it.
struct HullHit {
  int body = -1;                 ///< index in RayQuery::update(); -1 = nothing was hit
  PartIndex part = -1;           ///< -1 = nothing was hit
  double distance = 0.0;         ///< from the origin [m]; 0 if that is inside
  Vec3 position = Vec3::Zero();  ///< on the hull, world [m]; of what begins inside, or touching, where that begins
  Vec3 normal = Vec3::Zero();    ///< of the hull there, outward, unit; against the ray if it begins inside

  explicit operator bool() const { return body >= 0; }  ///< whether something was hit
};

/// Answers rays against bodies in their present pose, without skinning a mesh. The hulls count, not the skin: see
/// LiveBody::coverage(). Parts without volume are not hit.
///
/// Each hull is the intersection of its faces' half-spaces, so a ray is clipped by all of them with vector instructions
/// (Cyrus and Beck 1978). What is swept advances by its distance from the hull until that is its radius, to 1e-9 m
/// (conservative advancement, Mirtich 1996). The same answers on every instruction set, for one ray or many.
class RayQuery {
 public:
  /// Takes the present hulls of bodies, which have LiveDetail::kFaces; to be called after LiveBody::update(). Allocates
  /// only if there are more bodies or parts than ever before.
  /// @param bodies  the parts of each; not needed any more after the call
  void update(std::span<const std::span<const LivePart>> bodies);

  /// The nearest hit. A ray that is not finite, or has no direction, or a negative radius hits nothing.
  [[nodiscard]] HullHit nearest(const HullRay& ray) const;
  /// The same for many rays. @param hits  as many as rays
  void nearest(std::span<const HullRay> rays, std::span<HullHit> hits) const;
  /// One hit for each part on the ray's way, nearest first.
  /// @param hits  receives as many of the nearest as it has room for
  /// @return how many there are, which may be more
  std::size_t all(const HullRay& ray, std::span<HullHit> hits) const;
  /// The nearest point of the skin, which is looked for only in parts whose hulls the ray enters. A ray that passes a
  /// hull but not the skin within goes on to the next one. Skin is missed where it sticks out of the hulls: see
  /// LiveBody::coverage(). The ray's `radius` and `half` do not count.
  /// @param skins  one for each body, moved to the same poses
  [[nodiscard]] SkinHit nearestOnSkin(const HullRay& ray, std::span<PosedSkin> skins) const;

 private:
  struct Part {
    Isometry3 partFromWorld = Isometry3::Identity();
    std::size_t firstPlane = 0;                    ///< in planes_
    std::size_t planeCount = 0;                    ///< with padding; 0 = no part
    std::size_t firstVertex = 0, vertexCount = 0;  ///< in vertices_
    int body = 0;
    PartIndex index = 0;
    Aabb box = {};  ///< in its frame, with a margin
  };
  template <typename Visit>
  void visit(const HullRay& ray, const Visit& each) const;

  std::vector<std::size_t> firstPart_;  ///< of each body, and behind the last: multiples of the padding
  BallList bodyBalls_, partBalls_;      ///< as parts_
  std::vector<Part> parts_;             ///< those with volume
  // Of each part planeCount times x, then y, z of its faces' normals, then their offsets: of any length, in the part's
  // frame. Padded with planes behind which is everything.
  std::vector<double> planes_;
  std::vector<Vec3> vertices_;  // of the parts, in their frames
};

}  // namespace lorica

#pragma once

#include "acd/decomposition.h"
#include "geometry/math.h"
#include "skinning/character.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace lorica {

/// Bounding balls, one array a coordinate, padded with balls that nothing hits. Internal.
struct BallList {
  std::vector<double> x;                                  ///< of the middles [m]
  std::vector<double> y;                                  ///< the same
  std::vector<double> z;                                  ///< the same
  std::vector<double> radius;                             ///< [m]
  void resize(std::size_t count);                         ///< new balls are hit by nothing
  void set(std::size_t i, const Vec3& middle, double r);  ///< [m]
  /// [m]
  [[nodiscard]] Vec3 middle(std::size_t i) const { return {x[i], y[i], z[i]}; }
};

/// Where a ray meets the skin, from either side.
struct SkinHit {
  int body = -1;                 ///< index in RayQuery::update(); -1 = no skin was met
  PartIndex part = -1;           ///< one that has a piece of the triangle
  std::int32_t triangle = -1;    ///< of Character::mesh
  Vec3 weights = Vec3::Zero();   ///< barycentric: of its corners in this point; their sum is 1
  double distance = kInfinity;   ///< from the origin [m]
  Vec3 position = Vec3::Zero();  ///< world [m]
  Vec3 normal = Vec3::Zero();    ///< of the triangle's outside, unit

  /// Whether a skin was met.
  explicit operator bool() const { return triangle >= 0; }
};

/// The skin of one body, part by part, for RayQuery::nearestOnSkin(). Only parts whose hulls are hit are skinned, once
/// in a pose. Copies share what does not move. To be used by one thread at a time.
class PosedSkin {
 public:
  /// @param decomposition  made from the character's mesh
  /// @param character      must outlive this
  PosedSkin(const Decomposition& decomposition, const Character& character);

  /// The next pose. Allocates nothing. @param worldFromModel  as of LiveBody::update()
  void update(std::span<const Affine3> worldFromModel);

  /// Takes the nearest triangle of a part that a ray meets before `best.distance`. Allocates nothing.
  /// @param direction  unit
  void meet(PartIndex part, const Vec3& origin, const Vec3& direction, SkinHit& best);

 private:
  /// The triangles of the mesh of which a part has pieces, in groups of neighbours.
  struct Patch {
    std::vector<VertexIndex> vertices;  ///< of the mesh
    std::vector<Triangle> triangles;    ///< of these
    std::vector<std::int32_t> source;   ///< of the mesh
  };
  /// The same in this pose.
  struct PosedPatch {
    std::vector<Vec3> vertices;  ///< world [m]
    BallList balls;              ///< around each group
    bool posed = false;
  };
  void pose(PartIndex part);

  const Character* character_ = nullptr;
  std::shared_ptr<const std::vector<Patch>> patches_;
  std::vector<PosedPatch> posed_;
  std::vector<Affine3> worldFromModel_;
};

}  // namespace lorica

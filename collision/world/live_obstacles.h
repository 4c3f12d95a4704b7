#pragma once

#include "collision/live/live_body.h"
#include "collision/world/prop.h"
#include "geometry/math.h"
#include "skinning/character.h"
#include "skinning/springs/spring_simulation.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// A plane that a tail has to get above.
struct SpringPush {
  Vec3 normal = Vec3::UnitY();  ///< world, unit
  double height = 0.0;          ///< of the plane above the tail's head [m]
  double give = 0.0;            ///< how far below it a tail that is squeezed should get at most [m], above 0
};

/// The live hulls of a body and the props of its world, as obstacles of the body's own springs.
///
/// Hulls are those of the last frame, moved on with the joint that moves most of the part. Two kinds of hull would push
/// a strand away from where it grows, so they do not count as they are:
/// - Hulls of parts that springs move. They are replaced by the hull of the part's points that springs do not move, in
///   the rest pose, fixed to the joint that moves most of these.
/// - Hulls in which a tail lies at rest. A tail at most as deep as its hit radius may stay at that depth, but not get
///   deeper; a tail that is deeper ignores the hull.
/// Props without mass do not count: the avatar passes through them.
class LiveObstacles final : public SpringObstacles {
 public:
  /// @param body  of the character
  LiveObstacles(const LiveBody& body, const Character& character, const SpringSimulation& springs);

  /// Takes a frame. Allocates nothing.
  /// @param parts     of the body in the last frame
  /// @param last,now  worldFromModel of all joints in the last frame and in this one, springs at any rotation
  /// @param props     where they are, with velocities
  /// @param seconds   from the last frame to this one
  void prepare(std::span<const LivePart> parts, std::span<const Affine3> last, std::span<const Affine3> now,
               std::span<const Prop> props, double seconds);

  void moveTo(double share) override;
  void pushOut(std::size_t spring, const Vec3& head, double length, Vec3& tail) override;

  /// How far a tail is below where obstacles let it be, at most over all of them [m]; 0 or less if it is free.
  [[nodiscard]] double below(std::size_t spring, const Vec3& head, const Vec3& tail) const;

  /// Signed distance of a point from the planes of a part's obstacle as of the last moveTo() [m], negative inside.
  /// Nothing if the spring ignores the part.
  [[nodiscard]] std::optional<double> distance(std::size_t spring, PartIndex part, const Vec3& point) const;

 private:
  struct Plane {
    Vec3 normal = Vec3::UnitY();  ///< outward, unit
    double offset = 0.0;          ///< normal . p on the plane [m]
  };
  /// A convex body with faces, in a frame of its own.
  struct Solid {
    std::vector<Plane> planes;  ///< none: no obstacle
    Vec3 center = Vec3::Zero();
    double radius = 0.0;  ///< of a ball around `center` that contains it [m]
    JointIndex joint = 0;
    bool live = true;  ///< its planes are the live hull's; else fixed to the joint
    Isometry3 begin = Isometry3::Identity(), end = Isometry3::Identity(), worldFromSolid = Isometry3::Identity();
  };

  [[nodiscard]] static double depthless(const Solid& solid, const Vec3& point);
  static void takeFaces(const ConvexHull& hull, Solid& solid);
  void placeAtRest(const LiveBody& body, const Character& character, const SpringSimulation& springs);
  [[nodiscard]] static std::optional<SpringPush> pushOf(const Solid& solid, double radius, double hitRadius,
                                                        const Vec3& head, double length, const Vec3& tail);
  [[nodiscard]] std::optional<SpringPush> pushOf(const Prop& prop, double radius, const Vec3& head,
                                                 const Vec3& tail) const;

  std::vector<Solid> solids_;     ///< one for each part
  std::vector<double> radii_;     ///< of each spring and part [m]; -infinity: ignored
  std::vector<double> hitRadii_;  ///< of each spring [m]
  std::span<const Prop> props_;
  double seconds_ = 0.0, share_ = 1.0;  ///< of this frame
};

}  // namespace lorica

#pragma once

#include "acd/decomposition.h"
#include "collision/live_part.h"
#include "geometry/math.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace lorica {

enum class PropShape : std::uint8_t { kBox, kSphere, kCapsule, kCylinder };
inline constexpr int kPropShapeCount = 4;

/// A rigid body of the virtual world.
struct Prop {
  PropShape shape = PropShape::kBox;
  /// Box: half its sides; sphere: x is the radius; capsule and cylinder: about the prop's y axis, x is the radius, y
  /// half the height, caps included [m].
  Vec3 halfExtents = Vec3::Constant(0.1);
  double mass = 1.0;  ///< [kg]; 0 = furniture, which nothing moves and which the avatar passes through
  double friction = 0.6;
  double restitution = 0.2;
  Isometry3 worldFromProp = Isometry3::Identity();
  Vec3 velocity = Vec3::Zero();           ///< [m/s]
  Vec3f color = Vec3f(0.8f, 0.5f, 0.2f);  ///< linear RGB, 0 to 1
};

/// Of the sphere around a prop's middle that holds it [m].
[[nodiscard]] double boundingRadius(const Prop& prop);

inline constexpr int kWorldItself = -1;

/// A place where a part of the avatar touched a prop during the last step. Hits shorter than the step are here too.
struct Contact {
  PartIndex part = 0;
  int prop = 0;
  Vec3 point = Vec3::Zero();   ///< world [m]
  Vec3 normal = Vec3::Zero();  ///< from the part to the prop, unit
  double depth = 0.0;          ///< deepest penetration in the step [m], > 0 when they overlap
  double impulse = 0.0;        ///< along the normal, summed over the step [N s]
};

/// Rigid-body world with a floor, props, and the avatar's parts as kinematic bodies: they push props, and
/// nothing pushes them. Parts touch props only, neither each other nor the floor. Bullet, single precision, substeps
/// that follow from what moves: the same inputs give the same motion, bit for bit.
class World {
 public:
  struct Settings {
    Vec3 gravity{0.0, -9.81, 0.0};        ///< [m/s^2]
    bool floor = true;                    ///< at y = 0
    double substepSeconds = 1.0 / 240.0;  ///< longest substep; a frame without fast parts is cut into equal ones
  };
  World();
  explicit World(const Settings& settings);
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  /// @param prop  extents above zero, no capsule lower than wide
  /// @return its index in props() and in Contact::prop; they count up from 0
  int addProp(const Prop& prop);
  /// Ties two props together at a place, as by a ball joint; they do not touch each other from then on.
  /// @param a,b    of props(), different; kWorldItself for one of them hangs the other up
  /// @param place  world [m]
  void addLink(int a, int b, const Vec3& place);

  /// Moves the world from the last frame to this one; the parts sweep from their previous to their present motion.
  ///
  /// A prop that is hit gets the velocity of the place that hits it, and bounces as its restitution says. Where a
  /// part and a prop may meet, substeps are so short that they come closer by at most 2.5 cm in each: whatever the
  /// length of the frame, a prop at least 4 cm thin is not passed through by a part at least 2 cm thin.
  ///
  /// No place of a part strikes faster than 0.5 m/s where the part's trust is 0; the bound rises with it, and where it
  /// is 1 there is none: a prop that a wholly distrusted part hits leaves with at most 1.1 m/s, twice that speed and
  /// 0.1 m/s for what overlaps.
  ///
  /// A part faster than 25 m/s (a tracker's jump) is put in its new place without sweeping; a part with a degenerate
  /// hull touches nothing in this frame.
  /// @param parts    the avatar; the same parts in every call, or none
  /// @param seconds  length of the frame [s]; 0 moves the parts only
  void step(std::span<const LivePart> parts, double seconds);

  /// Props with their present place and velocity.
  [[nodiscard]] std::span<const Prop> props() const;
  /// Contacts between the avatar and props in the last step, by part, then prop. A pair has a contact for each place
  /// where it touched; touches within 2 cm of each other are one place.
  [[nodiscard]] std::span<const Contact> contacts() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lorica

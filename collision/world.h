#pragma once

#include "collision/live_body.h"
#include "geometry/math.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace lorica {

enum class PropShape : std::uint8_t { kBox, kSphere };

/// A rigid body of the virtual world.
struct Prop {
  PropShape shape = PropShape::kBox;
  Vec3 halfExtents = Vec3::Constant(0.1);  ///< box: half its sides; sphere: x is the radius [m]
  double mass = 1.0;                       ///< [kg]
  double friction = 0.6;
  double restitution = 0.2;
  Isometry3 worldFromProp = Isometry3::Identity();
  Vec3 velocity = Vec3::Zero();           ///< [m/s]
  Vec3f color = Vec3f(0.8f, 0.5f, 0.2f);  ///< linear RGB, 0 to 1
};

/// A place where a part of the avatar touches a prop.
struct Contact {
  PartIndex part = 0;
  int prop = 0;
  Vec3 point = Vec3::Zero();   ///< world [m]
  Vec3 normal = Vec3::Zero();  ///< from the part to the prop, unit
  double depth = 0.0;          ///< penetration [m], > 0 when they overlap
  double impulse = 0.0;        ///< [N s]
};

/// Rigid-body world with a floor at y = 0, props, and the avatar's parts as kinematic bodies. Bullet, single
/// precision, fixed substeps: the same inputs give the same motion.
class World {
 public:
  struct Settings {
    Vec3 gravity{0.0, -9.81, 0.0};  ///< [m/s^2]
    double substepSeconds = 1.0 / 240.0;
  };
  World();
  explicit World(const Settings& settings);
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  int addProp(const Prop& prop);

  /// Moves the world from the last frame to this one; the parts sweep from their previous to their present motion.
  /// @param parts    the avatar; the same number in every call; may be empty
  /// @param seconds  length of the frame [s]
  void step(std::span<const LivePart> parts, double seconds);

  /// Props with their present place and velocity.
  [[nodiscard]] std::span<const Prop> props() const;
  /// Contacts between the avatar and props in the last step; one an avatar part, prop and manifold point.
  [[nodiscard]] std::span<const Contact> contacts() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lorica

#pragma once

#include "acd/decomposition.h"
#include "collision/live/live_part.h"
#include "collision/particles/particles.h"
#include "collision/world/prop.h"
#include "geometry/math.h"
#include "skinning/skeleton.h"

#include <memory>
#include <optional>
#include <span>

namespace lorica {

inline constexpr int kWorldItself = -1;

/// A place where a part of the avatar touched a prop during the last step. Hits shorter than the step are here too.
struct Contact {
  PartIndex part = 0;
  int prop = 0;
  JointIndex bone = kNoJoint;  ///< of the character, that moves the place most; a world knows none, Session fills it in
  Vec3 point = Vec3::Zero();   ///< world [m]
  Vec3 normal = Vec3::Zero();  ///< from the part to the prop, unit
  double depth = 0.0;          ///< deepest penetration in the step [m], > 0 when they overlap
  double impulse = 0.0;        ///< along the normal, summed over the step [N s]
};

struct Ray {
  Vec3 origin = Vec3::Zero();      ///< world [m]
  Vec3 direction = Vec3::UnitZ();  ///< of any length but 0
};

/// Where a ray meets a prop.
struct PropPick {
  int prop = 0;
  Vec3 place = Vec3::Zero();  ///< world [m]
  double distance = 0.0;      ///< from the ray's origin [m]
};

/// A prop that is held by a place of it.
struct PropGrab {
  int prop = 0;
  Vec3 place = Vec3::Zero();   ///< where the place on the prop is now, world [m]
  Vec3 target = Vec3::Zero();  ///< where it is drawn to, world [m]
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
    /// What would be inside the avatar in the first step that has parts goes out of its way before it, see roomFor().
    bool makesRoom = false;
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

  /// So many thrown props there are at most.
  static constexpr int kMostThrown = 64;
  /// Adds a prop while the world runs, with the velocity that it has. When there are kMostThrown, the oldest thrown one
  /// becomes it, at its index.
  /// @return its index
  int throwProp(const Prop& prop);

  /// The first prop that a ray meets within 200 m, furniture too. Not through the floor; the avatar is not in the way.
  [[nodiscard]] std::optional<PropPick> pick(const Ray& ray) const;
  /// Takes hold of a prop at a place of it: from then on a soft ball joint draws that place to where moveGrab() says,
  /// with at most 600 N and 200 m/s^2, at up to 8 m/s. What is held before is released.
  /// @param place  world [m], within 1 m of the prop
  /// @return false where there is no such prop, or it is furniture, or not there: nothing is held then
  bool grab(int prop, const Vec3& place);
  /// @param place  world [m], finite; without a grab nothing happens
  void moveGrab(const Vec3& place);
  /// The prop goes on as fast as it is.
  void release();
  [[nodiscard]] std::optional<PropGrab> held() const;

  /// Sand or water that the parts push from now on, in the place of what there was. Props and particles pass through
  /// each other.
  void setParticles(const ParticleSettings& settings);
  /// Null = none.
  [[nodiscard]] const Particles* particles() const { return particles_.get(); }
  /// What moving them took in the last step [s].
  [[nodiscard]] double particleSeconds() const { return particleSeconds_; }

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
  /// The same, for who knows the bones.
  [[nodiscard]] std::span<Contact> contacts();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  std::unique_ptr<Particles> particles_;
  double particleSeconds_ = 0.0;
};

}  // namespace lorica

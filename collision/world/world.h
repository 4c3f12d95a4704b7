#pragma once

#include "acd/decomposition.h"
#include "collision/live/live_part.h"
#include "collision/world/prop.h"
#include "geometry/math.h"
#include "skinning/skeleton.h"

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

class Particles;
struct ParticleSettings;

inline constexpr int kWorldItself = -1;  ///< in place of a prop: what stands

/// A point where a part of an avatar touched a prop during the last step, including contacts shorter than the step.
struct Contact {
  int avatar = 0;              ///< index in stepAvatars()
  PartIndex part = 0;          ///< of that avatar
  int prop = 0;                ///< index in props()
  JointIndex bone = kNoJoint;  ///< of the character, with the most influence on the point; filled in by Session
  Vec3 point = Vec3::Zero();   ///< world [m]
  Vec3 normal = Vec3::Zero();  ///< from the part to the prop, unit
  double depth = 0.0;          ///< deepest penetration in the step [m], > 0 when they overlap
  double impulse = 0.0;        ///< along the normal, summed over the step [N s]
};

/// A half-line.
struct Ray {
  Vec3 origin = Vec3::Zero();      ///< world [m]
  Vec3 direction = Vec3::UnitZ();  ///< of any length except 0
};

/// Intersection of a ray with a prop.
struct PropPick {
  int prop = 0;                  ///< index in props()
  Vec3 position = Vec3::Zero();  ///< world [m]
  double distance = 0.0;         ///< from the ray's origin [m]
};

/// A prop that is held at a point on it.
struct PropGrab {
  int prop = 0;                  ///< index in props()
  Vec3 position = Vec3::Zero();  ///< current position of the held point, world [m]
  Vec3 target = Vec3::Zero();    ///< position that it is pulled to, world [m]
};

/// Rigid-body world with a floor, props, and the parts of avatars as kinematic bodies: they push props, and nothing
/// pushes them. Parts collide with props only, neither with each other nor with the floor. Uses Bullet in single
/// precision, with a number of substeps that depends on the speeds. Deterministic: the same inputs give the same
/// motion, bit for bit.
class World {
 public:
  /// What is set once.
  struct Settings {
    Vec3 gravity{0.0, -9.81, 0.0};        ///< [m/s^2]
    bool floor = true;                    ///< at y = 0
    double substepSeconds = 1.0 / 240.0;  ///< longest substep; a frame without fast parts has equal substeps
    /// Before the first step that has parts, props inside the avatars are moved out of them, see resolveOverlaps().
    bool resolvesOverlaps = false;
  };
  World();
  /// Without props and avatars.
  explicit World(const Settings& settings);
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  static constexpr int kMaxProps = 4096;  ///< of a world, thrown ones included
  /// @param prop  extents above zero; a capsule must be at least as high as wide; at most kMaxProps
  /// @return its index in props() and in Contact::prop; indices count up from 0
  int addProp(const Prop& prop);
  /// Links two props with a ball joint; they no longer collide with each other.
  /// @param a,b       of props(), different; kWorldItself for one of them fixes the other to the world
  /// @param position  of the joint, world [m]
  void addLink(int a, int b, const Vec3& position);

  /// Maximum number of thrown props.
  static constexpr int kMaxThrown = 64;
  /// Adds a prop with its velocity while the world runs. If there are kMaxThrown already, it replaces the oldest thrown
  /// prop and takes its index.
  /// @return its index
  int throwProp(const Prop& prop);

  /// The first prop that a ray meets within 200 m, including static bodies. The floor blocks the ray, the avatar does
  /// not.
  [[nodiscard]] std::optional<PropPick> pick(const Ray& ray) const;
  static constexpr int kMaxHands = 16;  ///< hands that may hold a prop at the same time
  /// Grabs a prop at a point: a soft ball joint pulls that point to the target of moveGrab(), with at most 600 N and
  /// 200 m/s^2, at up to 8 m/s. What this hand held before is released. Several hands may hold one prop: all of them
  /// pull, and share the 200 m/s^2.
  /// @param position  world [m], within 1 m of the prop
  /// @param hand      0 to kMaxHands - 1; each holds one prop
  /// @return false if there is no such prop, if it is a static body or if it is out of reach: nothing is held then
  bool grab(int prop, const Vec3& position, int hand = 0);
  /// Moves the target of a hand. Does nothing if it holds nothing.
  /// @param position  world [m], finite
  void moveGrab(const Vec3& position, int hand = 0);
  /// Releases what a hand holds.
  /// @param velocity  with which the prop leaves the last hand that holds it [m/s]; 0 = with its own
  void release(const Vec3& velocity = Vec3::Zero(), int hand = 0);
  [[nodiscard]] std::optional<PropGrab> held(int hand = 0) const;  ///< what a hand holds, if anything

  /// Adds sand or water that the parts push, and replaces earlier particles. Props and particles push each other;
  /// none starts in a prop that is there already.
  /// @return an error if a setting is out of range (kInvalidArgument): then nothing has changed
  Result<void> setParticles(const ParticleSettings& settings);
  /// Null if there are none.
  [[nodiscard]] const Particles* particles() const { return particles_.get(); }
  /// Settles them around avatars that stand, before the first step, which does it otherwise.
  /// @param avatars  see stepAvatars()
  void settle(std::span<const std::span<const LivePart>> avatars);
  /// Particles::watchSettling() of the present ones.
  void watchSettling(std::function<bool(int frame, int frames)> watch);
  /// Time that the particles took in the last step [s].
  [[nodiscard]] double particleSeconds() const { return particleSeconds_; }

  /// Advances the world from the last frame to this one; the parts sweep from their previous to their current pose.
  ///
  /// A prop that is hit gets the velocity of the contact point on the part and bounces according to its restitution. If
  /// a part and a prop may meet, substeps are so short that they approach by at most 2.5 cm in each. So a part of at
  /// least 2 cm thickness never passes through a prop of at least 4 cm thickness, whatever the length of the frame.
  ///
  /// A part of trust 0 strikes with at most 0.5 m/s at any point; the limit rises with the trust, and at trust 1 there
  /// is none. A prop hit by a part of trust 0 leaves with at most 1.1 m/s: twice that speed, and 0.1 m/s from resolving
  /// the overlap.
  ///
  /// A part faster than 25 m/s (a tracker's jump) is set to its new pose without sweeping; a part with a degenerate
  /// hull touches nothing in this frame.
  /// @param avatars  the parts of each; the same parts in every call, or none while the avatar is not there: it comes
  ///                 back without sweeping. Parts beyond kMaxParts in total touch nothing. If there are more than
  ///                 128, parts that are far from all props are left out: a prop that is hit in this frame and flies
  ///                 to one of them, farther than 0.25 m, meets it in the next frame. Props that may touch then form
  ///                 islands, each with substeps of its own of at most 1/90 s, and sleep after 0.5 s instead of 2 s;
  ///                 what this loses is in docs/AVATARS.md.
  /// @param seconds  length of the frame [s]; 0 moves the parts only
  void stepAvatars(std::span<const std::span<const LivePart>> avatars, double seconds);
  /// The same with one avatar.
  void step(std::span<const LivePart> avatar, double seconds) { stepAvatars(std::span(&avatar, 1), seconds); }

  static constexpr int kMaxParts = 28'000;  ///< of all avatars together

  /// Whether there is a floor, at y = 0.
  [[nodiscard]] bool hasFloor() const;
  /// Props with their current pose and velocity.
  [[nodiscard]] std::span<const Prop> props() const;
  /// Contacts between avatars and props in the last step, sorted by avatar, part, then prop. A pair has one contact for
  /// each point where it touched; points within 2 cm of each other are merged.
  [[nodiscard]] std::span<const Contact> contacts() const;
  /// Mutable access, so that Session can fill in the bones.
  [[nodiscard]] std::span<Contact> contacts();

 private:
  [[nodiscard]] std::span<const LivePart> partsForParticles(std::span<const std::span<const LivePart>> avatars);

  struct Impl;
  std::unique_ptr<Impl> impl_;
  std::unique_ptr<Particles> particles_;
  double particleSeconds_ = 0.0;
  std::vector<LivePart> allParts_;  // of several avatars, for the particles
};

}  // namespace lorica

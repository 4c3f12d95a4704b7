#pragma once

#include "geometry/math.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

class ParticleGrid;
struct ParticleRow;

/// A rigid body that meets particles in one frame. Its own frame has its origin at the centre of mass and the principal
/// axes of inertia.
struct ParticleBody {
  /// See Prop.
  enum class Shape : std::uint8_t { kBox, kSphere, kCapsule, kCylinder, kHulls };
  /// Faces of a convex hull: outward normal and distance from the origin, own frame [m].
  using Hull = std::vector<Eigen::Vector4f>;

  Shape shape = Shape::kBox;           ///< says what the numbers below mean
  Vec3 halfExtents = Vec3::Ones();     ///< see Prop [m]
  std::span<const Hull> hulls;         ///< of kHulls
  double radius = 1.0;                 ///< around the centre of mass [m]
  double inverseMass = 0.0;            ///< 0 = nothing moves it [1/kg]
  Vec3 inverseInertia = Vec3::Zero();  ///< about its own axes [1/(kg m^2)]

  /// Where it is, and how it moves.
  struct Motion {
    Isometry3 worldFromBody = Isometry3::Identity();  ///< [m]
    Vec3 velocity = Vec3::Zero();                     ///< of the centre of mass, world axes [m/s]
    Vec3 angularVelocity = Vec3::Zero();              ///< world axes [rad/s]
  };
  Motion from;          ///< at the frame's begin
  Motion to;            ///< at its end if there were no particles; then with them
  bool pushed = false;  ///< whether particles changed `to`
};

/// Distance of a point from a body's surface, below 0 inside [m]. Outside of kHulls, and beyond the reach, it is a
/// lower bound.
/// @param point   in the body's frame [m]
/// @param normal  outward there
[[nodiscard]] float distanceFrom(const ParticleBody& body, const Vec3f& point, float reach, Vec3f& normal);
/// Whether a point in world space is nearer to a body, at the frame's begin, than `away` [m].
[[nodiscard]] bool isWithin(const ParticleBody& body, const Vec3f& point, float away);
/// Half the sides of a box with the axes of the world around a body's centre of mass [m].
/// @param bodyFromWorld  its rotation
[[nodiscard]] Vec3f extentOf(const ParticleBody& body, const Eigen::Matrix3f& bodyFromWorld);

/// The bodies of a frame while particles move in substeps: contacts, and impulses of equal size on both sides. Internal
/// to the particle simulations.
///
/// A body follows the path that it has without particles; what they change in its velocity is added to that path, so a
/// light body answers within the substep. Allocates only for more bodies or contacts than ever before.
class ParticleBodies {
 public:
  /// Begins a frame of `seconds`.
  void begin(std::span<ParticleBody> bodies, double seconds, int substeps);
  [[nodiscard]] bool empty() const { return bodies_.empty(); }  ///< no bodies in this frame
  /// Moves the bodies to the end of a substep.
  void advance(int substep);
  /// Calls work(min, max) for a box around each, where it is now [m].
  template <class Work>
  void forBoxes(const Work& work) const {
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const Vec3f middle = states_[b].position.cast<float>(), half = extentOf(bodies_[b], states_[b].bodyFromWorld);
      work(Vec3f(middle - half), Vec3f(middle + half));
    }
  }
  /// Writes what the particles changed to the bodies.
  void finish();

  /// A particle that is near a body in a substep.
  struct Contact {
    std::uint32_t particle;  ///< index in their simulation
    std::uint32_t body;      ///< index in begin()
    float distance;          ///< of the particle from the surface [m]
    Vec3f normal;            ///< out of the body
  };
  /// Collects the particles that may come within a distance of the bodies in this substep: kMaxParticlePairs in all,
  /// those of the first bodies.
  /// @param moved  how far any particle can be from where it was sorted [m]
  void gather(const ParticleGrid& grid, std::span<const ParticleRow> positions, float reach, float moved);
  /// Those that are now within a distance, by body.
  std::span<const Contact> find(std::span<const ParticleRow> positions, float reach);
  /// Sets the flags of particles near bodies that move visibly. Positions are those of the last sorting.
  void markAround(const ParticleGrid& grid, float margin, std::vector<std::uint8_t>& flags) const;

  /// How easily a body gives way at a contact, along its normal [1/kg].
  [[nodiscard]] double yielding(const Contact& contact, const ParticleRow& at) const;
  /// Number of contacts of a body, of those found last.
  [[nodiscard]] std::uint32_t contactsOf(std::uint32_t body) const { return states_[body].contacts; }
  /// @param impulse  on the body [N s]
  void push(const Contact& contact, const ParticleRow& at, const Vec3& impulse);
  /// Removes the approach of a particle and a body, and their sliding as far as friction can.
  /// @param inverseMass  of the particle; 0 = it stays [1/kg]
  /// @param leaving      speed at which they then part, or, below 0, may still approach [m/s]
  /// @return the change of the particle's velocity [m/s]
  Vec3f collide(const Contact& contact, const ParticleRow& at, const Vec3f& velocity, double inverseMass,
                double friction, double leaving);
  /// Takes a share of the particle's velocity along the surface to the body. @return the change of its velocity [m/s]
  Vec3f drag(const Contact& contact, const ParticleRow& at, const Vec3f& velocity, double mass, double share);
  /// Moves the bodies on by what push() and collide() have changed since the last call.
  void follow();

 private:
  struct State {
    Vec3 position, velocity, spin;
    Quat rotation;
    Vec3 shift, addedVelocity, addedSpin;  // by particles, in this frame
    Vec3 pendingVelocity, pendingSpin;     // of those, what the pose does not yet follow
    Quat turn;
    Mat3 inverseInertia;  // world axes
    Eigen::Matrix3f bodyFromWorld;
    std::uint32_t contacts;
  };
  void place(State& state, const ParticleBody& body, double fraction) const;
  void give(State& state, const ParticleBody& body, const Vec3& arm, const Vec3& impulse);

  std::span<ParticleBody> bodies_;
  std::vector<State> states_;
  std::vector<Contact> candidates_, contacts_;
  double seconds_ = 0.0;  // of a substep
  int substeps_ = 1;
  double ownShare_ = 0.5;  // of a change of velocity in the substep that makes it
};

}  // namespace lorica

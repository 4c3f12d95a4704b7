#pragma once

#include "collision/world/dynamics_world.h"
#include "collision/world/part_dispatcher.h"
#include "collision/world/part_shape.h"
#include "collision/world/prop_body.h"
#include "collision/world/strike_limit.h"
#include "collision/world/world.h"
#include "geometry/counts.h"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <btBulletDynamicsCommon.h>

#include <array>
#include <cmath>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

namespace lorica {

struct PartCollider;

/// Props that may touch within a tick, directly or through parts, with all that may touch them. Internal.
///
/// No other island reads or writes what one changes, so cores solve islands at the same time, each with the number of
/// substeps that its own fastest approach needs.
struct Island {
  std::vector<btCollisionObject*> props;
  std::vector<PartCollider*> parts;
  std::vector<btBroadphasePair*> pairs;
  std::vector<btTypedConstraint*> joints;
  std::vector<Contact> contacts;  ///< of all substeps
  btManifoldArray manifolds;      ///< with contacts, in this substep
  std::unique_ptr<ContactSolver> solver = std::make_unique<ContactSolver>();

  void clear();
};

/// Sets of numbers that are united step by step; the name of a set is its smallest number. Internal.
class DisjointSets {
 public:
  void reset(int count);
  [[nodiscard]] int find(int i);
  void unite(int i, int j);

 private:
  std::vector<int> parents_;
};

/// A part of a frame in which bodies keep their islands. Internal.
struct Tick {
  double begin = 0.0;    ///< fraction of the frame
  double share = 0.0;    ///< length as a fraction of the frame
  double seconds = 0.0;  ///< length of the frame
};

/// What a world needs to step a crowd; memory is kept from tick to tick. Internal.
struct Crowd {
  bool present = false;  ///< many parts: those far from all props are left out, and islands step on their own
  std::vector<PartCollider*> parts;  ///< those in the world
  DisjointSets sets;                 ///< of props, then parts
  std::vector<int> islandOfSet;      ///< index in `islands`, or -1
  std::vector<Island> islands;
  std::size_t islandCount = 0;      ///< of `islands`, in this tick
  std::vector<std::size_t> bySize;  ///< the islands, the largest first
  btManifoldArray manifolds;        ///< scratch
};

/// A part and a prop that may meet approach by at most this much in a substep. The thinnest pair that is guaranteed to
/// collide, 2 cm and 4 cm, has half thicknesses of 3 cm together. Internal [m].
inline constexpr double kLongestApproach = 0.025;
/// Faster approaches get no shorter substeps. Internal [m/s].
inline constexpr double kFastestApproach = 2.0 * kTeleportSpeed;

/// A part's motion within one frame: the origin moves on a straight line, the rotation has a fixed axis and constant
/// speed. Internal.
struct Sweep {
  Vec3 origin = Vec3::Zero();
  Quat rotation = Quat::Identity();
  Vec3 travel = Vec3::Zero();  ///< over the whole frame [m]
  Vec3 axis = Vec3::UnitX();   ///< world, unit
  double angle = 0.0;          ///< over the whole frame [rad]
  double radius = 0.0;         ///< of the part around its origin [m]
  double strength = 1.0;       ///< share of the velocity that is transferred to props

  [[nodiscard]] btTransform at(double fraction) const;
  /// Bound on the way of any point over the whole frame [m].
  [[nodiscard]] double path() const { return travel.norm() + std::abs(angle) * radius; }
};

struct PartCollider {
  explicit PartCollider(btScalar margin) : shape(margin) {}
  PartShape shape;
  std::unique_ptr<btRigidBody> body;
  bool counts = false;  ///< in this frame
  bool inWorld = false;
  btVector3 low{0, 0, 0}, high{0, 0, 0};  ///< bounds in a tick of a crowd, or in a frame
  bool reshaped = false;
  int slot = 0;  ///< in the crowd's sets
  Sweep sweep;
};

/// A ball that holds a prop during the frame. Internal.
struct PropReach {
  double begin = 0.0;  ///< smallest x [m]
  Vec3 center = Vec3::Zero();
  double radius = 0.0;
  [[nodiscard]] bool operator<(const PropReach& other) const { return begin < other.begin; }
};

/// The joint by which a hand holds a prop.
struct GrabAnchor {
  int prop = 0;
  Vec3 target = Vec3::Zero();  ///< requested position
  Vec3 drawn = Vec3::Zero();   ///< where the joint pulls the prop now, on the way to the target
  btVector3 inBody{0, 0, 0};   ///< held point in the body's frame
  std::unique_ptr<btPoint2PointConstraint> joint;
};

/// Keeps the number of pairs that the broad phase reports within bounds: further pairs pass through each other until
/// they part. Pairs with parts of the avatar have twice the room.
class PairLimit : public btOverlapFilterCallback {
 public:
  explicit PairLimit(const btOverlappingPairCache& pairs) : pairs_(pairs) {}
  bool needBroadphaseCollision(btBroadphaseProxy* a, btBroadphaseProxy* b) const override;

 private:
  const btOverlappingPairCache& pairs_;
};

struct World::Impl {
  // The sweep-and-prune grid. Bodies outside are still handled, but less efficiently.
  static constexpr btScalar kGridHalfSize = 64.0f;
  static constexpr unsigned short kMaxBodies = 32'500;

  Settings settings;
  btDefaultCollisionConfiguration configuration;
  PartDispatcher dispatcher{&configuration};
  // Not the usual btDbvtBroadphase: it balances its tree by comparing addresses, so the order of contacts, and thus the
  // motion, would differ from run to run.
  btAxisSweep3 broadphase{btVector3(-kGridHalfSize, -kGridHalfSize, -kGridHalfSize),
                          btVector3(kGridHalfSize, kGridHalfSize, kGridHalfSize), kMaxBodies, nullptr, true};
  PairLimit pairLimit{*broadphase.getOverlappingPairCache()};
  ContactSolver solver;
  DynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  btStaticPlaneShape floorShape{btVector3(0, 1, 0), 0};
  std::unique_ptr<btRigidBody> floor;
  std::vector<std::vector<std::unique_ptr<PartCollider>>> avatars;  ///< the parts of each
  /// Of props that parts can move, by their smallest x. Empty if all parts count.
  std::vector<PropReach> reaches;
  double widestReach = 0.0;  ///< greatest radius of `reaches`
  Crowd crowd;
  std::vector<PropBody> propBodies;
  std::vector<std::unique_ptr<btTypedConstraint>> links;
  std::vector<Prop> props;
  std::vector<Contact> contacts;
  std::vector<ParticleBody> met;                           ///< of the props, while particles move
  std::deque<int> thrown;                                  ///< oldest first
  std::array<std::optional<GrabAnchor>, kMaxHands> grabs;  ///< of each hand
  bool overlapsResolved = false;

  explicit Impl(const Settings& s);
  ~Impl();
  void replaceProp(int index, const Prop& prop);
  void addBody(const PropBody& body, bool isStatic);
  [[nodiscard]] bool isProp(int index) const { return index >= 0 && index < countOf(props); }
  /// Number of hands that hold a prop.
  [[nodiscard]] int holdersOf(int prop) const;
  void release(int hand);
  void drawGrabbed(int hand, double seconds);
  void resolveInitialOverlaps(std::span<const std::span<const LivePart>> avatars);
  void setPartCounts(std::span<const std::span<const LivePart>> present);
  void setPartCount(std::size_t avatar, std::size_t count);
  void findReaches(double seconds);
  void findNear(std::span<const LivePart> parts, std::vector<PropReach>& near) const;
  void takeParts(std::span<const std::span<const LivePart>> present, double seconds);
  void readPart(PartCollider& part, const LivePart& live, std::span<const PropReach> near, double seconds) const;
  void followSurfaces();
  [[nodiscard]] double longestSubstep(double fraction, double usual, double seconds) const;
  static void movePart(PartCollider& part, double fraction, double seconds);
  void stepTogether(double seconds);
  void stepCrowd(double seconds);
  void setTickBounds(const Tick& tick);
  void wakeTouched(const Tick& tick);
  void findIslands();
  [[nodiscard]] double longestSubstep(const Island& island, double fraction, double left, double seconds) const;
  void stepIsland(Island& island, const Tick& tick);
  void substep(Island& island, double length);
  void sleepAtRest(double seconds);
  [[nodiscard]] static bool isAwake(const btCollisionObject& body);
  [[nodiscard]] const PartCollider& partOf(const btCollisionObject& body) const {
    return *avatars[body.getUserIndex3()][body.getUserIndex()];
  }
  [[nodiscard]] btContactSolverInfo solverInfo(double length);
  static void collectContacts(const btPersistentManifold& manifold, std::vector<Contact>& contacts);
  void keepAboveFloor(btRigidBody& body) const;
  static void noteContact(std::vector<Contact>& contacts, const Contact& contact);
  void readProps();
  /// The props as particles meet them, before and after they have moved in a frame.
  std::vector<ParticleBody>& bodiesBefore();
  std::span<ParticleBody> bodiesAfter(double seconds);
  void takeBodies();
};

enum CollisionGroup : int { kFloorGroup = 1, kPropGroup = 2, kPartGroup = 4 };

}  // namespace lorica
